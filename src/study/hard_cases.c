#include "study/hard.h"

#include <math.h>
#include <string.h>

static const HardCase cases[] = {
    {.name = "coincident_faces", .ought = "", .size = 96},
    {.name = "layers_one_ulp", .ought = "", .size = 96},
    {.name = "crossing_nearly_coplanar", .ought = "", .size = 96},
    {.name = "thin_shells", .ought = "", .size = 96},
    {.name = "layers_64", .ought = "", .size = 96},
    {.name = "layers_256", .ought = "", .size = 48},
    {.name = "layers_1000", .ought = "", .size = 24},
    {.name = "at_opaque_depth", .ought = "", .size = 96},
    {.name = "depth_16_aliasing", .ought = "", .size = 96},
    {.name = "raw_24", .ought = "", .size = 96},
    {.name = "bias", .ought = "", .size = 96},
    {.name = "near_far_wide", .ought = "", .size = 96},
    {.name = "far_infinite", .ought = "", .size = 96},
    {.name = "denormal_depths", .ought = "", .size = 96},
    {.name = "draw_order", .ought = "", .size = 96},
    {.name = "inside_glass", .ought = "", .size = 96},
    {.name = "behind_the_eye", .ought = "", .size = 96},
    {.name = "near_and_far_planes", .ought = "", .size = 96},
    {.name = "slivers", .ought = "", .size = 96},
    {.name = "fan", .ought = "", .size = 96},
    {.name = "shared_edges", .ought = "", .size = 96},
    {.name = "confetti", .ought = "", .size = 96},
    {.name = "huge_triangles", .ought = "", .size = 96},
    {.name = "degenerate", .ought = "", .size = 96},
    {.name = "mirrored", .ought = "", .size = 96},
    {.name = "alpha_zero", .ought = "", .size = 96},
    {.name = "alpha_threshold", .ought = "", .size = 96},
    {.name = "alpha_almost_one", .ought = "", .size = 96},
    {.name = "alpha_one", .ought = "", .size = 96},
    {.name = "drift_8", .ought = "", .size = 96},
    {.name = "half_overflow", .ought = "", .size = 96},
    {.name = "brightest", .ought = "", .size = 96},
    {.name = "roughness_zero", .ought = "", .size = 96},
    {.name = "roughness_one", .ought = "", .size = 96},
    {.name = "grazing", .ought = "", .size = 96},
    {.name = "light_at_surface", .ought = "", .size = 96},
    {.name = "light_behind", .ought = "", .size = 96},
    {.name = "zero_normals", .ought = "", .size = 96},
    {.name = "many_lights", .ought = "", .size = 96},
};

const HardCase *hard_cases(size_t *count)
{
    *count = sizeof cases / sizeof cases[0];
    return cases;
}

const HardCase *hard_find(const char *name)
{
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        if (strcmp(cases[i].name, name) == 0)
            return &cases[i];
    return NULL;
}
