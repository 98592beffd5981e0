/* libpeel: the reference for order-independent transparency by depth peeling, as a library.
 *
 * It blends arrays of pixels in several arithmetics (exactly rounded, as a GL driver does, or as
 * you name it), renders scenes given as arrays by the reference pipeline and by the ground truth,
 * and compares images value by value. It opens no file, prints nothing, never exits (but GMP aborts
 * when PEEL_TRUTH finds no memory for its numbers), and needs GMP and the C library alone. C99 or
 * C++, this one header:
 *
 *     cc program.c $(pkg-config --cflags --libs peel)
 *     find_package(peel CONFIG REQUIRED)  target_link_libraries(program peel::peel)
 *
 * Images: rows from top to bottom, pixels tightly packed. Colours are linear and, where they have
 * an alpha or a transmittance with them, premultiplied. Matrices: 16 numbers, column after column,
 * for column vectors, as OpenGL has them.
 *
 * Errors: functions that can fail return a PeelResult; peel_message() then says what, where and
 * what was expected, in one line. Outputs are untouched after a failure. Pointers must not be NULL
 * where nothing is said of it; NULL is then PEEL_BAD_INPUT, not a crash. Strings that are returned
 * are static.
 *
 * Threads: every function may be called by any number of threads at the same time, on outputs of
 * their own; a PeelScene is only read. peel_scene_render starts threads of its own and ends them.
 * Functions use the default floating-point environment on x86-64 whatever the caller's is, and
 * leave the caller's as it was; elsewhere the caller must have the default one.
 *
 * Pixels depend on no processor: the same input gives the same bits everywhere.
 *
 * Versions: semantic. Before 1.0 a change of the second number may change structures; the shared
 * library's name then changes too. */
#ifndef PEEL_H
#define PEEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define PEEL_API __attribute__((visibility("default")))
#else
#define PEEL_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

#define PEEL_VERSION_MAJOR 0
#define PEEL_VERSION_MINOR 1
#define PEEL_VERSION_PATCH 0

/* "0.1.0": of the library that runs, which may be newer than this header. */
PEEL_API const char *peel_version(void);

typedef enum PeelResult {
    PEEL_OK = 0,
    PEEL_NO_MEMORY,   /* an allocation failed, or would exceed the caller's limit */
    PEEL_BAD_INPUT,   /* an argument is out of its range */
    PEEL_UNSUPPORTED, /* a good argument, but not modelled, or not by this processor */
    PEEL_STOPPED,     /* the caller's callback asked for it */
    PEEL_INTERNAL     /* a bug of the library */
} PeelResult;

PEEL_API const char *peel_result_text(PeelResult result); /* "bad input" */

/* The calling thread's latest message, "" if there was none. Valid until the thread's next failure.
 */
PEEL_API const char *peel_message(void);

/* ---- formats -------------------------------------------------------------------------------- */

/* How a pixel is stored: channels in the order of the name, each in the machine's byte order. */
typedef enum PeelFormat {
    PEEL_RGBA32F = 0,
    PEEL_RGBA16F,
    PEEL_RGBA16, /* 16-bit integers that mean code / 65535 */
    PEEL_RGBA8,  /* code / 255 */
    PEEL_RG32F,
    PEEL_R32F,
    /* Only of rendering's buffers: */
    PEEL_RG16,  /* code / 65535 */
    PEEL_D32F,  /* window depth, 0 to 1, as a float */
    PEEL_D24,   /* window depth as code / (2^24 - 1), in a uint32_t */
    PEEL_D16,   /* code / 65535, in a uint32_t too */
    PEEL_R32UI, /* an index; UINT32_MAX is none */
    PEEL_FORMAT_COUNT
} PeelFormat;

PEEL_API const char *peel_format_name(PeelFormat format);   /* "rgba16f"; NULL of no format */
PEEL_API int peel_format_channels(PeelFormat format);       /* 0 of no format */
PEEL_API size_t peel_format_pixel_bytes(PeelFormat format); /* likewise */

/* The number that a stored channel holds: floats and halves as they are, integers by their meaning
 * above, rounded to float. pixel: in that format, at any address. channel: from 0. */
PEEL_API PeelResult peel_value(PeelFormat format, const void *pixel, int channel, float *out);

