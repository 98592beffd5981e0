#include "frame/method.h"

#include <string.h>

/* Dual depth peeling has positions from 32-bit depths, and the lists' nodes 8-bit colours and
 * alpha: hence the tolerances. */
static const MethodInfo methods[METHOD_COUNT] = {
    [METHOD_PEEL] = {METHOD_PEEL, "peel",
                     "Rapetta, \"OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling\"",
                     "deferred depth peeling, front to back", true, true, 1e-4},
    [METHOD_PEEL_ID] = {METHOD_PEEL_ID, "peel-id",
                        "Everitt, \"Interactive Order-Independent Transparency\", 2001; the order "
                        "by primitive is ours",
                        "deferred depth peeling by depth and primitive: keeps coplanar layers",
                        true, true, 1e-4},
    [METHOD_DUAL] = {METHOD_DUAL, "dual",
                     "Rapetta, \"OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling\"; "
                     "Bavoil, Myers, \"Order Independent Transparency with Dual Depth Peeling\", "
                     "2008",
                     "deferred dual depth peeling, from both sides", true, true, 2e-3},
    [METHOD_FORWARD] = {METHOD_FORWARD, "forward",
                        "Everitt, \"Interactive Order-Independent Transparency\", 2001; Bavoil and "
                        "Myers, \"Order Independent Transparency with Dual Depth Peeling\", 2008",
                        "front-to-back peeling, shaded in the geometry pass", true, true, 1e-4},
    [METHOD_FORWARD_DUAL] = {METHOD_FORWARD_DUAL, "forward-dual",
                             "Bavoil, Myers, \"Order Independent Transparency with Dual Depth "
                             "Peeling\", 2008",
                             "dual depth peeling, shaded in the geometry pass", true, true, 1e-4},
    [METHOD_LINKED_LIST] =
        {METHOD_LINKED_LIST, "linked-list",
         "Breust, \"Deep Deferred Renderer\"; Yang et al., \"Real-Time Concurrent "
         "Linked List Construction on the GPU\", 2010",
         "deep deferred: one geometry pass into per-pixel lists of G-buffer "
         "nodes, sorted by depth and primitive",
         true, true, 2e-2},
    [METHOD_WEIGHTED_AVERAGE] =
        {METHOD_WEIGHTED_AVERAGE, "weighted-average",
         "Bavoil, Myers, \"Order Independent Transparency with Dual Depth "
         "Peeling\", 2008",
         "every fragment has the pixel's average colour and alpha; one pass", false, false, 0},
    [METHOD_WEIGHTED_SUM] = {METHOD_WEIGHTED_SUM, "weighted-sum",
                             "Meshkin, \"Sort-Independent Alpha Blending\", 2007",
                             "the terms of blending that do not depend on order; one pass", false,
                             false, 0},
    [METHOD_WEIGHTED_BLENDED] = {METHOD_WEIGHTED_BLENDED, "weighted-blended",
                                 "McGuire, Bavoil, \"Weighted Blended Order-Independent "
                                 "Transparency\", 2013",
                                 "an average weighted by depth and alpha; one pass", false, false,
                                 0},
    [METHOD_PAINTER] =
        {METHOD_PAINTER, "painter",
         "Newell, Newell, Sancha, \"A Solution to the Hidden Surface Problem\", 1972",
         "objects or triangles sorted by centroid and blended over; one pass", false, false, 0},
};

bool method_has_bound(const RenderDesc *desc)
{
    switch (desc->method) {
    case METHOD_PEEL:
    case METHOD_PEEL_ID:
    case METHOD_FORWARD:
        return true;
    case METHOD_LINKED_LIST:
        return !render_desc_edges(desc);
    default:
        return false;
    }
}

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
