#include "frame/view.h"

#include "base/memory.h"
#include "base/random.h"
#include "frame/shading.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of planes closer than this the rounding of w comes near the least normal number. */
#define NEAR_MIN 0x1p-124f

/* From it on nothing reaches the least distance that the shading knows; no product with a squared
 * distance overflows. */
#define INVERSE_RANGE2_MAX (2.0 / (double)SHADING_DISTANCE2_MIN)

/* The original leaves out entities that cannot be seen at all. A texture only lowers alpha; without
 * one a masked material is all there or not there at all. */
static bool is_visible(const Material *material)
{
    float alpha = material->base_color[3];
    switch (material->alpha_mode) {
    case ALPHA_OPAQUE:
        return true;
    case ALPHA_MASK:
        return alpha >= material->alpha_cutoff;
    case ALPHA_BLEND:
        break;
    }
    return alpha >= 1e-4f;
}

static bool culls_back(CullMode mode, const Material *material, bool transparent)
{
    switch (mode) {
    case CULL_GLTF:
        return !material->double_sided;
    case CULL_SEED:
        return !transparent;
    case CULL_NONE:
        break;
    }
    return false;
}

/* Normals are normalised after the product, so a power of two changes no bit of them; it keeps the
 * matrix of a tiny or huge instance within single precision. */
void view_normal_matrix(const Matrix *model_view, float out[9])
{
    double normal[9], largest = 0.0;
    matrix_normal(model_view, normal);
    for (int i = 0; i < 9; i++)
        largest = fmax(largest, fabs(normal[i]));
    int exponent = 0;
    frexp(largest, &exponent);
    for (int i = 0; i < 9; i++)
        out[i] = (float)ldexp(normal[i], -exponent);
}

static Draw make_draw(const Scene *scene, uint32_t index, const Matrix *view, CullMode cull)
{
    const Instance *instance = &scene->instances[index];
    const Material *material = &scene->materials[instance->material];
    Matrix model_view = matrix_multiply(view, &instance->world);

    Draw draw = {.instance = index, .mesh = instance->mesh, .material = instance->material};
    draw.transparent = material->alpha_mode == ALPHA_BLEND;
    draw.flipped = matrix_determinant3(&model_view) < 0.0;
    draw.masked = material->alpha_mode == ALPHA_MASK && material->base_color_texture > 0;
    draw.cull_back = culls_back(cull, material, draw.transparent);
    matrix_round(&model_view, draw.model_view);
    view_normal_matrix(&model_view, draw.normal_matrix);
    return draw;
}

static float inverse_range2(float range)
{
    if (range == 0.0f)
        return 0.0f;
    double inverse = 1.0 / ((double)range * (double)range);
    if (inverse < (double)FLT_MIN) /* a denormal, which the renderers take for 0 */
        return 0.0f;
    return (float)fmin(inverse, INVERSE_RANGE2_MAX);
}

static ViewLight make_light(const Light *light, const Matrix *world_to_view)
{
    ViewLight out;
    double position[3];
    matrix_point(world_to_view, light->position, position);
    for (int i = 0; i < 3; i++) {
        out.position[i] = (float)position[i];
        out.color[i] = light->color[i];
        out.attenuation[i] = light->attenuation[i];
    }
    out.inverse_range2 = inverse_range2(light->range);
    return out;
}

/* The light's distance from the eye, rounded up; infinite where shading it may overflow: the limits
 * are those of scene_validate, and its tolerance. */
static double light_reach(const ViewLight *light)
{
    const float *p = light->position, *falloff = light->attenuation;
    bool bounded = falloff[0] + 0.01 * falloff[1] + 1e-4 * falloff[2] >= 0.99e-8;
    for (int i = 0; i < 3; i++)
        bounded =
            bounded && light->color[i] >= 0.0f && light->color[i] <= 1e12f && falloff[i] >= 0.0f;
    double length = sqrt((double)p[0] * p[0] + (double)p[1] * p[1] + (double)p[2] * p[2]);
    return bounded ? 1.000001 * length + 1e-6 : INFINITY;
}

