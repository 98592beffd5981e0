#include "compare/against.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool is_diagnostic(const char *name)
{
    const char *dot = strrchr(name, '.');
    return dot && strcmp(dot, ".primitive") == 0;
}

/* The row of this name: the latest, because a buffer's rectangles come one after another. */
static Result find_or_add(Against *against, const char *name, BufferMetrics **out)
{
    for (size_t i = against->count; i-- > 0;)
        if (strcmp(against->buffers[i].name, name) == 0) {
            *out = &against->buffers[i];
            return RESULT_OK;
        }
    Result result = memory_grow((void **)&against->buffers, &against->capacity, against->count + 1,
                                sizeof *against->buffers);
    if (result != RESULT_OK)
        return result;
    *out = &against->buffers[against->count++];
    **out = (BufferMetrics){0};
    snprintf((*out)->name, sizeof(*out)->name, "%s", name);
    return RESULT_OK;
}

static uint64_t value_count(PixelFormat format, int width, int height)
{
    return (uint64_t)width * (uint64_t)height * (uint64_t)format_info(format)->channels;
}

/* A buffer that the reference has not so: every value differs. */
static void all_differ(BufferMetrics *metrics, PixelFormat format, int width, int height)
{
    metrics->values = value_count(format, width, height);
    metrics->differing = metrics->values;
    metrics->max_ulp = UINT32_MAX;
    metrics->has_first = true;
}

/* Values of the reference that never came differ too. */
static void add_missing(BufferMetrics *metrics, const StoredBuffer *stored)
{
    uint64_t expected = value_count(stored->format, stored->width, stored->height);
    if (metrics->values >= expected)
        return;
    metrics->differing += expected - metrics->values;
    metrics->values = expected;
    metrics->max_ulp = UINT32_MAX;
    metrics->has_first = true;
}

static Result put(TraceSink *sink, const TraceBuffer *buffer)
{
    Against *against = (Against *)sink;
    if (is_diagnostic(buffer->name))
        return RESULT_OK;
    BufferMetrics *metrics;
    Result result = find_or_add(against, buffer->name, &metrics);
    if (result != RESULT_OK)
        return result;
    int index = store_find(against->reference, buffer->name);
    const StoredBuffer *stored = index < 0 ? NULL : store_buffer(against->reference, index);
    if (!stored || stored->format != buffer->format || stored->width != buffer->image_width ||
        stored->height != buffer->image_height) {
        all_differ(metrics, buffer->format, buffer->image_width, buffer->image_height);
        return RESULT_OK;
    }
    size_t row_bytes = (size_t)buffer->width * format_pixel_bytes(buffer->format);
    result =
        memory_grow((void **)&against->band, &against->band_capacity, row_bytes * TRACE_TILE, 1);
    for (int y = 0; result == RESULT_OK && y < buffer->height; y += TRACE_TILE) {
        int rows = buffer->height - y < TRACE_TILE ? buffer->height - y : TRACE_TILE;
        result = store_read(against->reference, index, buffer->x, buffer->y + y, buffer->width,
                            rows, against->band, row_bytes);
        if (result == RESULT_OK)
            metrics_buffer(metrics, buffer->format, buffer->x, buffer->y + y, buffer->width, rows,
                           against->band, row_bytes,
                           (const unsigned char *)buffer->pixels + (size_t)y * buffer->row_bytes,
                           buffer->row_bytes);
    }
    return result;
}

Against against_of(const TraceStore *reference)
{
    return (Against){.sink = {.put = put}, .reference = reference};
}

Result against_finish(Against *against)
{
    for (int i = 0; i < store_count(against->reference); i++) {
        const StoredBuffer *stored = store_buffer(against->reference, i);
        if (is_diagnostic(stored->name))
            continue;
        BufferMetrics *metrics;
        Result result = find_or_add(against, stored->name, &metrics);
        if (result != RESULT_OK)
            return result;
        add_missing(metrics, stored);
    }
    return RESULT_OK;
}

void against_free(Against *against)
{
    free(against->buffers);
    free(against->band);
    *against = (Against){0};
}
