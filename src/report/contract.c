/* The folder of `peel scenes NAME --export DIR`. The keys of contract.json are a contract, too. */
#include "report/contract.h"

#include "base/file.h"
#include "base/memory.h"
#include "frame/view.h"
#include "report/document.h"
#include "report/pictures.h"
#include "report/summary.h"
#include "scene/gltf.h"
#include "scene/gltf_child.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const char contract_peel_dump_h[], contract_peel_shade_h[];

/* ---- JSON -------------------------------------------------------------------------------------
 */

static json_t *hex(Document *json, const float *values, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        document_append(json, array, document_hex((double)values[i]));
    return array;
}

static json_t *make_lights(Document *json, const View *view)
{
    json_t *array = json_array();
    for (size_t i = 0; i < view->light_count; i++) {
        const ViewLight *light = &view->lights[i];
        json_t *object = json_object();
        document_put(json, object, "position", hex(json, light->position, 3));
        document_put(json, object, "color", hex(json, light->color, 3));
        document_put(json, object, "attenuation", hex(json, light->attenuation, 3));
        document_put(json, object, "inverse_range2", document_hex((double)light->inverse_range2));
        document_append(json, array, object);
    }
    return array;
}

static json_t *texture_index(uint32_t texture)
{
    return texture ? json_integer((json_int_t)texture - 1) : json_null();
}

static json_t *make_materials(Document *json, const Scene *scene)
{
    static const char *const modes[] = {"OPAQUE", "MASK", "BLEND"};
    json_t *array = json_array();
    for (size_t i = 0; i < scene->material_count; i++) {
        const Material *material = &scene->materials[i];
        json_t *object = json_object();
        document_put(json, object, "name", json_string(material->name));
        document_put(json, object, "base_color", hex(json, material->base_color, 4));
        document_put(json, object, "roughness", document_hex((double)material->roughness));
        document_put(json, object, "metallic", document_hex((double)material->metallic));
        document_put(json, object, "occlusion", document_hex((double)material->occlusion));
        document_put(json, object, "alpha_mode", json_string(modes[material->alpha_mode]));
        document_put(json, object, "alpha_cutoff", document_hex((double)material->alpha_cutoff));
        document_put(json, object, "double_sided", json_boolean(material->double_sided));
        document_put(json, object, "base_color_texture",
                     texture_index(material->base_color_texture));
        document_put(json, object, "metallic_roughness_texture",
                     texture_index(material->metallic_roughness_texture));
        document_append(json, array, object);
    }
    return array;
}

static json_t *make_textures(Document *json, const Scene *scene)
{
    static const char *const wraps[] = {"repeat", "clamp", "mirror"};
    json_t *array = json_array();
    uint64_t offset = 0;
    for (size_t i = 0; i < scene->texture_count; i++) {
        const Texture *texture = &scene->textures[i];
        json_t *object = json_object();
        document_put(json, object, "width", json_integer(texture->width));
        document_put(json, object, "height", json_integer(texture->height));
        document_put(json, object, "offset", document_count(offset));
        document_put(json, object, "wrap_s", json_string(wraps[texture->wrap_s]));
        document_put(json, object, "wrap_t", json_string(wraps[texture->wrap_t]));
        document_put(json, object, "nearest", json_boolean(texture->nearest));
        document_append(json, array, object);
        offset += (uint64_t)texture->width * texture->height * sizeof(float[4]);
    }
    return array;
}

/* Where a mesh begins in the two files. */
typedef struct MeshPlace {
    uint64_t vertex, index;
} MeshPlace;

static MeshPlace place_of(const Scene *scene, uint32_t mesh)
{
    MeshPlace place = {0, 0};
    for (uint32_t i = 0; i < mesh; i++) {
        place.vertex += scene->meshes[i].vertex_count;
        place.index += 3 * (uint64_t)scene->meshes[i].triangle_count;
    }
    return place;
}

static json_t *make_draws(Document *json, const Scene *scene, const View *view)
{
    json_t *array = json_array();
    for (size_t i = 0; i < view->draw_count; i++) {
        const Draw *draw = &view->draws[i];
        MeshPlace place = place_of(scene, draw->mesh);
        json_t *object = json_object();
        document_put(json, object, "name", json_string(scene->instances[draw->instance].name));
        document_put(json, object, "material", json_integer(draw->material));
        document_put(json, object, "first_index", document_count(place.index));
        document_put(json, object, "index_count",
                     document_count(3 * (uint64_t)scene->meshes[draw->mesh].triangle_count));
        document_put(json, object, "base_vertex", document_count(place.vertex));
        document_put(json, object, "first_primitive", json_integer(draw->first_primitive));
        document_put(json, object, "transparent", json_boolean(draw->transparent));
        document_put(json, object, "flipped", json_boolean(draw->flipped));
        document_put(json, object, "cull_back", json_boolean(draw->cull_back));
        document_put(json, object, "masked", json_boolean(draw->masked));
        document_put(json, object, "model_view", hex(json, draw->model_view, 16));
        document_put(json, object, "normal_matrix", hex(json, draw->normal_matrix, 9));
        document_append(json, array, object);
    }
    return array;
}

