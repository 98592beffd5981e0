#include "scene/blob.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

static const char magic[8] = {'P', 'E', 'E', 'L', 'S', 'C', 'N', '1'};

enum {
    PALETTE_MAX = 256
};

/* ---- writing ---- */

typedef struct Out {
    unsigned char *bytes;
    size_t count, room;
    Result result; /* the first failure; later calls do nothing */
} Out;

static void put(Out *out, const void *data, size_t size)
{
    void *array = out->bytes;
    if (out->result == RESULT_OK)
        out->result = memory_grow(&array, &out->room, out->count + size, 1);
    if (out->result != RESULT_OK)
        return;
    out->bytes = array;
    memcpy(out->bytes + out->count, data, size);
    out->count += size;
}

static void put_u32(Out *out, size_t value)
{
    uint32_t word = (uint32_t)value;
    put(out, &word, sizeof word);
}

static void put_floats(Out *out, const float *values, size_t count)
{
    put(out, values, count * sizeof *values);
}

static void put_doubles(Out *out, const double *values, size_t count)
{
    put(out, values, count * sizeof *values);
}

static void put_string(Out *out, const char *text)
{
    put_u32(out, strlen(text));
    put(out, text, strlen(text));
}

static void put_mesh(Out *out, const Mesh *mesh)
{
    put_u32(out, mesh->vertex_count);
    put_u32(out, mesh->triangle_count);
    put_u32(out, mesh->uv != NULL);
    put_floats(out, mesh->position, 3 * (size_t)mesh->vertex_count);
    put_floats(out, mesh->normal, 3 * (size_t)mesh->vertex_count);
    if (mesh->uv)
        put_floats(out, mesh->uv, 2 * (size_t)mesh->vertex_count);
    put(out, mesh->index, 3 * (size_t)mesh->triangle_count * sizeof *mesh->index);
}

/* The place of a value in the palette, by its bits; a new one is appended. PALETTE_MAX where there
 * is no room. */
static int palette_place(float palette[PALETTE_MAX], int *count, float value)
{
    for (int i = 0; i < *count; i++)
        if (memcmp(&palette[i], &value, sizeof value) == 0)
            return i;
    if (*count < PALETTE_MAX)
        palette[*count] = value;
    return *count < PALETTE_MAX ? (*count)++ : PALETTE_MAX;
}

static void put_channel(Out *out, const Texture *texture, int channel)
{
    size_t texels = (size_t)texture->width * texture->height;
    float palette[PALETTE_MAX];
    int count = 0, place = 0;
    unsigned char *codes = memory_array(texels, 1);
    if (!codes) {
        out->result = RESULT_NO_MEMORY;
        return;
    }
    for (size_t i = 0; i < texels && place < PALETTE_MAX; i++) {
        float value = texture->texels[4 * i + (size_t)channel];
        /* Neighbours are often equal. */
        if (i == 0 || memcmp(&value, &palette[place], sizeof value) != 0)
            place = palette_place(palette, &count, value);
        codes[i] = (unsigned char)place;
    }
    bool fits = place < PALETTE_MAX;
    put_u32(out, fits ? (size_t)count : 0);
    if (fits) {
        put_floats(out, palette, (size_t)count);
        put(out, codes, texels);
    }
    for (size_t i = 0; i < texels && !fits; i++)
        put_floats(out, &texture->texels[4 * i + (size_t)channel], 1);
    free(codes);
}

static void put_texture(Out *out, const Texture *texture)
{
    put_u32(out, texture->width);
    put_u32(out, texture->height);
    put_u32(out, texture->wrap_s);
    put_u32(out, texture->wrap_t);
    put_u32(out, texture->nearest);
    for (int channel = 0; channel < 4; channel++)
        put_channel(out, texture, channel);
}

static void put_material(Out *out, const Material *material)
{
    put_string(out, material->name);
    put_floats(out, material->base_color, 4);
    put_floats(out, &material->roughness, 1);
    put_floats(out, &material->metallic, 1);
    put_floats(out, &material->occlusion, 1);
    put_floats(out, &material->alpha_cutoff, 1);
    put_u32(out, material->alpha_mode);
    put_u32(out, material->double_sided);
    put_u32(out, material->base_color_texture);
    put_u32(out, material->metallic_roughness_texture);
}

static void put_camera(Out *out, const Camera *camera)
{
    put_string(out, camera->name);
    put(out, &camera->world, sizeof camera->world);
    put_doubles(out, (const double[]){camera->yfov, camera->near, camera->far}, 3);
}

static void put_light(Out *out, const Light *light)
{
    put_doubles(out, light->position, 3);
    put_floats(out, light->color, 3);
    put_floats(out, light->attenuation, 3);
    put_floats(out, &light->range, 1);
}

