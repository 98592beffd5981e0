#include "frame/method.h"

#include <string.h>

/* Dual depth peeling has positions from 32-bit depths, and the lists' nodes 8-bit colours and
 * alpha: hence the tolerances. */
static const MethodInfo methods[METHOD_COUNT] = {
    [METHOD_PEEL] = {.id = METHOD_PEEL,
                     .name = "peel",
                     .paper =
                         "Rapetta, \"OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling\"",
                     .summary = "deferred depth peeling, front to back",
                     .exact = true,
                     .loses_ties = true,
                     .layers = true,
                     .tolerance = 1e-4},
    [METHOD_PEEL_ID] = {.id = METHOD_PEEL_ID,
                        .name = "peel-id",
                        .paper = "Everitt, \"Interactive Order-Independent Transparency\", 2001; "
                                 "the order by primitive is ours",
                        .summary =
                            "deferred depth peeling by depth and primitive: keeps coplanar layers",
                        .exact = true,
                        .layers = true,
                        .tolerance = 1e-4},
    [METHOD_DUAL] =
        {.id = METHOD_DUAL,
         .name = "dual",
         .paper = "Rapetta, \"OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling\"; Bavoil, "
                  "Myers, \"Order Independent Transparency with Dual Depth Peeling\", 2008",
         .summary = "deferred dual depth peeling, from both sides",
         .exact = true,
         .loses_ties = true,
         .layers = true,
         .tolerance = 2e-3},
    [METHOD_FORWARD] =
        {.id = METHOD_FORWARD,
         .name = "forward",
         .paper = "Everitt, \"Interactive Order-Independent Transparency\", 2001; Bavoil and "
                  "Myers, \"Order Independent Transparency with Dual Depth Peeling\", 2008",
         .summary = "front-to-back peeling, shaded in the geometry pass",
         .exact = true,
         .loses_ties = true,
         .layers = true,
         .tolerance = 1e-4},
    [METHOD_FORWARD_DUAL] =
        {.id = METHOD_FORWARD_DUAL,
         .name = "forward-dual",
         .paper = "Bavoil, Myers, \"Order Independent Transparency with Dual Depth Peeling\", 2008",
         .summary = "dual depth peeling, shaded in the geometry pass",
         .exact = true,
         .loses_ties = true,
         .layers = true,
         .tolerance = 1e-4},
    [METHOD_LINKED_LIST] = {.id = METHOD_LINKED_LIST,
                            .name = "linked-list",
                            .paper = "Breust, \"Deep Deferred Renderer\"; Yang et al., \"Real-Time "
                                     "Concurrent Linked List Construction on the GPU\", 2010",
                            .summary = "deep deferred: one geometry pass into per-pixel lists of "
                                       "G-buffer nodes, sorted by depth and primitive",
                            .exact = true,
                            .layers = true,
                            .tolerance = 2e-2},
    [METHOD_WEIGHTED_AVERAGE] =
        {.id = METHOD_WEIGHTED_AVERAGE,
         .name = "weighted-average",
         .paper = "Bavoil, Myers, \"Order Independent Transparency with Dual Depth Peeling\", 2008",
         .summary = "every fragment has the pixel's average colour and alpha; one pass"},
    [METHOD_WEIGHTED_SUM] = {.id = METHOD_WEIGHTED_SUM,
                             .name = "weighted-sum",
                             .paper = "Meshkin, \"Sort-Independent Alpha Blending\", 2007",
                             .summary =
                                 "the terms of blending that do not depend on order; one pass"},
    [METHOD_WEIGHTED_BLENDED] =
        {.id = METHOD_WEIGHTED_BLENDED,
         .name = "weighted-blended",
         .paper = "McGuire, Bavoil, \"Weighted Blended Order-Independent Transparency\", 2013",
         .summary = "an average weighted by depth and alpha; one pass"},
    [METHOD_PAINTER] =
        {.id = METHOD_PAINTER,
         .name = "painter",
         .paper = "Newell, Newell, Sancha, \"A Solution to the Hidden Surface Problem\", 1972",
         .summary = "objects or triangles sorted by centroid and blended over; one pass"},
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

bool method_is_judged(const RenderDesc *desc)
{
    return method_info(desc->method)->exact && !render_desc_edges(desc);
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
