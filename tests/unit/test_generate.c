/* Shapes, the teapot and the built-in scenes. */
#include "scene/generate.h"
#include "scene/shapes.h"
#include "scene/teapot.h"

#include "testing.h"

#include <math.h>
#include <stdio.h>

/* ---- meshes --------------------------------------------------------------------------------- */

static void triangle_normal(const Mesh *mesh, uint32_t triangle, double out[3])
{
    double u[3], v[3];
    const uint32_t *index = mesh->index + 3 * (size_t)triangle;
    for (int k = 0; k < 3; k++) {
        double origin = (double)mesh->position[3 * (size_t)index[0] + k];
        u[k] = (double)mesh->position[3 * (size_t)index[1] + k] - origin;
        v[k] = (double)mesh->position[3 * (size_t)index[2] + k] - origin;
    }
    out[0] = u[1] * v[2] - u[2] * v[1];
    out[1] = u[2] * v[0] - u[0] * v[2];
    out[2] = u[0] * v[1] - u[1] * v[0];
}

/* Unit normals, no triangle without area, and every triangle counter-clockwise as seen from the
 * side that its vertices' normals point to. */
static void check_surface(const Mesh *mesh)
{
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        const float *n = mesh->normal + 3 * v;
        ck_assert_float_eq_tol(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1.0f, 1e-6f);
    }
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double face[3];
        triangle_normal(mesh, t, face);
        ck_assert(face[0] * face[0] + face[1] * face[1] + face[2] * face[2] > 0.0);
        for (int corner = 0; corner < 3; corner++) {
            const float *n = mesh->normal + 3 * (size_t)mesh->index[3 * (size_t)t + corner];
            double side = face[0] * (double)n[0] + face[1] * (double)n[1] + face[2] * (double)n[2];
            ck_assert_msg(side > 0.0, "triangle %u: corner %d has a normal on its back", t, corner);
        }
    }
}

/* Six times the volume that a closed, outward surface encloses. */
static double volume6(const Mesh *mesh)
{
    double sum = 0.0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        double face[3];
        const float *p = mesh->position + 3 * (size_t)mesh->index[3 * (size_t)t];
        triangle_normal(mesh, t, face);
        sum += face[0] * (double)p[0] + face[1] * (double)p[1] + face[2] * (double)p[2];
    }
    return sum;
}

typedef struct Edge {
    float ends[6]; /* the smaller end first */
} Edge;

static int compare_edges(const void *a, const void *b)
{
    const float *x = ((const Edge *)a)->ends, *y = ((const Edge *)b)->ends;
    for (int i = 0; i < 6; i++)
        if (x[i] != y[i])
            return x[i] < y[i] ? -1 : 1;
    return 0;
}

/* Edges, by position, that belong to one triangle only; none may belong to more than two. */
static size_t boundary_edges(const Mesh *mesh)
{
    size_t count = (size_t)mesh->triangle_count * 3, alone = 0;
    Edge *edges = calloc(count, sizeof *edges);
    ck_assert_ptr_nonnull(edges);
    for (size_t i = 0; i < count; i++) {
        const float *a = mesh->position + 3 * (size_t)mesh->index[i];
        const float *b = mesh->position + 3 * (size_t)mesh->index[i % 3 == 2 ? i - 2 : i + 1];
        Edge forward, backward;
        for (int k = 0; k < 3; k++) {
            forward.ends[k] = backward.ends[3 + k] = a[k];
            forward.ends[3 + k] = backward.ends[k] = b[k];
        }
        edges[i] = compare_edges(&forward, &backward) < 0 ? forward : backward;
    }
    qsort(edges, count, sizeof *edges, compare_edges);
    for (size_t i = 0, same; i < count; i += same) {
        for (same = 1; i + same < count && compare_edges(&edges[i], &edges[i + same]) == 0; same++)
            continue;
        ck_assert_uint_le(same, 2);
        alone += same == 1;
    }
    free(edges);
    return alone;
}

