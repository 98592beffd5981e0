/* The settings that the determinism matrix renders every scene with. */
#ifndef PEEL_TESTS_DETERMINISM_SETTINGS_H
#define PEEL_TESTS_DETERMINISM_SETTINGS_H

#include "frame/render_desc.h"

typedef struct DeterminismSetting {
    const char *name; /* the method's, then what is not the default */
    RenderDesc desc;  /* width and height 0: the scene's */
} DeterminismSetting;

/* Each method with the defaults, each again with what leads it another way; of peel, whose tile
 * path is rendered too, every choice of every setting at least once. */
static const DeterminismSetting determinism_settings[] = {
    {"peel", {0}},
    {"peel-odd-size", {.width = 67, .height = 41}},
    {"peel-seed",
     {.depth = FORMAT_D24,
      .accum = FORMAT_RGBA16,
      .gbuffer = GBUFFER_SEED,
      .depth_func = DEPTH_LEQUAL,
      .peel_test = PEEL_TEST_RAW,
      .cull = CULL_SEED,
      .normals = NORMALS_KEPT,
      .opaque_blend = OPAQUE_BLEND_SEED,
      .passes = 20}},
    {"peel-unfused", {.unfused = true, .model_all = true, .passes = 30}},
    {"peel-rgba16f-d24", {.accum = FORMAT_RGBA16F, .depth = FORMAT_D24, .passes = 5}},
    {"peel-rgba8-d16-compact",
     {.accum = FORMAT_RGBA8,
      .depth = FORMAT_D16,
      .gbuffer = GBUFFER_COMPACT,
      .cull = CULL_NONE,
      .unfused = true,
      .passes = 12}},
    {"peel-raw-bias",
     {.peel_test = PEEL_TEST_RAW, .bias = 0x1p-16f, .passes = 20, .accum = FORMAT_RGBA16F}},
    {"peel-reversed-stable",
     {.depth_range = DEPTH_RANGE_REVERSED,
      .position = POSITION_RECONSTRUCT,
      .ggx = GGX_STABLE,
      .back_light = true,
      .passes = 25}},
    {"peel-zero-one-phong-rgba16",
     {.depth_range = DEPTH_RANGE_ZERO_ONE,
      .shading = SHADING_PHONG,
      .accum = FORMAT_RGBA16,
      .passes = 10}},
    {"peel-id", {.method = METHOD_PEEL_ID}},
    {"peel-id-d16-unfused",
     {.method = METHOD_PEEL_ID,
      .depth = FORMAT_D16,
      .gbuffer = GBUFFER_SEED,
      .unfused = true,
      .draw_order = DRAW_ORDER_REVERSE,
      .passes = 7}},
    {"dual", {.method = METHOD_DUAL}},
    {"dual-seed-rgba16f",
     {.method = METHOD_DUAL, .gbuffer = GBUFFER_SEED, .accum = FORMAT_RGBA16F, .passes = 3}},
    {"forward", {.method = METHOD_FORWARD}},
    {"forward-raw-rgba8",
     {.method = METHOD_FORWARD,
      .peel_test = PEEL_TEST_RAW,
      .accum = FORMAT_RGBA8,
      .gbuffer = GBUFFER_SEED,
      .depth = FORMAT_D24,
      .passes = 15}},
    {"forward-dual", {.method = METHOD_FORWARD_DUAL}},
    {"forward-dual-rgba8-unfused",
     {.method = METHOD_FORWARD_DUAL,
      .accum = FORMAT_RGBA8,
      .unfused = true,
      .ggx = GGX_STABLE,
      .passes = 6}},
    {"linked-list", {.method = METHOD_LINKED_LIST}},
    {"linked-list-edges-full",
     {.method = METHOD_LINKED_LIST,
      .post = POST_EDGES,
      .nodes_per_pixel = 2,
      .accum = FORMAT_RGBA16F}},
    {"weighted-average", {.method = METHOD_WEIGHTED_AVERAGE}},
    {"weighted-average-rgba16f", {.method = METHOD_WEIGHTED_AVERAGE, .accum = FORMAT_RGBA16F}},
    {"weighted-sum", {.method = METHOD_WEIGHTED_SUM}},
    {"weighted-sum-rgba16f-unfused",
     {.method = METHOD_WEIGHTED_SUM, .accum = FORMAT_RGBA16F, .unfused = true}},
    {"weighted-blended", {.method = METHOD_WEIGHTED_BLENDED}},
    {"weighted-blended-7-rgba16f",
     {.method = METHOD_WEIGHTED_BLENDED, .weight = WEIGHT_7, .accum = FORMAT_RGBA16F}},
    {"weighted-blended-8", {.method = METHOD_WEIGHTED_BLENDED, .weight = WEIGHT_8}},
    {"weighted-blended-10-unfused",
     {.method = METHOD_WEIGHTED_BLENDED, .weight = WEIGHT_10, .unfused = true}},
    {"painter", {.method = METHOD_PAINTER}},
    {"painter-triangles-shuffle-rgba16",
     {.method = METHOD_PAINTER,
      .sort = SORT_TRIANGLES,
      .draw_order = DRAW_ORDER_SHUFFLE,
      .draw_seed = 7,
      .accum = FORMAT_RGBA16}},
};

enum {
    DETERMINISM_SETTINGS = sizeof determinism_settings / sizeof *determinism_settings
};

#endif
