#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Coordinates further out would overflow single precision when squared. */
#define COORDINATE_LIMIT 1e15
#define INTENSITY_LIMIT  1e12f
#define DEGREES_LIMIT    1e12
/* What the attenuation's denominator must reach at the shortest distance the shading knows, 0.01,
 * so that 1/x times the greatest intensity stays finite. */
#define ATTENUATION_MIN 1e-8
#define PI              3.141592653589793

static void free_meshes(Scene *scene)
{
    for (size_t i = 0; scene->meshes && i < scene->mesh_count; i++) {
        free(scene->meshes[i].position);
        free(scene->meshes[i].normal);
        free(scene->meshes[i].uv);
        free(scene->meshes[i].index);
    }
    free(scene->meshes);
}

void scene_free(Scene *scene)
{
    free_meshes(scene);
    for (size_t i = 0; scene->textures && i < scene->texture_count; i++)
        free(scene->textures[i].texels);
    for (size_t i = 0; scene->materials && i < scene->material_count; i++)
        free(scene->materials[i].name);
    for (size_t i = 0; scene->instances && i < scene->instance_count; i++)
        free(scene->instances[i].name);
    for (size_t i = 0; scene->cameras && i < scene->camera_count; i++)
        free(scene->cameras[i].name);
    free(scene->textures);
    free(scene->materials);
    free(scene->instances);
    free(scene->cameras);
    free(scene->lights);
    free(scene->name);
    *scene = (Scene){0};
}

uint64_t scene_triangle_count(const Scene *scene)
{
    uint64_t count = 0;
    for (size_t i = 0; i < scene->instance_count; i++)
        count += scene->meshes[scene->instances[i].mesh].triangle_count;
    return count;
}

/* ---- validation ----------------------------------------------------------------------------- */

static bool within(double x, double low, double high) /* false for NaN */
{
    return x >= low && x <= high;
}

/* Index of the first element that is not finite, count if there is none. */
static size_t first_nonfinite(const float *values, size_t count)
{
    size_t i = 0;
    while (i < count && isfinite(values[i]))
        i++;
    return i;
}

static Result check_floats(size_t mesh, const char *what, const float *values, size_t vertex_count,
                           size_t channels)
{
    if (!values)
        return result_fail(RESULT_BAD_INPUT, "mesh %zu: no %ss, expected one per vertex", mesh,
                           what);
    size_t bad = first_nonfinite(values, vertex_count * channels);
    if (bad < vertex_count * channels)
        return result_fail(RESULT_BAD_INPUT, "mesh %zu: %s of vertex %zu is not finite", mesh, what,
                           bad / channels);
    return RESULT_OK;
}

/* A normal's square must not overflow, nor a texture coordinate over w. */
static Result check_magnitudes(size_t mesh, const char *what, const float *values,
                               size_t vertex_count, size_t channels)
{
    for (size_t i = 0; i < vertex_count * channels; i++)
        if (fabsf(values[i]) > (float)COORDINATE_LIMIT)
            return result_fail(RESULT_BAD_INPUT,
                               "mesh %zu: %s of vertex %zu has component %g, expected within 1e15",
                               mesh, what, i / channels, (double)values[i]);
    return RESULT_OK;
}

static Result check_mesh(size_t number, const Mesh *mesh)
{
    if (mesh->vertex_count == 0 || mesh->triangle_count == 0)
        return result_fail(RESULT_BAD_INPUT,
                           "mesh %zu: %u vertices and %u triangles, expected at least one of each",
                           number, mesh->vertex_count, mesh->triangle_count);
    Result result = check_floats(number, "position", mesh->position, mesh->vertex_count, 3);
    if (!result)
        result = check_floats(number, "normal", mesh->normal, mesh->vertex_count, 3);
    if (!result)
        result = check_magnitudes(number, "normal", mesh->normal, mesh->vertex_count, 3);
    if (!result && mesh->uv)
        result = check_floats(number, "texture coordinate", mesh->uv, mesh->vertex_count, 2);
    if (!result && mesh->uv)
        result = check_magnitudes(number, "texture coordinate", mesh->uv, mesh->vertex_count, 2);
    if (result)
        return result;
    if (!mesh->index)
        return result_fail(RESULT_BAD_INPUT, "mesh %zu: no indices", number);
    for (size_t i = 0; i < (size_t)mesh->triangle_count * 3; i++)
        if (mesh->index[i] >= mesh->vertex_count)
            return result_fail(RESULT_BAD_INPUT,
                               "mesh %zu: index %u of triangle %zu is out of range, expected below "
                               "%u",
                               number, mesh->index[i], i / 3, mesh->vertex_count);
    return RESULT_OK;
}

