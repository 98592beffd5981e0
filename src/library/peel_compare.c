/* peel.h: comparing. */
#include "compare/diff_pixels.h"
#include "frame/render_desc.h"
#include "library/convert.h"
#include "number/op.h"

#include <string.h>

static void fill(const DiffPart *part, PeelDifference *out)
{
    *out = (PeelDifference){
        .pixels = part->pixels,
        .differing = part->differing,
        .values = part->values,
        .differing_values = part->differing_values,
        .nonfinite_a = part->nonfinite[0],
        .nonfinite_b = part->nonfinite[1],
        .broken = part->broken,
        .mean = part->mean,
        .rms = part->rms,
        .psnr = part->psnr,
        .max = part->max,
        .max_at = {-1, -1, -1},
        .first = {-1, -1, -1},
    };
    if (part->max > 0.0) {
        out->max_at[0] = part->max_at.x;
        out->max_at[1] = part->max_at.y;
        out->max_at[2] = part->max_at.channel;
    }
    if (part->differing)
        memcpy(out->first, part->first, sizeof out->first);
    for (int c = 0; c < part->channel_count; c++) {
        uint32_t ulp = part->channels[c].max_ulp;
        out->channel_max_ulp[c] = ulp;
        out->max_ulp = ulp > out->max_ulp ? ulp : out->max_ulp;
    }
}

/* Apart from peel_compare, so that its arithmetic stays within the environment set there. */
static __attribute__((noinline)) PeelResult compare(PixelFormat format, int width, int height,
                                                    const void *a, const void *b,
                                                    PeelDifference *out)
{
    const DiffOptions options = diff_options_default();
    DiffPart part;
    Result result = diff_pixels(format, width, height, a, b, &options, &part);
    if (result == RESULT_OK)
        fill(&part, out);
    diff_part_free(&part);
    return convert_result(result);
}

PeelResult peel_compare(PeelFormat format, int width, int height, const void *a, const void *b,
                        PeelDifference *out)
{
    PixelFormat stored = convert_format(format);
    if (!a || !b || !out)
        return convert_missing("peel_compare", !a ? "a" : !b ? "b" : "out");
    if (stored == FORMAT_NONE)
        return convert_result(
            result_fail(RESULT_BAD_INPUT, "peel_compare: %d is no format", (int)format));
    if (width < 1 || height < 1 || width > SIZE_MAX_PIXELS || height > SIZE_MAX_PIXELS)
        return convert_result(result_fail(RESULT_BAD_INPUT,
                                          "peel_compare: size %d×%d: expected 1 to %d pixels a "
                                          "side",
                                          width, height, SIZE_MAX_PIXELS));
    uint32_t environment = op_suspend();
    PeelResult result = compare(stored, width, height, a, b, out);
    op_leave(environment);
    return result;
}