/* All factors of its colour are finite: a black light adds +0 or −0 to a sum that starts at +0. */
static bool can_light(const Light *light, const RenderDesc *desc)
{
    return desc->shading != SHADING_PHONG &&
           (light->color[0] != 0.0f || light->color[1] != 0.0f || light->color[2] != 0.0f);
}

static Result check(const Scene *scene, const RenderDesc *desc)
{
    Result result = render_desc_check(desc);
    if (result != RESULT_OK)
        return result;
    if (desc->camera < 0 || (size_t)desc->camera >= scene->camera_count)
        return result_fail(RESULT_BAD_INPUT, "camera %d: the scene has %zu", desc->camera,
                           scene->camera_count);
    if (scene_triangle_count(scene) >= UINT32_MAX)
        return result_fail(RESULT_BAD_INPUT, "more than 2^32 − 2 triangles");
    return RESULT_OK;
}

static void add_draws(const Scene *scene, CullMode cull, const Matrix *view, View *out)
{
    uint32_t primitive = 0;
    for (size_t i = 0; i < scene->instance_count; i++) {
        const Instance *instance = &scene->instances[i];
        if (is_visible(&scene->materials[instance->material])) {
            Draw *draw = &out->draws[out->draw_count++];
            *draw = make_draw(scene, (uint32_t)i, view, cull);
            draw->first_primitive = primitive;
        }
        primitive += scene->meshes[instance->mesh].triangle_count;
    }
}

/* Puts the opaque draws back into the order that they have in scene. */
static void restore_opaque(const Draw *scene, View *out)
{
    size_t next = 0;
    for (size_t i = 0; i < out->draw_count; i++) {
        if (out->draws[i].transparent)
            continue;
        while (scene[next].transparent)
            next++;
        out->draws[i] = scene[next++];
    }
}

/* Which draw comes first changes; their primitive ids do not. Nor does the order of opaque draws
 * among themselves, which decides what is seen of coplanar ones and is not a method's concern. */
static Result reorder_draws(const RenderDesc *desc, View *out)
{
    Draw *scene = memory_array(out->draw_count, sizeof *scene);
    if (!scene)
        return RESULT_NO_MEMORY;
    memcpy(scene, out->draws, out->draw_count * sizeof *scene);
    Random random = random_seed(desc->draw_seed);
    for (size_t i = out->draw_count; i-- > 1;) {
        size_t other = desc->draw_order == DRAW_ORDER_SHUFFLE
                           ? (size_t)(random_bits(&random) % (i + 1))
                           : out->draw_count - 1 - i;
        if (desc->draw_order == DRAW_ORDER_REVERSE && other >= i)
            continue;
        Draw draw = out->draws[i];
        out->draws[i] = out->draws[other];
        out->draws[other] = draw;
    }
    restore_opaque(scene, out);
    free(scene);
    return RESULT_OK;
}

static void add_lights(const Scene *scene, const RenderDesc *desc, const Matrix *view, View *out)
{
    double degrees = fmod(scene->light_degrees_per_second * desc->time, 360.0);
    Matrix turn = matrix_rotate_y(degrees * (3.14159265358979323846 / 180.0));
    Matrix world_to_view = matrix_multiply(view, &turn);
    size_t asked = scene->light_count;
    if (desc->lights < 0)
        asked = 0;
    else if (desc->lights > 0 && (size_t)desc->lights < scene->light_count)
        asked = (size_t)desc->lights;
    double reach = 0.0;
    for (size_t i = 0; i < asked; i++) {
        if (!desc->model_all && !can_light(&scene->lights[i], desc))
            continue;
        ViewLight *light = &out->lights[out->light_count++];
        *light = make_light(&scene->lights[i], &world_to_view);
        out->ranged = out->ranged || light->inverse_range2 > 0.0f;
        double distance = light_reach(light);
        reach = reach >= distance ? reach : distance; /* NaN stays */
    }
    out->light_reach = reach <= 0x1p47 ? (float)reach : 0.0f;
    out->dark_light_count = asked - out->light_count;
}

