/* The rule that peeling stands on: the peels of a scene are its layers, each once, in order. */
#include "study/driver_test.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    WIDTH = 93,
    HEIGHT = 57,
    PIXELS = WIDTH * HEIGHT,
    SHEETS = 6, /* triangles through each other */
    SCENES = 3
};

/* Owns its parts by value. Do not copy once made. */
typedef struct Sheets {
    Scene scene;
    Mesh meshes[SHEETS];
    float position[SHEETS][9], normal[SHEETS][9];
    uint32_t index[3];
    Material material;
    Instance instances[SHEETS];
    Camera camera;
} Sheets;

/* Depth buffers by step, as codes. */
typedef struct DepthSink {
    TraceSink sink;
    int count;
    uint32_t depth[SHEETS + 1][PIXELS];
} DepthSink;

typedef struct Peels {
    Sheets sheets;
    DepthSink opaque, peels;
} Peels;

static void make_sheets(Random *random, Sheets *out)
{
    *out = (Sheets){.index = {0, 1, 2}};
    out->material = (Material){.name = "",
                               .base_color = {1, 1, 1, 1},
                               .roughness = 1.0f,
                               .occlusion = 1.0f,
                               .double_sided = true};
    for (uint32_t i = 0; i < SHEETS; i++) {
        for (int k = 0; k < 9; k++) {
            double depth = random_range(random, 1.0, 8.0);
            out->position[i][k] = (float)(k % 3 == 2 ? -depth : random_range(random, -6.0, 6.0));
            out->normal[i][k] = k % 3 == 2 ? 1.0f : 0.0f;
        }
        out->meshes[i] = (Mesh){.vertex_count = 3,
                                .triangle_count = 1,
                                .position = out->position[i],
                                .normal = out->normal[i],
                                .index = out->index};
        out->instances[i] = (Instance){.name = "", .mesh = i, .world = matrix_identity()};
    }
    out->camera =
        (Camera){.name = "", .world = matrix_identity(), .yfov = 1.2, .near = 0.5, .far = 10.0};
    out->scene = (Scene){.name = "sheets",
                         .mesh_count = SHEETS,
                         .material_count = 1,
                         .instance_count = SHEETS,
                         .camera_count = 1,
                         .meshes = out->meshes,
                         .materials = &out->material,
                         .instances = out->instances,
                         .cameras = &out->camera,
                         .ambient = {1, 1, 1}};
}

/* Keeps the depths of the opaque pass, or of the peels. */
static Result keep_depth(TraceSink *sink, const TraceBuffer *buffer)
{
    DepthSink *self = (DepthSink *)sink;
    size_t length = strlen(buffer->name);
    if (length < 6 || strcmp(buffer->name + length - 6, ".depth") != 0)
        return RESULT_OK;
    int slot = buffer->step; /* 0 the opaque pass, K + 1 peel K */
    if (slot > SHEETS)
        return RESULT_OK;
    for (int y = 0; y < buffer->height; y++)
        memcpy(&self->depth[slot][(buffer->y + y) * WIDTH + buffer->x],
               (const char *)buffer->pixels + (size_t)y * buffer->row_bytes,
               (size_t)buffer->width * sizeof(uint32_t));
    self->count = slot > self->count ? slot : self->count;
    return RESULT_OK;
}

static uint32_t far_code(PixelFormat format)
{
    return format == FORMAT_D32F ? 0x3f800000u : format_info(format)->unorm_max;
}

static Result render(Test *test, const Scene *scene, DepthSink *sink)
{
    RenderDesc desc = {.width = WIDTH,
                       .height = HEIGHT,
                       .depth = test->rule->experiment.format,
                       .passes = SHEETS,
                       .lights = -1};
    Frame frame;
    uint32_t far = far_code(test->rule->experiment.format);
    sink->sink.put = keep_depth;
    sink->count = 0;
    for (int i = 0; i <= SHEETS; i++)
        for (int p = 0; p < PIXELS; p++)
            sink->depth[i][p] = far;
    Result result = test->renderer(scene, &desc, &sink->sink, &frame);
    if (result == RESULT_OK)
        frame_free(&frame);
    return result;
}

static int ascending(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

/* layers: the depths of each triangle drawn alone. Codes and bits of depths sort as they are. */
static void compare(Test *test, uint32_t (*layers)[PIXELS], const DepthSink *peels)
{
    uint32_t far = far_code(test->rule->experiment.format);
    for (int p = 0; p < PIXELS; p++) {
        uint32_t expected[SHEETS];
        int count = 0;
        for (int i = 0; i < SHEETS; i++)
            expected[i] = layers[i][p];
        qsort(expected, SHEETS, sizeof *expected, ascending);
        for (int i = 0; i < SHEETS; i++)
            if (count == 0 || expected[i] != expected[count - 1])
                expected[count++] = expected[i];
        for (int i = count; i < SHEETS; i++)
            expected[i] = far;
        for (int i = 0; i < SHEETS; i++) {
            uint32_t got = peels->depth[i + 1][p];
            if (!test_differs(test, expected[i], got))
                continue;
            DriverExample *example = test_example(test, NULL, NULL, 0, expected[i], got);
            if (example)
                snprintf(example->place, sizeof example->place,
                         "pixel %d, %d from the top: depth of peel %d", p % WIDTH, p / WIDTH, i);
        }
    }
}

static Result run_scene(Test *test, Peels *peels, uint32_t (*layers)[PIXELS])
{
    Sheets *sheets = &peels->sheets;
    make_sheets(&test->random, sheets);
    Result result = RESULT_OK;
    sheets->scene.instance_count = 1;
    for (int i = 0; i < SHEETS && result == RESULT_OK; i++) {
        sheets->scene.instances = &sheets->instances[i];
        result = render(test, &sheets->scene, &peels->opaque);
        memcpy(layers[i], peels->opaque.depth[0], sizeof *layers);
    }
    sheets->scene.instances = sheets->instances;
    sheets->scene.instance_count = SHEETS;
    sheets->material.alpha_mode = ALPHA_BLEND;
    sheets->material.base_color[3] = 0.5f;
    if (result == RESULT_OK)
        result = render(test, &sheets->scene, &peels->peels);
    if (result == RESULT_OK)
        compare(test, layers, &peels->peels);
    return result;
}

Result test_peels(Test *test)
{
    Peels *peels = memory_array(1, sizeof *peels);
    uint32_t(*layers)[PIXELS] = memory_array(SHEETS, sizeof *layers);
    Result result = peels && layers ? RESULT_OK : RESULT_NO_MEMORY;
    for (int i = 0; i < SCENES && result == RESULT_OK; i++)
        result = run_scene(test, peels, layers);
    free(layers);
    free(peels);
    return result;
}
