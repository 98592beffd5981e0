#include "frame/pixel_trace.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static Result put(TraceSink *sink, const TraceBuffer *buffer)
{
    PixelTrace *trace = (PixelTrace *)sink;
    int column = trace->x - buffer->x, row = trace->y - buffer->y;
    if (column < 0 || row < 0 || column >= buffer->width || row >= buffer->height)
        return RESULT_OK;
    void *values = trace->values;
    Result result = memory_grow(&values, &trace->room, trace->count + 1, sizeof *trace->values);
    trace->values = values;
    if (result != RESULT_OK)
        return result;
    PixelValue *value = &trace->values[trace->count++];
    size_t bytes = format_pixel_bytes(buffer->format);
    snprintf(value->name, sizeof value->name, "%s", buffer->name);
    value->format = buffer->format;
    memset(value->bytes, 0, sizeof value->bytes);
    memcpy(value->bytes,
           (const char *)buffer->pixels + (size_t)row * buffer->row_bytes + (size_t)column * bytes,
           bytes);
    return RESULT_OK;
}

static Result put_all(TraceSink *sink, const TraceBuffer *buffer)
{
    PixelFan *fan = (PixelFan *)sink;
    Result result = RESULT_OK;
    for (size_t i = 0; i < fan->count && result == RESULT_OK; i++)
        result = put(&fan->traces[i].sink, buffer);
    return result;
}

PixelFan pixel_fan_of(PixelTrace *traces, size_t count)
{
    return (PixelFan){.sink = {.put = put_all}, .traces = traces, .count = count};
}

PixelTrace pixel_trace_of(int x, int y)
{
    return (PixelTrace){.sink = {.put = put}, .x = x, .y = y};
}

void pixel_trace_free(PixelTrace *trace)
{
    free(trace->values);
    *trace = pixel_trace_of(trace->x, trace->y);
}

const PixelValue *pixel_trace_find(const PixelTrace *trace, const char *name)
{
    for (size_t i = 0; i < trace->count; i++)
        if (strcmp(trace->values[i].name, name) == 0)
            return &trace->values[i];
    return NULL;
}

const PixelValue *pixel_trace_numbered(const PixelTrace *trace, const char *prefix, int number,
                                       const char *what)
{
    char name[PIXEL_TRACE_NAME];
    snprintf(name, sizeof name, "%s.%d.%s", prefix, number, what);
    return pixel_trace_find(trace, name);
}

uint32_t pixel_trace_bits(const PixelValue *value, uint32_t other)
{
    return value ? format_bits(value->format, value->bytes, 0) : other;
}
