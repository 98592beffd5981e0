/* peel.h: results and formats. */
#include "library/convert.h"
#include "number/blend.h"
#include "number/op.h"

#define TEXT_OF(x) #x
#define TEXT(x)    TEXT_OF(x)

/* The build system has the version, too. Of 0.1.0 two parts are equal. */
/* NOLINTNEXTLINE(misc-redundant-expression) */
_Static_assert(PEEL_VERSION_MAJOR == PROJECT_MAJOR && PEEL_VERSION_MINOR == PROJECT_MINOR &&
                   PEEL_VERSION_PATCH == PROJECT_PATCH,
               "peel.h has another version than CMakeLists.txt");

const char *peel_version(void)
{
    return TEXT(PEEL_VERSION_MAJOR) "." TEXT(PEEL_VERSION_MINOR) "." TEXT(PEEL_VERSION_PATCH);
}

const char *peel_result_text(PeelResult result)
{
    switch (result) {
    case PEEL_OK:
        return result_text(RESULT_OK);
    case PEEL_NO_MEMORY:
        return result_text(RESULT_NO_MEMORY);
    case PEEL_BAD_INPUT:
        return result_text(RESULT_BAD_INPUT);
    case PEEL_UNSUPPORTED:
        return result_text(RESULT_UNSUPPORTED);
    case PEEL_STOPPED:
        return "stopped by the caller";
    case PEEL_INTERNAL:
        return result_text(RESULT_INTERNAL);
    }
    return "unknown result";
}

const char *peel_message(void)
{
    return result_message();
}

/* ---- formats ---- */

const char *peel_format_name(PeelFormat format)
{
    PixelFormat stored = convert_format(format);
    return stored == FORMAT_NONE ? NULL : format_info(stored)->name;
}

int peel_format_channels(PeelFormat format)
{
    return format_info(convert_format(format))->channels;
}

size_t peel_format_pixel_bytes(PeelFormat format)
{
    return format_pixel_bytes(convert_format(format));
}

PeelResult peel_value(PeelFormat format, const void *pixel, int channel, float *out)
{
    PixelFormat stored = convert_format(format);
    if (!pixel)
        return convert_missing("peel_value", "pixel");
    if (!out)
        return convert_missing("peel_value", "out");
    if (channel < 0 || channel >= format_info(stored)->channels)
        return convert_result(result_fail(RESULT_BAD_INPUT,
                                          "peel_value: channel %d of format %d: expected a format "
                                          "and one of its channels, from 0",
                                          channel, (int)format));
    uint32_t environment = op_suspend();
    *out = format_channel(stored, pixel, channel);
    op_leave(environment);
    return PEEL_OK;
}

static PeelResult check_pixels(const char *function, PeelFormat format, size_t count,
                               const void *pixels, PixelFormat *out)
{
    PeelResult result = convert_color_format(function, format, out);
    if (result)
        return result;
    return count && !pixels ? convert_missing(function, "pixels") : PEEL_OK;
}

PeelResult peel_store(PeelFormat format, size_t count, const float *values, void *pixels)
{
    PixelFormat stored;
    PeelResult result = check_pixels("peel_store", format, count, pixels, &stored);
    if (result)
        return result;
    if (count && !values)
        return convert_missing("peel_store", "values");
    uint32_t environment = op_enter();
    for (size_t i = 0; i < count; i++)
        format_store(stored, values + 4 * i, (char *)pixels + i * format_pixel_bytes(stored));
    op_leave(environment);
    return PEEL_OK;
}

PeelResult peel_fetch(PeelFormat format, size_t count, const void *pixels, float *values)
{
    PixelFormat stored;
    PeelResult result = check_pixels("peel_fetch", format, count, pixels, &stored);
    if (result)
        return result;
    if (count && !values)
        return convert_missing("peel_fetch", "values");
    uint32_t environment = op_enter();
    for (size_t i = 0; i < count; i++)
        format_fetch(stored, (const char *)pixels + i * format_pixel_bytes(stored), values + 4 * i);
    op_leave(environment);
    return PEEL_OK;
}

PeelResult peel_ulp(PeelFormat format, const void *a, const void *b, uint32_t *out)
{
    PixelFormat stored = convert_format(format);
    const FormatInfo *info = format_info(stored);
    if (!a || !b || !out)
        return convert_missing("peel_ulp", !a ? "a" : !b ? "b" : "out");
    if (stored == FORMAT_NONE)
        return convert_result(
            result_fail(RESULT_BAD_INPUT, "peel_ulp: %d is no format", (int)format));
    for (int c = 0; c < info->channels; c++)
        out[c] = format_ulp(info->kind, format_bits(stored, a, c), format_bits(stored, b, c));
    return PEEL_OK;
}

PeelResult peel_clear(PeelFormat format, size_t count, void *pixels)
{
    PixelFormat stored;
    PeelResult result = check_pixels("peel_clear", format, count, pixels, &stored);
    if (result)
        return result;
    uint32_t environment = op_enter();
    for (size_t i = 0; i < count; i++)
        blend_clear(stored, (char *)pixels + i * format_pixel_bytes(stored));
    op_leave(environment);
    return PEEL_OK;
}
