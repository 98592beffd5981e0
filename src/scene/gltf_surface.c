#include "scene/gltf_surface.h"

#include <stdio.h>
#include <string.h>

#define BASE_COLOR         "baseColorTexture"
#define METALLIC_ROUGHNESS "metallicRoughnessTexture"

/* ---- which textures are used ---------------------------------------------------------------- */

/* The texture info, if its texture has an image. */
static const json_t *usable(const GltfJson *json, const json_t *material, const char *key)
{
    const json_t *info = json_object_get(json_object_get(material, "pbrMetallicRoughness"), key);
    const json_t *texture =
        gltf_json_element(json, "textures", gltf_json_index(info, "index", SIZE_MAX));
    return json_object_get(texture, "source") ? info : NULL;
}

const json_t *gltf_surface_texture(const GltfJson *json, const json_t *material, const char *key)
{
    const json_t *info = usable(json, material, key);
    const json_t *base = usable(json, material, BASE_COLOR);
    if (info && base &&
        gltf_json_index(info, "texCoord", 0) != gltf_json_index(base, "texCoord", 0))
        return NULL;
    return info;
}

bool gltf_surface_uv_name(const GltfJson *json, const json_t *primitive, char out[UV_NAME_SIZE])
{
    const json_t *material =
        gltf_json_element(json, "materials", gltf_json_index(primitive, "material", SIZE_MAX));
    const json_t *info = usable(json, material, BASE_COLOR);
    if (!info)
        info = usable(json, material, METALLIC_ROUGHNESS);
    snprintf(out, UV_NAME_SIZE, "TEXCOORD_%zu", gltf_json_index(info, "texCoord", 0));
    return info != NULL;
}

/* ---- checks --------------------------------------------------------------------------------- */

static bool positive(const json_t *numbers)
{
    const json_t *number;
    size_t i;
    json_array_foreach(numbers, i, number)
    {
        if (json_number_value(number) > 0.0)
            return true;
    }
    return false;
}

static Result check_images(const GltfCheck *check)
{
    const json_t *image;
    size_t i;
    json_array_foreach(gltf_array(check, "images"), i, image)
    {
        const json_t *uri = json_object_get(image, "uri");
        const json_t *view = json_object_get(image, "bufferView");
        const json_t *type = json_object_get(image, "mimeType");
        if (!uri == !view || (uri && !json_is_string(uri)) ||
            !gltf_valid_index(view, gltf_count(check, "bufferViews")))
            return gltf_fail(check, "image", i, "a string as its uri, or a bufferView that exists");
        if (type && !json_is_string(type))
            return gltf_fail(check, "image", i, "a string as its mimeType");
    }
    return RESULT_OK;
}

/* Absent, or one of the first values that are not 0. */
static bool one_of(const json_t *value, const int allowed[6])
{
    for (int i = 0; value && i < 6 && allowed[i]; i++)
        if (json_is_integer(value) && json_integer_value(value) == allowed[i])
            return true;
    return !value;
}

static Result check_samplers(const GltfCheck *check)
{
    static const int wraps[6] = {SAMPLER_REPEAT, SAMPLER_CLAMP, SAMPLER_MIRROR};
    static const int magnify[6] = {FILTER_NEAREST, FILTER_LINEAR};
    static const int minify[6] = {FILTER_NEAREST, FILTER_LINEAR, 9984, 9985, 9986, 9987};
    const json_t *sampler;
    size_t i;
    json_array_foreach(gltf_array(check, "samplers"), i, sampler)
    {
        if (!one_of(json_object_get(sampler, "wrapS"), wraps) ||
            !one_of(json_object_get(sampler, "wrapT"), wraps))
            return gltf_fail(check, "sampler", i, "wrapS and wrapT of 10497, 33071 or 33648");
        if (!one_of(json_object_get(sampler, "magFilter"), magnify))
            return gltf_fail(check, "sampler", i, "a magFilter of 9728 or 9729");
        if (!one_of(json_object_get(sampler, "minFilter"), minify))
            return gltf_fail(check, "sampler", i, "a minFilter of 9728, 9729 or 9984 to 9987");
    }
    return RESULT_OK;
}

