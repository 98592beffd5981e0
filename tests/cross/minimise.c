#include "minimise.h"

#include "base/memory.h"
#include "frame/method.h"
#include "scene/gltf.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A triangle with vertices of its own, so that any set of them makes a scene. */
typedef struct Triangle {
    uint32_t instance;
    float position[9], normal[9], uv[6];
} Triangle;

typedef struct Minimiser {
    const Scene *original;
    MinimiseFails fails;
    RenderDesc desc;
    size_t light_count;
    Triangle *triangles, *candidate;
    uint32_t count;
    Scene scene; /* as last assembled */
    float *position, *normal, *uv;
    uint32_t *index;
} Minimiser;

/* Makes m->scene of count triangles. Triangles of one instance follow each other. */
static void assemble(Minimiser *m, const Triangle *triangles, uint32_t count)
{
    Scene *scene = &m->scene;
    scene->instance_count = 0;
    for (uint32_t t = 0; t < count; t++) {
        const Triangle *triangle = &triangles[t];
        if (t == 0 || triangle->instance != triangles[t - 1].instance) {
            size_t next = scene->instance_count++;
            scene->instances[next] = m->original->instances[triangle->instance];
            scene->instances[next].mesh = (uint32_t)next;
            scene->meshes[next] = (Mesh){.position = m->position + 9 * (size_t)t,
                                         .normal = m->normal + 9 * (size_t)t,
                                         .uv = m->uv + 6 * (size_t)t,
                                         .index = m->index};
        }
        memcpy(m->position + 9 * (size_t)t, triangle->position, sizeof triangle->position);
        memcpy(m->normal + 9 * (size_t)t, triangle->normal, sizeof triangle->normal);
        memcpy(m->uv + 6 * (size_t)t, triangle->uv, sizeof triangle->uv);
        Mesh *mesh = &scene->meshes[scene->instance_count - 1];
        mesh->triangle_count++;
        mesh->vertex_count += 3;
    }
    scene->mesh_count = scene->instance_count;
    scene->light_count = m->light_count;
}

static bool still_fails(Minimiser *m, const Triangle *triangles, uint32_t count)
{
    assemble(m, triangles, count);
    return m->fails(&m->scene, &m->desc);
}

/* ---- triangles ------------------------------------------------------------------------------ */

/* Leaves out triangles from … to − 1 for good, if it fails without them. */
static bool leave_out(Minimiser *m, uint32_t from, uint32_t to)
{
    uint32_t after = m->count - to;
    memcpy(m->candidate, m->triangles, from * sizeof *m->triangles);
    memcpy(m->candidate + from, m->triangles + to, after * sizeof *m->triangles);
    if (from + after == 0 || !still_fails(m, m->candidate, from + after))
        return false;
    Triangle *reduced = m->candidate;
    m->candidate = m->triangles;
    m->triangles = reduced;
    m->count = from + after;
    return true;
}

static void reduce_triangles(Minimiser *m)
{
    for (uint32_t chunk = (m->count + 1) / 2; chunk > 0;) {
        bool reduced = false;
        for (uint32_t from = 0; from < m->count;) {
            uint32_t to = from + chunk < m->count ? from + chunk : m->count;
            if (leave_out(m, from, to))
                reduced = true;
            else
                from = to;
        }
        if (!reduced || chunk > 1)
            chunk /= 2; /* single triangles until all of them are needed */
    }
}

/* ---- lights and settings -------------------------------------------------------------------- */

static void reduce_lights(Minimiser *m)
{
    size_t before = m->light_count;
    for (m->light_count = 0; m->light_count < before; m->light_count++)
        if (still_fails(m, m->triangles, m->count))
            return;
}

static bool keep_if_fails(Minimiser *m, RenderDesc simpler)
{
    RenderDesc before = m->desc;
    m->desc = simpler;
    if (still_fails(m, m->triangles, m->count))
        return true;
    m->desc = before;
    return false;
}

#define DEFAULTED(member)                                                                          \
    do {                                                                                           \
        RenderDesc simpler = m->desc;                                                              \
        simpler.member = 0;                                                                        \
        if (m->desc.member != 0)                                                                   \
            keep_if_fails(m, simpler);                                                             \
    } while (0)

