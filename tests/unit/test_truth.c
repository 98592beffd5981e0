/* ref/truth end to end: scenes whose order and colours are known by hand, and a ray caster as a
 * second opinion. */
#include "base/random.h"
#include "frame/view.h"
#include "ref/truth/truth.h"
#include "testing.h"

#include <math.h>
#include <stdio.h>

enum {
    ITEMS_MAX = 8,
    LAYERS_MAX = 64,
    NONE = -1
};

#define EXPECT(condition, ...)                                                                     \
    do {                                                                                           \
        if (!(condition))                                                                          \
            ck_abort_msg(__VA_ARGS__);                                                             \
    } while (0)

/* A scene in static arrays. The camera sits at 0 and looks down −z; 90° of view, near 1, far 3:
 * its projection is made of small integers. */
typedef struct Stage {
    Scene scene;
    Camera camera;
    Light lights[2];
    Mesh meshes[ITEMS_MAX];
    Material materials[ITEMS_MAX];
    Instance instances[ITEMS_MAX];
    float positions[ITEMS_MAX][12], normals[ITEMS_MAX][12];
} Stage;

static uint32_t quad_index[6] = {0, 1, 2, 0, 2, 3};

static Stage *stage_new(void)
{
    Stage *stage = calloc(1, sizeof *stage);
    stage->camera = (Camera){.world = matrix_identity(), .near = 1, .far = 3};
    stage->camera.yfov = 1.5707963267948966;
    stage->scene = (Scene){.meshes = stage->meshes,
                           .materials = stage->materials,
                           .instances = stage->instances,
                           .lights = stage->lights,
                           .cameras = &stage->camera,
                           .camera_count = 1,
                           .ambient = {1, 1, 1}};
    return stage;
}

/* A square of the given half side at (0, 0, −depth), facing the camera. */
static Material *add_quad(Stage *stage, float depth, float half, const float color[4])
{
    Scene *scene = &stage->scene;
    size_t i = scene->mesh_count++;
    const float x[4] = {-half, half, half, -half}, y[4] = {-half, -half, half, half};
    for (int k = 0; k < 4; k++) {
        const float position[3] = {x[k], y[k], -depth}, normal[3] = {0, 0, 1};
        memcpy(&stage->positions[i][3 * k], position, sizeof position);
        memcpy(&stage->normals[i][3 * k], normal, sizeof normal);
    }
    stage->meshes[i] = (Mesh){.vertex_count = 4,
                              .triangle_count = 2,
                              .position = stage->positions[i],
                              .normal = stage->normals[i],
                              .index = quad_index};
    stage->materials[i] = (Material){.roughness = 0.5f, .occlusion = 1};
    memcpy(stage->materials[i].base_color, color, sizeof stage->materials[i].base_color);
    stage->materials[i].alpha_mode = color[3] < 1.0f ? ALPHA_BLEND : ALPHA_OPAQUE;
    stage->instances[i] =
        (Instance){.mesh = (uint32_t)i, .material = (uint32_t)i, .world = matrix_identity()};
    scene->material_count = scene->instance_count = scene->mesh_count;
    return &stage->materials[i];
}

/* ---- a sink that keeps the layers --------------------------------------------------------------
 */

typedef struct Layers {
    TraceSink sink;
    int width, height;
    uint32_t *id[LAYERS_MAX + 1]; /* by step; a layer never sent is NULL */
    uint8_t *seen;                /* how often opaque.primitive came, per pixel */
} Layers;

