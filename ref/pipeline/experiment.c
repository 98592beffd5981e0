#include "ref/pipeline/experiment.h"

#include "number/blend.h"
#include "number/op.h"
#include "ref/pipeline/buffers.h"

static void operations(bool fused, const Experiment *experiment, uint32_t *out)
{
    for (int i = 0; i < EXPERIMENT_TEXELS; i++) {
        float result[4];
        experiment_operation(fused, experiment->operation, experiment->a[i], experiment->b[i],
                             i % EXPERIMENT_WIDTH, i / EXPERIMENT_WIDTH, result);
        memcpy(&out[4 * i], result, sizeof result);
    }
}

/* The channels of a stored pixel; those that are not stored are 0. */
static void put_codes(PixelFormat format, const void *pixel, uint32_t out[4])
{
    for (int k = 0; k < 4; k++)
        out[k] = k < format_info(format)->channels ? format_bits(format, pixel, k) : 0;
}

static void stores(const Experiment *experiment, uint32_t *out)
{
    for (int i = 0; i < EXPERIMENT_TEXELS; i++) {
        unsigned char pixel[16];
        format_store(experiment->format, experiment->a[i], pixel);
        put_codes(experiment->format, pixel, &out[4 * i]);
    }
}

static void clears(const Experiment *experiment, uint32_t *out)
{
    const FormatInfo *info = format_info(experiment->format);
    for (int i = 0; i < experiment->count; i++) {
        unsigned char pixel[16];
        format_store(experiment->format, experiment->a[i], pixel);
        put_codes(experiment->format, pixel, &out[4 * i]);
        for (int k = 0; k < info->channels && info->unorm_max == 65535; k++)
            out[4 * i + k] = unorm16_from_clear(experiment->a[i][k]);
    }
}

static void fetches(const Experiment *experiment, uint32_t *out)
{
    const FormatInfo *info = format_info(experiment->format);
    for (int i = 0; i < EXPERIMENT_TEXELS; i++) {
        unsigned char pixel[16];
        float value[4];
        for (int k = 0; k < info->channels; k++) {
            uint16_t code = (uint16_t)(4 * i + k);
            uint8_t byte = (uint8_t)code;
            memcpy(pixel + k * info->channel_bytes,
                   info->channel_bytes == 1 ? (const void *)&byte : (const void *)&code,
                   (size_t)info->channel_bytes);
        }
        format_fetch(experiment->format, pixel, value);
        memcpy(&out[4 * i], value, sizeof value);
    }
}

static void depth_stores(const Experiment *experiment, uint32_t *out)
{
    for (int i = 0; i < EXPERIMENT_TEXELS; i++)
        out[i] = depth_key(experiment->format, experiment->a[i][0]);
}

static void depth_fetches(const Experiment *experiment, uint32_t *out)
{
    for (int i = 0; i < EXPERIMENT_TEXELS; i++) {
        float value = experiment->a[i][0];
        out[2 * i] = experiment->format == FORMAT_D32F ? op_bits(value) : (uint32_t)value;
        out[2 * i + 1] = op_bits(depth_fetch(experiment->format, out[2 * i]));
    }
}

static void blends(bool fused, const Experiment *experiment, uint32_t *out)
{
    for (int i = 0; i < EXPERIMENT_TEXELS; i++) {
        unsigned char pixel[16];
        format_store(experiment->format, experiment->b[i], pixel);
        if (experiment->before)
            put_codes(experiment->format, pixel, &experiment->before[4 * i]);
        blend_pixels(&experiment->equation, fused, experiment->format, 1, &experiment->a[i], pixel);
        put_codes(experiment->format, pixel, &out[4 * i]);
    }
}

/* Not inlined: see op_enter. */
static __attribute__((noinline)) void perform(bool fused, const Experiment *experiment,
                                              uint32_t *out)
{
    switch (experiment->kind) {
    case EXPERIMENT_OPERATION:
        operations(fused, experiment, out);
        return;
    case EXPERIMENT_STORE:
        stores(experiment, out);
        return;
    case EXPERIMENT_CLEAR:
        clears(experiment, out);
        return;
    case EXPERIMENT_FETCH:
        fetches(experiment, out);
        return;
    case EXPERIMENT_DEPTH_STORE:
        depth_stores(experiment, out);
        return;
    case EXPERIMENT_DEPTH_FETCH:
        depth_fetches(experiment, out);
        return;
    case EXPERIMENT_BLEND:
        blends(fused, experiment, out);
        return;
    default:
        experiment_raster(fused, experiment, out);
    }
}

static Result run(Lab *lab, const Experiment *experiment, uint32_t *out)
{
    const PipelineLab *self = (const PipelineLab *)lab;
    uint32_t saved = op_enter();
    perform(self->fused, experiment, out);
    op_leave(saved);
    return RESULT_OK;
}

PipelineLab pipeline_lab(bool fused)
{
    return (PipelineLab){{run}, fused};
}