static Result check_texture(size_t number, const Texture *texture)
{
    if (!within(texture->width, 1, TEXTURE_MAX_PIXELS) ||
        !within(texture->height, 1, TEXTURE_MAX_PIXELS))
        return result_fail(RESULT_BAD_INPUT, "texture %zu: %u×%u texels, expected 1 to %d a side",
                           number, texture->width, texture->height, TEXTURE_MAX_PIXELS);
    if (texture->wrap_s > WRAP_MIRROR || texture->wrap_t > WRAP_MIRROR)
        return result_fail(RESULT_BAD_INPUT, "texture %zu: unknown wrap mode", number);
    if (!texture->texels)
        return result_fail(RESULT_BAD_INPUT, "texture %zu: no texels", number);
    for (size_t i = 0; i < (size_t)texture->width * texture->height * 4; i++)
        if (!within(texture->texels[i], 0.0, 1.0))
            return result_fail(RESULT_BAD_INPUT, "texture %zu: texel %zu has %g, expected 0 to 1",
                               number, i / 4, (double)texture->texels[i]);
    return RESULT_OK;
}

Result scene_validate_material(const Scene *scene, const Material *material, size_t number)
{
    const struct {
        const char *what;
        float value;
    } units[] = {{"red", material->base_color[0]},   {"green", material->base_color[1]},
                 {"blue", material->base_color[2]},  {"alpha", material->base_color[3]},
                 {"roughness", material->roughness}, {"metallic", material->metallic},
                 {"occlusion", material->occlusion}};
    for (size_t i = 0; i < sizeof units / sizeof units[0]; i++)
        if (!within(units[i].value, 0.0, 1.0))
            return result_fail(RESULT_BAD_INPUT, "material %zu: %s is %g, expected 0 to 1", number,
                               units[i].what, (double)units[i].value);
    if (material->alpha_mode < ALPHA_OPAQUE || material->alpha_mode > ALPHA_BLEND)
        return result_fail(RESULT_BAD_INPUT, "material %zu: unknown alpha mode", number);
    if (!isfinite(material->alpha_cutoff) || material->alpha_cutoff < 0.0f)
        return result_fail(RESULT_BAD_INPUT,
                           "material %zu: alpha cutoff is %g, expected a finite number from 0",
                           number, (double)material->alpha_cutoff);
    if (material->base_color_texture > scene->texture_count ||
        material->metallic_roughness_texture > scene->texture_count)
        return result_fail(RESULT_BAD_INPUT,
                           "material %zu: texture %u or %u out of range, expected at most %zu",
                           number, material->base_color_texture,
                           material->metallic_roughness_texture, scene->texture_count);
    if (!material->name)
        return result_fail(RESULT_BAD_INPUT, "material %zu: no name", number);
    return RESULT_OK;
}

static Result check_matrix(const char *what, size_t number, const Matrix *world)
{
    for (int i = 0; i < 16; i++)
        if (!within(world->m[i], -COORDINATE_LIMIT, COORDINATE_LIMIT))
            return result_fail(RESULT_BAD_INPUT,
                               "%s %zu: world matrix has element %g, expected finite, within 1e15",
                               what, number, world->m[i]);
    if (world->m[3] != 0.0 || world->m[7] != 0.0 || world->m[11] != 0.0 || world->m[15] != 1.0)
        return result_fail(RESULT_BAD_INPUT,
                           "%s %zu: world matrix is not affine, expected a last row of 0 0 0 1",
                           what, number);
    return RESULT_OK;
}

static void bounds_include(const double point[3], double low[3], double high[3])
{
    for (int i = 0; i < 3; i++) {
        low[i] = point[i] < low[i] ? point[i] : low[i];
        high[i] = point[i] > high[i] ? point[i] : high[i];
    }
}