static Result layers_put(TraceSink *sink, const TraceBuffer *buffer)
{
    Layers *layers = (Layers *)sink;
    size_t pixels = (size_t)buffer->image_width * (size_t)buffer->image_height;
    ck_assert_int_eq(buffer->format, FORMAT_R32UI);
    ck_assert_int_eq(buffer->x % TRACE_TILE + buffer->y % TRACE_TILE, 0);
    ck_assert_int_le(buffer->step, LAYERS_MAX);
    char name[32] = "opaque.primitive";
    if (buffer->step > 0)
        snprintf(name, sizeof name, "peel.%d.primitive", buffer->step - 1);
    ck_assert_str_eq(buffer->name, name);
    if (!layers->seen)
        layers->seen = calloc(pixels, 1);
    layers->width = buffer->image_width;
    layers->height = buffer->image_height;
    uint32_t **id = &layers->id[buffer->step];
    if (!*id) {
        *id = malloc(pixels * sizeof **id);
        memset(*id, 0xff, pixels * sizeof **id);
    }
    for (int row = 0; row < buffer->height; row++) {
        size_t at = (size_t)(buffer->y + row) * (size_t)buffer->image_width + (size_t)buffer->x;
        memcpy(&(*id)[at], (const char *)buffer->pixels + (size_t)row * buffer->row_bytes,
               (size_t)buffer->width * sizeof **id);
        for (int x = 0; x < buffer->width && buffer->step == 0; x++)
            layers->seen[at + (size_t)x]++;
    }
    return RESULT_OK;
}

static void layers_free(Layers *layers)
{
    for (int i = 0; i <= LAYERS_MAX; i++)
        free(layers->id[i]);
    free(layers->seen);
}

static uint32_t layer_id(const Layers *layers, int step, int x, int y)
{
    return layers->id[step] ? layers->id[step][y * layers->width + x] : UINT32_MAX;
}

/* Renders and asserts that every pixel has these four values, to the bit, and the display that
 * belongs to them. */
static void check_color(const Stage *stage, const RenderDesc *desc, const float expected[4])
{
    Frame frame;
    ck_assert_int_eq(truth_render(&stage->scene, desc, NULL, &frame), RESULT_OK);
    for (int y = 0; y < desc->height; y++) {
        for (int x = 0; x < desc->width; x++) {
            const float *final = image_pixel(&frame.final, x, y);
            const uint8_t *display = image_pixel(&frame.display, x, y);
            for (int i = 0; i < 4; i++)
                EXPECT(final[i] == expected[i], "pixel %d,%d channel %d: got %a, expected %a", x, y,
                       i, (double) final[i], (double)expected[i]);
            for (int i = 0; i < 3; i++) {
                double c = expected[i];
                EXPECT(display[i] == lround(255 * pow(c / (c + 1), 1 / 2.2)), "display %d: %d", i,
                       display[i]);
            }
            EXPECT(display[3] == 255, "display alpha %d", display[3]);
        }
    }
    frame_free(&frame);
}

static const RenderDesc small = {.width = 8, .height = 8, .threads = 1};
static const float red[4] = {1, 0, 0, 0.5f}, green[4] = {0, 1, 0, 0.25f}, blue[4] = {0, 0, 1, 1};

/* ---- by hand -----------------------------------------------------------------------------------
 */

START_TEST(test_empty_scene)
{
    Stage *stage = stage_new();
    memcpy(stage->scene.background, (const float[]){0.25f, 0.5f, 2}, sizeof(float[3]));
    const float expected[4] = {0.25f, 0.5f, 2, 0};
    check_color(stage, &(RenderDesc){.width = 1, .height = 1}, expected);
    check_color(stage, &(RenderDesc){.width = 70, .height = 65, .threads = 3}, expected);
    Layers layers = {.sink.put = layers_put};
    Frame frame;
    const RenderDesc desc = {.width = 130, .height = 65};
    ck_assert_int_eq(truth_render(&stage->scene, &desc, &layers.sink, &frame), RESULT_OK);
    for (int i = 0; i < 130 * 65; i++)
        EXPECT(layers.seen[i] == 1 && layers.id[0][i] == UINT32_MAX, "pixel %d", i);
    ck_assert_ptr_null(layers.id[1]);
    ck_assert_uint_eq(frame.layers.max, 0);
    ck_assert_int_eq(frame.peels, 0);
    ck_assert_str_eq(frame.renderer, "truth (double precision A-buffer)");
    frame_free(&frame);
    layers_free(&layers);
    free(stage);
}
END_TEST

