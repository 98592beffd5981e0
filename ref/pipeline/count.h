/* Counts layers: the opaque list's depths and the transparent list's, nothing shaded. */
#ifndef PEEL_REF_COUNT_H
#define PEEL_REF_COUNT_H

#include "frame/layers.h"

/* See LayerCounter. Memory: 16 bytes a pixel and, while a tile is counted, 20 a fragment of it. */
Result count_layers(const Scene *scene, const RenderDesc *desc, LayerCounts *out);

#endif
