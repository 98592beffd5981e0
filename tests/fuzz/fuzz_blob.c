/* Scenes as bytes: what blob_read makes of any. What it takes is valid and reads the same when it
 * is written again; not byte for byte, since a texture's channel may be written in two ways. */
#include "fuzz.h"

#include "scene/blob.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    unsigned char *bytes, *again;
    size_t count, again_count;
    Scene scene, copy;
    if (blob_read(data, size, &scene) != RESULT_OK) {
        fuzz_check_message();
        FUZZ_CHECK(!scene.meshes && !scene.name, "a scene after a failure");
        return 0;
    }
    FUZZ_CHECK(scene_validate(&scene) == RESULT_OK, "%s", result_message());
    FUZZ_CHECK(blob_write(&scene, &bytes, &count) == RESULT_OK, "%s", result_message());
    FUZZ_CHECK(blob_read(bytes, count, &copy) == RESULT_OK, "%s", result_message());
    FUZZ_CHECK(blob_write(&copy, &again, &again_count) == RESULT_OK, "%s", result_message());
    FUZZ_CHECK(again_count == count && memcmp(again, bytes, count) == 0, "%zu and %zu bytes", count,
               again_count);
    scene_free(&scene);
    scene_free(&copy);
    free(bytes);
    free(again);
    return 0;
}