START_TEST(test_under_compositing)
{
    /* Front to back red 1/2, green 1/4, then background or opaque blue, drawn in any order. */
    for (int order = 0; order < 2; order++) {
        Stage *stage = stage_new();
        memcpy(stage->scene.background, (const float[]){0.5f, 0, 1}, sizeof(float[3]));
        add_quad(stage, order ? 1.5f : 2, 4, order ? red : green);
        add_quad(stage, order ? 2 : 1.5f, 4, order ? green : red);
        check_color(stage, &small, (const float[]){0.6875f, 0.125f, 0.375f, 0.625f});
        Material *material = add_quad(stage, 2.5f, 4, blue);
        material->occlusion = 0.5f;
        check_color(stage, &small, (const float[]){0.5f, 0.125f, 0.1875f, 1});
        free(stage);
    }
}
END_TEST

START_TEST(test_opaque_hides)
{
    /* Behind and at the same depth: hidden, whatever the order and the depth function. */
    for (int n = 0; n < 8; n++) {
        Stage *stage = stage_new();
        RenderDesc desc = small;
        desc.depth_func = n & 1 ? DEPTH_LEQUAL : DEPTH_LESS;
        float depth = n & 2 ? 2.0f : 2.5f;
        if (n & 4)
            add_quad(stage, 2, 4, blue);
        add_quad(stage, depth, 4, red);
        if (!(n & 4))
            add_quad(stage, 2, 4, blue);
        check_color(stage, &desc, (const float[]){0, 0, 1, 1});
        free(stage);
    }
}
END_TEST

/* The id of peel `step` − 1 (0: opaque) everywhere, as the number of its quad, NONE if none. */
static void check_quads(const Stage *stage, DepthFunc func, const int quads[3])
{
    RenderDesc desc = small;
    desc.depth_func = func;
    Layers layers = {.sink.put = layers_put};
    Frame frame;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, &layers.sink, &frame), RESULT_OK);
    uint32_t visible = 0;
    for (int step = 0; step < 3; step++) {
        visible += step > 0 && quads[step] != NONE;
        for (int i = 0; i < 64; i++) {
            uint32_t id = layer_id(&layers, step, i % 8, i / 8);
            int quad = id == UINT32_MAX ? NONE : (int)(id / 2);
            EXPECT(quad == quads[step], "step %d, pixel %d: quad %d, expected %d", step, i, quad,
                   quads[step]);
        }
    }
    ck_assert_uint_eq(frame.layers.max, visible);
    ck_assert_uint_eq(frame.layers.fragments, 64 * visible);
    ck_assert_uint_eq(frame.layers.coverage_differs, 0);
    frame_free(&frame);
    layers_free(&layers);
}

START_TEST(test_ties_follow_depth_func)
{
    Stage *stage = stage_new();
    add_quad(stage, 2, 4, red);
    add_quad(stage, 2, 4, green);
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, 0, 1});
    check_quads(stage, DEPTH_LEQUAL, (const int[]){NONE, 1, 0});
    check_color(stage, &small, (const float[]){0.5f, 0.125f, 0, 0.625f});
    RenderDesc lequal = small;
    lequal.depth_func = DEPTH_LEQUAL;
    check_color(stage, &lequal, (const float[]){0.375f, 0.25f, 0, 0.625f});
    add_quad(stage, 2.5f, 4, blue);
    add_quad(stage, 2.5f, 4, blue);
    check_quads(stage, DEPTH_LESS, (const int[]){2, 0, 1});
    check_quads(stage, DEPTH_LEQUAL, (const int[]){3, 1, 0});
    free(stage);
}
END_TEST