Result blob_write(const Scene *scene, unsigned char **bytes, size_t *count)
{
    Out out = {0};
    put(&out, magic, sizeof magic);
    put_string(&out, scene->name);
    put_floats(&out, scene->ambient, 3);
    put_floats(&out, scene->background, 3);
    put_doubles(&out, &scene->light_degrees_per_second, 1);
    const size_t counts[] = {scene->mesh_count,     scene->texture_count, scene->material_count,
                             scene->instance_count, scene->light_count,   scene->camera_count};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        put_u32(&out, counts[i]);
    for (size_t i = 0; i < scene->mesh_count; i++)
        put_mesh(&out, &scene->meshes[i]);
    for (size_t i = 0; i < scene->texture_count; i++)
        put_texture(&out, &scene->textures[i]);
    for (size_t i = 0; i < scene->material_count; i++)
        put_material(&out, &scene->materials[i]);
    for (size_t i = 0; i < scene->instance_count; i++) {
        put_string(&out, scene->instances[i].name);
        put_u32(&out, scene->instances[i].mesh);
        put_u32(&out, scene->instances[i].material);
        put(&out, &scene->instances[i].world, sizeof scene->instances[i].world);
    }
    for (size_t i = 0; i < scene->light_count; i++)
        put_light(&out, &scene->lights[i]);
    for (size_t i = 0; i < scene->camera_count; i++)
        put_camera(&out, &scene->cameras[i]);
    if (out.result != RESULT_OK) {
        free(out.bytes);
        return out.result;
    }
    *bytes = out.bytes;
    *count = out.count;
    return RESULT_OK;
}

/* ---- reading ---- */

typedef struct In {
    const unsigned char *at, *end;
    Result result;
} In;

static void fail(In *in)
{
    if (in->result == RESULT_OK)
        in->result =
            result_fail(RESULT_BAD_INPUT, "scene bytes: expected what this version writes");
    in->at = in->end;
}

static void get(In *in, void *data, size_t size)
{
    if (size > (size_t)(in->end - in->at)) {
        memset(data, 0, size);
        fail(in);
        return;
    }
    memcpy(data, in->at, size);
    in->at += size;
}

static uint32_t get_u32(In *in)
{
    uint32_t word;
    get(in, &word, sizeof word);
    return word;
}

/* A count of elements that take so many bytes each, at least; 0 after a failure. */
static size_t get_count(In *in, size_t element_bytes)
{
    size_t count = get_u32(in);
    if (count <= (size_t)(in->end - in->at) / element_bytes)
        return count;
    fail(in);
    return 0;
}

/* An array of its own; NULL after a failure. */
static void *get_array(In *in, size_t count, size_t size)
{
    if (count > (size_t)(in->end - in->at) / size) {
        fail(in);
        return NULL;
    }
    void *array = memory_array(count, size);
    if (array)
        get(in, array, count * size);
    else if (in->result == RESULT_OK)
        in->result = RESULT_NO_MEMORY;
    return array;
}

static char *get_string(In *in)
{
    size_t length = get_count(in, 1);
    char *text = memory_array(length + 1, 1);
    if (text)
        get(in, text, length);
    else if (in->result == RESULT_OK)
        in->result = RESULT_NO_MEMORY;
    return text;
}

/* A zeroed array to be filled. */
static void *make_array(In *in, size_t count, size_t size)
{
    void *array = memory_array(count, size);
    if (!array && in->result == RESULT_OK)
        in->result = RESULT_NO_MEMORY;
    return in->result == RESULT_OK ? array : (free(array), NULL);
}

static void get_mesh(In *in, Mesh *mesh)
{
    mesh->vertex_count = get_u32(in);
    mesh->triangle_count = get_u32(in);
    bool uv = get_u32(in);
    size_t vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    mesh->position = get_array(in, vertices, 3 * sizeof(float));
    mesh->normal = get_array(in, vertices, 3 * sizeof(float));
    if (uv)
        mesh->uv = get_array(in, vertices, 2 * sizeof(float));
    mesh->index = get_array(in, triangles, 3 * sizeof(uint32_t));
}

static void get_channel(In *in, Texture *texture, int channel)
{
    size_t texels = (size_t)texture->width * texture->height;
    float palette[PALETTE_MAX] = {0};
    uint32_t count = get_u32(in);
    if (count > PALETTE_MAX)
        fail(in);
    else
        get(in, palette, count * sizeof *palette);
    for (size_t i = 0; i < texels && in->result == RESULT_OK; i++) {
        unsigned char code = 0;
        float value = 0.0f;
        if (count)
            get(in, &code, 1);
        else
            get(in, &value, sizeof value);
        texture->texels[4 * i + (size_t)channel] = count ? palette[code] : value;
    }
}

