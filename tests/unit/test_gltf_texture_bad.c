/* Broken textures in glTF files: each is refused with one line. */
#include "scene/gltf_bytes.h"

#include "textured_gltf.h"

#include <stdio.h>

static void refuses(const char *members, const char *part)
{
    SmallPng png = textured_png();
    refused_file(write_textured(members, &png), RESULT_BAD_INPUT, part);
}

#define BASE "\"baseColorTexture\":{\"index\":0}"

START_TEST(bad_references)
{
    refuses(WITH("{\"source\":1}", BASE), "texture 0: expected a source that exists");
    refuses(WITH("{\"source\":-1}", BASE), "texture 0: expected a source that exists");
    refuses(WITH("{\"source\":0,\"sampler\":0}", BASE),
            "texture 0: expected a sampler that exists");
    refuses(WITH("7", BASE), "textures 0: expected an object");
    refuses(WITH("{\"source\":0}", "\"baseColorTexture\":{\"index\":1}"),
            "material 0: expected textures that exist");
    refuses(WITH("{\"source\":0}", "\"metallicRoughnessTexture\":{}"),
            "material 0: expected textures that exist");
    refuses(WITH("{\"source\":0}", "\"baseColorTexture\":[0]"),
            "material 0: expected textures that exist");
    refuses(WITH("{\"source\":0}", "\"baseColorTexture\":{\"index\":0,\"texCoord\":-1}"),
            "material 0: expected an integer from 0 as every texCoord");
    refuses(TEXTURED_MESH ",\"materials\":[{}],\"images\":{}", "images: expected an array");
    refuses(TEXTURED_MESH ",\"materials\":[{}],\"images\":[{}]", "image 0: expected");
    refuses(TEXTURED_MESH ",\"materials\":[{}],\"images\":[{\"uri\":1}]", "image 0: expected");
    refuses(TEXTURED_MESH ",\"materials\":[{}],\"images\":[{\"uri\":\"a\",\"bufferView\":0}]",
            "image 0: expected");
    refuses(TEXTURED_MESH ",\"materials\":[{}],\"images\":[{\"bufferView\":7}]",
            "image 0: expected");
    refuses(TEXTURED_MESH ",\"materials\":[{}],\"images\":[{\"bufferView\":6,\"mimeType\":1}]",
            "image 0: expected a string as its mimeType");
}
END_TEST

START_TEST(bad_samplers)
{
    static const char *const bad[] = {"{\"wrapS\":0}",         "{\"wrapT\":10496}",
                                      "{\"wrapT\":\"10497\"}", "{\"magFilter\":9987}",
                                      "{\"magFilter\":null}",  "{\"minFilter\":9730}",
                                      "{\"minFilter\":9728.5}"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char members[512];
        snprintf(members, sizeof members, TEXTURED_MESH ",\"materials\":[{}],\"samplers\":[{},%s]",
                 bad[i]);
        refuses(members, "sampler 1: expected");
    }
}
END_TEST

static void refuses_image(const char *image, const char *part)
{
    char members[2048];
    snprintf(members, sizeof members,
             TEXTURED_MESH ",\"images\":[%s],\"textures\":[{\"source\":0}],"
                           "\"materials\":[" BASE_COLOR_0 "]",
             image);
    refuses(members, part);
}

START_TEST(bad_images)
{
    SmallPng png = textured_png();
    refuses_image("{\"uri\":\"none.png\"}", "image 0: no file none.png beside it");
    refuses_image("{\"uri\":\"%4\"}", "two hexadecimal digits");
    refuses_image("{\"uri\":\".\"}", "not a regular file");
    refuses_image("{\"bufferView\":0}", "image 0: expected PNG or JPEG data");
    refuses_image("{\"uri\":\"data:image/png,abc\"}", "image 0: expected ;base64 in its data uri");
    refuses_image("{\"uri\":\"data:\"}", "image 0: expected ;base64 in its data uri");
    refuses_image("{\"uri\":\"data:;base64,a*==\"}", "image 0: expected base64 digits");
    refuses_image("{\"uri\":\"data:;base64,abcde\"}", "image 0: expected base64 digits");
    refuses_image("{\"uri\":\"data:;base64,=abc\"}", "image 0: expected base64 digits");
    refuses_image("{\"uri\":\"data:;base64,\"}", "image 0: expected PNG or JPEG data");
    png.count -= 20;
    refuses_image(image_member(&png), "image 0: cannot decode the PNG");
    png = png_make(16385, 1, 8, PNG_RGBA, textured_pixels, 8);
    refuses_image(image_member(&png), "image 0: 16385x1 pixels, expected 1 to 16384 a side");
}
END_TEST

