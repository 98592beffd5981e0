#include "scene/gltf_texture.h"

#include "base/memory.h"
#include "image/decode.h"
#include "scene/gltf_surface.h"

#include <stdio.h>
#include <stdlib.h>

void gltf_texture_free(GltfTextures *textures)
{
    free(textures->keys);
    *textures = (GltfTextures){0};
}

static TextureWrap wrap_of(const json_t *sampler, const char *key)
{
    switch (gltf_json_index(sampler, key, SAMPLER_REPEAT)) {
    case SAMPLER_CLAMP:
        return WRAP_CLAMP;
    case SAMPLER_MIRROR:
        return WRAP_MIRROR;
    default:
        return WRAP_REPEAT;
    }
}

static GltfTextureKey key_of(const GltfJson *json, const json_t *info, TextureEncoding encoding)
{
    const json_t *texture = gltf_json_element(json, "textures", gltf_json_index(info, "index", 0));
    const json_t *sampler =
        gltf_json_element(json, "samplers", gltf_json_index(texture, "sampler", SIZE_MAX));
    size_t filter =
        gltf_json_index(sampler, "magFilter", gltf_json_index(sampler, "minFilter", FILTER_LINEAR));
    return (GltfTextureKey){.image = gltf_json_index(texture, "source", 0),
                            .encoding = encoding,
                            .wrap_s = wrap_of(sampler, "wrapS"),
                            .wrap_t = wrap_of(sampler, "wrapT"),
                            .nearest = filter == FILTER_NEAREST};
}

/* span: the image's file. */
static Result decode(GltfTextures *textures, const GltfTextureKey *key, const GltfSpan *span,
                     Texture *out)
{
    char label[512];
    int width, height, channels;
    Image image;
    snprintf(label, sizeof label, "%s: image %zu", textures->bytes->path, key->image);
    Result result = decode_size(span->bytes, span->count, label, &width, &height, &channels);
    if (result)
        return result;
    textures->texels += (uint64_t)width * (uint64_t)height;
    if (textures->texels > GLTF_TEXTURE_MAX_TEXELS)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: %dx%d texels on top of the others, expected at most 2^28 in all "
                           "textures",
                           label, width, height);
    result = decode_image(span->bytes, span->count, label, &image);
    if (!result)
        result = texture_from_image(&image, key->encoding, out);
    image_free(&image);
    out->wrap_s = key->wrap_s;
    out->wrap_t = key->wrap_t;
    out->nearest = key->nearest;
    return result;
}

uint32_t gltf_texture_add(GltfTextures *textures, Builder *builder, const json_t *info,
                          TextureEncoding encoding)
{
    if (!info || builder->result)
        return 0;
    GltfTextureKey key = key_of(textures->bytes->json, info, encoding);
    for (size_t i = 0; i < textures->key_count; i++) {
        const GltfTextureKey *known = &textures->keys[i];
        if (known->image == key.image && known->encoding == key.encoding &&
            known->wrap_s == key.wrap_s && known->wrap_t == key.wrap_t &&
            known->nearest == key.nearest)
            return known->texture;
    }
    void *keys = textures->keys;
    builder->result = memory_grow(&keys, &textures->key_room, textures->key_count + 1, sizeof key);
    if (builder->result)
        return 0;
    textures->keys = keys;
    GltfSpan span;
    Texture texture = {0};
    Result made = gltf_bytes_image(textures->bytes, key.image, &span);
    if (!made)
        made = decode(textures, &key, &span, &texture);
    free(span.owned);
    key.texture = builder_texture(builder, made, &texture);
    textures->keys[textures->key_count++] = key;
    return key.texture;
}