/* count vec4 to and from pixels of one of the first six formats, as the render targets and texel
 * fetches of Mesa's llvmpipe do: 8 and 16 bits round to nearest even, halves are
 * truncated toward zero, NaN is code 0, channels that are not stored are fetched as 0, alpha as 1.
 * (To round halves to nearest even, blend them with the arithmetic "exact" and the equation
 * "one,zero".) values: 4 * count floats; pixels: count pixels. count may be 0. */
PEEL_API PeelResult peel_store(PeelFormat format, size_t count, const float *values, void *pixels);
PEEL_API PeelResult peel_fetch(PeelFormat format, size_t count, const void *pixels, float *values);

/* The number of representable values between two pixels, channel by channel: 0 where the bits are
 * equal or both are NaN; +0 and -0 are 1 apart; UINT32_MAX between a NaN and a number. a, b: one
 * pixel each; out: one number for each channel of the format. */
PEEL_API PeelResult peel_ulp(PeelFormat format, const void *a, const void *b, uint32_t *out);

/* Clears count pixels of one of the first six formats to (0, 0, 0, 1): no colour, full
 * transmittance, which "under" starts from. */
PEEL_API PeelResult peel_clear(PeelFormat format, size_t count, void *pixels);

/* ---- blending -------------------------------------------------------------------------------- */

/* Factors and functions as OpenGL has them (4.6 core, section 17.3.6). */
typedef enum PeelFactor {
    PEEL_ZERO = 0,
    PEEL_ONE,
    PEEL_SRC_COLOR,
    PEEL_ONE_MINUS_SRC_COLOR,
    PEEL_DST_COLOR,
    PEEL_ONE_MINUS_DST_COLOR,
    PEEL_SRC_ALPHA,
    PEEL_ONE_MINUS_SRC_ALPHA,
    PEEL_DST_ALPHA,
    PEEL_ONE_MINUS_DST_ALPHA,
    PEEL_SRC_ALPHA_SATURATE,
    PEEL_FACTOR_COUNT
} PeelFactor;

typedef enum PeelFunc {
    PEEL_ADD = 0,
    PEEL_SUBTRACT,         /* source - destination */
    PEEL_REVERSE_SUBTRACT, /* destination - source */
    PEEL_MIN,              /* takes no factors, like PEEL_MAX */
    PEEL_MAX,
    PEEL_FUNC_COUNT
} PeelFunc;

/* func(source * factor, destination * factor). Formats without alpha read a destination alpha of 1;
 * what they do not store is dropped. All zero gives 0. */
typedef struct PeelEquation {
    PeelFactor source, destination;             /* of red, green and blue */
    PeelFactor source_alpha, destination_alpha; /* of alpha */
    PeelFunc func, func_alpha;
} PeelEquation;

/* The equations with names, in order, "under" first; NULL of i beyond the last. what may be NULL;
 * else it becomes one line. */
PEEL_API const char *peel_equation_name(size_t i, const char **what);

/* A name, or factors: "SOURCE,DESTINATION[,SOURCE_ALPHA,DESTINATION_ALPHA][:FUNC[,FUNC_ALPHA]]" in
 * GL's words with '-' for '_': "dst-alpha,one,zero,one-minus-src-alpha", "one,one:max". */
PEEL_API PeelResult peel_equation_parse(const char *text, PeelEquation *out);

typedef enum PeelArithmeticKind {
    PEEL_EXACT = 0, /* the exact result of the stored operands, rounded once, to nearest even */
    PEEL_DRIVER,    /* Mesa's llvmpipe, bit for bit */
    PEEL_STEPS      /* one operation after the other, as the other fields say */
} PeelArithmeticKind;

typedef enum PeelPrecision {
    PEEL_PRECISION_FLOAT = 0, /* operands, products and sums are rounded to 24 bits */
    PEEL_PRECISION_HALF,
    PEEL_PRECISION_DOUBLE,
    PEEL_PRECISION_CODES /* integers of the format; rgba8 and rgba16 only */
} PeelPrecision;

typedef enum PeelRounding {
    PEEL_NEAREST_EVEN = 0,
    PEEL_TOWARD_ZERO,
    PEEL_NEAREST_AWAY, /* ties away from zero */
    PEEL_UPWARD
} PeelRounding;

