#include "scene/hard_scenes.h"

#include <string.h>

#define EVERITT "Everitt, \"Interactive Order-Independent Transparency\", 2001"
#define GOLDBERG                                                                                   \
    "Goldberg, \"What Every Computer Scientist Should Know About Floating-Point "                  \
    "Arithmetic\", 1991"
#define PIXELS   "OpenGL 4.6, 14.6.1 (polygon rasterization)"
#define CLIPPING "Blinn, Newell, \"Clipping Using Homogeneous Coordinates\", 1978"
#define DEPTHS   "Lapidous, Jiao, \"Optimal Depth Buffer for Low-Cost Graphics Hardware\", 1999"
#define BLENDING "Porter, Duff, \"Compositing Digital Images\", 1984"
#define GGX      "Walter et al., \"Microfacet Models for Refraction through Rough Surfaces\", 2007"

static const HardScene scenes[] = {
    {"coincident_faces",
     "Several faces lie in one plane: a peel keeps one of equal depths and loses the others.",
     EVERITT, hard_scenes_coincident_faces},
    {"layers_one_ulp",
     "Sixteen layers whose exact depths are one step of single precision apart: the roundings on "
     "the way to a depth are as large.",
     GOLDBERG, hard_scenes_layers_one_ulp},
    {"crossing_nearly_coplanar",
     "Two planes cross at 0.001 degrees: far to both sides of the crossing their depths round to "
     "the same number, or to the wrong order.",
     "Newell, Newell, Sancha, \"A Solution to the Hidden Surface Problem\", 1972; z-fighting",
     hard_scenes_crossing_nearly_coplanar},
    {"thin_shells",
     "Balls through each other, each of two shells 0.2 % apart: many layers, close together, that "
     "change places along curves.",
     EVERITT, hard_scenes_thin_shells},
    {"layers_64", "64 layers: every error of a layer is made 64 times.", EVERITT,
     hard_scenes_layers_64},
    {"layers_256", "256 layers: limits of passes, lists and counters show.",
     "Yang et al., \"Real-Time Concurrent Linked List Construction on the GPU\", 2010",
     hard_scenes_layers_256},
    {"layers_1000", "1,000 layers of alpha 1/255: each changes less than 8 bits can store.",
     "Blinn, \"Three Wrongs Make a Right\", 1995", hard_scenes_layers_1000},
    {"at_opaque_depth",
     "Transparent surfaces exactly at the depth of an opaque one: hidden by the rule, and a "
     "rounding away from showing through.",
     "decals and z-fighting; OpenGL 4.6, 17.3.4 (depth buffer test)", hard_scenes_at_opaque_depth},
    {"depth_16_aliasing", "Eight layers inside three codes of a 16-bit depth buffer.", DEPTHS,
     hard_scenes_depth_16_aliasing},
    {"raw_24",
     "A depth of 32 bits is compared with one that was rounded to 24: a layer can lie behind "
     "itself.",
     "Rapetta, \"OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling\"; precision mismatch",
     hard_scenes_raw_24},
    {"bias",
     "Layers closer together than the bias that is to keep a layer from being peeled twice.",
     "Reeves, Salesin, Cook, \"Rendering Antialiased Shadows with Depth Maps\", 1987",
     hard_scenes_bias},
    {"near_far_wide",
     "Near 1e-4, far 1e4: nearly all of the depth range is spent on the first millimetres.", DEPTHS,
     hard_scenes_near_far_wide},
    {"far_infinite", "The same with the far plane at infinity, and a pane 9e14 away.",
     "Upchurch, Desbrun, \"Tightening the Precision of Perspective Rendering\", 2012",
     hard_scenes_far_infinite},
    {"denormal_depths",
     "Reversed depths below 2^-126, which hardware may flush to 0, the depth of nothing at all.",
     "OpenGL 4.6, 2.3.4 (floating-point numbers); flush to zero", hard_scenes_denormal_depths},
    {"draw_order",
     "Panes through each other and two in one plane: the picture must not depend on the order in "
     "which they are drawn.",
     "Mammen, \"Transparency and Antialiasing Algorithms Implemented with the Virtual Pixel Maps "
     "Technique\", 1989",
     hard_scenes_draw_order},
    {"inside_glass",
     "The eye is inside a ball of glass, and the near plane cuts another: back faces come first.",
     CLIPPING, hard_scenes_inside_glass},
    {"behind_the_eye",
     "Triangles that reach through the plane of the eye, where w is 0, and one that touches the "
     "eye itself.",
     CLIPPING, hard_scenes_behind_the_eye},
    {"near_and_far_planes",
     "Panes exactly in the planes that clip them, one step inside, and one cut by both.", CLIPPING,
     hard_scenes_near_and_far_planes},
    {"slivers",
     "Triangles down to 1/1024 of a pixel thin, along a diagonal through pixel centres: the tie "
     "rule decides every pixel.",
     "Shewchuk, \"Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric "
     "Predicates\", 1997",
     hard_scenes_slivers},
    {"fan",
     "10,000 triangles meet in the centre of a pixel: transparent, each pixel must be drawn once.",
     PIXELS, hard_scenes_fan},
    {"shared_edges",
     "Edges that two transparent surfaces share, through pixel centres: no pixel twice, none "
     "missing.",
     PIXELS, hard_scenes_shared_edges},
    {"confetti", "1,200 triangles smaller than a pixel: most are between the centres.", PIXELS,
     hard_scenes_confetti},
    {"huge_triangles",
     "Corners a million images away: edge functions, planes and attributes lose their digits.",
     "Olano, Greer, \"Triangle Scan Conversion Using 2D Homogeneous Coordinates\", 1997; guard "
     "bands",
     hard_scenes_huge_triangles},
    {"degenerate",
     "Triangles without area and instances flattened to a plane and to a line: divisions by 0, and "
     "every layer twice.",
     "division by the area; singular normal matrices", hard_scenes_degenerate},
    {"mirrored",
     "A matrix with negative determinant turns every triangle round; culling and normals must "
     "follow.",
     "glTF 2.0, 3.7.4 (instantiation: winding order)", hard_scenes_mirrored},
    {"alpha_zero", "A surface that cannot be seen must neither blend nor count as a layer.",
     BLENDING, hard_scenes_alpha_zero},
    {"alpha_threshold",
     "Alpha just below, at and just above the 1e-4 at which surfaces and fragments are dropped.",
     "Rapetta, \"OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling\" (alpha test)",
     hard_scenes_alpha_threshold},
    {"alpha_almost_one",
     "Alpha 1 - 2^-24: what is behind comes through at 2^-24, and is bright enough to be seen.",
     GOLDBERG, hard_scenes_alpha_almost_one},
    {"alpha_one",
     "An opaque layer among the transparent ones: nothing behind it may come through, and it must "
     "not write the opaque depth.",
     BLENDING, hard_scenes_alpha_one},
    {"drift_8", "96 layers of alpha 0.01: the rounding of 8 bits has one sign, and adds up.",
     "Blinn, \"Three Wrongs Make a Right\", 1995", hard_scenes_drift_8},
    {"half_overflow",
     "Light beyond 65504, the greatest half: infinity there, and infinity times 0 is no number.",
     "IEEE 754-2019, 7.4 (overflow); McGuire, Bavoil, \"Weighted Blended Order-Independent "
     "Transparency\", 2013",
     hard_scenes_half_overflow},
    {"brightest",
     "The brightest lights that a scene may have, near the least attenuation, on mirrors: sums up "
     "to 1e26 in single precision.",
     "overflow of light sums", hard_scenes_brightest},
    {"roughness_zero",
     "Mirrors: the highlight's distribution is near 1e5 over a few pixels, and its textbook form "
     "cancels there.",
     GGX, hard_scenes_roughness_zero},
    {"roughness_one", "The roughest surfaces: the geometry term at its limit.", GGX,
     hard_scenes_roughness_one},
    {"grazing",
     "Normals at right angles to the line of sight: the specular term's denominator goes to 0.",
     "Heitz, \"Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs\", 2014",
     hard_scenes_grazing},
    {"light_at_surface",
     "Lights inside the surface: the direction to them is 0/0, their attenuation 1/0.",
     "division by the distance", hard_scenes_light_at_surface},
    {"light_behind",
     "A light on the line of sight behind the surface: the half vector has length 0.", GGX,
     hard_scenes_light_behind},
    {"zero_normals",
     "Normals of length 0, as files have them, and normals that cancel between two corners.",
     "normalisation of zero vectors", hard_scenes_zero_normals},
    {"many_lights",
     "Metal and dielectric under 128 lights, some inside: 128 roundings a pixel, many highlights.",
     GGX, hard_scenes_many_lights},
};

const HardScene *hard_scenes_table(size_t *count)
{
    *count = sizeof scenes / sizeof scenes[0];
    return scenes;
}

const HardScene *hard_scenes_find(const char *name)
{
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++)
        if (strcmp(scenes[i].name, name) == 0)
            return &scenes[i];
    return NULL;
}