START_TEST(sphere_and_torus_are_closed)
{
    Mesh mesh;
    ck_assert_int_eq(shapes_sphere(1.0, 48, 24, &mesh), RESULT_OK);
    check_surface(&mesh);
    ck_assert_uint_eq(boundary_edges(&mesh), 0);
    ck_assert_double_eq_tol(volume6(&mesh) / 6.0, 4.0 / 3.0 * 3.14159265, 0.05);
    shapes_free(&mesh);
    ck_assert_int_eq(shapes_torus(1.0, 0.25, 64, 32, &mesh), RESULT_OK);
    check_surface(&mesh);
    ck_assert_uint_eq(boundary_edges(&mesh), 0);
    ck_assert_double_eq_tol(volume6(&mesh) / 6.0, 2.0 * 9.8696044 * 0.0625, 0.02);
    shapes_free(&mesh);
}
END_TEST

START_TEST(smallest_shapes)
{
    Mesh mesh;
    ck_assert_int_eq(shapes_sphere(1.0, 3, 2, &mesh), RESULT_OK);
    ck_assert_uint_eq(mesh.triangle_count, 6);
    ck_assert_uint_eq(boundary_edges(&mesh), 0);
    shapes_free(&mesh);
    ck_assert_int_eq(shapes_torus(1.0, 0.25, 3, 3, &mesh), RESULT_OK);
    ck_assert_uint_eq(boundary_edges(&mesh), 0);
    shapes_free(&mesh);
    ck_assert_int_eq(shapes_plane(2.0, 4.0, 3, 2, &mesh), RESULT_OK);
    check_surface(&mesh);
    ck_assert_uint_eq(mesh.triangle_count, 12);
    ck_assert_uint_eq(boundary_edges(&mesh), 10);
    shapes_free(&mesh);
}
END_TEST

/* The cut cube's volume: 8000 less 12 edges' prisms and 8 corners' rests; negative, being inward.
 */
START_TEST(room_is_closed_and_inward)
{
    Mesh mesh;
    ck_assert_int_eq(shapes_room(10.0, 1.0, &mesh), RESULT_OK);
    check_surface(&mesh);
    ck_assert_uint_eq(boundary_edges(&mesh), 0);
    ck_assert_double_eq_tol(volume6(&mesh) / 6.0, -(8000.0 - 12.0 * 18.0 / 2.0 - 8.0 * 5.0 / 6.0),
                            1e-6);
    shapes_free(&mesh);
}
END_TEST

/* Open at the lip's inside, the lid's edge, and both ends of handle and spout: nowhere else. */
START_TEST(teapot_surface)
{
    Mesh mesh;
    ck_assert_int_eq(teapot_mesh(&mesh), RESULT_OK);
    check_surface(&mesh);
    ck_assert_uint_eq(mesh.triangle_count, 9312);
    ck_assert_uint_eq(boundary_edges(&mesh), 48 + 48 + 4 * 24);
    float low[3] = {9.0f, 9.0f, 9.0f}, high[3] = {-9.0f, -9.0f, -9.0f};
    for (size_t i = 0; i < (size_t)mesh.vertex_count * 3; i++) {
        low[i % 3] = fminf(low[i % 3], mesh.position[i]);
        high[i % 3] = fmaxf(high[i % 3], mesh.position[i]);
    }
    ck_assert_float_bits(low[1], 0.0f);
    ck_assert_float_bits(high[1], 1.2f);
    ck_assert_float_bits(low[2], -high[2]);
    ck_assert_float_eq_tol(high[2], 2.0f * 1.2f / 3.15f, 1e-6f); /* the body's radius */
    ck_assert_float_eq_tol(low[0], -3.0f * 1.2f / 3.15f, 1e-6f); /* the handle */
    shapes_free(&mesh);
}
END_TEST

/* The poles' normals are the axis itself. */
START_TEST(teapot_poles)
{
    Mesh mesh;
    int poles = 0;
    ck_assert_int_eq(teapot_mesh(&mesh), RESULT_OK);
    for (size_t v = 0; v < mesh.vertex_count; v++) {
        const float *p = mesh.position + 3 * v, *n = mesh.normal + 3 * v;
        if (p[0] != 0.0f || p[2] != 0.0f)
            continue;
        ck_assert_float_bits(n[1], p[1] > 0.5f ? 1.0f : -1.0f);
        poles++;
    }
    ck_assert_int_eq(poles, 2);
    shapes_free(&mesh);
}
END_TEST