/* a * b / (2^n - 1) of integers of n bits. */
typedef enum PeelCodeProduct {
    /* t = ab + 2^(n-1); (t + (t >> n)) >> n: the exact quotient to nearest */
    PEEL_CODES_NEAREST = 0,
    PEEL_CODES_DRIVER,        /* t = ab; t += t >> n; (t + 2^(n-1)) >> n */
    PEEL_CODES_FLOOR,         /* ab / (2^n - 1) */
    PEEL_CODES_SHIFT,         /* ab >> n */
    PEEL_CODES_SHIFT_ROUND,   /* (ab + 2^(n-1)) >> n */
    PEEL_CODES_SHIFT_MOST,    /* (ab + 2^n - 1) >> n */
    PEEL_CODES_SHIFT_STRETCH, /* a * (b + (b >> (n - 1))) >> n */
    PEEL_CODES_SHIFT_PLUS,    /* a * (b + 1) >> n; b is the factor */
    PEEL_CODES_RECIPROCAL     /* ab * (2^n + 1) >> 2n */
} PeelCodeProduct;

/* Zero: exact. */
typedef struct PeelArithmetic {
    PeelArithmeticKind kind;
    /* Of PEEL_STEPS: */
    PeelPrecision precision;
    PeelRounding rounding; /* of products and sums */
    PeelRounding store;    /* of the result into the format */
    PeelCodeProduct product;
    bool fused;         /* the last product is added without being rounded; of PEEL_DRIVER: the
                         * processor has fused multiply-add */
    bool flush;         /* denormal operands and results are zeros of their sign */
    bool source_stored; /* the source is first rounded to the format */
    uint32_t mistakes;  /* deliberate ones, as peel_arithmetic_parse sets them */
} PeelArithmetic;

typedef struct PeelArithmeticInfo {
    const char *name; /* "separate-truncated" */
    const char *what; /* one line: the formula, or what is wrong with it */
    PeelArithmetic arithmetic;
    bool wrong; /* a known mistake, there to be found, in every format. Where it is false, steps
                 * of PEEL_PRECISION_HALF are still wrong in the formats that have more digits
                 * than a half's 11: PEEL_RGBA16, PEEL_RGBA32F, PEEL_RG32F and PEEL_R32F */
} PeelArithmeticInfo;

/* The arithmetics with names: right ones, then wrong ones. */
PEEL_API size_t peel_arithmetic_count(void);
PEEL_API PeelResult peel_arithmetic_info(size_t i, PeelArithmeticInfo *out);

/* A name, or key=value pairs with commas between: precision=float|half|double|codes, rounding= and
 * store=nearest|truncate|away|up, product=nearest|driver|floor|shift|shift-round|shift-most|
 * shift-stretch|shift-plus|reciprocal, fused=, flush= and source-stored=yes|no, mistake=NAME:
 * "precision=codes,product=shift-round", "store=truncate". */
PEEL_API PeelResult peel_arithmetic_parse(const char *text, PeelArithmetic *out);

/* Blends count sources, 4 floats each, onto count pixels of one of the first six formats, aligned
 * to their channels. Of formats of integers the source is stored first, as GPUs do, unless the
 * arithmetic's fields say otherwise. PEEL_UNSUPPORTED where the arithmetic is not defined for the
 * equation and format. One thread, no allocation; count may be 0. */
PEEL_API PeelResult peel_blend(const PeelArithmetic *arithmetic, const PeelEquation *equation,
                               PeelFormat format, size_t count, const float *sources, void *pixels);

/* One channel of one blend, value by value: numbers, or where codes is true integers. What an exact
 * blend has no double for is NaN. */
typedef struct PeelBlendSteps {
    double source, destination; /* as they are used */
    double source_factor, destination_factor;
    double source_product, destination_product;
    double sum;      /* or difference, minimum, maximum; not yet stored */
    uint32_t stored; /* bits of the format */
    bool codes;
} PeelBlendSteps;

/* The same blend of one source, 4 floats, and one pixel, which is not changed. out: one for each
 * channel of the format. */
PEEL_API PeelResult peel_blend_steps(const PeelArithmetic *arithmetic, const PeelEquation *equation,
                                     PeelFormat format, const float *source, const void *pixel,
                                     PeelBlendSteps *out);

/* ---- scenes ---------------------------------------------------------------------------------- */

/* Right-handed, y up, counter-clockwise triangles face front, as in glTF 2.0, whose materials and
 * cameras these are. Nothing lies beyond 1e15 of the origin. */