static void reduce_settings(Minimiser *m)
{
    DEFAULTED(opaque_blend);
    DEFAULTED(method);
    DEFAULTED(shading);
    DEFAULTED(bias);
    DEFAULTED(draw_order);
    DEFAULTED(sort);
    DEFAULTED(weight);
    DEFAULTED(nodes_per_pixel);
    DEFAULTED(post);
    DEFAULTED(gbuffer);
    DEFAULTED(position);
    DEFAULTED(depth_range);
    DEFAULTED(ggx);
    DEFAULTED(back_light);
    DEFAULTED(depth);
    DEFAULTED(accum);
    DEFAULTED(depth_func);
    DEFAULTED(peel_test);
    DEFAULTED(cull);
    DEFAULTED(normals);
    DEFAULTED(lights);
    DEFAULTED(passes);
    for (int passes = 1; passes < 4; passes++) {
        RenderDesc simpler = m->desc;
        simpler.passes = passes;
        if ((m->desc.passes == 0 || m->desc.passes > passes) && keep_if_fails(m, simpler))
            break;
    }
}

/* ---- all of it ------------------------------------------------------------------------------ */

static void take_apart(Minimiser *m)
{
    const Scene *scene = m->original;
    for (uint32_t i = 0; i < scene->instance_count; i++) {
        const Mesh *mesh = &scene->meshes[scene->instances[i].mesh];
        for (uint32_t corner = 0; corner < 3 * mesh->triangle_count; corner++) {
            uint32_t vertex = 3 * mesh->index[corner], pair = 2 * mesh->index[corner];
            uint32_t k = corner % 3;
            Triangle *triangle = &m->triangles[m->count];
            triangle->instance = i;
            memcpy(&triangle->position[3 * k], &mesh->position[vertex], 3 * sizeof(float));
            memcpy(&triangle->normal[3 * k], &mesh->normal[vertex], 3 * sizeof(float));
            if (mesh->uv)
                memcpy(&triangle->uv[2 * k], &mesh->uv[pair], 2 * sizeof(float));
            m->count += k == 2;
        }
    }
}

static bool allocate(Minimiser *m)
{
    size_t triangles = (size_t)scene_triangle_count(m->original);
    m->triangles = memory_array(triangles, sizeof *m->triangles);
    m->candidate = memory_array(triangles, sizeof *m->candidate);
    m->position = memory_array(9 * triangles, sizeof *m->position);
    m->normal = memory_array(9 * triangles, sizeof *m->normal);
    m->uv = memory_array(6 * triangles, sizeof *m->uv);
    m->index = memory_array(3 * triangles, sizeof *m->index);
    m->scene.meshes = memory_array(m->original->instance_count, sizeof *m->scene.meshes);
    m->scene.instances = memory_array(m->original->instance_count, sizeof *m->scene.instances);
    if (!m->triangles || !m->candidate || !m->position || !m->normal || !m->uv || !m->index ||
        !m->scene.meshes || !m->scene.instances)
        return false;
    for (size_t i = 0; i < 3 * triangles; i++)
        m->index[i] = (uint32_t)i;
    return true;
}

Result minimise(const Scene *scene, const RenderDesc *desc, MinimiseFails fails, Minimal *out)
{
    Minimiser m = {.original = scene,
                   .fails = fails,
                   .desc = *desc,
                   .light_count = scene->light_count,
                   .scene = *scene};
    Result result = allocate(&m) ? RESULT_OK : RESULT_NO_MEMORY;
    if (result == RESULT_OK) {
        take_apart(&m);
        reduce_settings(&m);
        reduce_lights(&m);
        reduce_triangles(&m);
        reduce_settings(&m);
        reduce_lights(&m);
        if (m.light_count == 0)
            m.desc.lights = -1; /* a file without lights is given some */
        assemble(&m, m.triangles, m.count);
    }
    free(m.triangles);
    free(m.candidate);
    *out = (Minimal){.scene = m.scene, .desc = m.desc, .triangles = m.count};
    if (result != RESULT_OK) {
        free(m.position);
        free(m.normal);
        free(m.uv);
        free(m.index);
        free(m.scene.meshes);
        free(m.scene.instances);
        *out = (Minimal){0};
    }
    return result;
}

void minimise_free(Minimal *minimal)
{
    if (minimal->scene.mesh_count > 0) { /* the first mesh begins the arrays of all */
        free(minimal->scene.meshes[0].position);
        free(minimal->scene.meshes[0].normal);
        free(minimal->scene.meshes[0].uv);
        free(minimal->scene.meshes[0].index);
    }
    free(minimal->scene.meshes);
    free(minimal->scene.instances);
    *minimal = (Minimal){0};
}

