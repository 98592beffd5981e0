#include "compare/finite.h"

#include <string.h>

/* Exponents of all ones are infinities and NaN. */
static uint64_t count_floats(const unsigned char *bytes, size_t values)
{
    uint64_t count = 0;
    for (size_t i = 0; i < values; i++) {
        uint32_t bits;
        memcpy(&bits, bytes + i * sizeof bits, sizeof bits);
        count += (bits & 0x7f800000u) == 0x7f800000u;
    }
    return count;
}

static uint64_t count_halves(const unsigned char *bytes, size_t values)
{
    uint64_t count = 0;
    for (size_t i = 0; i < values; i++) {
        uint16_t bits;
        memcpy(&bits, bytes + i * sizeof bits, sizeof bits);
        count += (bits & 0x7c00u) == 0x7c00u;
    }
    return count;
}

static Result put(TraceSink *sink, const TraceBuffer *buffer)
{
    Finite *finite = (Finite *)sink;
    const FormatInfo *info = format_info(buffer->format);
    size_t values = (size_t)buffer->width * (size_t)info->channels;
    for (int y = 0; y < buffer->height; y++) {
        const unsigned char *row =
            (const unsigned char *)buffer->pixels + (size_t)y * buffer->row_bytes;
        if (info->kind == KIND_FLOAT)
            finite->nonfinite += count_floats(row, values);
        else if (info->kind == KIND_HALF)
            finite->nonfinite += count_halves(row, values);
    }
    return finite->next ? finite->next->put(finite->next, buffer) : RESULT_OK;
}

Finite finite_before(TraceSink *next)
{
    return (Finite){.sink = {.put = put}, .next = next};
}