START_TEST(test_far_plane)
{
    /* Exactly at depth 1: opaque passes LEQUAL against the clear value only; transparent never. */
    Stage *stage = stage_new();
    add_quad(stage, 3, 4, blue);
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, NONE, NONE});
    check_quads(stage, DEPTH_LEQUAL, (const int[]){0, NONE, NONE});
    add_quad(stage, 3, 4, red);
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, NONE, NONE});
    add_quad(stage, 1, 4, red); /* at the near plane: seen */
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, 2, NONE});
    free(stage);
}
END_TEST

START_TEST(test_alpha_extremes)
{
    Stage *stage = stage_new();
    add_quad(stage, 1.5f, 4, (const float[]){1, 1, 1, 1e-4f}); /* a fragment, but adds nothing */
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, 0, NONE});
    check_color(stage, &small, (const float[]){0, 0, 0, 0});
    add_quad(stage, 2, 4, (const float[]){0, 1, 0, 1})->alpha_mode = ALPHA_BLEND;
    check_quads(stage, DEPTH_LESS, (const int[]){NONE, 0, 1});
    add_quad(stage, 2.5f, 4, red);
    check_color(stage, &small, (const float[]){0, 1, 0, 1});
    free(stage);
}
END_TEST

/* A quad turned away (by turning its indices) and lit from the camera's side. */
START_TEST(test_facing)
{
    static uint32_t turned_index[6] = {0, 2, 1, 0, 3, 2};
    Stage *stage = stage_new();
    const float clear[4] = {0, 0, 0, 0}, seen[4] = {0, 0.25f, 0, 0.25f};
    add_quad(stage, 2, 4, green);
    stage->meshes[0].index = turned_index;
    RenderDesc desc = small;
    check_color(stage, &desc, clear);
    desc.cull = CULL_SEED; /* culls opaque materials only */
    check_color(stage, &desc, seen);
    desc.cull = CULL_NONE;
    check_color(stage, &desc, seen);
    stage->materials[0].double_sided = true;
    desc.cull = CULL_GLTF;
    check_color(stage, &desc, seen);
    /* A mirroring matrix turns nothing over: the triangles' own order counts. */
    stage->materials[0].double_sided = false;
    stage->instances[0].world = matrix_scale(-1, 1, 1);
    check_color(stage, &desc, clear);
    stage->meshes[0].index = quad_index;
    check_color(stage, &desc, seen);
    stage->meshes[0].index = turned_index;
    /* The stored normal points to the camera, and so to the light: turned over, it does not. */
    stage->instances[0].world = matrix_identity();
    stage->materials[0].double_sided = true;
    stage->scene.light_count = 1;
    stage->lights[0] = (Light){.color = {1, 1, 1}, .attenuation = {0, 0, 1}};
    check_color(stage, &desc, seen);
    desc.normals = NORMALS_KEPT;
    Frame frame;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_OK);
    ck_assert_float_gt(((float *)image_pixel(&frame.final, 4, 4))[1], 0.26f);
    frame_free(&frame);
    free(stage);
}
END_TEST

/* The image's first row is the top: a quad above the axis, in a wide image. */
START_TEST(test_orientation)
{
    Stage *stage = stage_new();
    add_quad(stage, 2, 1, blue);
    stage->instances[0].world = matrix_translate(2, 1, 0); /* x 1 … 3, y 0 … 2 at depth 2 */
    const RenderDesc desc = {.width = 16, .height = 8};
    Layers layers = {.sink.put = layers_put};
    Frame frame;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, &layers.sink, &frame), RESULT_OK);
    for (int y = 0; y < 8; y++)
        for (int x = 0; x < 16; x++)
            EXPECT((layer_id(&layers, 0, x, y) != UINT32_MAX) == (x >= 10 && x < 14 && y < 4),
                   "pixel %d,%d", x, y);
    frame_free(&frame);
    layers_free(&layers);
    free(stage);
}
END_TEST

