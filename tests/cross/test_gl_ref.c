/* ref/pipeline against OpenGL on seeded triangle soups, every buffer of the trace bit for bit:
 * triangles cross the near plane and the view's edges, intersect, degenerate, mirror and repeat. */
#include "testing.h"

#include "base/memory.h"
#include "base/random.h"
#include "gl/gl_renderer.h"
#include "ref/pipeline/pipeline.h"

#include <stdio.h>

enum {
    MESHES = 3,
    MATERIALS = 6,
    INSTANCES = 9,
    LIGHTS = 3,
    TRIANGLES = 40,
    BUFFERS_MAX = 512
};

/* ---- scenes ------------------------------------------------------------------------------------
 */

static char *copy_text(const char *text)
{
    size_t bytes = strlen(text) + 1;
    char *copy = memory_array(bytes, 1);
    memcpy(copy, text, bytes);
    return copy;
}

static float between(Random *random, double low, double high)
{
    return (float)random_range(random, low, high);
}

/* Three vertices a triangle; now and then a triangle without area or a vertex without normal. */
static Mesh soup_mesh(Random *random, double size)
{
    Mesh mesh = {.vertex_count = 3 * TRIANGLES, .triangle_count = TRIANGLES};
    size_t values = 3 * (size_t)mesh.vertex_count;
    mesh.position = memory_array(values, sizeof *mesh.position);
    mesh.normal = memory_array(values, sizeof *mesh.normal);
    mesh.index = memory_array(values / 3, sizeof *mesh.index);
    for (uint32_t i = 0; i < mesh.vertex_count; i++) {
        for (int k = 0; k < 3; k++) {
            mesh.position[3 * i + (uint32_t)k] = between(random, -size, size);
            mesh.normal[3 * i + (uint32_t)k] = i % 17 == 0 ? 0.0f : between(random, -1, 1);
        }
        mesh.index[i] = i % 31 == 2 ? i - 1 : i;
    }
    return mesh;
}

static Material soup_material(Random *random, int index)
{
    static const AlphaMode modes[] = {ALPHA_BLEND, ALPHA_OPAQUE, ALPHA_BLEND,
                                      ALPHA_BLEND, ALPHA_MASK,   ALPHA_BLEND};
    Material material = {.name = copy_text("surface"),
                         .roughness = between(random, 0, 1),
                         .metallic = between(random, 0, 1),
                         .occlusion = between(random, 0.5, 1),
                         .alpha_mode = modes[index],
                         .alpha_cutoff = 0.1f,
                         .double_sided = index % 3 != 0};
    for (int k = 0; k < 4; k++)
        material.base_color[k] = between(random, 0.2, 1);
    if (index == 5)
        material.base_color[3] = 1.0f;
    return material;
}

/* spread: how far instances lie from the camera, which looks through the middle of them. */
static Scene soup_scene(uint64_t seed, double size, double spread, double near)
{
    Random random = random_seed(seed);
    Scene scene = {.name = copy_text("soup"),
                   .mesh_count = MESHES,
                   .material_count = MATERIALS,
                   .instance_count = INSTANCES,
                   .light_count = LIGHTS,
                   .camera_count = 1,
                   .ambient = {0.25f, 0.2f, 0.3f},
                   .background = {0.1f, 0.0f, 0.7f}};
    scene.meshes = memory_array(MESHES, sizeof *scene.meshes);
    scene.materials = memory_array(MATERIALS, sizeof *scene.materials);
    scene.instances = memory_array(INSTANCES, sizeof *scene.instances);
    scene.lights = memory_array(LIGHTS, sizeof *scene.lights);
    scene.cameras = memory_array(1, sizeof *scene.cameras);
    for (int i = 0; i < MESHES; i++)
        scene.meshes[i] = soup_mesh(&random, size);
    for (int i = 0; i < MATERIALS; i++)
        scene.materials[i] = soup_material(&random, i);
    for (uint32_t i = 0; i < INSTANCES; i++) {
        Matrix place = matrix_translate(random_range(&random, -spread, spread),
                                        random_range(&random, -spread, spread),
                                        random_range(&random, -2 * spread, 0));
        Matrix scale = matrix_scale(i % 4 == 3 ? -1.0 : 1.0, 0.5 + random_unit(&random), 1.0);
        scene.instances[i] = (Instance){copy_text("part"), i % MESHES, i % MATERIALS,
                                        matrix_multiply(&place, &scale)};
    }
    for (int i = 0; i < LIGHTS; i++)
        scene.lights[i] = (Light){
            {random_range(&random, -3, 3), random_range(&random, -3, 3), random_unit(&random)},
            {between(&random, 0, 2), between(&random, 0, 2), between(&random, 0, 2)},
            {1.0f, 0.14f, 0.07f}};
    scene.cameras[0] =
        (Camera){copy_text("camera"), matrix_identity(), .yfov = 1.2, .near = near, .far = 100.0};
    ck_assert_msg(scene_validate(&scene) == RESULT_OK, "%s", result_message());
    return scene;
}

