/* What to render and how: the one description that all three renderers receive.
 * Zero is the default everywhere, so `(RenderDesc){.width = 640, .height = 360}` is complete. */
#ifndef PEEL_FRAME_RENDER_DESC_H
#define PEEL_FRAME_RENDER_DESC_H

#include "base/result.h"
#include "number/format.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum MethodId {
    METHOD_PEEL = 0,
    METHOD_PEEL_ID,
    METHOD_DUAL,
    METHOD_FORWARD,
    METHOD_FORWARD_DUAL,
    METHOD_LINKED_LIST,
    METHOD_WEIGHTED_AVERAGE,
    METHOD_WEIGHTED_SUM,
    METHOD_WEIGHTED_BLENDED,
    METHOD_PAINTER,
    METHOD_COUNT
} MethodId;
/* How a surface is lit, by every method: the original's point lights, or one directional light as
 * in the WebGPU tutorial. */
typedef enum ShadingModel {
    SHADING_GGX = 0,
    SHADING_PHONG
} ShadingModel;
/* The order in which instances are drawn; primitive ids stay those of the scene, and so does the
 * order of opaque instances among themselves. */
typedef enum DrawOrder {
    DRAW_ORDER_SCENE = 0,
    DRAW_ORDER_REVERSE,
    DRAW_ORDER_SHUFFLE /* by draw_seed */
} DrawOrder;
/* What the painter sorts by its centroid's distance. */
typedef enum SortUnit {
    SORT_OBJECTS = 0,
    SORT_TRIANGLES
} SortUnit;
/* Weights of McGuire and Bavoil 2013, by the paper's equation. */
typedef enum WeightEquation {
    WEIGHT_9 = 0,
    WEIGHT_7,
    WEIGHT_8,
    WEIGHT_10
} WeightEquation;
/* What is done to the lit layers of a linked list. */
typedef enum PostEffect {
    POST_NONE = 0,
    POST_EDGES /* outlines, from normals and depths */
} PostEffect;
typedef enum GBufferFormat {
    GBUFFER_FULL = 0,
    GBUFFER_SEED,   /* the original's */
    GBUFFER_COMPACT /* octahedral normals, 8-bit material, no position */
} GBufferFormat;
/* Where the lighting pass has the position from: the G-buffer, or the stored depth. A compact
 * G-buffer has none, whatever is asked for. */
typedef enum PositionSource {
    POSITION_BUFFER = 0,
    POSITION_RECONSTRUCT
} PositionSource;
typedef enum DepthFunc {
    DEPTH_LESS = 0,
    DEPTH_LEQUAL
} DepthFunc;
/* stored: a fragment's depth is converted to the stored format before it is compared with a
 * previous layer; raw: gl_FragCoord.z is compared with the fetched value as it is. */
typedef enum PeelTest {
    PEEL_TEST_STORED = 0,
    PEEL_TEST_RAW
} PeelTest;
/* gl: clip space −w ≤ z ≤ w, depth 0 near and 1 far. zero-one: 0 ≤ z ≤ w (clip control), the same
 * depths. reversed: 0 ≤ z ≤ w, depth 1 near and 0 far; clears and comparisons are mirrored. */
typedef enum DepthRange {
    DEPTH_RANGE_GL = 0,
    DEPTH_RANGE_ZERO_ONE,
    DEPTH_RANGE_REVERSED
} DepthRange;
/* gltf: back faces of single-sided materials are culled; seed: of opaque materials only. */
typedef enum CullMode {
    CULL_GLTF = 0,
    CULL_SEED,
    CULL_NONE
} CullMode;
typedef enum NormalMode {
    NORMALS_FACED = 0,
    NORMALS_KEPT
} NormalMode;
/* How the distribution's denominator is computed: as the source writes it, or without the
 * cancellation of 1 − (N·H)² (frame/shading.h). */
typedef enum GgxForm {
    GGX_SOURCE = 0,
    GGX_STABLE
} GgxForm;
/* under: destination alpha becomes 0 behind opaque; seed: glBlendFunc(DST_ALPHA, ONE) for all
 * four channels, so destination alpha becomes 2T and means nothing. RGB is the same. */
typedef enum OpaqueBlend {
    OPAQUE_BLEND_UNDER = 0,
    OPAQUE_BLEND_SEED
} OpaqueBlend;
typedef enum RefPath {
    REF_PATH_AUTO = 0,
    REF_PATH_DEFINITION,
    REF_PATH_TILE
} RefPath;

/* Which instruction set the fast path of ref uses; the bits are the same. */
typedef enum SimdChoice {
    SIMD_AUTO = 0,
    SIMD_SCALAR,
    SIMD_SSE2,
    SIMD_AVX2,
    SIMD_AVX512,
    SIMD_COUNT
} SimdChoice;

const char *simd_name(SimdChoice simd); /* "auto", "scalar", …; static */

enum {
    SIZE_MAX_PIXELS = 16384
}; /* per side */
enum {
    PASSES_MAX = 4096
};
enum {
    THREADS_MAX = 256
};
enum {
    NODES_MAX = 4096
}; /* per pixel, on average */
enum {
    TILE_MIN = 8,
    TILE_DEFAULT = 64,
    TILE_MAX = 256
};
/* Bytes: 4 GiB, or half of a 32-bit address space. */
#define RENDER_MEMORY_DEFAULT                                                                      \
    (SIZE_MAX / 2 < (uint64_t)4 << 30 ? SIZE_MAX / 2 : (size_t)((uint64_t)4 << 30))

