/* Textures and texture coordinates in glTF files: what they mean, there and back. */
#include "base/file.h"
#include "scene/gltf_texture.h"
#include "scene/texture.h"

#include "textured_gltf.h"

#include <stdio.h>
#include <unistd.h>

static void same_texels(const Texture *texture, const uint8_t *codes, TextureEncoding encoding)
{
    for (size_t i = 0; i < (size_t)texture->width * texture->height * 4; i++)
        ck_assert_float_bits(texture->texels[i],
                             texture_decode(i % 4 == 3 ? TEXTURE_LINEAR : encoding, codes[i], 255));
}

/* ---- images --------------------------------------------------------------------------------- */

START_TEST(two_encodings_of_one_image)
{
    Scene scene;
    char members[4096];
    SmallPng png = textured_png();
    snprintf(members, sizeof members,
             TEXTURED_MESH ",\"images\":[%s],\"textures\":[{\"source\":0},{\"source\":0}],"
                           "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":"
                           "{\"index\":0},\"metallicRoughnessTexture\":{\"index\":1}}}]",
             image_member(&png));
    load_textured(members, NULL, &scene);
    ck_assert_uint_eq(scene.texture_count, 2);
    const Material *material = &scene.materials[scene.instances[0].material];
    ck_assert_uint_eq(material->base_color_texture, 1);
    ck_assert_uint_eq(material->metallic_roughness_texture, 2);
    for (size_t i = 0; i < 2; i++) {
        ck_assert_uint_eq(scene.textures[i].width, 2);
        ck_assert_uint_eq(scene.textures[i].height, 1);
        ck_assert_int_eq(scene.textures[i].wrap_s, WRAP_REPEAT);
        ck_assert_int_eq(scene.textures[i].wrap_t, WRAP_REPEAT);
        ck_assert(!scene.textures[i].nearest);
        same_texels(&scene.textures[i], textured_pixels, i == 0 ? TEXTURE_SRGB : TEXTURE_LINEAR);
    }
    scene_free(&scene);
}
END_TEST

/* The same file embedded, in a buffer, and beside the document under an escaped name. */
START_TEST(places_of_images)
{
    Scene scene;
    char members[4096];
    SmallPng png = textured_png();
    const char *path = scratch_path("a b.png");
    ck_assert_int_eq(file_write(path, png.bytes, png.count), RESULT_OK);
    const char *const images[] = {image_member(&png),
                                  "{\"bufferView\":6,\"mimeType\":\"image/png\"}",
                                  "{\"uri\":\"a%20b.png\"}"};
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++) {
        snprintf(members, sizeof members,
                 TEXTURED_MESH ",\"images\":[%s],\"textures\":[{\"source\":0}],"
                               "\"materials\":[" BASE_COLOR_0 "]",
                 images[i]);
        load_textured(members, &png, &scene);
        ck_assert_uint_eq(scene.texture_count, 1);
        same_texels(&scene.textures[0], textured_pixels, TEXTURE_SRGB);
        scene_free(&scene);
    }
}
END_TEST