START_TEST(test_memory_limit)
{
    Stage *stage = stage_new();
    for (int i = 0; i < ITEMS_MAX; i++)
        add_quad(stage, 1.5f + (float)i / 16, 4, red);
    RenderDesc desc = {.width = 64, .height = 64, .threads = 1};
    Frame frame;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_OK);
    size_t enough = frame.buffer_bytes;
    ck_assert_uint_ge(frame.layers.fragments, 8 * 64 * 64);
    frame_free(&frame);
    const size_t limits[5] = {1, 81920, 82300, enough / 4, enough / 2};
    for (int i = 0; i < 5; i++) {
        desc.max_memory = limits[i];
        ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_NO_MEMORY);
        ck_assert_ptr_nonnull(strstr(result_message(), "needs "));
        ck_assert_ptr_null(frame.final.pixels);
    }
    desc.max_memory = 2 * enough;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_OK);
    frame_free(&frame);
    desc.width = 0;
    ck_assert_int_eq(truth_render(&stage->scene, &desc, NULL, &frame), RESULT_BAD_INPUT);
    free(stage);
}
END_TEST

static Result refuse(TraceSink *sink, const TraceBuffer *buffer)
{
    (void)sink;
    return result_fail(RESULT_IO, "%s: refused", buffer->name);
}

START_TEST(test_trace_failure_ends_rendering)
{
    Stage *stage = stage_new();
    TraceSink sink = {refuse};
    Frame frame;
    const RenderDesc desc = {.width = 300, .height = 300, .threads = 2};
    ck_assert_int_eq(truth_render(&stage->scene, &desc, &sink, &frame), RESULT_IO);
    ck_assert_str_eq(result_message(), "opaque.primitive: refused");
    ck_assert_ptr_null(frame.final.pixels);
    free(stage);
}
END_TEST

/* ---- random triangles against a ray caster -----------------------------------------------------
 */

enum {
    SOUP_TRIANGLES = 60,
    WIDTH = 150,
    HEIGHT = 100
};

typedef struct RandomSoup {
    Stage *stage;
    float position[9 * SOUP_TRIANGLES], normal[9 * SOUP_TRIANGLES];
    uint32_t index[3 * SOUP_TRIANGLES];
} RandomSoup;

/* Two draws of one mesh each: the first half of the triangles, and the second (opaque if asked).
 * Corners anywhere around the camera, behind it too. */
static RandomSoup *soup_new(uint64_t seed, bool opaque)
{
    RandomSoup *soup = calloc(1, sizeof *soup);
    Random random = random_seed(seed);
    for (int i = 0; i < 9 * SOUP_TRIANGLES; i++) {
        bool is_z = i % 3 == 2;
        soup->position[i] = (float)random_range(&random, is_z ? -3.5 : -4, is_z ? 0.5 : 4);
        soup->normal[i] = (float)random_range(&random, -1, 1);
    }
    for (uint32_t i = 0; i < 3 * SOUP_TRIANGLES; i++)
        soup->index[i] = i;
    soup->stage = stage_new();
    Stage *stage = soup->stage;
    add_quad(stage, 2, 4, red);
    add_quad(stage, 2, 4, opaque ? blue : green);
    for (int i = 0; i < 2; i++) {
        stage->meshes[i] = (Mesh){.vertex_count = 3 * SOUP_TRIANGLES,
                                  .triangle_count = SOUP_TRIANGLES / 2,
                                  .position = soup->position,
                                  .normal = soup->normal,
                                  .index = soup->index + i * 3 * (SOUP_TRIANGLES / 2)};
        stage->materials[i].double_sided = true;
    }
    stage->scene.light_count = 2;
    stage->lights[0] = (Light){.position = {1, 2, 0}, .color = {3, 2, 1}, .attenuation = {1, 0, 1}};
    stage->lights[1] =
        (Light){.position = {-2, 0, -4}, .color = {1, 2, 3}, .attenuation = {0, 1, 0}};
    return soup;
}

static void soup_drop(RandomSoup *soup)
{
    free(soup->stage);
    free(soup);
}

typedef struct Hit {
    double depth; /* along −z, in view space */
    uint32_t triangle;
} Hit;

/* Source: Möller, Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997.
 * The ray runs from 0 through (x, y, −1). */