/* Indexed triangles. Equal depth: the earlier triangle is in front. */
typedef struct PeelMesh {
    uint32_t vertex_count, triangle_count; /* from 1 */
    const float *positions;                /* 3 per vertex, finite */
    const float *normals;                  /* 3 per vertex, of any length */
    const float *uvs;                      /* 2 per vertex, v down; may be NULL */
    const uint32_t *indices;               /* 3 per triangle, each below vertex_count */
} PeelMesh;

typedef enum PeelWrap {
    PEEL_REPEAT = 0,
    PEEL_CLAMP, /* to the edge */
    PEEL_MIRROR
} PeelWrap;

/* One of texels and codes, the other NULL; RGBA, row 0 at v = 0. No mip levels. */
typedef struct PeelTexture {
    uint32_t width, height; /* 1 to 16384 */
    const float *texels;    /* linear, each 0 to 1 */
    const uint8_t *codes;   /* 8 bits: linear, or with srgb R, G and B as sRGB has them */
    bool srgb;
    bool nearest; /* else bilinear */
    PeelWrap wrap_s, wrap_t;
} PeelTexture;

typedef enum PeelAlphaMode {
    PEEL_OPAQUE = 0,
    PEEL_MASK, /* opaque where alpha is at least alpha_cutoff, else not there */
    PEEL_TRANSPARENT
} PeelAlphaMode;

/* All from 0 to 1. */
typedef struct PeelMaterial {
    float base_color[4]; /* linear, not premultiplied; A counts where the mode has a use for it */
    float roughness, metallic;
    float occlusion; /* of ambient light; 1 is none, 0 all */
    PeelAlphaMode alpha_mode;
    float alpha_cutoff; /* from 0, also above 1 */
    bool double_sided;
    /* 0: none; else 1 + index into the scene's textures. Multiplied with base_color; green with
     * roughness and blue with metallic. */
    uint32_t base_color_texture, metallic_roughness_texture;
} PeelMaterial;

typedef struct PeelInstance {
    uint32_t mesh, material; /* indices */
    const double *world;     /* mesh to world, affine, may be singular; NULL: identity */
} PeelInstance;

/* A point light: color / (c + l*d + q*d^2) at distance d. */
typedef struct PeelLight {
    double position[3];   /* world */
    float color[3];       /* 0 to 1e12 */
    float attenuation[3]; /* c, l, q, from 0, at least 1e-8 together at d = 0.01 */
    float range;          /* times 1 - (d/range)^4, nothing beyond; 0: no end; finite */
} PeelLight;

/* Looks from eye to target. world, where it is not NULL, is used instead: camera to world, affine,
 * looking down -z with y up (the inverse of a view matrix); as in glTF 2.0 its scale is left out.
 * A projection that does not fit in floats is refused when it is rendered. */
typedef struct PeelCamera {
    double eye[3], target[3], up[3]; /* up: not along the gaze */
    const double *world;
    double yfov;                  /* vertical field of view in radians, between 0 and pi */
    double near_plane, far_plane; /* 0 < near < far; far may be INFINITY */
} PeelCamera;

/* The counts are of the arrays; 0 and NULL for none. */
typedef struct PeelSceneDesc {
    size_t mesh_count, texture_count, material_count, instance_count, light_count, camera_count;
    const PeelMesh *meshes;
    const PeelTexture *textures;
    const PeelMaterial *materials;
    const PeelInstance *instances; /* in the order in which they are drawn */
    const PeelLight *lights;
    const PeelCamera *cameras; /* without one: a camera that sees the whole scene */
    float ambient[3];          /* light that reaches every surface, 0 to 1e12 */
    float background[3];       /* linear, 0 to 1e12 */
} PeelSceneDesc;

typedef struct PeelScene PeelScene;

/* Copies and checks all of it; the caller's arrays are then free again, and the scene is the
 * caller's to free. PEEL_BAD_INPUT names the first breach: "mesh 3: index 8 of triangle 2 is out of
 * range, expected below 8". */
PEEL_API PeelResult peel_scene_create(const PeelSceneDesc *desc, PeelScene **out);
PEEL_API void peel_scene_free(PeelScene *scene); /* NULL is fine */

/* ---- rendering ------------------------------------------------------------------------------- */

