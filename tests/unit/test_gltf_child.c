/* scene/gltf_child.h: the child's scene is the one that gltf_load gives, and whatever happens to
 * the child becomes one line that names the file. */
#include "textured_gltf.h"

#include "base/file.h"
#include "base/memory.h"
#include "scene/blob.h"
#include "scene/generate.h"
#include "scene/gltf_child.h"

#include <sys/stat.h>
#include <unistd.h>

/* ---- a loader that does what a test asks -------------------------------------------------------
 */

typedef enum Fate {
    FATE_LOADS = 0,
    FATE_CRASHES,
    FATE_EXITS,
    FATE_PRINTS, /* and crashes */
    FATE_GROWS
} Fate;

static Fate fate;

Result __real_gltf_load_files(const char *path, GltfFile file, void *context, Scene *out);
Result __wrap_gltf_load_files(const char *path, GltfFile file, void *context, Scene *out);
Result __wrap_gltf_load_files(const char *path, GltfFile file, void *context, Scene *out)
{
    switch (fate) {
    case FATE_PRINTS:
        fputs("terminate called after throwing\n", stdout);
        fputs("an instance of 'std::length_error'\n", stderr);
        fflush(stdout);
        raise(SIGKILL);
        break;
    case FATE_CRASHES:
        raise(SIGKILL);
        break;
    case FATE_EXITS:
        exit(0);
    case FATE_GROWS:
        for (;;)
            if (!memory_array(1 << 24, 1))
                return RESULT_NO_MEMORY;
    default:
        break;
    }
    return __real_gltf_load_files(path, file, context, out);
}

/* ---- tests -------------------------------------------------------------------------------------
 */

static void check_same(const char *path)
{
    Scene here, there;
    unsigned char *bytes[2];
    size_t counts[2];
    load(path, &here);
    ck_assert_msg(gltf_child_load(path, 0, &there) == RESULT_OK, "%s", result_message());
    ck_assert_int_eq(blob_write(&here, &bytes[0], &counts[0]), RESULT_OK);
    ck_assert_int_eq(blob_write(&there, &bytes[1], &counts[1]), RESULT_OK);
    ck_assert_uint_eq(counts[0], counts[1]);
    ck_assert_mem_eq(bytes[0], bytes[1], counts[0]);
    free(bytes[0]);
    free(bytes[1]);
    scene_free(&here);
    scene_free(&there);
}

START_TEST(test_same_scene)
{
    static const char *const names[] = {"teapot_hall", "lamps"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        Scene scene;
        const char *path = scratch_path(i ? "other.glb" : "scene.glb"); /* the first is kept */
        ck_assert_int_eq(generate_find(names[i])->generate(&scene), RESULT_OK);
        ck_assert_int_eq(gltf_write(&scene, path), RESULT_OK);
        scene_free(&scene);
        check_same(path);
    }
    check_same(write_quad(quad, QUAD_MESH "," ONE_NODE));
}
END_TEST

static void check_refused(const char *path, size_t max_memory, Result expected, const char *part)
{
    Scene scene;
    Result result = gltf_child_load(path, max_memory, &scene);
    refused_so(path, result, &scene, expected, part);
}

START_TEST(test_refused)
{
    check_refused(scratch_path("nosuch.gltf"), 0, RESULT_IO, ": cannot read: No such file");
    check_refused(scratch_path("nosuch.obj"), 0, RESULT_BAD_INPUT, ": unknown extension");
    const char *path = scratch_path("text.gltf");
    write_text(path, "hello");
    check_refused(path, 0, RESULT_BAD_INPUT, ": not glTF: line 1");
}
END_TEST

START_TEST(test_ends)
{
    const char *path = write_quad(quad, QUAD_MESH "," ONE_NODE);
    fate = FATE_CRASHES;
    check_refused(path, 0, RESULT_BAD_INPUT,
                  ": cannot load: the library that reads it ended by signal 9 (Killed)");
    fate = FATE_EXITS;
    check_refused(path, 0, RESULT_BAD_INPUT, "ended without a result, exit code 0");
    fate = FATE_LOADS;
    check_same(path);
}
END_TEST

/* What both standard streams have become. */
static void captured(const char *path, char *text, size_t size)
{
    FILE *file = tmpfile();
    int out = dup(STDOUT_FILENO), error = dup(STDERR_FILENO);
    Scene scene;
    ck_assert_ptr_nonnull(file);
    dup2(fileno(file), STDOUT_FILENO);
    dup2(fileno(file), STDERR_FILENO);
    result_warnings_enable(true);
    gltf_child_load(path, 0, &scene);
    result_warnings_enable(false);
    scene_free(&scene);
    dup2(out, STDOUT_FILENO);
    dup2(error, STDERR_FILENO);
    rewind(file);
    text[fread(text, 1, size - 1, file)] = '\0';
    fclose(file);
}

