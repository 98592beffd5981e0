/* peel_dump.h: writes the framebuffers of an OpenGL program as a trace that `peel check` reads.
 *
 * C99 or C++, this one file, no library. Needs OpenGL 3.0 or OpenGL ES 3.0, through the function
 * that gives its entry points, whatever it is called (glfwGetProcAddress, OSMesaGetProcAddress):
 *
 *     PeelDump dump;
 *     peel_dump_open(&dump, "mine.peel", (PeelDumpLoad)glfwGetProcAddress);
 *     ... draw the opaque surfaces ...
 *     peel_dump_depth(&dump, "opaque.depth", framebuffer, PEEL_DUMP_D32F, width, height);
 *     ... for each peel, front to back ...
 *     peel_dump_depth(&dump, "peel.0.depth", framebuffer, PEEL_DUMP_D32F, width, height);
 *     peel_dump_color(&dump, "peel.0.accum", framebuffer, GL_COLOR_ATTACHMENT0, PEEL_DUMP_RGBA32F,
 *                     width, height);
 *     ...
 *     if (peel_dump_close(&dump) != 0)
 *         fprintf(stderr, "%s\n", dump.error);
 *
 *     peel check scene.gltf mine.peel
 *
 * Buffers (any of them, in any order; K counts peels from 0):
 *     opaque.depth                     window depth of the opaque surfaces
 *     opaque.normal .position .diffuse .material    their G-buffer: view space; see the contract
 *     peel.K.depth                     window depth of layer K, the clear value where there is none
 *     peel.K.normal .position .diffuse .material    its G-buffer
 *     peel.K.accum                     linear colour so far, premultiplied, over nothing; A is the
 *                                      transmittance that is left, from 1
 *     accum                            the same behind the opaque surfaces
 *     display                          what is shown, PEEL_DUMP_RGBA8
 * Values are what the framebuffer stores: name its format, and no value is converted.
 *
 * Functions return 0, or -1 after a failure, which sticks: dump.error is one line. They change the
 * binding of GL_READ_FRAMEBUFFER, the framebuffer's read buffer and the pack parameters and restore
 * them; errors that glGetError had to tell are lost. No pixel pack buffer may be bound.
 *
 * The file: for each buffer one line of text, "peel-dump 1 NAME FORMAT WIDTHxHEIGHT ROWS ORDER",
 * and its pixels, tightly packed. FORMAT: rgba32f rgba16f rgba16 rgba8 rg32f rg16 r32f d32f, or d24
 * and d16, of which each depth is a 32-bit integer. ROWS: bottom or top, which row is first. ORDER:
 * little or big, of the bytes of a value. */
#ifndef PEEL_DUMP_H
#define PEEL_DUMP_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32) && !defined(_WIN64)
#define PEEL_DUMP_CALL __stdcall
#else
#define PEEL_DUMP_CALL
#endif

typedef enum PeelDumpFormat {
    PEEL_DUMP_RGBA32F,
    PEEL_DUMP_RGBA16F,
    PEEL_DUMP_RGBA16,
    PEEL_DUMP_RGBA8,
    PEEL_DUMP_RG32F,
    PEEL_DUMP_RG16,
    PEEL_DUMP_R32F,
    PEEL_DUMP_D32F,
    PEEL_DUMP_D24, /* also of packed depth and stencil */
    PEEL_DUMP_D16
} PeelDumpFormat;

typedef void(PEEL_DUMP_CALL *PeelDumpEntry)(void);
typedef PeelDumpEntry (*PeelDumpLoad)(const char *name);

/* Fields are private but for error. */
typedef struct PeelDump {
    const char *error; /* NULL while all is well */
    FILE *file;
    void(PEEL_DUMP_CALL *ReadPixels)(int, int, int, int, unsigned, unsigned, void *);
    void(PEEL_DUMP_CALL *BindFramebuffer)(unsigned, unsigned);
    void(PEEL_DUMP_CALL *ReadBuffer)(unsigned);
    void(PEEL_DUMP_CALL *PixelStorei)(unsigned, int);
    void(PEEL_DUMP_CALL *GetIntegerv)(unsigned, int *);
    unsigned(PEEL_DUMP_CALL *GetError)(void);
} PeelDump;