/* ---- scenes --------------------------------------------------------------------------------- */

static uint64_t digest_bytes(uint64_t digest, const void *bytes, size_t count)
{
    for (size_t i = 0; i < count; i++) /* FNV-1a */
        digest = (digest ^ ((const unsigned char *)bytes)[i]) * 0x100000001b3u;
    return digest;
}

static uint64_t digest_scene(const Scene *scene)
{
    uint64_t digest = 0xcbf29ce484222325u;
    for (size_t i = 0; i < scene->mesh_count; i++) {
        const Mesh *mesh = &scene->meshes[i];
        digest = digest_bytes(digest, mesh->position, mesh->vertex_count * 3 * sizeof(float));
        digest = digest_bytes(digest, mesh->normal, mesh->vertex_count * 3 * sizeof(float));
        digest = digest_bytes(digest, mesh->index, mesh->triangle_count * 3 * sizeof(uint32_t));
    }
    for (size_t i = 0; i < scene->instance_count; i++)
        digest = digest_bytes(digest, scene->instances[i].world.m, 16 * sizeof(double));
    for (size_t i = 0; i < scene->light_count; i++) {
        digest = digest_bytes(digest, scene->lights[i].position, 3 * sizeof(double));
        digest = digest_bytes(digest, scene->lights[i].color, 3 * sizeof(float));
        if (scene->lights[i].range > 0.0f)
            digest = digest_bytes(digest, &scene->lights[i].range, sizeof(float));
    }
    for (size_t i = 0; i < scene->camera_count; i++)
        digest = digest_bytes(digest, scene->cameras[i].world.m, 16 * sizeof(double));
    return digest;
}

static void generate(const char *name, Scene *out)
{
    const BuiltinScene *builtin = generate_find(name);
    ck_assert_msg(builtin != NULL, "no scene %s", name);
    ck_assert_msg(builtin->generate(out) == RESULT_OK, "%s: %s", name, result_message());
    ck_assert_str_eq(out->name, name);
}

/* The same bytes with every compiler and on every machine. If a scene is changed on purpose, take
 * the digest that is printed, and write data/scenes again with `peel scenes NAME -o FILE`. */
START_TEST(scenes_are_the_same_everywhere)
{
    static const struct {
        const char *name;
        uint64_t digest;
    } pinned[] = {{"teapot_hall", 0xbcf96e839b762b68},
                  {"teapot_hall_stress", 0xa31793fe51915044},
                  {"tutorial", 0x6569e6769b22aa91},
                  {"chain", 0x61834bda2b6f16b0},
                  {"crossing_planes", 0x761ec8dae1f46c35},
                  {"alpha_ladder", 0xb8f5044236a485f7},
                  {"lamps", 0x02c222c48eb9968d}};
    size_t count;
    generate_table(&count);
    ck_assert_uint_eq(count, sizeof pinned / sizeof pinned[0]);
    for (size_t i = 0; i < count; i++) {
        Scene scene;
        generate(pinned[i].name, &scene);
        uint64_t digest = digest_scene(&scene);
        ck_assert_msg(digest == pinned[i].digest, "%s: got 0x%016llx, expected 0x%016llx",
                      pinned[i].name, (unsigned long long)digest,
                      (unsigned long long)pinned[i].digest);
        scene_free(&scene);
    }
}
END_TEST

static void check_float(double value)
{
    ck_assert((double)(float)value == value);
}

START_TEST(placements_fit_in_float)
{
    size_t count;
    const BuiltinScene *table = generate_table(&count);
    for (size_t s = 0; s < count; s++) {
        Scene scene;
        generate(table[s].name, &scene);
        for (int k = 0; k < 16; k++) {
            for (size_t i = 0; i < scene.instance_count; i++)
                check_float(scene.instances[i].world.m[k]);
            for (size_t i = 0; i < scene.camera_count; i++)
                check_float(scene.cameras[i].world.m[k]);
        }
        for (size_t i = 0; i < scene.light_count; i++)
            for (int k = 0; k < 3; k++)
                check_float(scene.lights[i].position[k]);
        scene_free(&scene);
    }
}
END_TEST