START_TEST(test_prints)
{
    char text[1024], expected[1024];
    const char *path = write_quad(quad, QUAD_MESH ",\"skins\":[],\"animations\":[{}]," ONE_NODE);
    captured(path, text, sizeof text);
    snprintf(expected, sizeof expected, "peel: warning: %s: not modelled and ignored: animations\n",
             path);
    ck_assert_str_eq(text, expected); /* once */
#ifndef CHILD_SANITIZED
    fate = FATE_PRINTS;
    captured(path, text, sizeof text);
    ck_assert_str_eq(text, "");
#endif
}
END_TEST

START_TEST(test_limits)
{
    const uint64_t gibibyte = (uint64_t)1 << 30;
    ChildLimits limits = gltf_child_limits(0, 0);
    ck_assert_uint_eq(limits.memory, gibibyte);
    ck_assert_double_eq(limits.seconds, 10.0);
    limits = gltf_child_limits((uint64_t)8 << 20, 0);
    ck_assert_uint_eq(limits.memory, 2 * gibibyte);
    ck_assert_double_eq(limits.seconds, 20.0);
    limits = gltf_child_limits(UINT64_MAX, 0);
    ck_assert_uint_eq(limits.memory, 4 * gibibyte);
    limits = gltf_child_limits(0, 100);
    ck_assert_uint_eq(limits.memory, 100);
    ck_assert_double_eq(limits.seconds, 10.0);
    limits = gltf_child_limits(0, SIZE_MAX);
    ck_assert_uint_eq(limits.memory, SIZE_MAX / 2);
    ck_assert_double_eq(limits.seconds, 10000.0);
}
END_TEST

typedef struct Files {
    int count;
    uint64_t bytes;
} Files;

static Result note_file(void *context, const char *path, uint64_t bytes)
{
    Files *files = context;
    const char *name = strrchr(path, '/') + 1;
    ck_assert_str_eq(name, files->count ? "external.bin" : "external.gltf");
    files->bytes += bytes;
    return ++files->count == 2 ? result_fail(RESULT_NO_GL, "enough") : RESULT_OK;
}

/* The files that a document names count, and are kept. */
START_TEST(test_files)
{
    const char *path = write_external("external.bin");
    FILE *file = fopen(scratch_path("external.bin"), "wb");
    struct stat info;
    Scene scene;
    Files files = {0};
    ck_assert_ptr_nonnull(file);
    ck_assert_int_eq(ftruncate(fileno(file), 4 << 20), 0);
    fclose(file);
    ck_assert_int_eq(stat(path, &info), 0);
    ck_assert_int_eq(gltf_load_files(path, note_file, &files, &scene), RESULT_NO_GL);
    ck_assert_ptr_null(scene.meshes);
    ck_assert_int_eq(files.count, 2);
    ck_assert_uint_eq(files.bytes, (uint64_t)info.st_size + (4 << 20));
    ck_assert_int_eq(file_check_kept(path), RESULT_OK);
    check_same(path);
    ck_assert_int_eq(file_check_kept(path), RESULT_BAD_INPUT);
    ck_assert_int_eq(file_check_kept(scratch_path("external.bin")), RESULT_BAD_INPUT);
    ck_assert_int_eq(file_check_kept(scratch_path("other.bin")), RESULT_OK);
}
END_TEST

START_TEST(test_memory)
{
    const char *path = write_quad(quad, QUAD_MESH "," ONE_NODE);
#ifndef CHILD_SANITIZED
    fate = FATE_GROWS;
    check_refused(path, (size_t)100 << 20, RESULT_NO_MEMORY,
                  ": loading it takes more memory than 100 MiB (--max-memory), or than there is");
    fate = FATE_LOADS;
#endif
    check_same(path);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("gltf_child");
    TCase *tcase = tcase_create("gltf_child");
    tcase_set_timeout(tcase, 60);
    tcase_add_checked_fixture(tcase, scratch_make, scratch_remove);
    tcase_add_test(tcase, test_same_scene);
    tcase_add_test(tcase, test_refused);
    tcase_add_test(tcase, test_ends);
    tcase_add_test(tcase, test_prints);
    tcase_add_test(tcase, test_limits);
    tcase_add_test(tcase, test_files);
    suite_add_tcase(suite, tcase);
    TCase *limits = testing_limits();
    tcase_add_checked_fixture(limits, scratch_make, scratch_remove);
    tcase_add_test(limits, test_memory);
    suite_add_tcase(suite, limits);
    return testing_run(suite);
}
