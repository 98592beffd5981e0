#include "scene/gltf_texture_write.h"

#include "base/memory.h"
#include "image/png.h"
#include "scene/gltf_file.h"
#include "scene/gltf_json.h"
#include "scene/texture.h"

#include <stdio.h>
#include <stdlib.h>

void gltf_texture_write_free(GltfTextureArrays *arrays)
{
    json_decref(arrays->images);
    json_decref(arrays->samplers);
    json_decref(arrays->textures);
    free(arrays->index[TEXTURE_LINEAR]);
    free(arrays->index[TEXTURE_SRGB]);
    *arrays = (GltfTextureArrays){0};
}

/* The texture as a data uri; the caller frees it. */
static Result encode(const Scene *scene, const char *path, size_t number, TextureEncoding encoding,
                     char **out)
{
    char label[512];
    unsigned char *bytes = NULL;
    size_t count = 0;
    bool exact;
    Image image;
    snprintf(label, sizeof label, "%s: texture %zu", path, number);
    Result result = texture_to_image(&scene->textures[number], encoding, &image, &exact);
    if (!result && !exact)
        result_warn("%s: rounded to 8 bits", label);
    if (!result)
        result = png_encode(&image, label, &bytes, &count);
    image_free(&image);
    *out = result ? NULL : gltf_file_data_uri("image/png", bytes, count);
    free(bytes);
    return result || *out ? result : RESULT_NO_MEMORY;
}

/* Packs an object and appends it; jansson fails only without memory. */
static Result append(json_t *array, json_t *object)
{
    return json_array_append_new(array, object)
               ? result_fail(RESULT_NO_MEMORY, "out of memory: JSON of a texture")
               : RESULT_OK;
}

static Result add(GltfTextureArrays *arrays, const Scene *scene, const char *path, size_t number,
                  TextureEncoding encoding)
{
    static const int wraps[] = {SAMPLER_REPEAT, SAMPLER_CLAMP, SAMPLER_MIRROR};
    const Texture *texture = &scene->textures[number];
    int filter = texture->nearest ? FILTER_NEAREST : FILTER_LINEAR;
    json_int_t index = (json_int_t)json_array_size(arrays->textures);
    char *uri;
    Result result = encode(scene, path, number, encoding, &uri);
    if (!result)
        result = append(arrays->images, json_pack("{ss}", "uri", uri));
    if (!result)
        result = append(arrays->samplers,
                        json_pack("{sisisisi}", "magFilter", filter, "minFilter", filter, "wrapS",
                                  wraps[texture->wrap_s], "wrapT", wraps[texture->wrap_t]));
    if (!result)
        result = append(arrays->textures, json_pack("{sIsI}", "sampler", index, "source", index));
    free(uri);
    arrays->index[encoding][number] = (uint32_t)index + 1;
    return result;
}

Result gltf_texture_write(const Scene *scene, const char *path, GltfTextureArrays *out)
{
    *out = (GltfTextureArrays){json_array(), json_array(), json_array(), {NULL, NULL}};
    for (int e = 0; e < 2; e++) {
        out->index[e] = memory_array(scene->texture_count, sizeof *out->index[e]);
        if (!out->index[e])
            return RESULT_NO_MEMORY;
    }
    Result result = RESULT_OK;
    for (size_t i = 0; !result && i < scene->material_count; i++) {
        const Material *material = &scene->materials[i];
        const uint32_t used[2] = {[TEXTURE_LINEAR] = material->metallic_roughness_texture,
                                  [TEXTURE_SRGB] = material->base_color_texture};
        for (int e = 0; !result && e < 2; e++)
            if (used[e] && !out->index[e][used[e] - 1])
                result = add(out, scene, path, used[e] - 1, (TextureEncoding)e);
    }
    return result;
}