static bool cast_ray(const float *p, double x, double y, double *depth)
{
    double e1[3], e2[3];
    for (int i = 0; i < 3; i++) {
        e1[i] = (double)p[3 + i] - p[i];
        e2[i] = (double)p[6 + i] - p[i];
    }
    const double d[3] = {x, y, -1}, t[3] = {-(double)p[0], -(double)p[1], -(double)p[2]};
    const double h[3] = {d[1] * e2[2] - d[2] * e2[1], d[2] * e2[0] - d[0] * e2[2],
                         d[0] * e2[1] - d[1] * e2[0]};
    const double q[3] = {t[1] * e1[2] - t[2] * e1[1], t[2] * e1[0] - t[0] * e1[2],
                         t[0] * e1[1] - t[1] * e1[0]};
    double determinant = e1[0] * h[0] + e1[1] * h[1] + e1[2] * h[2];
    double u = (t[0] * h[0] + t[1] * h[1] + t[2] * h[2]) / determinant;
    double v = (d[0] * q[0] + d[1] * q[1] + d[2] * q[2]) / determinant;
    *depth = (e2[0] * q[0] + e2[1] * q[1] + e2[2] * q[2]) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1 && *depth >= 1 && *depth < 3;
}

/* All hits at a pixel, front to back. */
static int cast_pixel(const RandomSoup *soup, int x, int y, Hit hits[SOUP_TRIANGLES])
{
    double ray_x = ((x + 0.5) / WIDTH * 2 - 1) * ((double)(float)((double)WIDTH / HEIGHT));
    double ray_y = 1 - (y + 0.5) / HEIGHT * 2;
    int count = 0;
    for (uint32_t i = 0; i < SOUP_TRIANGLES; i++) {
        Hit hit = {0, i};
        if (!cast_ray(&soup->position[9 * i], ray_x, ray_y, &hit.depth))
            continue;
        int at = count++;
        for (; at > 0 && hits[at - 1].depth > hit.depth; at--)
            hits[at] = hits[at - 1];
        hits[at] = hit;
    }
    return count;
}

/* Every triangle that only one side has at a pixel must be a counted coverage difference, and all
 * that both have must be in the same order. */
START_TEST(test_ray_caster_agrees)
{
    RandomSoup *soup = soup_new((uint64_t)_i + 1, false);
    const RenderDesc desc = {.width = WIDTH, .height = HEIGHT};
    Layers layers = {.sink.put = layers_put};
    Frame frame;
    ck_assert_int_eq(truth_render(&soup->stage->scene, &desc, &layers.sink, &frame), RESULT_OK);
    uint64_t differing = 0, fragments = 0;
    for (int pixel = 0; pixel < WIDTH * HEIGHT; pixel++) {
        int x = pixel % WIDTH, y = pixel / WIDTH;
        Hit hits[SOUP_TRIANGLES];
        int count = cast_pixel(soup, x, y, hits), next = 0;
        for (int step = 1; step <= LAYERS_MAX; step++) {
            uint32_t id = layer_id(&layers, step, x, y);
            if (id == UINT32_MAX)
                break;
            fragments++;
            int at = next;
            while (at < count && hits[at].triangle != id)
                at++;
            if (at == count) { /* not in the rest: either nowhere, or out of order */
                for (int i = 0; i < next; i++)
                    EXPECT(hits[i].triangle != id, "pixel %d,%d: order of triangle %u", x, y, id);
                differing++;
            } else {
                differing += (uint64_t)(at - next);
                next = at + 1;
            }
        }
        differing += (uint64_t)(count - next);
    }
    ck_assert_uint_gt(fragments, 5000);
    ck_assert_uint_eq(fragments, frame.layers.fragments);
    ck_assert_uint_eq(differing, frame.layers.coverage_differs);
    frame_free(&frame);
    layers_free(&layers);
    soup_drop(soup);
}
END_TEST