/* ---- traces ------------------------------------------------------------------------------------
 */

typedef struct Kept {
    char name[48];
    PixelFormat format;
    int step;
    void *pixels;
} Kept;

typedef struct Keeper {
    TraceSink sink;
    int count;
    Kept buffers[BUFFERS_MAX];
} Keeper;

static Kept *find(Keeper *keeper, const char *name)
{
    for (int i = 0; i < keeper->count; i++)
        if (!strcmp(keeper->buffers[i].name, name))
            return &keeper->buffers[i];
    return NULL;
}

static Result keep(TraceSink *sink, const TraceBuffer *buffer)
{
    Keeper *keeper = (Keeper *)sink;
    size_t pixel = format_pixel_bytes(buffer->format);
    if (strstr(buffer->name, "primitive"))
        return RESULT_OK;
    Kept *kept = find(keeper, buffer->name);
    if (!kept) {
        ck_assert_int_lt(keeper->count, BUFFERS_MAX);
        kept = &keeper->buffers[keeper->count++];
        snprintf(kept->name, sizeof kept->name, "%s", buffer->name);
        kept->format = buffer->format;
        kept->step = buffer->step;
        kept->pixels =
            memory_array((size_t)buffer->image_width * (size_t)buffer->image_height, pixel);
    }
    for (int y = 0; y < buffer->height; y++)
        memcpy((char *)kept->pixels +
                   ((size_t)(buffer->y + y) * (size_t)buffer->image_width + (size_t)buffer->x) *
                       pixel,
               (const char *)buffer->pixels + (size_t)y * buffer->row_bytes,
               (size_t)buffer->width * pixel);
    return RESULT_OK;
}

static void free_keeper(Keeper *keeper)
{
    for (int i = 0; i < keeper->count; i++)
        free(keeper->buffers[i].pixels);
}

static void assert_same_buffer(const Kept *ours, const Kept *driver, int width, int height)
{
    ck_assert_int_eq(ours->format, driver->format);
    ck_assert_int_eq(ours->step, driver->step);
    const FormatInfo *info = format_info(ours->format);
    size_t bytes = (size_t)info->channel_bytes;
    size_t values = (size_t)width * (size_t)height * (size_t)info->channels;
    for (size_t i = 0; i < values; i++) {
        const char *a = (const char *)ours->pixels + i * bytes;
        const char *b = (const char *)driver->pixels + i * bytes;
        size_t pixel = i / (size_t)info->channels;
        if (memcmp(a, b, bytes) != 0)
            ck_abort_msg("%s, pixel %zu,%zu: ref %a, gl %a", ours->name, pixel % (size_t)width,
                         pixel / (size_t)width, (double)format_channel(ours->format, a, 0),
                         (double)format_channel(ours->format, b, 0));
    }
}

/* ---- the comparison ----------------------------------------------------------------------------
 */

