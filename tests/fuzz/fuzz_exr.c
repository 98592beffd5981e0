/* Flat OpenEXR files: both readers, every part. What they take is at most 2^26 bytes. */
#include "fuzz.h"

#include "image/exr.h"
#include "image/exr_planes.h"

#include <math.h>
#include <stdlib.h>

enum {
    PARTS_MAX = 4,
    BYTES_MAX = 1 << 26,
    WRITTEN_MAX = 1 << 12 /* pixels, of what is written again */
};

static void check_planes_equal(const Planes *a, const Planes *b, const char *what)
{
    FUZZ_CHECK(a->width == b->width && a->height == b->height && a->count == b->count, "%s", what);
    size_t pixels = (size_t)a->width * (size_t)a->height;
    for (int i = 0; i < a->count; i++) {
        int other = planes_find(b, a->planes[i].name);
        FUZZ_CHECK(other >= 0 && a->planes[i].kind == b->planes[other].kind, "%s: channel %s", what,
                   a->planes[i].name);
        /* Of two channels of one name only the first is found. */
        if (planes_find(a, a->planes[i].name) == i)
            FUZZ_CHECK(
                memcmp(a->planes[i].bits, b->planes[other].bits, pixels * sizeof(uint32_t)) == 0,
                "%s: channel %s of %dx%d pixels", what, a->planes[i].name, a->width, a->height);
    }
}

/* Planes of floats, written and read, are the same. */
static void check_written(const Planes *planes)
{
    ExrFile *file;
    Planes again;
    for (int i = 0; i < planes->count; i++)
        if (planes->planes[i].kind != KIND_FLOAT ||
            planes_find(planes, planes->planes[i].name) != i)
            return;
    if ((int64_t)planes->width * planes->height * planes->count > WRITTEN_MAX)
        return;
    FUZZ_CHECK(exr_planes_write(planes, fuzz_output()) == RESULT_OK &&
                   exr_file_open(fuzz_output(), &file) == RESULT_OK &&
                   exr_file_planes(file, 0, 0, &again) == RESULT_OK,
               "planes that were read");
    check_planes_equal(planes, &again, "written and read");
    planes_free(&again);
    exr_file_close(file);
}

static void check_plane(const Planes *planes, const Plane *plane)
{
    size_t pixels = (size_t)planes->width * (size_t)planes->height;
    for (size_t i = 0; i < pixels; i++)
        if (plane->kind == KIND_UNORM)
            FUZZ_CHECK(plane->bits[i] <= plane->unorm_max, "%u of at most %u", plane->bits[i],
                       plane->unorm_max);
        else if (plane->kind == KIND_HALF)
            FUZZ_CHECK(plane->bits[i] <= 0xffff, "%#x is no half", plane->bits[i]);
}

/* False for planes beyond BYTES_MAX, an image of which is not asked for. */
static bool read_planes(const char *path, ExrFile *file, int part)
{
    Planes planes, again;
    (void)exr_file_name(file, part);
    Result result = exr_file_planes(file, part, BYTES_MAX, &planes);
    if (result != RESULT_OK) {
        fuzz_check_message();
        FUZZ_CHECK(planes.count == 0 && !planes.planes, "planes after a failure");
        return result != RESULT_NO_MEMORY;
    }
    FUZZ_CHECK(!exr_file_is_deep(file, part), "a deep part is flat");
    for (int i = 0; i < planes.count; i++)
        check_plane(&planes, &planes.planes[i]);
    FUZZ_CHECK(exr_file_planes(file, part, BYTES_MAX, &again) == RESULT_OK, "%s: read once", path);
    check_planes_equal(&planes, &again, "read twice");
    planes_free(&again);
    check_written(&planes);
    planes_free(&planes);
    return true;
}

static void read_image(const char *path, int part)
{
    Image image;
    char name[64];
    bool has;
    if (exr_read(path, part, &image, name) != RESULT_OK) {
        fuzz_check_message();
        FUZZ_CHECK(!image.pixels, "pixels after a failure");
        return;
    }
    size_t bytes = format_pixel_bytes(image.format);
    size_t pixels = (size_t)image.width * (size_t)image.height;
    double sum = 0.0;
    for (size_t i = 0; i < pixels; i++)
        sum += format_info(image.format)->kind == KIND_FLOAT
                   ? 0.0
                   : fabs((double)format_channel(image.format,
                                                 (const char *)image.pixels + i * bytes, 0));
    FUZZ_CHECK(sum >= 0.0 || isnan(sum), "a sum of magnitudes");
    FUZZ_CHECK(exr_has_channel(path, part, "A", &has) == RESULT_OK, "part %d was read", part);
    image_free(&image);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    const char *path = fuzz_file(0, data, size);
    ExrFile *file;
    bool is;
    FUZZ_CHECK(exr_is(path, &is) == RESULT_OK, "a file of %zu bytes", size);
    if (exr_file_open(path, &file) != RESULT_OK) {
        fuzz_check_message();
        return 0;
    }
    FUZZ_CHECK(is, "opened, but no EXR file");
    int parts = exr_file_count(file);
    (void)exr_file_is_trace(file);
    for (int part = 0; part < parts && part < PARTS_MAX; part++)
        if (read_planes(path, file, part))
            read_image(path, part);
    exr_file_close(file);
    return 0;
}
