/* What the tests of ref/truth share: hand-made scenes, a trace sink that keeps primitive ids, and
 * an assertion for inner loops. */
#ifndef PEEL_TESTS_TRUTH_STAGE_H
#define PEEL_TESTS_TRUTH_STAGE_H

#include "ref/truth/truth.h"
#include "testing.h"

#include <stdio.h>

enum {
    ITEMS_MAX = 8,
    LAYERS_MAX = 64
};

/* An assertion that costs nothing while it holds: check reports its own to the runner each time. */
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

static const float red[4] = {1, 0, 0, 0.5f}, green[4] = {0, 1, 0, 0.25f}, blue[4] = {0, 0, 1, 1};
static uint32_t quad_index[6] = {0, 1, 2, 0, 2, 3};

static inline Stage *stage_new(void)
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
static inline Material *add_quad(Stage *stage, float depth, float half, const float color[4])
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

/* ---- a sink that keeps the layers ----------------------------------------------------------- */

typedef struct Layers {
    TraceSink sink;
    int width, height;
    uint32_t *id[LAYERS_MAX + 1]; /* by step; a layer never sent is NULL */
    uint8_t *seen;                /* how often opaque.primitive came, per pixel */
} Layers;

static inline Result layers_put(TraceSink *sink, const TraceBuffer *buffer)
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

static inline void layers_free(Layers *layers)
{
    for (int i = 0; i <= LAYERS_MAX; i++)
        free(layers->id[i]);
    free(layers->seen);
}

static inline uint32_t layer_id(const Layers *layers, int step, int x, int y)
{
    return layers->id[step] ? layers->id[step][y * layers->width + x] : UINT32_MAX;
}

#endif
