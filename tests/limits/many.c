/* many layers|triangles|lights COUNT FILE: writes a scene that has so many, as .gltf or .glb. */
#include "scene/gltf.h"
#include "scene/hard_kit.h"
#include "scene/shapes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A sheet of squares across the view, with waves too low to see, so that depths differ. */
static Result make_sheet(long triangles, Mesh *out)
{
    uint32_t side = (uint32_t)ceil(sqrt((double)triangles / 2.0));
    Result result = shapes_plane(4.0, 4.0, side, side, out);
    for (uint32_t i = 0; result == RESULT_OK && i < out->vertex_count; i++)
        out->position[3 * (size_t)i + 2] = -2.0f + 1e-4f * (float)(i % 97);
    return result;
}

static void put_triangles(Builder *builder, long count)
{
    Mesh sheet;
    hard_kit_lamps(builder);
    hard_kit_put(builder, builder_mesh(builder, make_sheet(count, &sheet), &sheet),
                 hard_kit_tint(builder, 1, 0.5f));
}

/* Each lights a part of a wall and of a pane in front of it. */
static void put_lights(Builder *builder, long count)
{
    const HardQuad wall = hard_kit_pane(-3.0, 1.0), pane = hard_kit_pane(-2.0, 0.8);
    long side = (long)ceil(sqrt((double)count));
    hard_kit_put(builder, hard_kit_quads(builder, &wall, 1), hard_kit_wall(builder, 0.8f));
    hard_kit_put(builder, hard_kit_quads(builder, &pane, 1), hard_kit_tint(builder, 2, 0.5f));
    for (long i = 0; i < count; i++) {
        const Light light = {.position = {4.0 * (double)(i % side) / (double)side - 2.0,
                                          4.0 * (double)(i / side) / (double)side - 2.0,
                                          -1.0 - 1e-4 * (double)i},
                             .color = {0.02f, 0.02f, 0.02f},
                             .attenuation = {1.0f, 0.0f, 1.0f},
                             .range = 3.0f};
        builder_light(builder, &light);
    }
}

int main(int argc, char **argv)
{
    long count = argc == 4 ? strtol(argv[2], NULL, 10) : 0;
    Scene scene;
    if (count < 1) {
        fprintf(stderr, "Usage: many layers|triangles|lights COUNT FILE\n");
        return 2;
    }
    Builder builder = hard_kit_begin("many", 0.1, 100.0);
    if (strcmp(argv[1], "layers") == 0)
        hard_kit_stack(&builder, (int)count, 1.0, 10.0 / (double)count, 8, 1.0f / 255.0f);
    else if (strcmp(argv[1], "triangles") == 0)
        put_triangles(&builder, count);
    else
        put_lights(&builder, count);
    Result result = builder_finish(&builder, &scene);
    if (result == RESULT_OK)
        result = gltf_write(&scene, argv[3]);
    scene_free(&scene);
    if (result != RESULT_OK)
        fprintf(stderr, "many: %s\n", result_message());
    return result == RESULT_OK ? 0 : 1;
}
