/* That a glTF file of data/ is what its generator writes today. */
#ifndef PEEL_TESTS_CURRENT_GLTF_H
#define PEEL_TESTS_CURRENT_GLTF_H

#include "base/file.h"
#include "scene/gltf.h"
#include "scene/gltf_file.h"

#include "scratch.h"
#include "testing.h"

#include <stdio.h>

/* data/<folder>/<name>.gltf. */
static inline void current_gltf_check(const char *folder, const char *name,
                                      Result (*generate)(Scene *out))
{
    Scene scene;
    char stored[256];
    unsigned char *expected, *got;
    size_t expected_count, got_count;
    const char *path = scratch_path("fresh.gltf");
    snprintf(stored, sizeof stored, "%s/data/%s/%s.gltf", PEEL_SOURCE_DIR, folder, name);
    ck_assert_int_eq(generate(&scene), RESULT_OK);
    ck_assert_int_eq(gltf_write(&scene, path), RESULT_OK);
    ck_assert_int_eq(file_load(path, &expected, &expected_count), RESULT_OK);
    ck_assert_msg(file_load(stored, &got, &got_count) == RESULT_OK, "%s", result_message());
    ck_assert_msg(got_count == expected_count && memcmp(got, expected, got_count) == 0,
                  "%s differs from what the generator writes", stored);
    free(expected);
    free(got);
    scene_free(&scene);
}

#endif
