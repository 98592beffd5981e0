#include "lab.h"

#include "base/memory.h"
#include "formats.h"
#include "lab_draw.h"
#include "number/op.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COPY_BODY "#define BODY r = a;\n"

static void widen(PixelFormat format, const void *pixels, size_t count, uint32_t *out)
{
    size_t bytes = format_pixel_bytes(format);
    int channels = format_info(format)->channels;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 4; k++)
            out[4 * i + (size_t)k] =
                k < channels ? format_bits(format, (const char *)pixels + i * bytes, k) : 0;
}

static void draw_all(void)
{
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

/* A point a texel, row by row: softpipe gets gl_VertexID wrong beyond 4096 vertices. */
static void draw_points(void)
{
    for (int y = 0; y < EXPERIMENT_HEIGHT; y++)
        gl.DrawArrays(GL_POINTS, y * EXPERIMENT_WIDTH, EXPERIMENT_WIDTH);
}

/* Draws with the current program to a colour target and reads it. */
static Result draw_color(GlLab *lab, PixelFormat format, void (*draw)(void), uint32_t *out)
{
    LabTarget target;
    Result result =
        lab_target(format, 1, FORMAT_NONE, EXPERIMENT_WIDTH, EXPERIMENT_HEIGHT, &target);
    if (result != RESULT_OK)
        return result;
    draw();
    lab_read_color(&target, 0, lab->pixels);
    widen(format, lab->pixels, EXPERIMENT_TEXELS, out);
    lab_target_destroy(&target);
    return RESULT_OK;
}

static Result operate(GlLab *lab, const Experiment *experiment, uint32_t *out)
{
    char defines[256];
    snprintf(defines, sizeof defines, "#define BODY %s\n%s",
             operation_info(experiment->operation)->glsl,
             experiment->vertex ? "#define VERTEX_STAGE\n" : "");
    Result result = lab_use(lab, defines);
    if (result != RESULT_OK)
        return result;
    return draw_color(lab, FORMAT_RGBA32F, experiment->vertex ? draw_points : draw_all, out);
}

static Result store(GlLab *lab, const Experiment *experiment, uint32_t *out)
{
    Result result = lab_use(lab, COPY_BODY);
    return result == RESULT_OK ? draw_color(lab, experiment->format, draw_all, out) : result;
}

static Result clear(GlLab *lab, const Experiment *experiment, uint32_t *out)
{
    LabTarget target;
    Result result = lab_target(experiment->format, 1, FORMAT_NONE, 1, 1, &target);
    if (result != RESULT_OK)
        return result;
    for (int i = 0; i < experiment->count; i++) {
        gl.ClearNamedFramebufferfv(target.framebuffer, GL_COLOR, 0, experiment->a[i]);
        lab_read_color(&target, 0, lab->pixels);
        widen(experiment->format, lab->pixels, 1, &out[4 * i]);
    }
    lab_target_destroy(&target);
    return RESULT_OK;
}

static Result fetch(GlLab *lab, const Experiment *experiment, uint32_t *out)
{
    PixelFormat format = experiment->format;
    const FormatInfo *info = format_info(format);
    unsigned char *at = (unsigned char *)lab->pixels;
    for (int i = 0; i < EXPERIMENT_TEXELS; i++)
        for (int k = 0; k < info->channels; k++, at += info->channel_bytes) {
            uint16_t code = (uint16_t)(4 * i + k);
            uint8_t byte = (uint8_t)code;
            memcpy(at, info->channel_bytes == 1 ? (const void *)&byte : (const void *)&code,
                   (size_t)info->channel_bytes);
        }
    GLuint texture = lab_texture(format, EXPERIMENT_WIDTH, EXPERIMENT_HEIGHT);
    gl.TextureSubImage2D(texture, 0, 0, 0, EXPERIMENT_WIDTH, EXPERIMENT_HEIGHT,
                         formats_gl(format)->format, formats_gl(format)->type, lab->pixels);
    gl.BindTextureUnit(0, texture);
    Result result = lab_use(lab, COPY_BODY);
    if (result == RESULT_OK)
        result = draw_color(lab, FORMAT_RGBA32F, draw_all, out);
    gl.BindTextureUnit(0, lab->operands[0]);
    gl.DeleteTextures(1, &texture);
    return result;
}

static Result store_depth(GlLab *lab, const Experiment *experiment, uint32_t *out)
{
    LabTarget target;
    Result result = lab_use(lab, COPY_BODY "#define WRITE_DEPTH\n");
    if (result == RESULT_OK)
        result = lab_target(FORMAT_NONE, 0, experiment->format, EXPERIMENT_WIDTH, EXPERIMENT_HEIGHT,
                            &target);
    if (result != RESULT_OK)
        return result;
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthFunc(GL_ALWAYS);
    draw_all();
    gl.Disable(GL_DEPTH_TEST);
    lab_read_depth(&target, out);
    lab_target_destroy(&target);
    return RESULT_OK;
}

/* The driver may round what it uploads, so the codes are read back. */
static Result fetch_depth(GlLab *lab, const Experiment *experiment, uint32_t *out)
{
    PixelFormat format = experiment->format;
    LabTarget depth, target;
    Result result = lab_use(lab, COPY_BODY);
    if (result == RESULT_OK)
        result = lab_target(FORMAT_NONE, 0, format, EXPERIMENT_WIDTH, EXPERIMENT_HEIGHT, &depth);
    if (result != RESULT_OK)
        return result;
    uint32_t *words = (void *)lab->pixels; /* room for either */
    for (int i = 0; i < EXPERIMENT_TEXELS; i++) {
        uint32_t code = (uint32_t)experiment->a[i][0];
        words[i] = format == FORMAT_D24   ? code << 8 | code >> 16
                   : format == FORMAT_D16 ? code << 16 | code
                                          : op_bits(experiment->a[i][0]);
    }
    gl.TextureSubImage2D(depth.depth, 0, 0, 0, EXPERIMENT_WIDTH, EXPERIMENT_HEIGHT,
                         GL_DEPTH_COMPONENT, formats_gl(format)->type, words);
    lab_read_depth(&depth, words);
    for (int i = 0; i < EXPERIMENT_TEXELS; i++)
        out[2 * i] = words[i];
    result =
        lab_target(FORMAT_RGBA32F, 1, FORMAT_NONE, EXPERIMENT_WIDTH, EXPERIMENT_HEIGHT, &target);
    if (result == RESULT_OK) {
        gl.BindTextureUnit(0, depth.depth);
        draw_all();
        gl.BindTextureUnit(0, lab->operands[0]);
        lab_read_color(&target, 0, lab->pixels);
        for (int i = 0; i < EXPERIMENT_TEXELS; i++)
            out[2 * i + 1] = op_bits(lab->pixels[i][0]);
        lab_target_destroy(&target);
    }
    lab_target_destroy(&depth);
    return result;
}

static void set_blend(const BlendEquation *equation)
{
    static const GLenum factors[FACTOR_COUNT] = {
        [FACTOR_ZERO] = GL_ZERO,
        [FACTOR_ONE] = GL_ONE,
        [FACTOR_SRC_COLOR] = GL_SRC_COLOR,
        [FACTOR_ONE_MINUS_SRC_COLOR] = GL_ONE_MINUS_SRC_COLOR,
        [FACTOR_DST_COLOR] = GL_DST_COLOR,
        [FACTOR_ONE_MINUS_DST_COLOR] = GL_ONE_MINUS_DST_COLOR,
        [FACTOR_SRC_ALPHA] = GL_SRC_ALPHA,
        [FACTOR_ONE_MINUS_SRC_ALPHA] = GL_ONE_MINUS_SRC_ALPHA,
        [FACTOR_DST_ALPHA] = GL_DST_ALPHA,
        [FACTOR_ONE_MINUS_DST_ALPHA] = GL_ONE_MINUS_DST_ALPHA,
        [FACTOR_SRC_ALPHA_SATURATE] = GL_SRC_ALPHA_SATURATE,
    };
    static const GLenum funcs[BLEND_FUNC_COUNT] = {
        [BLEND_FUNC_ADD] = GL_FUNC_ADD,
        [BLEND_FUNC_SUBTRACT] = GL_FUNC_SUBTRACT,
        [BLEND_FUNC_REVERSE_SUBTRACT] = GL_FUNC_REVERSE_SUBTRACT,
        [BLEND_FUNC_MIN] = GL_MIN,
        [BLEND_FUNC_MAX] = GL_MAX,
    };
    gl.BlendEquationSeparate(funcs[equation->func], funcs[equation->func_alpha]);
    gl.BlendFuncSeparate(factors[equation->source], factors[equation->destination],
                         factors[equation->source_alpha], factors[equation->destination_alpha]);
}

/* The destination is drawn first, without blending, so that it is what the format can store. */
static Result blend(GlLab *lab, const Experiment *experiment, uint32_t *out)
{
    LabTarget target;
    Result result = lab_use(lab, "#define BODY r = b;\n");
    if (result == RESULT_OK)
        result = lab_target(experiment->format, 1, FORMAT_NONE, EXPERIMENT_WIDTH, EXPERIMENT_HEIGHT,
                            &target);
    if (result != RESULT_OK)
        return result;
    draw_all();
    if (experiment->before) {
        lab_read_color(&target, 0, lab->pixels);
        widen(experiment->format, lab->pixels, EXPERIMENT_TEXELS, experiment->before);
    }
    set_blend(&experiment->equation);
    result = lab_use(lab, COPY_BODY);
    if (result == RESULT_OK) {
        gl.Enable(GL_BLEND);
        draw_all();
        gl.Disable(GL_BLEND);
        lab_read_color(&target, 0, lab->pixels);
        widen(experiment->format, lab->pixels, EXPERIMENT_TEXELS, out);
    }
    lab_target_destroy(&target);
    return result;
}

static Result perform(GlLab *lab, const Experiment *experiment, uint32_t *out)
{
    switch (experiment->kind) {
    case EXPERIMENT_RASTER:
    case EXPERIMENT_OVERLAP:
    case EXPERIMENT_SAMPLES:
        return lab_raster(lab, experiment, out);
    case EXPERIMENT_CLEAR:
        return clear(lab, experiment, out);
    case EXPERIMENT_FETCH:
        return fetch(lab, experiment, out);
    case EXPERIMENT_DEPTH_FETCH:
        return fetch_depth(lab, experiment, out);
    default:
        break;
    }
    lab_upload(lab, experiment, EXPERIMENT_TEXELS);
    switch (experiment->kind) {
    case EXPERIMENT_OPERATION:
        return operate(lab, experiment, out);
    case EXPERIMENT_STORE:
        return store(lab, experiment, out);
    case EXPERIMENT_BLEND:
        return blend(lab, experiment, out);
    default:
        return store_depth(lab, experiment, out);
    }
}

/* Triangles of a batch that needed clipping are set up in the calling thread: see gl_render. */
static Result run(Lab *lab, const Experiment *experiment, uint32_t *out)
{
    GlLab *self = (GlLab *)lab;
    Result result = context_use(self->context);
    if (result != RESULT_OK)
        return result;
    uint32_t saved = op_enter();
    result = perform(self, experiment, out);
    op_leave(saved);
    Result checked = context_check(self->context, "experiment");
    return result == RESULT_OK ? checked : result;
}

static void describe(LabDriver *out)
{
    const struct {
        GLenum name;
        char *text;
    } texts[] = {{GL_VENDOR, out->vendor},
                 {GL_RENDERER, out->renderer},
                 {GL_VERSION, out->version},
                 {GL_SHADING_LANGUAGE_VERSION, out->glsl}};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        const char *text = (const char *)gl.GetString(texts[i].name);
        snprintf(texts[i].text, sizeof out->vendor, "%s", text ? text : "");
    }
}