static void get_texture(In *in, Texture *texture)
{
    texture->width = get_u32(in);
    texture->height = get_u32(in);
    texture->wrap_s = (TextureWrap)get_u32(in);
    texture->wrap_t = (TextureWrap)get_u32(in);
    texture->nearest = get_u32(in);
    uint64_t texels = (uint64_t)texture->width * texture->height;
    if (texture->wrap_s > WRAP_MIRROR || texture->wrap_t > WRAP_MIRROR ||
        texels > (uint64_t)(in->end - in->at)) {
        fail(in);
        return;
    }
    texture->texels = make_array(in, (size_t)texels, 4 * sizeof(float));
    for (int channel = 0; channel < 4 && texture->texels; channel++)
        get_channel(in, texture, channel);
}

static void get_material(In *in, Material *material)
{
    material->name = get_string(in);
    get(in, material->base_color, sizeof material->base_color);
    get(in, &material->roughness, sizeof material->roughness);
    get(in, &material->metallic, sizeof material->metallic);
    get(in, &material->occlusion, sizeof material->occlusion);
    get(in, &material->alpha_cutoff, sizeof material->alpha_cutoff);
    material->alpha_mode = (AlphaMode)get_u32(in);
    material->double_sided = get_u32(in);
    material->base_color_texture = get_u32(in);
    material->metallic_roughness_texture = get_u32(in);
}

static void get_camera(In *in, Camera *camera)
{
    double lens[3];
    camera->name = get_string(in);
    get(in, &camera->world, sizeof camera->world);
    get(in, lens, sizeof lens);
    camera->yfov = lens[0];
    camera->near = lens[1];
    camera->far = lens[2];
}

static void get_light(In *in, Light *light)
{
    get(in, light->position, sizeof light->position);
    get(in, light->color, sizeof light->color);
    get(in, light->attenuation, sizeof light->attenuation);
    get(in, &light->range, sizeof light->range);
}

/* Every array as long as its count says, however early a failure comes: scene_free walks them. */
static void get_arrays(In *in, Scene *scene)
{
    size_t counts[6];
    for (int i = 0; i < 6; i++)
        counts[i] = get_count(in, 1);
    if ((scene->meshes = make_array(in, counts[0], sizeof *scene->meshes)))
        scene->mesh_count = counts[0];
    if ((scene->textures = make_array(in, counts[1], sizeof *scene->textures)))
        scene->texture_count = counts[1];
    if ((scene->materials = make_array(in, counts[2], sizeof *scene->materials)))
        scene->material_count = counts[2];
    if ((scene->instances = make_array(in, counts[3], sizeof *scene->instances)))
        scene->instance_count = counts[3];
    if ((scene->lights = make_array(in, counts[4], sizeof *scene->lights)))
        scene->light_count = counts[4];
    if ((scene->cameras = make_array(in, counts[5], sizeof *scene->cameras)))
        scene->camera_count = counts[5];
    for (size_t i = 0; i < scene->mesh_count; i++)
        get_mesh(in, &scene->meshes[i]);
    for (size_t i = 0; i < scene->texture_count; i++)
        get_texture(in, &scene->textures[i]);
    for (size_t i = 0; i < scene->material_count; i++)
        get_material(in, &scene->materials[i]);
    for (size_t i = 0; i < scene->instance_count; i++) {
        scene->instances[i].name = get_string(in);
        scene->instances[i].mesh = get_u32(in);
        scene->instances[i].material = get_u32(in);
        get(in, &scene->instances[i].world, sizeof scene->instances[i].world);
    }
    for (size_t i = 0; i < scene->light_count; i++)
        get_light(in, &scene->lights[i]);
    for (size_t i = 0; i < scene->camera_count; i++)
        get_camera(in, &scene->cameras[i]);
}

Result blob_read(const unsigned char *bytes, size_t count, Scene *out)
{
    In in = {bytes, bytes + count, RESULT_OK};
    char head[sizeof magic];
    *out = (Scene){0};
    get(&in, head, sizeof head);
    if (memcmp(head, magic, sizeof magic) != 0)
        fail(&in);
    out->name = get_string(&in);
    get(&in, out->ambient, sizeof out->ambient);
    get(&in, out->background, sizeof out->background);
    get(&in, &out->light_degrees_per_second, sizeof out->light_degrees_per_second);
    get_arrays(&in, out);
    if (in.result == RESULT_OK && in.at != in.end)
        fail(&in);
    Result result = in.result == RESULT_OK ? scene_validate(out) : in.result;
    if (result != RESULT_OK)
        scene_free(out);
    return result;
}