/* Axis-aligned box of the mesh's positions, in mesh space; it has at least one vertex. */
static void mesh_bounds(const Mesh *mesh, double low[3], double high[3])
{
    for (int i = 0; i < 3; i++)
        low[i] = high[i] = (double)mesh->position[i];
    for (size_t v = 1; v < mesh->vertex_count; v++) {
        const float *p = mesh->position + 3 * v;
        bounds_include((double[3]){(double)p[0], (double)p[1], (double)p[2]}, low, high);
    }
}

/* Extends a world-space box by the eight corners of a mesh-space one. */
static void bounds_include_box(const Matrix *world, const double box[2][3], double low[3],
                               double high[3])
{
    for (int corner = 0; corner < 8; corner++) {
        const double point[3] = {box[corner & 1][0], box[corner >> 1 & 1][1],
                                 box[corner >> 2 & 1][2]};
        double moved[3];
        matrix_point(world, point, moved);
        bounds_include(moved, low, high);
    }
}

/* boxes: mesh-space bounds of every mesh of the scene. */
static Result check_instance(const Scene *scene, size_t number, const double (*boxes)[2][3])
{
    const Instance *instance = &scene->instances[number];
    if (instance->mesh >= scene->mesh_count || instance->material >= scene->material_count)
        return result_fail(RESULT_BAD_INPUT,
                           "instance %zu: mesh %u or material %u out of range, expected below %zu "
                           "and %zu",
                           number, instance->mesh, instance->material, scene->mesh_count,
                           scene->material_count);
    if (!instance->name)
        return result_fail(RESULT_BAD_INPUT, "instance %zu: no name", number);
    Result result = check_matrix("instance", number, &instance->world);
    if (result)
        return result;
    double low[3] = {0.0}, high[3] = {0.0};
    bounds_include_box(&instance->world, boxes[instance->mesh], low, high);
    for (int i = 0; i < 3; i++)
        if (!within(low[i], -COORDINATE_LIMIT, COORDINATE_LIMIT) ||
            !within(high[i], -COORDINATE_LIMIT, COORDINATE_LIMIT))
            return result_fail(RESULT_BAD_INPUT,
                               "instance %zu: reaches beyond 1e15 from the origin", number);
    return RESULT_OK;
}

static Result check_instances(const Scene *scene)
{
    double(*boxes)[2][3] = calloc(scene->mesh_count + 1, sizeof *boxes);
    if (!boxes)
        return result_fail(RESULT_NO_MEMORY, "out of memory: bounds of %zu meshes",
                           scene->mesh_count);
    for (size_t i = 0; i < scene->mesh_count; i++)
        mesh_bounds(&scene->meshes[i], boxes[i][0], boxes[i][1]);
    Result result = RESULT_OK;
    for (size_t i = 0; !result && i < scene->instance_count; i++)
        result = check_instance(scene, i, (const double(*)[2][3])boxes);
    free(boxes);
    if (!result && scene_triangle_count(scene) >= UINT32_MAX)
        return result_fail(RESULT_BAD_INPUT,
                           "scene: %llu triangles over all instances, expected below 2^32 - 1",
                           (unsigned long long)scene_triangle_count(scene));
    return result;
}

Result scene_validate_light(const Light *light, size_t number)
{
    for (int i = 0; i < 3; i++) {
        if (!within(light->position[i], -COORDINATE_LIMIT, COORDINATE_LIMIT))
            return result_fail(RESULT_BAD_INPUT,
                               "light %zu: position is %g, expected finite, within 1e15", number,
                               light->position[i]);
        if (!(light->color[i] >= 0.0f && light->color[i] <= INTENSITY_LIMIT))
            return result_fail(RESULT_BAD_INPUT, "light %zu: intensity is %g, expected 0 to 1e12",
                               number, (double)light->color[i]);
        if (!(light->attenuation[i] >= 0.0f && isfinite(light->attenuation[i])))
            return result_fail(RESULT_BAD_INPUT,
                               "light %zu: attenuation is %g, expected a finite number from 0",
                               number, (double)light->attenuation[i]);
    }
    double nearest = (double)light->attenuation[0] + 0.01 * (double)light->attenuation[1] +
                     1e-4 * (double)light->attenuation[2];
    /* The tolerance lets (0, 0, 1e-4), rounded to float, pass. */
    if (nearest < ATTENUATION_MIN * (1.0 - 1e-6))
        return result_fail(RESULT_BAD_INPUT,
                           "light %zu: attenuation is %g at a distance of 0.01, expected at least "
                           "1e-8",
                           number, nearest);
    if (!(light->range >= 0.0f && isfinite(light->range)))
        return result_fail(RESULT_BAD_INPUT,
                           "light %zu: range is %g, expected a finite number from 0 (no limit)",
                           number, (double)light->range);
    return RESULT_OK;
}