/* Only what drawn materials use is decoded, and once: material 1's image does not exist. */
START_TEST(shared_and_unused_textures)
{
    Scene scene;
    char members[4096];
    SmallPng png = textured_png(), other = png_make(1, 1, 8, PNG_RGBA, textured_pixels + 4, 4);
    snprintf(members, sizeof members,
             "\"meshes\":[{\"primitives\":["
             "{\"attributes\":" TEXTURED_ATTRIBUTES ",\"indices\":5,\"material\":0},"
             "{\"attributes\":" TEXTURED_ATTRIBUTES ",\"indices\":5,\"material\":2},"
             "{\"attributes\":" TEXTURED_ATTRIBUTES ",\"indices\":5,\"material\":3},"
             "{\"attributes\":" TEXTURED_ATTRIBUTES ",\"indices\":5,\"material\":4}]}],"
             "\"images\":[%s,{\"uri\":\"none.png\"},%s],"
             "\"samplers\":[{\"wrapS\":33071},{\"wrapS\":33071,\"wrapT\":10497},{}],"
             "\"textures\":[{\"source\":0,\"sampler\":0},{\"source\":1},"
             "{\"source\":0,\"sampler\":1},{\"source\":0,\"sampler\":2},{\"source\":2}],"
             "\"materials\":[" BASE_COLOR_0
             ",{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1}}},"
             "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":2}}},"
             "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":3}}},"
             "{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":4}}}]",
             image_member(&png), image_member(&other));
    load_textured(members, NULL, &scene);
    ck_assert_uint_eq(scene.texture_count, 3); /* textures 0 and 2 say the same */
    ck_assert_uint_eq(scene.mesh_count, 1);
    ck_assert_uint_eq(scene.materials[0].base_color_texture, 1);
    ck_assert_uint_eq(scene.materials[1].base_color_texture, 1);
    ck_assert_uint_eq(scene.materials[2].base_color_texture, 2);
    ck_assert_uint_eq(scene.materials[3].base_color_texture, 3);
    same_texels(&scene.textures[2], textured_pixels + 4, TEXTURE_SRGB);
    scene_free(&scene);
}
END_TEST

START_TEST(samplers)
{
    static const struct {
        const char *text;
        TextureWrap wrap_s, wrap_t;
        bool nearest;
    } cases[] = {
        {"{}", WRAP_REPEAT, WRAP_REPEAT, false},
        {"{\"wrapS\":33071,\"wrapT\":33648}", WRAP_CLAMP, WRAP_MIRROR, false},
        {"{\"wrapS\":10497,\"wrapT\":33071}", WRAP_REPEAT, WRAP_CLAMP, false},
        {"{\"magFilter\":9728}", WRAP_REPEAT, WRAP_REPEAT, true},
        {"{\"minFilter\":9728}", WRAP_REPEAT, WRAP_REPEAT, true},
        {"{\"magFilter\":9729,\"minFilter\":9728}", WRAP_REPEAT, WRAP_REPEAT, false},
        {"{\"magFilter\":9728,\"minFilter\":9987}", WRAP_REPEAT, WRAP_REPEAT, true},
        {"{\"minFilter\":9984}", WRAP_REPEAT, WRAP_REPEAT, false},
    };
    SmallPng png = textured_png();
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        Scene scene;
        char members[4096];
        snprintf(members, sizeof members,
                 TEXTURED_MESH ",\"images\":[%s],\"samplers\":[%s],\"textures\":[{\"source\":0,"
                               "\"sampler\":0}],\"materials\":[" BASE_COLOR_0 "]",
                 image_member(&png), cases[i].text);
        load_textured(members, NULL, &scene);
        ck_assert_int_eq(scene.textures[0].wrap_s, cases[i].wrap_s);
        ck_assert_int_eq(scene.textures[0].wrap_t, cases[i].wrap_t);
        ck_assert_int_eq(scene.textures[0].nearest, cases[i].nearest);
        scene_free(&scene);
    }
}
END_TEST

/* ---- texture coordinates -------------------------------------------------------------------- */

/* Which of the file's vertices this one is, by its position. */
static size_t file_vertex(const Mesh *mesh, size_t vertex)
{
    size_t i = 0;
    while (i < 4 && memcmp(mesh->position + 3 * vertex, quad + 3 * i, 12) != 0)
        i++;
    ck_assert_uint_lt(i, 4);
    return i;
}

/* Every vertex keeps its coordinates, whatever becomes of the order: shared or flat normals, with
 * indices or without, a vertex that nothing uses, strips and fans. */
