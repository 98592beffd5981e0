/* The trace: a renderer hands each finished buffer to a sink, step by step.
 *
 * Names: opaque.depth opaque.normal opaque.position opaque.diffuse opaque.material,
 * peel.K.depth peel.K.normal peel.K.position peel.K.diffuse peel.K.material peel.K.accum (K from
 * 0; accum after blending peel K), accum (after the opaque lighting pass), display.
 * Of forward the lit, premultiplied opaque.color and peel.K.color stand for normal, position and
 * diffuse, and material is there with the raw peel test alone.
 * peel.K.id (FORMAT_R32UI): the id buffer of the methods peel-id and linked-list, which gl has too.
 * Methods that do not peel have, as step 1, instead of peel.K.…: weighted-average.sum and .count,
 * weighted-sum.sum, weighted-blended.sum and .product (sums RGBA32F or RGBA16F, count and product
 * R32F), painter.layers (the accumulation before the opaque surfaces).
 * opaque.primitive and peel.K.primitive (FORMAT_R32UI, UINT32_MAX where there is no fragment) tell
 * which triangle a fragment came from; ref and truth give them, gl does not.
 * Of dual and forward-dual, METHOD their name: METHOD.first.depth, METHOD.K.depth, the min-max
 * depths (FORMAT_RG32F); METHOD.K.back_accum; of forward-dual forward-dual.K.front and .back; of
 * dual dual.K.front_normal front_diffuse front_material back_normal back_diffuse back_material, and
 * peel.K.accum. Their peel.K.primitive count the front layers first, then the back ones.
 * A sink with details also gets, of ref, what no renderer stores: opaque.source and peel.K.source
 * (FORMAT_RGBA32F), the premultiplied colours that the lighting pass blended, 0 where there are
 * none; of the methods peel, forward and peel-id peel.K.hidden, peel.K.peeled and peel.K.farther
 * (FORMAT_R32UI), how many fragments the opaque depth, the previous layer and the depth test threw
 * away. These are of methods that light layers from a G-buffer, and of forward.
 * Values are the stored values in their stored formats; rows from top to bottom. */
#ifndef PEEL_FRAME_TRACE_H
#define PEEL_FRAME_TRACE_H

#include "base/result.h"
#include "number/format.h"

#include <stdbool.h>
#include <stddef.h>

/* Rectangles start at multiples of TRACE_TILE and end there or at the image's edge. */
enum {
    TRACE_TILE = 64
};

typedef struct TraceBuffer {
    const char *name;
    int step; /* 0 opaque pass, K + 1 peel K, then accum and display: order of completion */
    PixelFormat format;
    int image_width, image_height; /* of the whole buffer */
    int x, y, width, height;       /* the rectangle given here */
    const void *pixels;            /* the rectangle's rows, top first */
    size_t row_bytes;
} TraceBuffer;

typedef struct TraceSink TraceSink;
struct TraceSink {
    /* Copies what it wants; pixels are the renderer's again on return. Called by one thread at a
     * time. A failure ends the rendering with that result. */
    Result (*put)(TraceSink *sink, const TraceBuffer *buffer);
    bool details;
};

/* A whole buffer with tightly packed rows. A NULL sink takes everything and keeps nothing. */
Result trace_put(TraceSink *sink, const char *name, int step, PixelFormat format, int width,
                 int height, const void *pixels);

/* The same for peel `peel`: the name is "peel.K.<what>" and the step K + 1. */
Result trace_put_peel(TraceSink *sink, int peel, const char *what, PixelFormat format, int width,
                      int height, const void *pixels);

/* K of a name "peel.K", from 0 to PASSES_MAX - 1, and in *rest what follows it; -1 of others. */
int trace_peel_number(const char *name, const char **rest);

#endif