Result scene_validate_camera(const Camera *camera, size_t number)
{
    Matrix view;
    if (!camera->name)
        return result_fail(RESULT_BAD_INPUT, "camera %zu: no name", number);
    if (!(camera->yfov > 0.0 && camera->yfov < PI))
        return result_fail(RESULT_BAD_INPUT,
                           "camera %zu: vertical field of view is %g radians, expected between 0 "
                           "and pi",
                           number, camera->yfov);
    if (!(camera->near > 0.0 && isfinite(camera->near) && camera->far > camera->near))
        return result_fail(RESULT_BAD_INPUT,
                           "camera %zu: near %g and far %g, expected 0 < near < far", number,
                           camera->near, camera->far);
    Result result = check_matrix("camera", number, &camera->world);
    if (!result && !matrix_invert_affine(&camera->world, &view))
        return result_fail(RESULT_BAD_INPUT, "camera %zu: world matrix has no inverse", number);
    return result;
}

void scene_unscale_camera(Camera *camera)
{
    for (int c = 0; c < 3; c++) {
        double *axis = camera->world.m + 4 * c;
        double length = sqrt((axis[0] * axis[0] + axis[1] * axis[1]) + axis[2] * axis[2]);
        /* Not for what float rounding does: placements stay as they were written. */
        for (int r = 0; r < 3 && length > 0.0 && fabs(length - 1.0) > 1e-5; r++)
            axis[r] /= length;
    }
}

Result scene_validate_surroundings(const Scene *scene)
{
    for (int i = 0; i < 3; i++)
        if (!(scene->ambient[i] >= 0.0f && scene->ambient[i] <= INTENSITY_LIMIT) ||
            !(scene->background[i] >= 0.0f && scene->background[i] <= INTENSITY_LIMIT))
            return result_fail(RESULT_BAD_INPUT,
                               "scene: ambient light %g or background %g, expected 0 to 1e12",
                               (double)scene->ambient[i], (double)scene->background[i]);
    if (!(fabs(scene->light_degrees_per_second) <= DEGREES_LIMIT))
        return result_fail(RESULT_BAD_INPUT,
                           "scene: lights that turn by %g degrees per second, expected within "
                           "1e12",
                           scene->light_degrees_per_second);
    return scene->name ? RESULT_OK : result_fail(RESULT_BAD_INPUT, "scene: no name");
}

Result scene_validate(const Scene *scene)
{
    Result result = scene_validate_surroundings(scene);
    for (size_t i = 0; !result && i < scene->mesh_count; i++)
        result = check_mesh(i, &scene->meshes[i]);
    for (size_t i = 0; !result && i < scene->texture_count; i++)
        result = check_texture(i, &scene->textures[i]);
    for (size_t i = 0; !result && i < scene->material_count; i++)
        result = scene_validate_material(scene, &scene->materials[i], i);
    if (!result)
        result = check_instances(scene);
    for (size_t i = 0; !result && i < scene->light_count; i++)
        result = scene_validate_light(&scene->lights[i], i);
    for (size_t i = 0; !result && i < scene->camera_count; i++)
        result = scene_validate_camera(&scene->cameras[i], i);
    return result;
}

/* ---- what a scene may lack ------------------------------------------------------------------ */

