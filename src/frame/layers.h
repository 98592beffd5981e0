/* How many transparent layers a frame has: what a counting pass finds out without shading. */
#ifndef PEEL_FRAME_LAYERS_H
#define PEEL_FRAME_LAYERS_H

#include "frame/render_desc.h"
#include "scene/scene.h"

/* Of one pixel, or greatest over the frame: fragments in front of the opaque depth, and into how
 * many layers methods take them apart. Textures that make a fragment invisible do not count. */
typedef struct LayerCount {
    uint32_t fragments;
    uint32_t peels;  /* of METHOD_PEEL and METHOD_FORWARD: depths that the peel test tells apart */
    uint32_t ids;    /* of METHOD_PEEL_ID: depths and primitives */
    uint32_t depths; /* of the dual methods: 32-bit depths */
} LayerCount;

typedef struct LayerCounts {
    LayerCount most;
    uint64_t fragments, peels; /* sums over the pixels */
    uint64_t *histogram;       /* most.fragments + 1: pixels with i fragments */
    uint64_t *peel_histogram;  /* most.peels + 1: pixels with i layers */
    uint64_t opaque_primitives,
        transparent_primitives; /* on screen; clipping cuts some in pieces */
    uint64_t geometry_bytes;    /* of ref's vertices, primitives and bins */
    uint64_t bytes;             /* of the counting pass in all */
} LayerCounts;

void layers_free(LayerCounts *counts); /* leaves empty ones */

/* *out is empty on failure: NO_MEMORY, or as view_build. */
typedef Result (*LayerCounter)(const Scene *scene, const RenderDesc *desc, LayerCounts *out);

/* Geometry passes over the transparent list that a method takes for all of these layers, without a
 * pass limit; as Frame.geometry_passes, and 1 where there are no layers. With the raw peel test and
 * no limit a layer that repeats can take further passes. */
int layers_passes(const LayerCount *most, MethodId method);

#endif