typedef enum PeelRenderer {
    PEEL_REF = 0, /* what the OpenGL pipeline does, bit for bit */
    PEEL_TRUTH    /* every fragment, in exact order, in double precision; methods, passes and
                   * formats change nothing */
} PeelRenderer;

/* The methods' names, in order, "peel" first; NULL of i beyond the last. what may be NULL; else it
 * becomes one line. */
PEEL_API const char *peel_method_name(size_t i, const char **what);

typedef enum PeelGBuffer {
    PEEL_GBUFFER_FULL = 0, /* 32-bit floats */
    PEEL_GBUFFER_SEED,     /* 32- and 16-bit floats, 8-bit colours */
    PEEL_GBUFFER_COMPACT   /* octahedral normals, 8-bit material, positions from depth */
} PeelGBuffer;

typedef enum PeelDepthRange {
    PEEL_DEPTH_GL = 0,   /* clip space -w to w, depth 0 near and 1 far */
    PEEL_DEPTH_ZERO_ONE, /* 0 to w */
    PEEL_DEPTH_REVERSED  /* 0 to w, depth 1 near and 0 far */
} PeelDepthRange;

typedef enum PeelCull {
    PEEL_CULL_GLTF = 0, /* back faces of single-sided materials are left out */
    PEEL_CULL_OPAQUE,   /* of opaque materials */
    PEEL_CULL_NONE
} PeelCull;

typedef enum PeelSimd {
    PEEL_SIMD_AUTO = 0, /* the widest that the processor has; the bits are the same */
    PEEL_SIMD_SCALAR,
    PEEL_SIMD_SSE2,
    PEEL_SIMD_AVX2,
    PEEL_SIMD_AVX512
} PeelSimd;

/* Zero is the default of everything but the size. */
typedef struct PeelSettings {
    int width, height; /* pixels, 1 to 16384 */
    PeelRenderer renderer;
    int camera;         /* index */
    int lights;         /* the scene's first so many; 0 all, negative none */
    const char *method; /* a name; NULL: "peel" */
    int passes;         /* at most so many peels, up to 4096; 0: until one yields no fragment */
    PeelFormat depth;   /* PEEL_D32F, _D24 or _D16; zero: PEEL_D32F */
    PeelFormat accum;   /* PEEL_RGBA32F, _RGBA16F, _RGBA16 or _RGBA8 */
    PeelGBuffer gbuffer;
    PeelDepthRange depth_range;
    PeelCull cull;
    bool less_or_equal;        /* of equal depths the later triangle is in front */
    bool raw_test;             /* peels compare computed depths with stored ones */
    bool reconstruct_position; /* from depth */
    bool normals_kept;         /* not turned to the viewer on back faces */
    bool stable_highlight;     /* GGX without the textbook form's cancellation */
    bool back_light;           /* transparent surfaces also reflect lights behind them */
    bool phong;                /* one directional light instead of the scene's */
    bool unfused;              /* as a driver without fused multiply-add */
    bool sort_triangles;       /* painter: not instances */
    bool edges;                /* linked-list: outlines of every layer */
    int weight_equation;       /* weighted-blended: of its paper, 7, 8, 9 or 10; 0: 9 */
    int nodes_per_pixel;       /* linked-list: room on average, up to 4096; 0: as many as needed */
    float bias;                /* a peel takes what lies farther behind the last; 0 to 1 */
    bool definition_path;      /* pass by pass, in plain C: slower, the same bits */
    PeelSimd simd;
    int tile;          /* of the tile path: pixels a side, a power of two, 8 to 256; 0: 64 */
    int threads;       /* up to 256; 0: one per processor; the bits are the same */
    size_t max_memory; /* bytes that a rendering may need; 0: 4 GiB */
} PeelSettings;

/* Where the images go: the caller's memory, NULL where one is not wanted. */
typedef struct PeelImages {
    float *linear;    /* 4 floats a pixel: R, G, B over the background, A = 1 - transmittance */
    uint8_t *display; /* 4 bytes a pixel: tone-mapped and gamma-encoded, A = 255 */
    void *accum;      /* of PEEL_REF: pixels of the accumulation's format, as blending left them, A
                       * is transmittance; takes the definition's path, which is slower */
    float *bound;     /* of PEEL_TRUTH: 4 floats a pixel, how far PEEL_REF may be from linear in
                       * single precision and in the settings' formats, where it sees the same
                       * fragments in the same order; infinite where that is not known.
                       * PEEL_UNSUPPORTED of methods but peel, peel-id, forward and linked-list */
} PeelImages;

