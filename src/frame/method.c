#include "frame/method.h"

#include <string.h>

static const MethodInfo methods[METHOD_COUNT] = {
    [METHOD_PEEL] = {METHOD_PEEL, "peel",
                     "Rapetta, \"OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling\"",
                     "deferred depth peeling, front to back", true, true},
    [METHOD_WEIGHTED_AVERAGE] =
        {METHOD_WEIGHTED_AVERAGE, "weighted-average",
         "Bavoil, Myers, \"Order Independent Transparency with Dual Depth "
         "Peeling\", 2008",
         "every fragment has the pixel's average colour and alpha; one pass", false, false},
    [METHOD_WEIGHTED_SUM] = {METHOD_WEIGHTED_SUM, "weighted-sum",
                             "Meshkin, \"Sort-Independent Alpha Blending\", 2007",
                             "the terms of blending that do not depend on order; one pass", false,
                             false},
    [METHOD_WEIGHTED_BLENDED] = {METHOD_WEIGHTED_BLENDED, "weighted-blended",
                                 "McGuire, Bavoil, \"Weighted Blended Order-Independent "
                                 "Transparency\", 2013",
                                 "an average weighted by depth and alpha; one pass", false, false},
    [METHOD_PAINTER] =
        {METHOD_PAINTER, "painter",
         "Newell, Newell, Sancha, \"A Solution to the Hidden Surface Problem\", 1972",
         "objects or triangles sorted by centroid and blended over; one pass", false, false},
};

const MethodInfo *method_info(MethodId id)
{
    return &methods[id];
}

const MethodInfo *method_find(const char *name)
{
    for (int i = 0; i < METHOD_COUNT; i++)
        if (strcmp(methods[i].name, name) == 0)
            return &methods[i];
    return NULL;
}
