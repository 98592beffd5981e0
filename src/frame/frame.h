/* What a renderer returns. */
#ifndef PEEL_FRAME_FRAME_H
#define PEEL_FRAME_FRAME_H

#include "frame/render_desc.h"
#include "frame/trace.h"
#include "image/image.h"
#include "scene/scene.h"

#include <stdint.h>

/* Counts over the frame; what a renderer cannot know is 0. */
typedef struct LayerStats {
    uint32_t max;                /* most transparent fragments in one pixel */
    uint64_t fragments;          /* transparent fragments in front of the opaque depth */
    uint64_t lost_to_ties;       /* of those, never peeled: equal depth */
    uint64_t lost_to_pass_limit; /* of those, never peeled: passes ended first */
    uint64_t repeated;           /* peeled again at the depth of the previous peel */
    uint64_t coverage_differs;   /* truth: fragments that exact, unsnapped coverage would change */
    uint64_t lost_to_overflow;   /* a list had no room; some may be behind the opaque depth */
    uint64_t comparisons;        /* truth: of two fragments' depths */
    uint64_t exact_comparisons;  /* of those, decided in exact arithmetic */
    uint64_t ties;               /* truth: fragments at exactly the depth of the one in front */
    uint64_t undecided;          /* truth: comparisons without a result; 0 */
    uint64_t exact_coverage;     /* truth: unsnapped coverage decided in exact arithmetic */
    uint64_t overflowed;         /* pixels with a sum that left its format's range */
} LayerStats;

typedef struct Frame {
    Image final;   /* FORMAT_RGBA32F: linear RGB over the background, A = coverage (1 − T) */
    Image display; /* FORMAT_RGBA8: display-transformed, A = 255 */
    int peels;     /* geometry passes over the transparent list that yielded a fragment */
    int geometry_passes;       /* over the transparent list; the one over the opaque list is extra */
    uint64_t fragments_shaded; /* lit and blended: opaque and transparent; ref only */
    LayerStats layers;
    double residual_max;      /* greatest transmittance in front of fragments the limit lost */
    uint64_t residual_pixels; /* pixels with such fragments */
    uint64_t buffer_bytes;    /* of the renderer's images and lists */
    uint64_t nodes;           /* that lists had to hold, lost ones included; 0 without lists */
    uint32_t node_bytes;      /* of one */
    double time_ms, cpu_ms;   /* wall, and all threads of the renderer; scene upload included */
    int threads;
    bool fused;        /* the arithmetic mode that was used */
    char version[128]; /* of the driver, or of Peel */
    char renderer[128];
} Frame;

void frame_free(Frame *frame); /* leaves an empty frame */

/* The one signature of every renderer. trace may be NULL. On failure *out is empty. */
typedef Result (*Renderer)(const Scene *scene, const RenderDesc *desc, TraceSink *trace,
                           Frame *out);

#endif