static Result check_textures(const GltfCheck *check)
{
    const json_t *texture;
    size_t i;
    json_array_foreach(gltf_array(check, "textures"), i, texture)
    {
        if (!gltf_valid_index(json_object_get(texture, "source"), gltf_count(check, "images")))
            return gltf_fail(check, "texture", i, "a source that exists");
        if (!gltf_valid_index(json_object_get(texture, "sampler"), gltf_count(check, "samplers")))
            return gltf_fail(check, "texture", i, "a sampler that exists");
    }
    return RESULT_OK;
}

static Result check_info(const GltfCheck *check, size_t material, const char *key)
{
    const json_t *from = gltf_json_element(check->json, "materials", material);
    const json_t *info = json_object_get(json_object_get(from, "pbrMetallicRoughness"), key);
    if (!info)
        return RESULT_OK;
    if (!json_is_object(info) || !gltf_required_index(info, "index", gltf_count(check, "textures")))
        return gltf_fail(check, "material", material, "textures that exist");
    if (!gltf_valid_index(json_object_get(info, "texCoord"), UINT32_MAX))
        return gltf_fail(check, "material", material, "an integer from 0 as every texCoord");
    if (json_object_get(json_object_get(info, "extensions"), "KHR_texture_transform"))
        gltf_note(check, NOTE_TEXTURE_TRANSFORMS);
    if (!usable(check->json, from, key))
        gltf_note(check, NOTE_IMAGES);
    else if (!gltf_surface_texture(check->json, from, key))
        gltf_note(check, NOTE_UVS);
    return RESULT_OK;
}

/* mode: NULL where it is no string. */
static bool is_alpha_mode(const char *mode)
{
    return mode &&
           (strcmp(mode, "OPAQUE") == 0 || strcmp(mode, "MASK") == 0 || strcmp(mode, "BLEND") == 0);
}

/* Of what is modelled: a member of another type would count as absent. */
static Result check_types(const GltfCheck *check, size_t index, const json_t *material)
{
    const json_t *factors = json_object_get(material, "pbrMetallicRoughness");
    const json_t *mode = json_object_get(material, "alphaMode");
    const json_t *sided = json_object_get(material, "doubleSided");
    const json_t *numbers[] = {json_object_get(material, "alphaCutoff"),
                               json_object_get(factors, "metallicFactor"),
                               json_object_get(factors, "roughnessFactor")};
    if (factors && !json_is_object(factors))
        return gltf_fail(check, "material", index, "an object as its pbrMetallicRoughness");
    if (mode && !is_alpha_mode(json_string_value(mode)))
        return gltf_fail(check, "material", index, "OPAQUE, MASK or BLEND as its alphaMode");
    if (sided && !json_is_boolean(sided))
        return gltf_fail(check, "material", index, "true or false as its doubleSided");
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        if (numbers[i] && !json_is_number(numbers[i]))
            return gltf_fail(check, "material", index,
                             "numbers as its metallicFactor, roughnessFactor and alphaCutoff");
    return RESULT_OK;
}

static Result check_material(const GltfCheck *check, size_t index, const json_t *material)
{
    const json_t *factors = json_object_get(material, "pbrMetallicRoughness");
    Result result = check_types(check, index, material);
    if (result)
        return result;
    if (!gltf_valid_numbers(json_object_get(factors, "baseColorFactor"), 4))
        return gltf_fail(check, "material", index, "four numbers as its baseColorFactor");
    if (json_object_get(material, "normalTexture") ||
        json_object_get(material, "occlusionTexture") ||
        json_object_get(material, "emissiveTexture"))
        gltf_note(check, NOTE_TEXTURES);
    if (positive(json_object_get(material, "emissiveFactor")))
        gltf_note(check, NOTE_EMISSIVE);
    result = check_info(check, index, BASE_COLOR);
    return result ? result : check_info(check, index, METALLIC_ROUGHNESS);
}

Result gltf_surface_check(const GltfCheck *check)
{
    const json_t *material;
    size_t i;
    Result result = check_images(check);
    if (!result)
        result = check_samplers(check);
    if (!result)
        result = check_textures(check);
    json_array_foreach(gltf_array(check, "materials"), i, material)
    {
        if (!result)
            result = check_material(check, i, material);
    }
    return result;
}
