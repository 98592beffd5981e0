/* compare/store.h: what is put is what is read, sparse, shared, spilled or not. */
#include "testing.h"

#include "base/random.h"
#include "compare/store.h"

#include <stdio.h>

static TraceStore *store;

static void open_store(size_t budget)
{
    ck_assert_int_eq(store_create(budget, &store), RESULT_OK);
}

static Image random_image(Random *random, int width, int height, PixelFormat format)
{
    Image image;
    ck_assert_int_eq(image_create(width, height, format, &image), RESULT_OK);
    unsigned char *bytes = image.pixels;
    for (size_t i = 0; i < (size_t)width * (size_t)height * format_pixel_bytes(format); i++)
        bytes[i] = (unsigned char)random_bits(random);
    return image;
}

static void put(const char *name, int step, const Image *image)
{
    ck_assert_msg(trace_put(store_sink(store), name, step, image->format, image->width,
                            image->height, image->pixels) == RESULT_OK,
                  "%s", result_message());
}

static void check_equal(const char *name, const Image *expected)
{
    Image got;
    int index = store_find(store, name);
    ck_assert_int_ge(index, 0);
    ck_assert_int_eq(store_image(store, index, &got), RESULT_OK);
    ck_assert_int_eq(got.width, expected->width);
    ck_assert_int_eq(got.height, expected->height);
    ck_assert_int_eq(got.format, expected->format);
    ck_assert_mem_eq(got.pixels, expected->pixels,
                     (size_t)got.width * (size_t)got.height * format_pixel_bytes(got.format));
    image_free(&got);
}

/* Every format and odd sizes, in memory and in the file. */
START_TEST(test_round_trip)
{
    static const int sizes[][2] = {{1, 1}, {64, 64}, {65, 63}, {130, 70}, {3, 200}};
    Random random = random_seed(1);
    open_store(_i ? 1 : 0);
    Image images[5][FORMAT_COUNT];
    char name[32];
    for (int s = 0; s < 5; s++)
        for (int f = 0; f < FORMAT_COUNT; f++) {
            images[s][f] = random_image(&random, sizes[s][0], sizes[s][1], (PixelFormat)f);
            snprintf(name, sizeof name, "buffer.%d.%d", s, f);
            put(name, s, &images[s][f]);
        }
    ck_assert_int_eq(store_count(store), 5 * FORMAT_COUNT);
    for (int s = 0; s < 5; s++)
        for (int f = 0; f < FORMAT_COUNT; f++) {
            snprintf(name, sizeof name, "buffer.%d.%d", s, f);
            ck_assert_int_eq(store_buffer(store, store_find(store, name))->step, s);
            check_equal(name, &images[s][f]);
            image_free(&images[s][f]);
        }
    ck_assert_int_eq(store_find(store, "buffer.9.9"), -1);
    /* Random tiles do not compress: all is in memory, or, past a budget of one byte, in the file;
     * the 1 × 1 images are constant tiles. */
    ck_assert((store_memory_bytes(store) == 0) == (_i == 1));
    ck_assert((store_file_bytes(store) == 0) == (_i == 0));
    store_destroy(store);
}
END_TEST

START_TEST(test_budget)
{
    Random random = random_seed(2);
    Image image = random_image(&random, 256, 64, FORMAT_RGBA32F); /* four tiles of 64 KiB */
    open_store(3 * 65536);
    put("a", 0, &image);
    ck_assert_uint_eq(store_memory_bytes(store), 3 * 65536);
    ck_assert_uint_eq(store_file_bytes(store), 65536);
    check_equal("a", &image);
    store_destroy(store);
    image_free(&image);
}
END_TEST

