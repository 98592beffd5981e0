/* Traces in files, and the images that `peel check` takes. Every buffer that is handed out must be
 * whole. Files of more than 2^24 pixels in a buffer are left out, for the time they take. */
#include "fuzz.h"

#include "compare/given.h"
#include "compare/store.h"
#include "compare/trace_file.h"
#include "image/exr.h"
#include "image/exr_planes.h"

#include <math.h>
#include <stdio.h>

enum {
    BYTES_MAX = 1 << 26
};

/* All its parts are small enough. */
static bool is_small(const char *path)
{
    ExrFile *file;
    bool small = true;
    bool exr;
    if (exr_is(path, &exr) != RESULT_OK || !exr || exr_file_open(path, &file) != RESULT_OK)
        return true;
    for (int part = 0; part < exr_file_count(file) && small; part++) {
        Planes planes;
        small = exr_file_planes(file, part, BYTES_MAX, &planes) != RESULT_NO_MEMORY;
        planes_free(&planes);
    }
    exr_file_close(file);
    return small;
}

static void read_trace(const char *path)
{
    TraceStore *store;
    Image image;
    FUZZ_CHECK(store_create(1 << 16, &store) == RESULT_OK, "%s", result_message());
    Result result = trace_file_read(path, store);
    if (result != RESULT_OK)
        fuzz_check_message();
    for (int i = 0; i < store_count(store) && result == RESULT_OK; i++) {
        const StoredBuffer *buffer = store_buffer(store, i);
        FUZZ_CHECK(*buffer->name && trace_name_step(buffer->name) == buffer->step &&
                       store_find(store, buffer->name) == i,
                   "'%s': step %d", buffer->name, buffer->step);
        FUZZ_CHECK(store_image(store, i, &image) == RESULT_OK && image.width == buffer->width &&
                       image.height == buffer->height,
                   "'%s': %s", buffer->name, result_message());
        image_free(&image);
    }
    store_destroy(store);
}

/* The image that it is, in each of its meanings against itself. */
static void read_given(const char *path)
{
    static const GivenMeaning detect;
    GivenImage given;
    GivenReading reading, again;
    char text[256];
    if (given_load(path, NULL, &given) != RESULT_OK) {
        fuzz_check_message();
        FUZZ_CHECK(!given.stored.pixels, "pixels after a failure");
        return;
    }
    Image black;
    FUZZ_CHECK(image_create(given.stored.width, given.stored.height, FORMAT_RGBA32F, &black) ==
                       RESULT_OK &&
                   given_interpret(&given, &black, &detect, &reading) == RESULT_OK &&
                   given_interpret(&given, &reading.linear, &reading.meaning, &again) == RESULT_OK,
               "%s", result_message());
    FUZZ_CHECK(memcmp(&again.meaning, &reading.meaning, sizeof again.meaning) == 0,
               "a meaning that was given");
    given_describe(&given, &reading, text, sizeof text);
    given_reading_free(&again);
    given_reading_free(&reading);
    image_free(&black);
    given_free(&given);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(0, data, size);
    bool is = false;
    if (trace_file_is(path, &is) != RESULT_OK)
        fuzz_check_message();
    if (!is_small(path))
        return 0;
    read_trace(path);
    read_given(path);
    return 0;
}