/* Of those that reports show: not what rendering finds out, or is no business of others. */
static bool is_setting(const char *name)
{
    static const char *const others[] = {"Size", "Peels", "Arithmetic", "Tolerance"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (strcmp(name, others[i]) == 0)
            return false;
    return true;
}

static json_t *make_settings(Document *json, const ContractDesc *contract)
{
    Threeway head = {.desc = contract->desc,
                     .light_count = contract->scene->light_count,
                     .seed_profile = render_desc_is_seed(&contract->desc)};
    SummarySetting settings[SUMMARY_SETTINGS];
    int count = summary_settings(&head, settings);
    json_t *object = json_object();
    for (int i = 0; i < count; i++)
        if (is_setting(settings[i].name))
            document_put(json, object, settings[i].name, json_string(settings[i].value));
    return object;
}

static json_t *make_depth(Document *json, const RenderDesc *desc)
{
    static const char *const ranges[] = {"gl", "zero-one", "reversed"};
    bool reversed = desc->depth_range == DEPTH_RANGE_REVERSED;
    json_t *object = json_object();
    document_put(json, object, "range", json_string(ranges[desc->depth_range]));
    document_put(json, object, "clip_z",
                 json_string(desc->depth_range == DEPTH_RANGE_GL ? "-w to w" : "0 to w"));
    document_put(json, object, "near", json_integer(reversed ? 1 : 0));
    document_put(json, object, "clear", json_integer(reversed ? 0 : 1));
    document_put(json, object, "format", json_string(format_info(render_desc_depth(desc))->name));
    return object;
}

static void put_scene(Document *json, json_t *root, const ContractDesc *contract, const View *view)
{
    const Scene *scene = contract->scene;
    json_t *camera = json_object();
    document_put(json, camera, "name", json_string(scene->cameras[contract->desc.camera].name));
    document_put(json, camera, "world_to_camera", hex(json, view->world_to_camera, 16));
    document_put(json, camera, "projection", hex(json, view->projection, 16));
    document_put(json, root, "camera", camera);
    document_put(json, root, "depth", make_depth(json, &contract->desc));
    document_put(json, root, "background", hex(json, view->background, 3));
    document_put(json, root, "ambient", hex(json, view->ambient, 3));
    document_put(json, root, "lights", make_lights(json, view));
    document_put(json, root, "materials", make_materials(json, scene));
    document_put(json, root, "textures", make_textures(json, scene));
    document_put(json, root, "draws", make_draws(json, scene, view));
}

static Result write_json(const ContractDesc *contract, const View *view, const char *path)
{
    Document json = {0};
    json_t *root = json_object();
    document_put(&json, root, "contract", json_integer(1));
    document_put(&json, root, "scene", json_string(contract->name));
    document_put(&json, root, "width", json_integer(view->width));
    document_put(&json, root, "height", json_integer(view->height));
    document_put(&json, root, "passes", json_integer(contract->desc.passes));
    document_put(&json, root, "check", document_string(contract->check));
    document_put(&json, root, "settings", make_settings(&json, contract));
    put_scene(&json, root, contract, view);
    return document_write(&json, root, path);
}

/* ---- binary files -----------------------------------------------------------------------------
 */

static Result write_vertices(const Scene *scene, FileWriter *writer)
{
    Result result = RESULT_OK;
    for (size_t m = 0; m < scene->mesh_count; m++) {
        const Mesh *mesh = &scene->meshes[m];
        for (size_t v = 0; v < mesh->vertex_count && result == RESULT_OK; v++) {
            float vertex[8] = {0.0f};
            memcpy(vertex, mesh->position + 3 * v, sizeof(float[3]));
            memcpy(vertex + 3, mesh->normal + 3 * v, sizeof(float[3]));
            if (mesh->uv)
                memcpy(vertex + 6, mesh->uv + 2 * v, sizeof(float[2]));
            result = file_writer_put(writer, vertex, sizeof vertex);
        }
    }
    return result;
}

static Result write_indices(const Scene *scene, FileWriter *writer)
{
    Result result = RESULT_OK;
    for (size_t m = 0; m < scene->mesh_count; m++) {
        const Mesh *mesh = &scene->meshes[m];
        result = file_writer_put(writer, mesh->index, mesh->triangle_count * sizeof(uint32_t[3]));
    }
    return result;
}

static Result write_textures(const Scene *scene, FileWriter *writer)
{
    Result result = RESULT_OK;
    for (size_t i = 0; i < scene->texture_count; i++) {
        const Texture *texture = &scene->textures[i];
        result = file_writer_put(writer, texture->texels,
                                 (size_t)texture->width * texture->height * sizeof(float[4]));
    }
    return result;
}

static Result write_binary(const Scene *scene, Result (*body)(const Scene *, FileWriter *),
                           const char *path)
{
    FileWriter writer;
    Result result = file_writer_open(path, &writer);
    if (result != RESULT_OK)
        return result;
    body(scene, &writer);
    return file_writer_close(&writer, true);
}

/* ---- the folder -------------------------------------------------------------------------------
 */

static Result write_glsl(const ContractDesc *contract, size_t light_count, const char *path)
{
    FileWriter writer;
    Result result = file_writer_open(path, &writer);
    if (result != RESULT_OK)
        return result;
    file_writer_print(&writer,
                      "// Behind your #version, 420 or later. Lights: an array of three vec4 each "
                      "(position; color;\n// attenuation and inverse_range2) in uniform block "
                      "binding 0.\n%s#define LIGHT_COUNT %zu\n%s%s",
                      contract->glsl_constants, light_count,
                      light_count > 341 ? "#define LIGHTS_STORAGE\n" : "",
                      "#define LIGHT_RANGES\n");
    if (contract->desc.shading == SHADING_PHONG)
        file_writer_print(&writer, "#define PHONG\n");
    if (contract->desc.ggx == GGX_STABLE)
        file_writer_print(&writer, "#define GGX_STABLE\n");
    if (contract->desc.back_light)
        file_writer_print(&writer, "// For transparent surfaces, not opaque ones:\n"
                                   "// #define BACK_LIGHT\n");
    file_writer_print(&writer, "\n");
    file_writer_put(&writer, contract->glsl_shade, strlen(contract->glsl_shade));
    return file_writer_close(&writer, true);
}

static Result write_file(const ContractDesc *contract, const View *view, const char *name,
                         const char *path)
{
    const Scene *scene = contract->scene;
    if (strcmp(name, "contract.json") == 0)
        return write_json(contract, view, path);
    if (strcmp(name, "vertices.bin") == 0)
        return write_binary(scene, write_vertices, path);
    if (strcmp(name, "indices.bin") == 0)
        return write_binary(scene, write_indices, path);
    if (strcmp(name, "textures.bin") == 0)
        return scene->texture_count ? write_binary(scene, write_textures, path) : RESULT_OK;
    if (strcmp(name, "shade.glsl") == 0)
        return write_glsl(contract, view->light_count, path);
    if (strcmp(name, "peel_shade.h") == 0)
        return file_write(path, contract_peel_shade_h, strlen(contract_peel_shade_h));
    if (strcmp(name, "peel_dump.h") == 0)
        return file_write(path, contract_peel_dump_h, strlen(contract_peel_dump_h));
    return report_contract_page(path);
}

/* The contract is about the scene as it is read back: a file has matrices in single precision. */
static Result reload(const ContractDesc *contract, const char *dir, Scene *out)
{
    char *path = pictures_path(dir, "scene.gltf");
    Result result = path ? gltf_write(contract->scene, path) : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = gltf_child_load(path, contract->desc.max_memory, out);
    free(path);
    return result;
}

/* Before anything is written: the folder may be that of the scene, or of its buffers. */
static Result check_kept(const char *dir, const char *name)
{
    char *path = pictures_path(dir, name);
    Result result = path ? file_check_kept(path) : RESULT_NO_MEMORY;
    free(path);
    return result;
}

Result report_contract_write(const ContractDesc *contract, const char *dir)
{
    static const char *const names[] = {"contract.json", "vertices.bin", "indices.bin",
                                        "textures.bin",  "shade.glsl",   "peel_shade.h",
                                        "peel_dump.h",   "index.html"};
    Scene scene = {0};
    View view = {0};
    ContractDesc reloaded = *contract;
    reloaded.scene = &scene;
    Result result = check_kept(dir, "scene.gltf");
    for (size_t i = 0; i < sizeof names / sizeof names[0] && result == RESULT_OK; i++)
        result = check_kept(dir, names[i]);
    if (result == RESULT_OK)
        result = reload(contract, dir, &scene);
    if (result == RESULT_OK)
        result = view_build(&scene, &contract->desc, &view);
    for (size_t i = 0; i < sizeof names / sizeof names[0] && result == RESULT_OK; i++) {
        char *path = pictures_path(dir, names[i]);
        result = path ? write_file(&reloaded, &view, names[i], path) : RESULT_NO_MEMORY;
        free(path);
    }
    view_free(&view);
    scene_free(&scene);
    return result;
}