static inline int peel_dump_fail(PeelDump *dump, const char *error)
{
    if (!dump->error)
        dump->error = error;
    return -1;
}

/* load may be NULL where only peel_dump_pixels is used. */
static inline int peel_dump_open(PeelDump *dump, const char *path, PeelDumpLoad load)
{
    memset(dump, 0, sizeof *dump);
    dump->file = fopen(path, "wb");
    if (!dump->file)
        return peel_dump_fail(dump, "peel_dump: cannot write the file");
    if (!load)
        return 0;
    dump->ReadPixels = (void(PEEL_DUMP_CALL *)(int, int, int, int, unsigned, unsigned, void *))load(
        "glReadPixels");
    dump->BindFramebuffer = (void(PEEL_DUMP_CALL *)(unsigned, unsigned))load("glBindFramebuffer");
    dump->ReadBuffer = (void(PEEL_DUMP_CALL *)(unsigned))load("glReadBuffer");
    dump->PixelStorei = (void(PEEL_DUMP_CALL *)(unsigned, int))load("glPixelStorei");
    dump->GetIntegerv = (void(PEEL_DUMP_CALL *)(unsigned, int *))load("glGetIntegerv");
    dump->GetError = (unsigned(PEEL_DUMP_CALL *)(void))load("glGetError");
    if (!dump->ReadPixels || !dump->BindFramebuffer || !dump->ReadBuffer || !dump->PixelStorei ||
        !dump->GetIntegerv || !dump->GetError)
        return peel_dump_fail(dump, "peel_dump: the loader lacks an entry point of OpenGL 3.0");
    return 0;
}

static inline size_t peel_dump_pixel_bytes(PeelDumpFormat format)
{
    static const unsigned char bytes[] = {16, 8, 8, 4, 8, 4, 4, 4, 4, 4};
    return bytes[format];
}

/* Pixels in memory: width*height of them, the bottom row first if bottom_up is not 0. */
static inline int peel_dump_pixels(PeelDump *dump, const char *name, PeelDumpFormat format,
                                   int width, int height, int bottom_up, const void *pixels)
{
    static const char *const names[] = {"rgba32f", "rgba16f", "rgba16", "rgba8", "rg32f",
                                        "rg16",    "r32f",    "d32f",   "d24",   "d16"};
    const unsigned one = 1;
    const char *order = *(const unsigned char *)&one ? "little" : "big";
    size_t size = (size_t)width * (size_t)height * peel_dump_pixel_bytes(format);
    if (dump->error)
        return -1;
    fprintf(dump->file, "peel-dump 1 %s %s %dx%d %s %s\n", name, names[format], width, height,
            bottom_up ? "bottom" : "top", order);
    if (fwrite(pixels, 1, size, dump->file) != size)
        return peel_dump_fail(dump, "peel_dump: cannot write all of a buffer");
    return 0;
}

/* Reads with the pack parameters that mean tightly packed rows, whatever the program has set. */
static inline int peel_dump_read(PeelDump *dump, unsigned gl_format, unsigned gl_type, int width,
                                 int height, void *pixels)
{
    /* GL_PACK_SWAP_BYTES, _LSB_FIRST, _ROW_LENGTH, _SKIP_ROWS, _SKIP_PIXELS, _ALIGNMENT */
    static const int values[] = {0, 0, 0, 0, 0, 1};
    int saved[6], i;
    while (dump->GetError() != 0)
        continue;
    for (i = 0; i < 6; i++) {
        dump->GetIntegerv(0x0D00u + (unsigned)i, &saved[i]);
        dump->PixelStorei(0x0D00u + (unsigned)i, values[i]);
    }
    while (dump->GetError() != 0) /* OpenGL ES has not all of them */
        continue;
    dump->ReadPixels(0, 0, width, height, gl_format, gl_type, pixels);
    if (dump->GetError() != 0)
        peel_dump_fail(dump, "peel_dump: OpenGL cannot read this buffer in this format");
    for (i = 0; i < 6; i++)
        dump->PixelStorei(0x0D00u + (unsigned)i, saved[i]);
    while (dump->GetError() != 0)
        continue;
    return dump->error ? -1 : 0;
}