static size_t transparent_instances(const Scene *scene)
{
    size_t count = 0;
    for (size_t i = 0; i < scene->instance_count; i++)
        count += scene->materials[scene->instances[i].material].alpha_mode == ALPHA_BLEND;
    return count;
}

START_TEST(hall_is_as_described)
{
    Scene scene;
    generate("teapot_hall", &scene);
    ck_assert_uint_eq(scene.instance_count, 101);
    ck_assert_uint_eq(transparent_instances(&scene), 50);
    ck_assert_uint_eq(scene_triangle_count(&scene), 44 + 100 * 9312);
    ck_assert_uint_eq(scene.light_count, 128);
    ck_assert_double_eq(scene.light_degrees_per_second, 15.0);
    for (size_t i = 0; i < scene.light_count; i++)
        for (int k = 0; k < 3; k++) {
            ck_assert(fabs(scene.lights[i].position[k]) <= 10.0);
            ck_assert(scene.lights[i].color[k] >= 0.0f && scene.lights[i].color[k] <= 8.0f);
        }
    ck_assert_double_eq(scene.instances[1].world.m[14], -8.0);
    ck_assert_double_eq(scene.instances[100].world.m[14], 8.0);
    ck_assert_double_eq(scene.instances[100].world.m[12], 5.0);
    scene_free(&scene);
    generate("teapot_hall_stress", &scene);
    ck_assert_uint_eq(transparent_instances(&scene), 100);
    scene_free(&scene);
}
END_TEST

/* Cell (row, column) holds `column` layers, all at one place but for their distinct depths. */
START_TEST(ladder_counts_its_layers)
{
    Scene scene;
    int layers[8][16] = {{0}};
    generate("alpha_ladder", &scene);
    for (size_t i = 0; i < scene.instance_count; i++) {
        const Instance *instance = &scene.instances[i];
        const Material *material = &scene.materials[instance->material];
        if (material->alpha_mode != ALPHA_BLEND)
            continue;
        int column = (int)(instance->world.m[12] + 7.5), row = (int)(3.5 - instance->world.m[13]);
        ck_assert(column >= 0 && column < 16 && row >= 0 && row < 8);
        ck_assert_double_eq(instance->world.m[14], -layers[row][column] / 64.0);
        layers[row][column]++;
    }
    for (int row = 0; row < 8; row++)
        for (int column = 0; column < 16; column++)
            ck_assert_int_eq(layers[row][column], column + 1);
    scene_free(&scene);
}
END_TEST

/* Every lamp reaches the floor, and less than a third of its width: its light ends there. */
START_TEST(lamps_do_not_reach_far)
{
    Scene scene;
    generate("lamps", &scene);
    ck_assert_uint_eq(scene.light_count, 64);
    ck_assert_uint_eq(transparent_instances(&scene), 8);
    for (size_t i = 0; i < scene.light_count; i++) {
        const Light *light = &scene.lights[i];
        ck_assert(light->position[1] > 0.0 && light->position[1] < (double)light->range);
        ck_assert_float_le(light->range, 2.5f);
        for (int k = 0; k < 3; k += 2)
            ck_assert(fabs(light->position[k]) < 8.0);
    }
    scene_free(&scene);
}
END_TEST

START_TEST(unknown_scene)
{
    ck_assert_ptr_null(generate_find("no such scene"));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("generate");
    TCase *test = tcase_create("generate");
    tcase_set_timeout(test, 120);
    tcase_add_test(test, sphere_and_torus_are_closed);
    tcase_add_test(test, smallest_shapes);
    tcase_add_test(test, room_is_closed_and_inward);
    tcase_add_test(test, teapot_surface);
    tcase_add_test(test, teapot_poles);
    tcase_add_test(test, scenes_are_the_same_everywhere);
    tcase_add_test(test, placements_fit_in_float);
    tcase_add_test(test, hall_is_as_described);
    tcase_add_test(test, ladder_counts_its_layers);
    tcase_add_test(test, lamps_do_not_reach_far);
    tcase_add_test(test, unknown_scene);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}
