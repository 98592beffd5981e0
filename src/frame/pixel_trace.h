/* A trace sink that keeps one pixel of every buffer. */
#ifndef PEEL_FRAME_PIXEL_TRACE_H
#define PEEL_FRAME_PIXEL_TRACE_H

#include "frame/trace.h"

#include <stdint.h>

enum {
    PIXEL_TRACE_NAME = 48,
    PIXEL_TRACE_BYTES = 16
};

typedef struct PixelValue {
    char name[PIXEL_TRACE_NAME];
    PixelFormat format;
    _Alignas(8) unsigned char bytes[PIXEL_TRACE_BYTES];
} PixelValue;

typedef struct PixelTrace {
    TraceSink sink;     /* first */
    int x, y;           /* from the top left */
    PixelValue *values; /* in their order */
    size_t count, room;
} PixelTrace;

/* Several pixels of one frame. */
typedef struct PixelFan {
    TraceSink sink; /* first */
    PixelTrace *traces;
    size_t count;
} PixelFan;

/* traces: the caller's, who frees them. */
PixelFan pixel_fan_of(PixelTrace *traces, size_t count);

PixelTrace pixel_trace_of(int x, int y);
void pixel_trace_free(PixelTrace *trace); /* leaves one without values */

/* By name; NULL where it was not traced. */
const PixelValue *pixel_trace_find(const PixelTrace *trace, const char *name);
/* "<prefix>.<number>.<what>". */
const PixelValue *pixel_trace_numbered(const PixelTrace *trace, const char *prefix, int number,
                                       const char *what);
/* The first channel's bits: an id, a depth's code; other where it was not traced. */
uint32_t pixel_trace_bits(const PixelValue *value, uint32_t other);

#endif
