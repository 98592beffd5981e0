#include "frame/trace.h"

#include "frame/render_desc.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

Result trace_put(TraceSink *sink, const char *name, int step, PixelFormat format, int width,
                 int height, const void *pixels)
{
    if (!sink)
        return RESULT_OK;
    TraceBuffer buffer = {
        .name = name,
        .step = step,
        .format = format,
        .image_width = width,
        .image_height = height,
        .width = width,
        .height = height,
        .pixels = pixels,
        .row_bytes = (size_t)width * format_pixel_bytes(format),
    };
    return sink->put(sink, &buffer);
}

Result trace_put_peel(TraceSink *sink, int peel, const char *what, PixelFormat format, int width,
                      int height, const void *pixels)
{
    char name[48];
    snprintf(name, sizeof name, "peel.%d.%s", peel, what);
    return trace_put(sink, name, peel + 1, format, width, height, pixels);
}

int trace_peel_number(const char *name, const char **rest)
{
    if (strncmp(name, "peel.", 5) != 0 || name[5] < '0' || name[5] > '9')
        return -1;
    char *end;
    long peel = strtol(name + 5, &end, 10);
    *rest = end;
    return peel < PASSES_MAX ? (int)peel : -1;
}