static void check_equal(const Frame *a, const Frame *b)
{
    size_t pixels = (size_t)a->final.width * (size_t)a->final.height;
    ck_assert_mem_eq(a->final.pixels, b->final.pixels, 16 * pixels);
    ck_assert_mem_eq(a->display.pixels, b->display.pixels, 4 * pixels);
    ck_assert_mem_eq(&a->layers, &b->layers, sizeof a->layers);
}

START_TEST(test_any_threads_and_order_same_bits)
{
    RandomSoup *soup = soup_new(77, true);
    RenderDesc desc = {.width = 300, .height = 200, .threads = 1};
    Layers one_layers = {.sink.put = layers_put};
    Frame one, other;
    ck_assert_int_eq(truth_render(&soup->stage->scene, &desc, &one_layers.sink, &one), RESULT_OK);
    ck_assert_uint_gt(one.layers.fragments, 1000);
    for (int threads = 2; threads <= 3; threads++) {
        Layers layers = {.sink.put = layers_put};
        desc.threads = threads;
        ck_assert_int_eq(truth_render(&soup->stage->scene, &desc, &layers.sink, &other), RESULT_OK);
        check_equal(&one, &other);
        for (int step = 0; step <= LAYERS_MAX; step++) {
            ck_assert((layers.id[step] != NULL) == (one_layers.id[step] != NULL));
            if (layers.id[step])
                ck_assert_mem_eq(layers.id[step], one_layers.id[step], 4 * 300 * 200);
        }
        layers_free(&layers);
        frame_free(&other);
    }
    /* No two fragments tie here: the order of drawing must not matter. */
    Instance *instances = soup->stage->instances;
    Instance first = instances[0];
    instances[0] = instances[1];
    instances[1] = first;
    ck_assert_int_eq(truth_render(&soup->stage->scene, &desc, NULL, &other), RESULT_OK);
    check_equal(&one, &other);
    frame_free(&other);
    frame_free(&one);
    layers_free(&one_layers);
    soup_drop(soup);
}
END_TEST

/* Anything finite: no failure, no NaN. */
START_TEST(test_extreme_geometry)
{
    static const float values[] = {0,     1,      -1,   1e30f,  -1e30f, 1e-30f, -2, 1e4f,
                                   -1e4f, 1e-42f, 0.5f, -1e10f, 1.5f,   -1.5f,  -3, 2};
    Random random = random_seed((uint64_t)_i);
    RandomSoup *soup = soup_new(1, _i % 2);
    for (int i = 0; i < 9 * SOUP_TRIANGLES; i++) {
        soup->position[i] = values[random_bits(&random) % 16];
        soup->normal[i] = values[random_bits(&random) % 16];
    }
    const RenderDesc desc = {.width = 37, .height = 70, .depth_func = (DepthFunc)(_i % 2)};
    Frame frame;
    ck_assert_int_eq(truth_render(&soup->stage->scene, &desc, NULL, &frame), RESULT_OK);
    for (int i = 0; i < 37 * 70 * 4; i++)
        EXPECT(!isnan(((float *)frame.final.pixels)[i]), "pixel %d is not a number", i / 4);
    frame_free(&frame);
    soup_drop(soup);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("truth");
    TCase *tests = tcase_create("truth");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, test_empty_scene);
    tcase_add_test(tests, test_under_compositing);
    tcase_add_test(tests, test_opaque_hides);
    tcase_add_test(tests, test_ties_follow_depth_func);
    tcase_add_test(tests, test_far_plane);
    tcase_add_test(tests, test_alpha_extremes);
    tcase_add_test(tests, test_facing);
    tcase_add_test(tests, test_orientation);
    tcase_add_test(tests, test_memory_limit);
    tcase_add_test(tests, test_trace_failure_ends_rendering);
    tcase_add_loop_test(tests, test_ray_caster_agrees, 0, 6);
    tcase_add_test(tests, test_any_threads_and_order_same_bits);
    tcase_add_loop_test(tests, test_extreme_geometry, 0, 6);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}