bool scene_bounds(const Scene *scene, double low[3], double high[3])
{
    bool any = false;
    for (size_t i = 0; i < scene->instance_count; i++) {
        const Instance *instance = &scene->instances[i];
        const Mesh *mesh = &scene->meshes[instance->mesh];
        for (size_t v = 0; v < mesh->vertex_count; v++) {
            const float *p = mesh->position + 3 * v;
            double moved[3];
            matrix_point(&instance->world, (double[3]){(double)p[0], (double)p[1], (double)p[2]},
                         moved);
            for (int k = 0; !any && k < 3; k++)
                low[k] = high[k] = moved[k];
            any = true;
            bounds_include(moved, low, high);
        }
    }
    return any;
}

void scene_override_opacity(Scene *scene, float opacity)
{
    for (size_t i = 0; i < scene->material_count; i++) {
        Material *material = &scene->materials[i];
        material->base_color[3] = opacity;
        if (opacity < 1.0f)
            material->alpha_mode = ALPHA_BLEND;
        else if (material->alpha_mode != ALPHA_MASK)
            material->alpha_mode = ALPHA_OPAQUE;
    }
}

/* Centre and radius of a sphere around the scene; radius 1 where there is no extent. */
static double bounding_sphere(const Scene *scene, double center[3])
{
    double low[3] = {0.0}, high[3] = {0.0}, square = 0.0;
    scene_bounds(scene, low, high);
    for (int i = 0; i < 3; i++) {
        double half = (high[i] - low[i]) * 0.5;
        center[i] = low[i] + half;
        square += half * half;
    }
    /* A point far out still needs a radius that the coordinates can resolve. */
    double least = 1e-3 * (fabs(center[0]) + fabs(center[1]) + fabs(center[2]));
    double radius = sqrt(square);
    if (radius == 0.0)
        radius = 1.0;
    return radius > least ? radius : least;
}

Result scene_add_framing_camera(Scene *scene)
{
    double center[3], eye[3];
    const double direction[3] = {0.48, 0.36, 0.8}; /* of length 1 */
    double radius = bounding_sphere(scene, center);
    double yfov = PI / 4.0;
    double distance = 1.05 * radius / matrix_sin(yfov * 0.5);
    for (int i = 0; i < 3; i++)
        eye[i] = center[i] + direction[i] * distance;
    Matrix view = matrix_look_at(eye, center, (const double[3]){0.0, 1.0, 0.0});
    Camera camera = {.yfov = yfov, .near = distance - 1.1 * radius, .far = distance + 1.1 * radius};
    if (!matrix_invert_affine(&view, &camera.world))
        return result_fail(RESULT_BAD_INPUT, "scene: no camera can frame its bounds");
    Camera *grown = realloc(scene->cameras, (scene->camera_count + 1) * sizeof *grown);
    if (grown)
        scene->cameras = grown;
    camera.name = strdup("framing");
    if (!grown || !camera.name) {
        free(camera.name);
        return result_fail(RESULT_NO_MEMORY, "out of memory: a framing camera");
    }
    scene->cameras[scene->camera_count++] = camera;
    return RESULT_OK;
}

Result scene_add_default_lights(Scene *scene)
{
    static const struct {
        double direction[3]; /* from the scene's centre, in radii */
        float color[3];
    } rig[] = {{{1.2, 1.6, 1.6}, {2.6f, 2.5f, 2.4f}},
               {{-2.0, 0.6, 1.2}, {0.7f, 0.8f, 1.0f}},
               {{-0.4, 1.4, -2.2}, {1.2f, 1.2f, 1.2f}}};
    enum {
        COUNT = sizeof rig / sizeof rig[0]
    };
    double center[3];
    double radius = bounding_sphere(scene, center);
    Light *grown = realloc(scene->lights, (scene->light_count + COUNT) * sizeof *grown);
    if (!grown)
        return result_fail(RESULT_NO_MEMORY, "out of memory: the default lights");
    scene->lights = grown;
    for (int i = 0; i < COUNT; i++) {
        Light light = {.attenuation = {1.0f, 0.0f, 0.0f}};
        memcpy(light.color, rig[i].color, sizeof light.color);
        for (int k = 0; k < 3; k++)
            light.position[k] = center[k] + rig[i].direction[k] * radius;
        scene->lights[scene->light_count++] = light;
    }
    return RESULT_OK;
}
