#include "library/convert.h"

PeelResult convert_result(Result result)
{
    switch (result) {
    case RESULT_OK:
        return PEEL_OK;
    case RESULT_NO_MEMORY:
        return PEEL_NO_MEMORY;
    case RESULT_BAD_INPUT:
        return PEEL_BAD_INPUT;
    case RESULT_UNSUPPORTED:
        return PEEL_UNSUPPORTED;
    case RESULT_IO:
    case RESULT_NO_GL:
    case RESULT_INTERNAL:
        break;
    }
    return PEEL_INTERNAL;
}

static const PixelFormat formats[PEEL_FORMAT_COUNT] = {
    [PEEL_RGBA32F] = FORMAT_RGBA32F, [PEEL_RGBA16F] = FORMAT_RGBA16F, [PEEL_RGBA16] = FORMAT_RGBA16,
    [PEEL_RGBA8] = FORMAT_RGBA8,     [PEEL_RG32F] = FORMAT_RG32F,     [PEEL_R32F] = FORMAT_R32F,
    [PEEL_RG16] = FORMAT_RG16,       [PEEL_D32F] = FORMAT_D32F,       [PEEL_D24] = FORMAT_D24,
    [PEEL_D16] = FORMAT_D16,         [PEEL_R32UI] = FORMAT_R32UI,
};

PixelFormat convert_format(PeelFormat format)
{
    return (unsigned)format < PEEL_FORMAT_COUNT ? formats[format] : FORMAT_NONE;
}

PeelFormat convert_from_format(PixelFormat format)
{
    int i = 0;
    while (i < PEEL_FORMAT_COUNT && formats[i] != format)
        i++;
    return (PeelFormat)i;
}

PeelResult convert_color_format(const char *function, PeelFormat format, PixelFormat *out)
{
    *out = convert_format(format);
    if ((unsigned)format <= PEEL_R32F)
        return PEEL_OK;
    return convert_result(result_fail(RESULT_BAD_INPUT,
                                      "%s: format %d: expected rgba32f, rgba16f, rgba16, rgba8, "
                                      "rg32f or r32f",
                                      function, (int)format));
}

#undef convert_missing
PeelResult convert_missing(const char *function, const char *argument)
{
    return convert_result(
        result_fail(RESULT_BAD_INPUT, "%s: %s is NULL, expected a pointer", function, argument));
}
