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

/* The texture as a PNG file; the caller frees *bytes. */
static Result encode(const Scene *scene, const char *path, size_t number, TextureEncoding encoding,
                     unsigned char **bytes, size_t *count)
{
    char label[512];
    bool exact;
    Image image;
    snprintf(label, sizeof label, "%s: texture %zu", path, number);
    Result result = texture_to_image(&scene->textures[number], encoding, &image, &exact);
    if (!result && !exact)
        result_warn("%s: rounded to 8 bits", label);
    if (!result)
        result = png_encode(&image, label, bytes, count);
    image_free(&image);
    return result;
}

/* Takes over object; jansson fails only without memory. */
static Result append(json_t *array, json_t *object)
{
    return json_array_append_new(array, object)
               ? result_fail(RESULT_NO_MEMORY, "out of memory: JSON of a texture")
               : RESULT_OK;
}

static Result add_image(json_t *images, const GltfImageSink *sink, const unsigned char *bytes,
                        size_t count)
{
    size_t view = 0;
    if (sink->put) {
        Result result = sink->put(sink->context, bytes, count, &view);
        return result ? result
                      : append(images, json_pack("{sIss}", "bufferView", (json_int_t)view,
                                                 "mimeType", "image/png"));
    }
    char *uri = gltf_file_data_uri("image/png", bytes, count);
    Result result = uri ? append(images, json_pack("{ss}", "uri", uri)) : RESULT_NO_MEMORY;
    free(uri);
    return result;
}

static Result add_sampler(json_t *samplers, const Texture *texture)
{
    static const int wraps[] = {SAMPLER_REPEAT, SAMPLER_CLAMP, SAMPLER_MIRROR};
    int filter = texture->nearest ? FILTER_NEAREST : FILTER_LINEAR;
    return append(samplers,
                  json_pack("{sisisisi}", "magFilter", filter, "minFilter", filter, "wrapS",
                            wraps[texture->wrap_s], "wrapT", wraps[texture->wrap_t]));
}

/* What writing textures needs throughout. */
typedef struct TextureWriter {
    const Scene *scene;
    const char *path;
    const GltfImageSink *sink;
    GltfTextureArrays *out;
} TextureWriter;

static Result add(const TextureWriter *writer, size_t number, TextureEncoding encoding)
{
    GltfTextureArrays *out = writer->out;
    json_int_t index = (json_int_t)json_array_size(out->textures);
    unsigned char *bytes = NULL;
    size_t count = 0;
    Result result = encode(writer->scene, writer->path, number, encoding, &bytes, &count);
    if (!result)
        result = add_image(out->images, writer->sink, bytes, count);
    free(bytes);
    if (!result)
        result = add_sampler(out->samplers, &writer->scene->textures[number]);
    if (!result)
        result = append(out->textures, json_pack("{sIsI}", "sampler", index, "source", index));
    out->index[encoding][number] = (uint32_t)index + 1;
    return result;
}

Result gltf_texture_write(const Scene *scene, const char *path, const GltfImageSink *sink,
                          GltfTextureArrays *out)
{
    const TextureWriter writer = {scene, path, sink, out};
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
                result = add(&writer, used[e] - 1, (TextureEncoding)e);
    }
    return result;
}