Result lab_open(int threads, LabDriver *driver, GlLab **out)
{
    GlLab *lab = memory_array(1, sizeof *lab);
    if (!lab)
        return RESULT_NO_MEMORY;
    *out = NULL;
    lab->lab.run = run;
    lab->pixels = memory_array(EXPERIMENT_TEXELS, sizeof *lab->pixels);
    Result result = lab->pixels ? context_open(threads, &lab->context) : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = fuses_detect(lab->context, &driver->mode);
    if (result == RESULT_OK) {
        describe(driver);
        gl.CreateVertexArrays(1, &lab->vertex_array);
        gl.BindVertexArray(lab->vertex_array);
        gl.CreateQueries(GL_SAMPLES_PASSED, 1, &lab->query);
        for (GLuint i = 0; i < 2; i++) {
            lab->operands[i] = lab_texture(FORMAT_RGBA32F, EXPERIMENT_WIDTH, EXPERIMENT_HEIGHT);
            gl.BindTextureUnit(i, lab->operands[i]);
        }
        result = context_check(lab->context, "experiments");
    }
    if (result != RESULT_OK) {
        lab_close(lab);
        return result;
    }
    *out = lab;
    return RESULT_OK;
}

/* The context takes its textures and programs along. */
void lab_close(GlLab *lab)
{
    if (!lab)
        return;
    context_close(lab->context);
    free(lab->pixels);
    free(lab);
}

Lab *lab_experiments(GlLab *lab)
{
    return &lab->lab;
}