typedef struct RenderDesc {
    int width, height; /* pixels, 1 … SIZE_MAX_PIXELS */
    int camera;        /* index into the scene's cameras */
    double time;       /* seconds; turns the lights */
    int lights;        /* first N of the scene's; 0 all, negative none */
    MethodId method;
    int passes;        /* at most N peels; 0 until a peel yields no fragment */
    PixelFormat depth; /* FORMAT_D32F, D24 or D16; FORMAT_RGBA32F (zero) means the default D32F */
    PixelFormat accum; /* FORMAT_RGBA32F, RGBA16F, RGBA16 or RGBA8 */
    GBufferFormat gbuffer;
    PositionSource position;
    DepthRange depth_range;
    DepthFunc depth_func; /* reversed: GREATER and GEQUAL */
    PeelTest peel_test;
    CullMode cull;
    NormalMode normals;
    GgxForm ggx;
    bool back_light; /* transparent surfaces reflect lights behind them (frame/shading.h) */
    OpaqueBlend opaque_blend;
    float bias; /* a peel takes what lies farther behind the previous one than this; of METHOD_PEEL,
                 * METHOD_PEEL_ID and METHOD_FORWARD */
    ShadingModel shading;
    DrawOrder draw_order;
    uint64_t draw_seed;
    SortUnit sort;         /* of METHOD_PAINTER */
    WeightEquation weight; /* of METHOD_WEIGHTED_BLENDED */
    int nodes_per_pixel;   /* of METHOD_LINKED_LIST: room on average; 0: as many as are needed */
    PostEffect post;       /* of METHOD_LINKED_LIST */
    bool unfused;          /* model a driver without fused multiply-add */
    bool model_all;        /* leave nothing out that changes no bit (frame/needs.h) */
    RefPath ref_path;
    uint64_t mutations; /* ref: deliberate mistakes, bits of frame/mutation.h */
    SimdChoice simd;
    bool bound;        /* truth: fill Frame.bound */
    int tile;          /* ref: pixels per side, a power of two from TILE_MIN to TILE_MAX; 0:
                        * TILE_DEFAULT; the bits are the same */
    int threads;       /* 0: one per processor */
    size_t max_memory; /* bytes a renderer may allocate for buffers; 0: RENDER_MEMORY_DEFAULT */
} RenderDesc;

/* Whether every field is in its range, whatever the scene; BAD_INPUT with a message. */
Result render_desc_check(const RenderDesc *desc);

/* The depth format with the default filled in. */
static inline PixelFormat render_desc_depth(const RenderDesc *desc)
{
    return desc->depth == FORMAT_RGBA32F ? FORMAT_D32F : desc->depth;
}

/* The most peels that a frame may have. */
static inline int render_desc_pass_limit(const RenderDesc *desc)
{
    return desc->passes ? desc->passes : PASSES_MAX;
}

/* Stored formats of the G-buffer's colour buffers; position is FORMAT_NONE where it is
 * reconstructed, normal FORMAT_RG16 where it is octahedral. With METHOD_FORWARD diffuse is the lit,
 * premultiplied colour, in 32-bit floats where the G-buffer is full and else in the accumulation's
 * format, and there is nothing else but, for the raw peel test, material. */
typedef struct GBufferLayout {
    PixelFormat normal, position, diffuse, material;
} GBufferLayout;

/* Whether edges are drawn: desc->post has a meaning for linked lists only. */
static inline bool render_desc_edges(const RenderDesc *desc)
{
    return desc->post == POST_EDGES && desc->method == METHOD_LINKED_LIST;
}

const char *gbuffer_name(GBufferFormat format); /* "full", "seed", "compact"; static */

/* METHOD_LINKED_LIST has a compact one, whatever is asked for. */
GBufferLayout render_desc_layout(const RenderDesc *desc);

/* Only a 24-bit depth compared as stored is ambiguous when a texture fetch makes a float of it: the
 * two greatest are both 1. The opaque depth can be either of them, a previous peel's only where the
 * near plane is at 1. Then gl needs a R32UI copy of the integers. A bias is added to floats, but
 * METHOD_PEEL_ID compares integers as well. */
bool render_desc_needs_code(const RenderDesc *desc);
bool render_desc_needs_previous_code(const RenderDesc *desc);

/* METHOD_DUAL's targets: normals with opacity, or one of the two others. */
PixelFormat render_desc_dual_format(const RenderDesc *desc, bool normal);
/* Of the sums that METHOD_WEIGHTED_… blend. */
PixelFormat render_desc_sum_format(const RenderDesc *desc);

/* Sets every choice of the original program: G-buffer, 24-bit depth, 16-bit accumulation, LEQUAL,
 * raw peel test, its culling, normals, distribution, back light and opaque blend. */
void render_desc_seed_profile(RenderDesc *desc);
bool render_desc_is_seed(const RenderDesc *desc); /* whether all of these are set */

#endif
