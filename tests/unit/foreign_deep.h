/* Deep EXR files such as other programs may write: any channels, types, order and totals. */
#ifndef PEEL_TESTS_FOREIGN_DEEP_H
#define PEEL_TESTS_FOREIGN_DEEP_H

#include <check.h>
#include <openexr.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* One row of pixels with any channels, not compressed or (only the values) by run lengths; values:
 * channel by channel, samples in order, as 4 bytes (2 for half). */
typedef struct Foreign {
    const char *names[8]; /* in order of names; NULL ends them */
    exr_pixel_type_t types[8];
    int width;
    uint32_t totals[4]; /* running, one per pixel */
    const void *values;
    size_t bytes;
    bool runs;
} Foreign;

/* As the file format has it: even bytes, then odd ones, as differences, then runs of at least 3 and
 * what lies between them. Returns the bytes of out. */
static inline size_t pack_runs(const uint8_t *in, size_t size, uint8_t *out)
{
    uint8_t mixed[256];
    size_t packed = 0, literal = 0;
    for (size_t i = 0; i < size; i++)
        mixed[i % 2 ? (size + 1) / 2 + i / 2 : i / 2] = in[i];
    for (size_t i = size - 1; i > 0; i--)
        mixed[i] = (uint8_t)(mixed[i] - mixed[i - 1] + 128);
    for (size_t at = 0; at < size;) {
        size_t run = 1;
        while (at + run < size && run < 128 && mixed[at + run] == mixed[at])
            run++;
        if (run >= 3) {
            out[packed++] = (uint8_t)(run - 1);
            out[packed++] = mixed[at];
            literal = 0;
            at += run;
        } else {
            if (literal == 0)
                literal = ++packed;
            out[literal - 1] = (uint8_t) - (int)(packed - literal + 1);
            out[packed++] = mixed[at++];
        }
    }
    return packed;
}

static inline void write_foreign(const Foreign *foreign, const char *path)
{
    exr_context_t context;
    int index, failed = 0;
    uint8_t packed[512];
    const void *data = foreign->runs ? packed : foreign->values;
    size_t bytes =
        foreign->runs ? pack_runs(foreign->values, foreign->bytes, packed) : foreign->bytes;
    exr_attr_box2i_t window = {{.x = 5, .y = -3}, {.x = 4 + foreign->width, .y = -3}};
    failed |= exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, NULL);
    failed |= exr_add_part(context, "beauty", EXR_STORAGE_DEEP_SCANLINE, &index);
    failed |= exr_initialize_required_attr_simple(
        context, 0, 20, 10, foreign->runs ? EXR_COMPRESSION_RLE : EXR_COMPRESSION_NONE);
    failed |= exr_set_data_window(context, 0, &window);
    for (int i = 0; foreign->names[i]; i++)
        failed |= exr_add_channel(context, 0, foreign->names[i], foreign->types[i],
                                  EXR_PERCEPTUALLY_LINEAR, 1, 1);
    failed |= exr_write_header(context);
    failed |= exr_write_deep_scanline_chunk(context, 0, -3, data, bytes, foreign->bytes,
                                            foreign->totals, 4 * (uint64_t)foreign->width);
    failed |= exr_finish(&context);
    ck_assert_int_eq(failed, 0);
}

#define RGBAZ                                                                                      \
    {                                                                                              \
        "A", "B", "G", "R", "Z"                                                                    \
    }
#define FLOATS                                                                                     \
    {                                                                                              \
        EXR_PIXEL_FLOAT, EXR_PIXEL_FLOAT, EXR_PIXEL_FLOAT, EXR_PIXEL_FLOAT, EXR_PIXEL_FLOAT,       \
            EXR_PIXEL_FLOAT                                                                        \
    }

#endif