/* Depths of 24 and 16 bits come in the high bits of 32. */
static inline void peel_dump_depths(PeelDumpFormat format, size_t count, unsigned *depths)
{
    const int shift = format == PEEL_DUMP_D24 ? 8 : format == PEEL_DUMP_D16 ? 16 : 0;
    size_t i;
    for (i = 0; shift && i < count; i++)
        depths[i] >>= shift;
}

/* color_buffer: 0 for depth. */
static inline int peel_dump_buffer(PeelDump *dump, const char *name, unsigned framebuffer,
                                   unsigned color_buffer, PeelDumpFormat format, int width,
                                   int height)
{
    /* GL_RGBA, GL_RG, GL_RED, GL_DEPTH_COMPONENT; GL_FLOAT, GL_HALF_FLOAT, GL_UNSIGNED_SHORT,
     * GL_UNSIGNED_BYTE, GL_UNSIGNED_INT */
    static const unsigned formats[] = {0x1908, 0x1908, 0x1908, 0x1908, 0x8227,
                                       0x8227, 0x1903, 0x1902, 0x1902, 0x1902};
    static const unsigned types[] = {0x1406, 0x140B, 0x1403, 0x1401, 0x1406,
                                     0x1403, 0x1406, 0x1406, 0x1405, 0x1405};
    size_t count = (size_t)width * (size_t)height;
    int bound = 0, read_buffer = 0;
    void *pixels;
    if (dump->error || !dump->ReadPixels)
        return peel_dump_fail(dump, "peel_dump: opened without a loader");
    pixels = malloc(count * peel_dump_pixel_bytes(format));
    if (!pixels)
        return peel_dump_fail(dump, "peel_dump: out of memory");
    dump->GetIntegerv(0x8CAAu, &bound); /* GL_READ_FRAMEBUFFER_BINDING */
    dump->BindFramebuffer(0x8CA8u, framebuffer);
    dump->GetIntegerv(0x0C02u, &read_buffer); /* GL_READ_BUFFER, of this framebuffer */
    if (color_buffer)
        dump->ReadBuffer(color_buffer);
    if (peel_dump_read(dump, formats[format], types[format], width, height, pixels) == 0) {
        peel_dump_depths(format, count, (unsigned *)pixels);
        peel_dump_pixels(dump, name, format, width, height, 1, pixels);
    }
    if (color_buffer)
        dump->ReadBuffer((unsigned)read_buffer);
    dump->BindFramebuffer(0x8CA8u, (unsigned)bound);
    free(pixels);
    return dump->error ? -1 : 0;
}

/* A colour buffer of a framebuffer: GL_COLOR_ATTACHMENT0 + i, or GL_BACK of framebuffer 0. */
static inline int peel_dump_color(PeelDump *dump, const char *name, unsigned framebuffer,
                                  unsigned color_buffer, PeelDumpFormat format, int width,
                                  int height)
{
    return peel_dump_buffer(dump, name, framebuffer, color_buffer, format, width, height);
}

/* The depth buffer of a framebuffer. */
static inline int peel_dump_depth(PeelDump *dump, const char *name, unsigned framebuffer,
                                  PeelDumpFormat format, int width, int height)
{
    return peel_dump_buffer(dump, name, framebuffer, 0, format, width, height);
}

static inline int peel_dump_close(PeelDump *dump)
{
    if (dump->file && fclose(dump->file) != 0)
        peel_dump_fail(dump, "peel_dump: cannot write all of the file");
    dump->file = NULL;
    return dump->error ? -1 : 0;
}

#endif
