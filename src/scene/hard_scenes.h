/* The scenes of the hard cases: what is hard for peeling, for a rasterizer, for single precision or
 * for a stored format, each as small as it can be. */
#ifndef PEEL_SCENE_HARD_SCENES_H
#define PEEL_SCENE_HARD_SCENES_H

#include "scene/scene.h"

typedef struct HardScene {
    const char *name;
    const char *why;    /* it is hard: one sentence */
    const char *source; /* a paper, a specification, or a class of bugs */
    Result (*generate)(Scene *out);
} HardScene;

/* Static table, in the order of the documentation; *count rows. */
const HardScene *hard_scenes_table(size_t *count);
/* NULL when there is no such case. */
const HardScene *hard_scenes_find(const char *name);

/* The generators. */
#define HARD_SCENES(X)                                                                             \
    X(coincident_faces)                                                                            \
    X(layers_one_ulp)                                                                              \
    X(crossing_nearly_coplanar)                                                                    \
    X(thin_shells)                                                                                 \
    X(layers_64)                                                                                   \
    X(layers_256)                                                                                  \
    X(layers_1000)                                                                                 \
    X(at_opaque_depth)                                                                             \
    X(depth_16_aliasing)                                                                           \
    X(raw_24)                                                                                      \
    X(bias)                                                                                        \
    X(near_far_wide)                                                                               \
    X(far_infinite)                                                                                \
    X(denormal_depths)                                                                             \
    X(draw_order)                                                                                  \
    X(inside_glass)                                                                                \
    X(behind_the_eye)                                                                              \
    X(near_and_far_planes)                                                                         \
    X(slivers)                                                                                     \
    X(fan)                                                                                         \
    X(shared_edges)                                                                                \
    X(confetti)                                                                                    \
    X(huge_triangles)                                                                              \
    X(degenerate)                                                                                  \
    X(mirrored)                                                                                    \
    X(alpha_zero)                                                                                  \
    X(alpha_threshold)                                                                             \
    X(alpha_almost_one)                                                                            \
    X(alpha_one)                                                                                   \
    X(drift_8)                                                                                     \
    X(half_overflow)                                                                               \
    X(brightest)                                                                                   \
    X(roughness_zero)                                                                              \
    X(roughness_one)                                                                               \
    X(grazing)                                                                                     \
    X(light_at_surface)                                                                            \
    X(light_behind)                                                                                \
    X(zero_normals)                                                                                \
    X(many_lights)

#define HARD_SCENES_DECLARE(name) Result hard_scenes_##name(Scene *out);
HARD_SCENES(HARD_SCENES_DECLARE)
#undef HARD_SCENES_DECLARE

#endif