/* What a rendering counted; 0 where it cannot know. */
typedef struct PeelFigures {
    int passes;                  /* peels that yielded a fragment; of truth the most layers */
    int geometry_passes;         /* over the transparent triangles */
    uint64_t fragments;          /* transparent ones in front of the opaque surfaces */
    uint32_t max_layers;         /* most of them in one pixel */
    uint64_t fragments_shaded;   /* lit and blended, opaque ones too */
    uint64_t lost_to_ties;       /* of equal depth, which the method keeps one of */
    uint64_t lost_to_pass_limit; /* not reached by settings.passes */
    uint64_t lost_to_overflow;   /* a list had no room */
    uint64_t repeated;           /* peeled again at the depth of the previous peel */
    uint64_t overflowed;         /* pixels with a sum beyond its format's range */
    double residual_max;         /* greatest transmittance in front of what the limit lost */
    uint64_t residual_pixels;    /* pixels that the limit lost something of */
    uint64_t ties;               /* truth: fragments at exactly the depth of the one in front */
    uint64_t coverage_differs;   /* truth: fragments that exact, unsnapped coverage would change */
    uint64_t buffer_bytes;       /* of images and lists */
    double time_ms, cpu_ms;      /* wall time; processor time of all threads */
    int threads;                 /* that were used */
} PeelFigures;

/* A finished buffer, or a rectangle of one. Names: opaque.depth, .normal, .position, .diffuse,
 * .material, .primitive; of each peel K from 0 peel.K.depth ... peel.K.accum; accum; display; other
 * methods have others. Of truth: opaque.primitive and peel.K.primitive. */
typedef struct PeelBuffer {
    const char *name;
    int step; /* 0 the opaque pass, K + 1 peel K, then accum and display */
    PeelFormat format;
    int image_width, image_height; /* of the whole buffer */
    int x, y, width, height;       /* the rectangle */
    const void *pixels;            /* its rows; the library's, until the callback returns */
    size_t row_bytes;
} PeelBuffer;

/* Receives every buffer of a rendering in the order of completion. */
typedef struct PeelTrace {
    /* Called by one thread at a time, not always the caller's. Anything but 0 ends the rendering
     * with PEEL_STOPPED. */
    int (*put)(void *context, const PeelBuffer *buffer);
    void *context;
} PeelTrace;

/* Renders. trace may be NULL, and so may figures. With a trace PEEL_REF takes the definition's
 * path. */
PEEL_API PeelResult peel_scene_render(const PeelScene *scene, const PeelSettings *settings,
                                      const PeelTrace *trace, const PeelImages *images,
                                      PeelFigures *figures);

/* ---- comparing ------------------------------------------------------------------------------- */

/* How b differs from a, value by value; what `peel diff` prints. NaN equals NaN, and an infinity
 * one of its sign; values that are not finite are left out of the averages. Normalized formats
 * count as numbers from 0 to 1, PEEL_R32UI as its integers. */
typedef struct PeelDifference {
    uint64_t pixels, differing; /* pixels with any stored bit that differs, but those of NaN */
    uint64_t values, differing_values; /* over all channels */
    uint64_t nonfinite_a, nonfinite_b;
    uint64_t broken;        /* pixels not finite on one side alone, or otherwise */
    double mean, rms, psnr; /* of |a - b|; psnr in dB, for the greater of 1 and the greatest value,
                             * infinite of equal images */
    double max;             /* greatest finite |a - b| */
    int max_at[3];          /* x, y, channel of the first such; -1 where max is 0 */
    int first[3];           /* x, y, channel of the first value that differs; -1 where none */
    uint32_t max_ulp;       /* greatest distance in stored values, NaN against a number apart */
    uint32_t channel_max_ulp[4]; /* likewise of each channel */
} PeelDifference;

/* a and b: width * height pixels of one format; 1 to 16384 a side. Takes five bytes of memory a
 * pixel. */
PEEL_API PeelResult peel_compare(PeelFormat format, int width, int height, const void *a,
                                 const void *b, PeelDifference *out);

#ifdef __cplusplus
}
#endif

#endif