static uint64_t compare(const Scene *scene, const RenderDesc *desc)
{
    static Keeper ours, driver;
    ours = (Keeper){.sink = {keep}};
    driver = (Keeper){.sink = {keep}};
    RenderDesc modelled = *desc;
    modelled.ref_path = REF_PATH_DEFINITION;
    Frame ref, frame;
    ck_assert_msg(gl_render(scene, desc, &driver.sink, &frame) == RESULT_OK, "%s",
                  result_message());
    modelled.unfused = !frame.fused;
    ck_assert_msg(pipeline_render(scene, &modelled, &ours.sink, &ref) == RESULT_OK, "%s",
                  result_message());
    ck_assert_int_eq(ref.peels, frame.peels);
    ck_assert_uint_eq(ref.layers.repeated, frame.layers.repeated);
    ck_assert_int_eq(ours.count, driver.count);
    for (int i = 0; i < ours.count; i++) {
        const Kept *theirs = find(&driver, ours.buffers[i].name);
        ck_assert_msg(theirs != NULL, "gl has no %s", ours.buffers[i].name);
        assert_same_buffer(&ours.buffers[i], theirs, desc->width, desc->height);
    }
    size_t pixels = (size_t)desc->width * (size_t)desc->height;
    ck_assert_mem_eq(ref.final.pixels, frame.final.pixels, pixels * 16);
    ck_assert_mem_eq(ref.display.pixels, frame.display.pixels, pixels * 4);
    uint64_t repeated = frame.layers.repeated;
    frame_free(&ref);
    frame_free(&frame);
    free_keeper(&ours);
    free_keeper(&driver);
    return repeated;
}

static const RenderDesc variants[] = {
    {.passes = 0},
    {.depth = FORMAT_D24},
    {.depth = FORMAT_D24, .depth_func = DEPTH_LEQUAL, .gbuffer = GBUFFER_SEED},
    {.accum = FORMAT_RGBA16, .opaque_blend = OPAQUE_BLEND_SEED},
    {.peel_test = PEEL_TEST_RAW, .cull = CULL_SEED},
    {.peel_test = PEEL_TEST_RAW, .depth = FORMAT_D24, .cull = CULL_NONE},
    {.normals = NORMALS_KEPT, .depth_func = DEPTH_LEQUAL, .passes = 3, .lights = -1},
};

START_TEST(test_soup)
{
    RenderDesc desc = variants[_i];
    desc.width = 97;
    desc.height = 61;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        Scene scene = soup_scene(seed * 100 + (uint64_t)_i, 2.0, 3.0, 0.5);
        compare(&scene, &desc);
        scene_free(&scene);
    }
}
END_TEST

/* Close to the near plane a raw 24-bit peel test finds layers again; elsewhere it does not. */
START_TEST(test_repeated_layers)
{
    RenderDesc desc = {.width = 97, .height = 61};
    render_desc_seed_profile(&desc);
    Scene scene = soup_scene(7, 0.4, 0.4, 0.5);
    ck_assert_uint_gt(compare(&scene, &desc), 0);
    desc.passes = 4;
    ck_assert_uint_gt(compare(&scene, &desc), 0);
    desc.peel_test = PEEL_TEST_STORED;
    desc.passes = 0;
    ck_assert_uint_eq(compare(&scene, &desc), 0);
    scene_free(&scene);
}
END_TEST

/* More lights than a uniform block holds. */
START_TEST(test_many_lights)
{
    enum {
        MANY = 1500
    };
    const RenderDesc desc = {.width = 23, .height = 17, .passes = 2};
    Scene scene = soup_scene(11, 2.0, 3.0, 0.5);
    Light *lights = memory_array(MANY, sizeof *lights);
    for (int i = 0; i < MANY; i++)
        lights[i] = scene.lights[i % LIGHTS];
    free(scene.lights);
    scene.lights = lights;
    scene.light_count = MANY;
    compare(&scene, &desc);
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gl against ref");
    TCase *tcase = tcase_create("bits");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, test_soup, 0, sizeof variants / sizeof *variants);
    tcase_add_test(tcase, test_repeated_layers);
    tcase_add_test(tcase, test_many_lights);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
