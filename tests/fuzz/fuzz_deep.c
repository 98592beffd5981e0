/* Deep OpenEXR files: reading, compositing, and writing again. What they take is at most 2^26
 * bytes. */
#include "fuzz.h"

#include "image/exr_deep.h"

#include <math.h>

enum {
    BYTES_MAX = 1 << 26,
    WRITTEN_MAX = 1 << 12 /* pixels or samples, of what is written again */
};

static void check_image(const DeepImage *image)
{
    uint64_t total = 0;
    uint32_t most = 0;
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++) {
            uint32_t count;
            const DeepSample *samples = deep_pixel(image, x, y, &count);
            for (uint32_t i = 0; i < count; i++)
                FUZZ_CHECK(!isnan(samples[i].z) && (i == 0 || samples[i - 1].z <= samples[i].z),
                           "sample %u of pixel %d,%d is in no order", i, x, y);
            total += count;
            most = count > most ? count : most;
        }
    FUZZ_CHECK(total == image->sample_count && most == deep_most(image), "samples: %llu, %u",
               (unsigned long long)total, most);
    FUZZ_CHECK(image->bytes <= BYTES_MAX, "%zu bytes", image->bytes);
}

static void check_equal(const DeepImage *a, const DeepImage *b)
{
    FUZZ_CHECK(a->width == b->width && a->height == b->height &&
                   a->sample_count == b->sample_count && a->has_camera == b->has_camera,
               "%dx%d, %llu samples", b->width, b->height, (unsigned long long)b->sample_count);
    for (int y = 0; y < a->height; y++)
        for (int x = 0; x < a->width; x++) {
            uint32_t counts[2];
            const DeepSample *one = deep_pixel(a, x, y, &counts[0]);
            const DeepSample *other = deep_pixel(b, x, y, &counts[1]);
            FUZZ_CHECK(counts[0] == counts[1] &&
                           (counts[0] == 0 || memcmp(one, other, counts[0] * sizeof *one) == 0),
                       "pixel %d,%d", x, y);
        }
}

static void check_written(const DeepImage *image)
{
    DeepImage again;
    if ((int64_t)image->width * image->height > WRITTEN_MAX || image->sample_count > WRITTEN_MAX)
        return;
    FUZZ_CHECK(exr_deep_write(image, fuzz_output()) == RESULT_OK &&
                   exr_deep_read(fuzz_output(), BYTES_MAX, &again) == RESULT_OK,
               "an image that was read");
    check_equal(image, &again);
    deep_free(&again);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    DeepImage image;
    Image flat;
    if (exr_deep_read(fuzz_file(0, data, size), BYTES_MAX, &image) != RESULT_OK) {
        fuzz_check_message();
        FUZZ_CHECK(!image.counts && !image.pixels && !image.blocks, "samples after a failure");
        return 0;
    }
    check_image(&image);
    FUZZ_CHECK(deep_flatten(&image, &flat) == RESULT_OK, "%dx%d", image.width, image.height);
    check_written(&image);
    image_free(&flat);
    deep_free(&image);
    return 0;
}