START_TEST(coordinates_stay_with_their_vertices)
{
    static const char *const primitives[] = {
        "{\"attributes\":" TEXTURED_ATTRIBUTES ",\"indices\":5}",
        "{\"attributes\":" TEXTURED_ATTRIBUTES ",\"indices\":6}",
        "{\"attributes\":" TEXTURED_ATTRIBUTES ",\"mode\":6}",
        "{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":2},\"indices\":5}",
        "{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":2},\"indices\":6}",
        "{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":2},\"mode\":5}",
    };
    static const uint32_t vertices[] = {4, 3, 4, 6, 3, 6};
    for (size_t i = 0; i < sizeof primitives / sizeof primitives[0]; i++) {
        Scene scene;
        char members[512];
        snprintf(members, sizeof members, "\"meshes\":[{\"primitives\":[%s]}]", primitives[i]);
        load_textured(members, NULL, &scene);
        const Mesh *mesh = &scene.meshes[0];
        ck_assert_uint_eq(mesh->vertex_count, vertices[i]);
        for (size_t v = 0; v < mesh->vertex_count; v++)
            ck_assert_mem_eq(mesh->uv + 2 * v, textured_uv + 2 * file_vertex(mesh, v), 8);
        scene_free(&scene);
    }
}
END_TEST

START_TEST(normalised_integers)
{
    Scene scene;
    load_textured("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
                  "\"TEXCOORD_0\":3},\"indices\":5},{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
                  "\"TEXCOORD_0\":4},\"indices\":5}]}]",
                  NULL, &scene);
    ck_assert_uint_eq(scene.mesh_count, 2);
    for (size_t i = 0; i < 8; i++) {
        size_t byte = 4 * (i / 2) + i % 2;
        ck_assert_float_bits(scene.meshes[0].uv[i], (float)textured_shorts[i] / 65535.0f);
        ck_assert_float_bits(scene.meshes[1].uv[i], (float)textured_bytes[byte] / 255.0f);
    }
    scene_free(&scene);
}
END_TEST

/* One primitive's accessors under four materials: base colour on set 1, metallic-roughness on set
 * 1, neither, and base colour on a set that the mesh has not. */
START_TEST(the_set_that_a_texture_names)
{
    Scene scene;
    char members[4096];
    SmallPng png = textured_png();
#define PRIMITIVE(material)                                                                        \
    "{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"TEXCOORD_0\":2,\"TEXCOORD_1\":3},"             \
    "\"indices\":5,\"material\":" material "}"
    snprintf(members, sizeof members,
             "\"meshes\":[{\"primitives\":[" PRIMITIVE("0") "," PRIMITIVE("1") "," PRIMITIVE(
                 "2") "," PRIMITIVE("3") "]}],\"images\":[%s],\"textures\":[{\"source\":0}],"
                                         "\"materials\":[{\"pbrMetallicRoughness\":{"
                                         "\"baseColorTexture\":{\"index\":0,\"texCoord\":1}}},"
                                         "{\"pbrMetallicRoughness\":{\"metallicRoughnessTexture\":"
                                         "{\"index\":0,\"texCoord\":1}}},{},"
                                         "{\"pbrMetallicRoughness\":{\"baseColorTexture\":"
                                         "{\"index\":0,\"texCoord\":7}}}]",
             image_member(&png));
    load_textured(members, NULL, &scene);
    ck_assert_uint_eq(scene.mesh_count, 3);
    ck_assert_uint_eq(scene.instances[0].mesh, scene.instances[1].mesh);
    ck_assert_float_bits(scene.meshes[scene.instances[1].mesh].uv[1], 1.0f);
    ck_assert_float_bits(scene.meshes[scene.instances[2].mesh].uv[1], 1e-30f);
    ck_assert_ptr_null(scene.meshes[scene.instances[3].mesh].uv);
    ck_assert_uint_eq(scene.materials[scene.instances[3].material].base_color_texture, 1);
    scene_free(&scene);
}
END_TEST

/* ---- what is left out ----------------------------------------------------------------------- */