/* Constant tiles cost nothing; a tile equal to the previous peel's is shared with it. */
START_TEST(test_sparse_and_shared)
{
    Random random = random_seed(3);
    Image flat;
    ck_assert_int_eq(image_create(200, 150, FORMAT_RGBA32F, &flat), RESULT_OK);
    open_store(_i ? 1 : 0);
    put("opaque.normal", 0, &flat);
    ck_assert_uint_eq(store_memory_bytes(store) + store_file_bytes(store), 0);

    Image image = random_image(&random, 128, 64, FORMAT_RGBA32F); /* two tiles */
    put("peel.0.accum", 1, &image);
    uint64_t one = store_memory_bytes(store) + store_file_bytes(store);
    ck_assert_uint_eq(one, 2 * 65536);
    put("peel.1.accum", 2, &image);
    ck_assert_uint_eq(store_memory_bytes(store) + store_file_bytes(store), one);
    ((float *)image_pixel(&image, 100, 5))[2] = 7.0f; /* the second tile changes */
    put("peel.2.accum", 3, &image);
    ck_assert_uint_eq(store_memory_bytes(store) + store_file_bytes(store), one + 65536);
    check_equal("peel.2.accum", &image);
    put("peel.2.depthless", 3, &image); /* another buffer shares nothing */
    ck_assert_uint_eq(store_memory_bytes(store) + store_file_bytes(store), 2 * one + 65536);
    check_equal("opaque.normal", &flat);
    store_destroy(store);
    image_free(&flat);
    image_free(&image);
}
END_TEST

/* Rectangles in any order; what never came reads as 0, or as no index. */
START_TEST(test_rectangles)
{
    Random random = random_seed(4);
    for (int f = 0; f < 2; f++) {
        Image image = random_image(&random, 150, 140, f ? FORMAT_R32UI : FORMAT_RGBA16);
        open_store(0);
        for (int tile = 8; tile >= 0; tile -= 2) { /* the corners and the middle */
            int x = tile % 3 * TRACE_TILE, y = tile / 3 * TRACE_TILE;
            TraceBuffer rectangle = {
                .name = "peel.0.primitive",
                .step = 1,
                .format = image.format,
                .image_width = 150,
                .image_height = 140,
                .x = x,
                .y = y,
                .width = x + TRACE_TILE > 150 ? 150 - x : TRACE_TILE,
                .height = y + TRACE_TILE > 140 ? 140 - y : TRACE_TILE,
                .pixels = image_pixel(&image, x, y),
                .row_bytes = 150 * format_pixel_bytes(image.format),
            };
            ck_assert_int_eq(store_sink(store)->put(store_sink(store), &rectangle), RESULT_OK);
        }
        for (int y = 0; y < 140; y++)
            for (int x = 0; x < 150; x++)
                if ((x / TRACE_TILE + y / TRACE_TILE * 3) % 2)
                    memset(image_pixel(&image, x, y), f ? 0xff : 0,
                           format_pixel_bytes(image.format));
        check_equal("peel.0.primitive", &image);
        store_destroy(store);
        image_free(&image);
    }
}
END_TEST

/* Any rectangle, into rows wider than it; bytes beside them are left alone. */
START_TEST(test_read_rectangle)
{
    Random random = random_seed(5);
    Image image = random_image(&random, 150, 140, FORMAT_RGBA8);
    open_store(_i ? 1 : 0);
    put("a", 0, &image);
    for (int i = 0; i < 500; i++) {
        static unsigned char got[140][640];
        int x = (int)(random_bits(&random) % 150), y = (int)(random_bits(&random) % 140);
        int width = 1 + (int)(random_bits(&random) % (uint64_t)(150 - x));
        int height = 1 + (int)(random_bits(&random) % (uint64_t)(140 - y));
        memset(got, 0xa5, sizeof got);
        ck_assert_int_eq(store_read(store, 0, x, y, width, height, got, sizeof got[0]), RESULT_OK);
        for (int row = 0; row < height; row++) {
            if (memcmp(got[row], image_pixel(&image, x, y + row), 4 * (size_t)width) != 0)
                ck_abort_msg("row %d of %d×%d at (%d, %d) differs", row, width, height, x, y);
            if (width < 150 && got[row][4 * width] != 0xa5)
                ck_abort_msg("wrote past %d×%d at (%d, %d)", width, height, x, y);
        }
    }
    store_destroy(store);
    image_free(&image);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("store");
    TCase *tcase = tcase_create("store");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, test_round_trip, 0, 2);
    tcase_add_test(tcase, test_budget);
    tcase_add_loop_test(tcase, test_sparse_and_shared, 0, 2);
    tcase_add_test(tcase, test_rectangles);
    tcase_add_loop_test(tcase, test_read_rectangle, 0, 2);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
