/* Scene files: what gltf_load makes of any bytes, as a binary glTF file where they begin so, else
 * as a text. A scene that it gives is valid, is the same after blob_write and blob_read, and can be
 * rendered. Not rendered are scenes of many triangles, for the time they take, and nothing else is
 * left out: a crash inside Assimp ends the target like one of ours. */
#include "fuzz.h"

#include "base/file.h"
#include "ref/pipeline/pipeline.h"
#include "scene/blob.h"
#include "scene/gltf.h"

#include <assimp/cimport.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum {
    TRIANGLES_MAX = 2000,
    LIGHTS_MAX = 4
};

/* LeakSanitizer's, where it is linked. */
void __lsan_disable(void) __attribute__((weak));
void __lsan_enable(void) __attribute__((weak));

const struct aiScene *__real_aiImportFileEx(const char *path, unsigned flags, struct aiFileIO *io);
const struct aiScene *__wrap_aiImportFileEx(const char *path, unsigned flags, struct aiFileIO *io);

/* Assimp 5.2 loses a buffer whose base64 ends badly: what it allocates is not searched for leaks.
 * The loader of the program is a process that ends. */
const struct aiScene *__wrap_aiImportFileEx(const char *path, unsigned flags, struct aiFileIO *io)
{
    if (__lsan_disable)
        __lsan_disable();
    const struct aiScene *scene = __real_aiImportFileEx(path, flags, io);
    if (__lsan_enable)
        __lsan_enable();
    return scene;
}

static Result load(const uint8_t *data, size_t size, Scene *out)
{
    char path[128];
    bool binary = size >= 4 && memcmp(data, "glTF", 4) == 0;
    snprintf(path, sizeof path, "%s.%s", fuzz_output(), binary ? "glb" : "gltf");
    FILE *file = fopen(path, "wb");
    FUZZ_CHECK(file && fwrite(data, 1, size, file) == size && fclose(file) == 0, "%s", path);
    Result result = gltf_load(path, out);
    unlink(path);
    if (result != RESULT_OK) {
        fuzz_check_message();
        FUZZ_CHECK(strncmp(result_message(), path, strlen(path)) == 0, "'%s' does not name %s",
                   result_message(), path);
        FUZZ_CHECK(!out->meshes && !out->name, "a scene after a failure");
    }
    return result;
}

static void check_round_trip(const Scene *scene)
{
    unsigned char *bytes, *again;
    size_t count, again_count;
    Scene copy;
    FUZZ_CHECK(blob_write(scene, &bytes, &count) == RESULT_OK, "%s", result_message());
    FUZZ_CHECK(blob_read(bytes, count, &copy) == RESULT_OK, "%s", result_message());
    FUZZ_CHECK(blob_write(&copy, &again, &again_count) == RESULT_OK, "%s", result_message());
    FUZZ_CHECK(again_count == count && memcmp(again, bytes, count) == 0, "%zu and %zu bytes", count,
               again_count);
    scene_free(&copy);
    free(bytes);
    free(again);
}

static void check_rendered(Scene *scene, float opacity)
{
    const RenderDesc desc = {.width = 16, .height = 9, .threads = 1, .lights = LIGHTS_MAX};
    Frame frame;
    if (opacity < 1.0f)
        scene_override_opacity(scene, opacity);
    if (pipeline_render(scene, &desc, NULL, &frame) == RESULT_OK)
        frame_free(&frame);
    else
        fuzz_check_message();
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Scene scene;
    if (load(data, size, &scene) != RESULT_OK)
        return 0;
    FUZZ_CHECK(scene_validate(&scene) == RESULT_OK, "%s", result_message());
    check_round_trip(&scene);
    if (scene_triangle_count(&scene) <= TRIANGLES_MAX) {
        check_rendered(&scene, 1.0f);
        check_rendered(&scene, 0.5f);
    }
    scene_free(&scene);
    return 0;
}