static void warns(const char *members, const char *part)
{
    char text[1024];
    Scene scene;
    SmallPng png = textured_png();
    const char *path = write_textured(members, &png), *log = scratch_path("stderr");
    int kept = dup(STDERR_FILENO);
    ck_assert_ptr_nonnull(freopen(log, "wb", stderr));
    result_warnings_enable(true);
    Result result = gltf_load(path, &scene);
    result_warnings_enable(false);
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
    scene_free(&scene);
    size_t length = scratch_read(log, text, sizeof text);
    ck_assert_msg(part ? strstr(text, part) != NULL : length == 0, "got \"%s\", expected \"%s\"",
                  text, part ? part : "");
}

START_TEST(what_is_said)
{
    warns(WITH("{\"source\":0}", "\"baseColorTexture\":{\"index\":0}"), NULL);
    warns(WITH("{\"extensions\":{\"EXT_texture_webp\":{\"source\":0}}}",
               "\"baseColorTexture\":{\"index\":0}"),
          "images other than PNG and JPEG");
    warns(WITH("{\"source\":0}", "\"baseColorTexture\":{\"index\":0,\"extensions\":{"
                                 "\"KHR_texture_transform\":{\"scale\":[2,2]}}}"),
          "texture transforms");
    warns(WITH("{\"source\":0}", "\"baseColorTexture\":{\"index\":0},"
                                 "\"metallicRoughnessTexture\":{\"index\":0,\"texCoord\":1}"),
          "other coordinates than the base colour's");
    warns(TEXTURED_MESH ",\"materials\":[{\"occlusionTexture\":{\"index\":0}}]",
          "normal, occlusion and emissive textures");
}
END_TEST

/* Without its base colour's image, the material's coordinates are its other texture's. */
START_TEST(left_out_textures)
{
    Scene scene;
    SmallPng png = textured_png();
    load_textured(
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
        "\"TEXCOORD_0\":2,\"TEXCOORD_1\":3},\"indices\":5,\"material\":0}]}]," STORED_IMAGE
        ",\"textures\":[{},{\"source\":0}],\"materials\":[{\"pbrMetallicRoughness\":{"
        "\"baseColorTexture\":{\"index\":0},\"metallicRoughnessTexture\":{\"index\":1,"
        "\"texCoord\":1}}}]",
        &png, &scene);
    ck_assert_uint_eq(scene.texture_count, 1);
    ck_assert_uint_eq(scene.materials[0].base_color_texture, 0);
    ck_assert_uint_eq(scene.materials[0].metallic_roughness_texture, 1);
    ck_assert_float_bits(scene.meshes[0].uv[1], 1.0f);
    scene_free(&scene);
    load_textured(WITH("{\"source\":0}",
                       "\"baseColorTexture\":{\"index\":0},"
                       "\"metallicRoughnessTexture\":{\"index\":0,\"texCoord\":1}"),
                  &png, &scene);
    ck_assert_uint_eq(scene.materials[0].base_color_texture, 1);
    ck_assert_uint_eq(scene.materials[0].metallic_roughness_texture, 0);
    scene_free(&scene);
}
END_TEST

/* ---- there and back ------------------------------------------------------------------------- */

/* All 256 codes in every channel. */
static SmallPng all_codes(uint8_t *pixels)
{
    for (int i = 0; i < 256; i++)
        memcpy(pixels + 4 * i,
               ((uint8_t[]){(uint8_t)i, (uint8_t)(i * 7), (uint8_t)(i * 13), (uint8_t)(255 - i)}),
               4);
    return png_make(16, 16, 8, PNG_RGBA, pixels, 64);
}

static void same_textures(const Scene *a, const Scene *b)
{
    ck_assert_uint_eq(a->texture_count, b->texture_count);
    for (size_t i = 0; i < a->texture_count; i++) {
        const Texture *x = &a->textures[i], *y = &b->textures[i];
        ck_assert_uint_eq(x->width, y->width);
        ck_assert_uint_eq(x->height, y->height);
        ck_assert_int_eq(x->wrap_s, y->wrap_s);
        ck_assert_int_eq(x->wrap_t, y->wrap_t);
        ck_assert_int_eq(x->nearest, y->nearest);
        ck_assert_mem_eq(x->texels, y->texels, (size_t)x->width * x->height * 16);
    }
    const Material *x = &a->materials[0], *y = &b->materials[0];
    ck_assert_uint_eq(x->base_color_texture, y->base_color_texture);
    ck_assert_uint_eq(x->metallic_roughness_texture, y->metallic_roughness_texture);
    ck_assert_mem_eq(a->meshes[0].uv, b->meshes[0].uv, sizeof textured_uv);
}