/* The header says 2^28 texels; one small texture before it makes that too many. Its own pixels are
 * not looked at. */
START_TEST(too_many_texels)
{
    char members[4096];
    SmallPng small = textured_png(), large = png_begin(16384, 16384, 1, PNG_GREY);
    png_end(&large, textured_pixels, 8, 1);
    snprintf(members, sizeof members,
             TEXTURED_MESH ",\"images\":[%s,%s],\"textures\":[{\"source\":0},{\"source\":1}],"
                           "\"materials\":[{\"pbrMetallicRoughness\":{\"baseColorTexture\":"
                           "{\"index\":0},\"metallicRoughnessTexture\":{\"index\":1}}}]",
             image_member(&small), image_member(&large));
    refuses(members, "image 1: 16384x16384 texels on top of the others, expected at most 2^28");
}
END_TEST

/* Assimp finds the same, but only in buffers that it reads. */
START_TEST(short_buffers)
{
    json_error_t error;
    GltfJson json = {
        .root = json_loads("{\"buffers\":[{\"byteLength\":4,\"uri\":\"data:;base64,AAAA\"}],"
                           "\"bufferViews\":[{\"buffer\":0,\"byteLength\":4}],"
                           "\"images\":[{\"bufferView\":0}]}",
                           0, &error)};
    GltfBytes bytes = {.path = "x.gltf", .json = &json};
    GltfSpan span;
    ck_assert_ptr_nonnull(json.root);
    for (int i = 0; i < 2; i++) { /* and is not taken for read */
        ck_assert_int_eq(gltf_bytes_image(&bytes, 0, &span), RESULT_BAD_INPUT);
        ck_assert_str_eq(result_message(), "x.gltf: buffer 0: 3 bytes, expected 4");
        ck_assert_ptr_null(span.bytes);
    }
    gltf_bytes_free(&bytes);
    gltf_json_free(&json);
}
END_TEST

START_TEST(bad_coordinates)
{
    refuses("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":0},"
            "\"indices\":5}]}]",
            "accessor 0: expected the type that its use asks for");
    refuses("\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":9},"
            "\"indices\":5}]}]",
            "mesh 0: expected attributes whose accessors exist");
    const char *path = write_textured(TEXTURED_MESH ",\"materials\":[{}]", NULL);
    char text[8192], *flag;
    ck_assert_uint_lt(scratch_read(path, text, sizeof text), sizeof text - 1);
    /* Shorts without their flag. */
    flag = strstr(text, "\"normalized\":true");
    ck_assert_ptr_nonnull(flag);
    memcpy(flag, "\"normalised\"", 12);
    flag = strstr(text, "\"TEXCOORD_0\":2");
    ck_assert_ptr_nonnull(flag);
    flag[13] = '3';
    write_text(path, text);
    refused_file(path, RESULT_BAD_INPUT,
                 "accessor 3: expected floats or normalized unsigned bytes or shorts");
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gltf_texture_bad");
    TCase *test = tcase_create("gltf_texture_bad");
    tcase_set_timeout(test, 60);
    tcase_add_checked_fixture(test, scratch_make, scratch_remove);
    tcase_add_test(test, bad_references);
    tcase_add_test(test, bad_samplers);
    tcase_add_test(test, bad_images);
    tcase_add_test(test, too_many_texels);
    tcase_add_test(test, short_buffers);
    tcase_add_test(test, bad_coordinates);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}