/* Those that are seldom set. */
static int more_options(const RenderDesc *desc, char *text, size_t size)
{
    static const char *const weights[] = {"", " --weight 7", " --weight 8", " --weight 10"};
    char order[48] = "", nodes[32] = "";
    if (desc->draw_order == DRAW_ORDER_SHUFFLE)
        snprintf(order, sizeof order, " --draw-order shuffle=%llu",
                 (unsigned long long)desc->draw_seed);
    if (desc->nodes_per_pixel > 0)
        snprintf(nodes, sizeof nodes, " --nodes-per-pixel %d", desc->nodes_per_pixel);
    return snprintf(text, size, " --method %s%s%s%s%s%s%s%s --bias %.9g",
                    method_info(desc->method)->name,
                    desc->shading == SHADING_PHONG ? " --shading phong" : "",
                    desc->draw_order == DRAW_ORDER_REVERSE ? " --draw-order reverse" : "", order,
                    desc->sort == SORT_TRIANGLES ? " --sort triangles" : "", weights[desc->weight],
                    nodes, desc->post == POST_EDGES ? " --post edges" : "", (double)desc->bias);
}

void minimise_options(const RenderDesc *desc, char *text, size_t size)
{
    static const char *const culls[] = {"gltf", "seed", "none"};
    static const char *const ranges[] = {"gl", "zero-one", "reversed"};
    bool seed = desc->opaque_blend == OPAQUE_BLEND_SEED;
    bool no_position = render_desc_layout(desc).position == FORMAT_NONE;
    int length = snprintf(
        text, size,
        "%s--size %dx%d --depth %s --accum %s --gbuffer %s --position %s --depth-range %s "
        "--depth-func %s --peel-test %s --cull %s --normals %s --ggx %s --back-light %s --fma %s",
        seed ? "--profile seed " : "", desc->width, desc->height,
        format_info(render_desc_depth(desc))->name, format_info(desc->accum)->name,
        gbuffer_name(desc->gbuffer), no_position ? "reconstruct" : "buffer",
        ranges[desc->depth_range], desc->depth_func == DEPTH_LEQUAL ? "lequal" : "less",
        desc->peel_test == PEEL_TEST_RAW ? "raw" : "stored", culls[desc->cull],
        desc->normals == NORMALS_KEPT ? "kept" : "faced",
        desc->ggx == GGX_STABLE ? "stable" : "source", desc->back_light ? "on" : "off",
        desc->unfused ? "off" : "on");
    if (length > 0 && (size_t)length < size)
        length += more_options(desc, text + length, size - (size_t)length);
    if (desc->passes > 0 && length > 0 && (size_t)length < size)
        length += snprintf(text + length, size - (size_t)length, " --passes %d", desc->passes);
    if (desc->lights != 0 && length > 0 && (size_t)length < size)
        snprintf(text + length, size - (size_t)length, " --lights %d",
                 desc->lights > 0 ? desc->lights : 0);
}

/* ---- a file of it --------------------------------------------------------------------------- */

/* Whether the file, read again, still shows the failure. */
static Result shows(const char *path, const RenderDesc *desc, MinimiseFails fails, bool *out)
{
    Scene scene;
    Result result = gltf_load(path, &scene);
    if (result != RESULT_OK)
        return result;
    *out = fails(&scene, desc);
    scene_free(&scene);
    return RESULT_OK;
}

Result minimise_to_file(const Scene *scene, const RenderDesc *desc, MinimiseFails fails,
                        const char *path, MinimisedFile *out)
{
    char folder[1024] = "", options[640] = "";
    Minimal minimal;
    *out = (MinimisedFile){0};
    Result result = minimise(scene, desc, fails, &minimal);
    if (result != RESULT_OK)
        return result;
    out->triangles = minimal.triangles;
    out->lights = minimal.scene.light_count;
    result = gltf_write(&minimal.scene, path);
    minimise_options(&minimal.desc, options, sizeof options);
    if (!getcwd(folder, sizeof folder))
        *folder = '\0';
    snprintf(out->command, sizeof out->command, "build/peel compare %s/%s %s%s", folder, path,
             options, minimal.desc.bound ? " --bound --budget" : "");
    if (result == RESULT_OK)
        result = shows(path, &minimal.desc, fails, &out->shown);
    minimise_free(&minimal);
    return result;
}