START_TEST(written_textures_come_back)
{
    uint8_t pixels[1024];
    char members[8192];
    SmallPng png = all_codes(pixels);
    Scene scene, again;
    snprintf(members, sizeof members,
             TEXTURED_MESH ",\"images\":[%s],\"samplers\":[{\"wrapS\":33071,\"wrapT\":33648,"
                           "\"magFilter\":9728},{\"wrapT\":33071}],\"textures\":[{\"source\":0,"
                           "\"sampler\":0},{\"source\":0,\"sampler\":1}],\"materials\":[{"
                           "\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0},"
                           "\"metallicRoughnessTexture\":{\"index\":1}}}]",
             image_member(&png));
    load_textured(members, NULL, &scene);
    same_texels(&scene.textures[0], pixels, TEXTURE_SRGB);
    ck_assert_mem_eq(scene.meshes[0].uv, textured_uv, sizeof textured_uv);
    for (int binary = 0; binary < 2; binary++) {
        const char *path = scratch_path(binary ? "again.glb" : "again.gltf");
        ck_assert_msg(gltf_write(&scene, path) == RESULT_OK, "%s", result_message());
        load(path, &again);
        same_textures(&scene, &again);
        scene_free(&again);
        unsigned char *bytes;
        size_t count;
        ck_assert_int_eq(file_load(path, &bytes, &count), RESULT_OK);
        const char *text = (const char *)bytes + (binary ? 20 : 0); /* behind the header */
        ck_assert_int_eq(strstr(text, "data:") == NULL, binary);    /* not in binary files */
        free(bytes);
    }
    scene_free(&scene);
}
END_TEST

/* One texture of ours under both encodings is two images in a file. */
START_TEST(one_texture_in_two_roles)
{
    Scene scene, again;
    SmallPng png = textured_png();
    load_textured(WITH("{\"source\":0}", "\"metallicRoughnessTexture\":{\"index\":0}"), &png,
                  &scene);
    scene.materials[0].base_color_texture = scene.materials[0].metallic_roughness_texture;
    const char *path = scratch_path("roles.gltf");
    ck_assert_int_eq(gltf_write(&scene, path), RESULT_OK);
    load(path, &again);
    ck_assert_uint_eq(again.texture_count, 2);
    const float *base = again.textures[again.materials[0].base_color_texture - 1].texels;
    const float *other = again.textures[again.materials[0].metallic_roughness_texture - 1].texels;
    for (int i = 0; i < 8; i++) {
        ck_assert_float_bits(other[i], scene.textures[0].texels[i]);
        ck_assert_float_eq_tol(base[i], other[i], 0.005f);
    }
    scene_free(&scene);
    scene_free(&again);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gltf_texture");
    TCase *test = tcase_create("gltf_texture");
    tcase_set_timeout(test, 60);
    tcase_add_checked_fixture(test, scratch_make, scratch_remove);
    tcase_add_test(test, two_encodings_of_one_image);
    tcase_add_test(test, places_of_images);
    tcase_add_test(test, shared_and_unused_textures);
    tcase_add_test(test, samplers);
    tcase_add_test(test, coordinates_stay_with_their_vertices);
    tcase_add_test(test, normalised_integers);
    tcase_add_test(test, the_set_that_a_texture_names);
    tcase_add_test(test, what_is_said);
    tcase_add_test(test, left_out_textures);
    tcase_add_test(test, written_textures_come_back);
    tcase_add_test(test, one_texture_in_two_roles);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}