static Matrix make_projection(const Camera *camera, const RenderDesc *desc)
{
    double aspect = (double)desc->width / desc->height;
    switch (desc->depth_range) {
    case DEPTH_RANGE_GL:
        break;
    case DEPTH_RANGE_ZERO_ONE:
        return matrix_perspective_zero_one(camera->yfov, aspect, camera->near, camera->far);
    case DEPTH_RANGE_REVERSED:
        return matrix_perspective_reversed(camera->yfov, aspect, camera->near, camera->far);
    }
    return matrix_perspective(camera->yfov, aspect, camera->near, camera->far);
}

/* From the rounded matrix, so that it undoes what the vertices went through. Infinity becomes 1e15,
 * beyond which a scene has nothing. */
static Unprojection make_unprojection(const View *view, const Camera *camera)
{
    const float *m = view->projection;
    double a = m[10], b = m[14];
    bool half = view->depth_range != DEPTH_RANGE_GL;
    return (Unprojection){
        .depth_scale = (float)((half ? 1.0 : 2.0) / b),
        .depth_offset = (float)((half ? a : a - 1.0) / b),
        .inverse_far = (float)(camera->far < 1e15 ? 1.0 / camera->far : 1e-15),
        .ray_scale = {(float)(2.0 / (view->width * (double)m[0])),
                      (float)(2.0 / (view->height * (double)m[5]))},
        .ray_offset = {(float)((1.0 / view->width - 1.0) / (double)m[0]),
                       (float)((1.0 / view->height - 1.0) / (double)m[5])},
    };
}

Result view_build(const Scene *scene, const RenderDesc *desc, View *out)
{
    *out = (View){.width = desc->width, .height = desc->height};
    Result result = check(scene, desc);
    if (result != RESULT_OK)
        return result;
    const Camera *camera = &scene->cameras[desc->camera];
    Matrix view;
    if (!matrix_invert_affine(&camera->world, &view))
        return result_fail(RESULT_BAD_INPUT, "camera %d: its matrix has no inverse", desc->camera);
    out->depth_range = desc->depth_range;
    Matrix projection = make_projection(camera, desc);
    matrix_round(&projection, out->projection);
    matrix_round(&view, out->world_to_camera);
    /* Reversed, the depth of infinity is 0. On a near plane about 2^-126 clipped vertices may
     * round to w = 0. */
    bool fits = (float)camera->near >= NEAR_MIN && isnormal(out->projection[0]) &&
                isnormal(out->projection[5]) && isnormal(out->projection[14]) &&
                (isnormal(out->projection[10]) || out->projection[10] == 0.0f);
    if (!fits)
        return result_fail(RESULT_BAD_INPUT,
                           "camera %d: its projection (yfov %g, near %g, far %g) does not fit in "
                           "single precision",
                           desc->camera, camera->yfov, camera->near, camera->far);
    out->unprojection = make_unprojection(out, camera);
    out->draws = memory_array(scene->instance_count, sizeof *out->draws);
    out->lights = memory_array(scene->light_count, sizeof *out->lights);
    if (!out->draws || !out->lights) {
        view_free(out);
        return RESULT_NO_MEMORY;
    }
    add_draws(scene, desc->cull, &view, out);
    if (desc->draw_order != DRAW_ORDER_SCENE && reorder_draws(desc, out) != RESULT_OK) {
        view_free(out);
        return RESULT_NO_MEMORY;
    }
    add_lights(scene, desc, &view, out);
    memcpy(out->ambient, scene->ambient, sizeof out->ambient);
    memcpy(out->background, scene->background, sizeof out->background);
    return RESULT_OK;
}

void view_free(View *view)
{
    free(view->draws);
    free(view->lights);
    *view = (View){0};
}
