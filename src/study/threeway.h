/* All three renderers on one scene, compared buffer by buffer. */
#ifndef PEEL_STUDY_THREEWAY_H
#define PEEL_STUDY_THREEWAY_H

#include "compare/metrics.h"
#include "frame/frame.h"
#include "study/budget.h"

enum {
    RENDERER_REF,
    RENDERER_GL,
    RENDERER_TRUTH,
    RENDERER_COUNT
};

typedef struct PairReport {
    int a, b;               /* RENDERER_… */
    BufferMetrics *buffers; /* ref–gl only: one per traced buffer, in order of completion */
    size_t buffer_count;
    FinalMetrics final;
    bool has_unaffected; /* pairs with truth */
    UnaffectedMetrics unaffected;
    bool has_bound; /* pairs with truth, where desc asks for bounds */
    BoundMetrics bound;
} PairReport;

/* Counts of how ref's fragments differ from truth's. */
typedef struct StructureReport {
    bool known;                /* the method traces its layers; else the counts below are 0 */
    LayerStats layers;         /* ref's counts; truth's where only truth counts, max, fragments */
    uint64_t order_inversions; /* adjacent fragments that truth orders the other way */
    uint64_t opaque_flips;     /* pixels whose nearest opaque triangle differs */
    uint64_t set_differs;      /* fragments that only one side has, ties and limit apart */
    bool same_scene; /* opaque_flips, set_differs and repeated: 1 % of pixels and fragments, or 4 */
    uint8_t *same;   /* width·height: a StructureSame each */
} StructureReport;

/* One peel, for pictures: ref's accumulation after it, and what it added. */
typedef struct PeelPicture {
    int peel;
    uint64_t pixels; /* with a fragment */
    Image accum;     /* FORMAT_RGBA32F, reduced to at most 320 pixels wide; A = transmittance */
    Image added;     /* the same size: this peel's contribution, RGB; A = 1 where a fragment is */
} PeelPicture;

typedef struct Threeway {
    const char *scene_name, *scene_path;
    RenderDesc desc;
    size_t light_count; /* of the scene, whatever desc draws */
    bool seed_profile;
    double tolerance;
    Frame frames[RENDERER_COUNT];
    PairReport pairs[3]; /* ref–gl, ref–truth, gl–truth */
    StructureReport structure;
    uint64_t nonfinite; /* values in all of ref's buffers that are NaN or infinite */
    PeelPicture *peels;
    size_t peel_count;    /* pictures kept, at most PEEL_PICTURES_MAX */
    bool agree;           /* the verdict: exit code 0 */
    const Budget *budget; /* NULL: not asked for; the caller's */
} Threeway;

enum {
    PEEL_PICTURES_MAX = 64
};

/* Renderers in the order of RENDERER_…; any may fail, and the message says which.
 * tolerance: from 0; negative for the method's (frame/method.h). keep_pictures: fill peels. The
 * caller frees with threeway_free. */
Result threeway_run(const Scene *scene, const char *path, const RenderDesc *desc,
                    const Renderer renderers[RENDERER_COUNT], double tolerance, bool keep_pictures,
                    Threeway *out);
/* Frees the images, the pictures of peels and the structure of each pixel; keeps the figures. */
void threeway_release_images(Threeway *report);
void threeway_free(Threeway *report);

const char *threeway_renderer_name(int renderer); /* "ref", "gl", "truth" */

#endif
