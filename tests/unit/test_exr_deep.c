/* image/exr_deep: samples survive a round trip, other readers agree, other writers' files are read,
 * broken ones are refused. */
#include "image/exr_deep.h"

#include "base/file.h"
#include "base/random.h"
#include "compare/diff_files.h"
#include "foreign_deep.h"
#include "image/exr.h"
#include "image/exr_deep_core.h"
#include "scratch.h"
#include "testing.h"

#include <math.h>
#include <stdio.h>

enum {
    MEMORY = 1 << 28
};

/* Random bits in everything but z, which grows. Some pixels and, one in four, whole rows have no
 * samples. */
static DeepImage noise(int width, int height, int most, uint64_t seed)
{
    DeepImage image;
    DeepSample *samples;
    Random random = random_seed(seed);
    ck_assert_int_eq(deep_create(width, height, SIZE_MAX, &image), RESULT_OK);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            uint32_t count = (uint32_t)(random_bits(&random) % ((uint64_t)most + 1));
            count = (uint64_t)y % 4 == seed % 4 && height > 1 ? 0 : count;
            ck_assert_int_eq(deep_block(&image, count, &samples), RESULT_OK);
            for (size_t i = 0; i < count * sizeof *samples; i++)
                ((uint8_t *)samples)[i] = (uint8_t)random_bits(&random);
            for (uint32_t i = 0; i < count; i++)
                samples[i].z = 1.0f + (float)i / 8;
            deep_set(&image, x, y, samples, count);
        }
    return image;
}

static void assert_same(const DeepImage *got, const DeepImage *expected)
{
    ck_assert_int_eq(got->width, expected->width);
    ck_assert_int_eq(got->height, expected->height);
    ck_assert_uint_eq(got->sample_count, expected->sample_count);
    for (int y = 0; y < got->height; y++)
        for (int x = 0; x < got->width; x++) {
            uint32_t a_count, b_count;
            const DeepSample *a = deep_pixel(got, x, y, &a_count);
            const DeepSample *b = deep_pixel(expected, x, y, &b_count);
            if (a_count != b_count || (a_count && memcmp(a, b, a_count * sizeof *a) != 0))
                ck_abort_msg("pixel %d,%d differs: %u samples, expected %u", x, y, a_count,
                             b_count);
        }
}

START_TEST(test_round_trip)
{
    static const int sizes[][3] = {{37, 23, 5}, {1, 1, 1}, {1, 1, 0},   {1, 19, 3},
                                   {300, 2, 9}, {5, 4, 0}, {2, 1, 3000}};
    const char *path = scratch_path("a.exr");
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        DeepImage image = noise(sizes[s][0], sizes[s][1], sizes[s][2], 7 + s), back;
        image.has_camera = s % 2;
        for (int i = 0; i < 16; i++) {
            image.world_to_camera[i] = image.has_camera ? (float)i / 8 : 0;
            image.world_to_ndc[i] = image.has_camera ? (float)i / -4 : 0;
        }
        ck_assert_msg(exr_deep_write(&image, path) == RESULT_OK, "%s", result_message());
        ck_assert_int_eq(scratch_entries(), 1);
        ck_assert_msg(exr_deep_read(path, MEMORY, &back) == RESULT_OK, "%s", result_message());
        assert_same(&back, &image);
        ck_assert_int_eq(back.has_camera, image.has_camera);
        ck_assert_mem_eq(back.world_to_camera, image.world_to_camera, sizeof(float[16]));
        ck_assert_mem_eq(back.world_to_ndc, image.world_to_ndc, sizeof(float[16]));
        deep_free(&back);
        deep_free(&image);
    }
}
END_TEST

START_TEST(test_other_reader)
{
    const char *path = scratch_path("a.exr");
    DeepImage image;
    DeepSample *samples;
    ck_assert_int_eq(deep_create(3, 2, SIZE_MAX, &image), RESULT_OK);
    ck_assert_int_eq(deep_block(&image, 3, &samples), RESULT_OK);
    samples[0] = (DeepSample){{0.5f, 0.25f, 0.125f, 0.5f}, 2, 0.75f, 70000, 3};
    samples[1] = (DeepSample){{0, 1, 2, 1}, 2.5f, 0.875f, 80000, 4};
    samples[2] = samples[1];
    deep_set(&image, 1, 1, samples, 2);
    deep_set(&image, 2, 0, &samples[2], 1);
    ck_assert_int_eq(exr_deep_write(&image, path), RESULT_OK);
    char command[256], text[16384];
    snprintf(command, sizeof command, "oiiotool --info -v --stats --dumpdata %s 2>&1", path);
    ck_assert_int_eq(scratch_run(command, text, sizeof text), 0);
    static const char *const expected[] = {
        "3 x    2, 8 channel, deep float/float/float/float/float/uint/uint/float openexr",
        "compression: \"zips\"",
        "maxSamplesPerPixel: 2",
        "Total deep samples in all pixels: 3",
        "Minimum depth was 2 at (1, 1)",
        "R=0.5 G=0.25 B=0.125 A=0.5 Z=2 materialid=3 primitiveid=70000 depth.window=0.75",
        "R=0 G=1 B=2 A=1 Z=2.5 materialid=4 primitiveid=80000 depth.window=0.875",
    };
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
        ck_assert_msg(strstr(text, expected[i]) != NULL, "no '%s' in: %s", expected[i], text);
    /* Tidy, and said so; not where two samples have one Z. */
    exr_context_t context;
    const char *type;
    const void *state;
    int32_t size;
    for (int tie = 0; tie < 2; tie++) {
        samples[1].z = tie ? 2 : 2.5f;
        ck_assert_int_eq(exr_deep_write(&image, path), RESULT_OK);
        ck_assert_int_eq(exr_start_read(&context, path, NULL), EXR_ERR_SUCCESS);
        exr_result_t code = exr_attr_get_user(context, 0, "deepImageState", &type, &size, &state);
        ck_assert_int_eq(code == EXR_ERR_SUCCESS, !tie);
        if (!tie)
            ck_assert(size == 1 && *(const uint8_t *)state == 3);
        exr_finish(&context);
    }
    deep_free(&image);
}
END_TEST

/* ---- files of others ------------------------------------------------------------------------ */

START_TEST(test_unsorted)
{
    /* Pixel 0: Z 3, 1, 2, 1; pixel 1 none; pixel 2: one sample. A numbers them. */
    const float values[] = {1, 2, 3, 4, 5, 0, 0, 0, 0, 0, 0, 0, 0,
                            0, 0, 0, 0, 0, 0, 0, 3, 1, 2, 1, 9};
    Foreign foreign = {RGBAZ, FLOATS, 3, {4, 4, 5}, values, sizeof values, false};
    const char *path = scratch_path("a.exr");
    write_foreign(&foreign, path);
    DeepImage image;
    ck_assert_msg(exr_deep_read(path, MEMORY, &image) == RESULT_OK, "%s", result_message());
    ck_assert(image.width == 3 && image.height == 1 && image.sample_count == 5);
    ck_assert(!image.has_camera);
    static const float alpha[] = {2, 4, 3, 1}, z[] = {1, 1, 2, 3};
    for (int i = 0; i < 4; i++) {
        ck_assert_float_bits(image.pixels[0][i].rgba[3], alpha[i]);
        ck_assert_float_bits(image.pixels[0][i].z, z[i]);
        ck_assert_uint_eq(image.pixels[0][i].primitive, DEEP_NO_ID);
        ck_assert_uint_eq(image.pixels[0][i].material, DEEP_NO_ID);
    }
    ck_assert_ptr_null(image.pixels[1]);
    ck_assert_float_bits(image.pixels[2][0].rgba[3], 5);
    deep_free(&image);
}
END_TEST

START_TEST(test_run_lengths)
{
    /* Eight samples: runs of zeros, and values between them. */
    float values[40] = {0.5f, 0.25f};
    for (int i = 0; i < 8; i++)
        values[32 + i] = i < 4 ? 1 : 1.0f + (float)i / 7;
    Foreign foreign = {RGBAZ, FLOATS, 1, {8}, values, sizeof values, true};
    const char *path = scratch_path("a.exr");
    write_foreign(&foreign, path);
    DeepImage image;
    ck_assert_msg(exr_deep_read(path, MEMORY, &image) == RESULT_OK, "%s", result_message());
    ck_assert_uint_eq(image.counts[0], 8);
    for (int i = 0; i < 8; i++) {
        ck_assert_float_bits(image.pixels[0][i].rgba[3], values[i]);
        ck_assert_float_bits(image.pixels[0][i].rgba[0], 0);
        ck_assert_float_bits(image.pixels[0][i].z, values[32 + i]);
    }
    deep_free(&image);
}
END_TEST

START_TEST(test_half_and_more_channels)
{
    /* One sample: A, B half, G uint, R float, Z half, depth, then ids: of a type that none has. */
    static const uint8_t values[] = {0x00, 0x38, 0x00, 0x3c, 3, 0,    0,    0, 0, 0,    0x80,
                                     0x3e, 0x00, 0x42, 0,    0, 0x80, 0x3f, 0, 0, 0x80, 0x3f};
    Foreign foreign = {{"A", "B", "G", "R", "Z", "beauty", "materialid"},
                       {EXR_PIXEL_HALF, EXR_PIXEL_HALF, EXR_PIXEL_UINT, EXR_PIXEL_FLOAT,
                        EXR_PIXEL_HALF, EXR_PIXEL_FLOAT, EXR_PIXEL_FLOAT},
                       1,
                       {1},
                       values,
                       sizeof values,
                       false};
    const char *path = scratch_path("a.exr");
    write_foreign(&foreign, path);
    DeepImage image;
    ck_assert_msg(exr_deep_read(path, MEMORY, &image) == RESULT_OK, "%s", result_message());
    const DeepSample expected = {{0.25f, 3, 1, 0.5f}, 3, 0, DEEP_NO_ID, DEEP_NO_ID};
    ck_assert_mem_eq(image.pixels[0], &expected, sizeof expected);
    deep_free(&image);
}
END_TEST

static Result refuse(const char *path, size_t memory)
{
    DeepImage image;
    Result result = exr_deep_read(path, memory, &image);
    ck_assert_int_ne(result, RESULT_OK);
    ck_assert_ptr_null(strchr(result_message(), '\n'));
    ck_assert(!image.counts && !image.pixels && !image.blocks);
    return result;
}

START_TEST(test_foreign_refused)
{
    const char *path = scratch_path("a.exr");
    /* Two samples in one pixel: Z 1 and 2, and where they end. */
    float values[] = {0, 0, 0, 0, 0, 0, 0, 0, 1, 2, 2, 2};
    Foreign volumes = {
        {"A", "B", "G", "R", "Z", "ZBack"}, FLOATS, 1, {2}, values, sizeof values, false};
    DeepImage image;
    write_foreign(&volumes, path);
    ck_assert_msg(exr_deep_read(path, MEMORY, &image) == RESULT_OK, "%s", result_message());
    deep_free(&image);
    values[10] = nextafterf(2, 3);
    write_foreign(&volumes, path);
    ck_assert_int_eq(refuse(path, MEMORY), RESULT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(result_message(), "ZBack"));
    values[10] = NAN;
    write_foreign(&volumes, path);
    ck_assert_int_eq(refuse(path, MEMORY), RESULT_BAD_INPUT);
    values[10] = 2;
    values[8] = NAN;
    write_foreign(&volumes, path);
    ck_assert_int_eq(refuse(path, MEMORY), RESULT_BAD_INPUT);
    /* Counts that do not fit the samples, decrease, or are negative. */
    static const uint32_t totals[][2] = {
        {1, 1}, {3, 3}, {2, 1}, {0x80000002u, 2}, {2, 0x80000002u}};
    Foreign counts = {RGBAZ, FLOATS, 2, {0}, values, 40, false};
    for (int i = 0; i < 5; i++) {
        memcpy(counts.totals, totals[i], sizeof totals[i]);
        values[8] = 1;
        write_foreign(&counts, path);
        ck_assert_int_eq(refuse(path, MEMORY), RESULT_BAD_INPUT);
    }
    memcpy(counts.totals, (uint32_t[]){1, 2}, 8);
    write_foreign(&counts, path);
    ck_assert_int_eq(refuse(path, 50), RESULT_NO_MEMORY);
    ck_assert_msg(exr_deep_read(path, MEMORY, &image) == RESULT_OK, "%s", result_message());
    size_t kept = image.bytes;
    deep_free(&image);
    /* What a row takes while it is unpacked counts: its samples twice, at least. */
    ck_assert_int_eq(refuse(path, kept + 2 * 40 - 1), RESULT_NO_MEMORY);
    Foreign lacking = {{"A", "B", "G", "R"}, FLOATS, 1, {1}, values, 16, false};
    write_foreign(&lacking, path);
    ck_assert_int_eq(refuse(path, MEMORY), RESULT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(result_message(), "no channel Z"));
}
END_TEST

/* A part of deep tiles first, then one of scanlines, of one sample each. */
static void write_behind_tiles(const char *path)
{
    static const char *const channels[] = RGBAZ;
    static const float sample[5] = {1, 1, 1, 1, 2};
    exr_context_t context;
    const uint32_t one = 1;
    int index, failed = 0;
    failed |= exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, NULL);
    failed |= exr_add_part(context, "tiles", EXR_STORAGE_DEEP_TILED, &index);
    failed |= exr_add_part(context, "rows", EXR_STORAGE_DEEP_SCANLINE, &index);
    for (int part = 0; part < 2; part++) {
        failed |= exr_initialize_required_attr_simple(context, part, 1, 1, EXR_COMPRESSION_NONE);
        for (int i = 0; i < 5; i++)
            failed |= exr_add_channel(context, part, channels[i], EXR_PIXEL_FLOAT,
                                      EXR_PERCEPTUALLY_LINEAR, 1, 1);
    }
    failed |= exr_set_tile_descriptor(context, 0, 1, 1, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN);
    failed |= exr_write_header(context);
    failed |= exr_write_deep_tile_chunk(context, 0, 0, 0, 0, 0, sample, sizeof sample,
                                        sizeof sample, &one, sizeof one);
    failed |= exr_write_deep_scanline_chunk(context, 1, 0, sample, sizeof sample, sizeof sample,
                                            &one, sizeof one);
    failed |= exr_finish(&context);
    ck_assert_int_eq(failed, 0);
}

START_TEST(test_behind_tiles)
{
    const char *path = scratch_path("a.exr");
    const DiffFilesOptions options = {0};
    DeepImage image;
    DiffReport report;
    write_behind_tiles(path);
    ck_assert_msg(exr_deep_read(path, MEMORY, &image) == RESULT_OK, "%s", result_message());
    ck_assert_int_eq(image.part, 1);
    deep_free(&image);
    ck_assert_int_eq(diff_files(path, path, &options, &report), RESULT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(result_message(), "part 0 is of deep tiles"));
    diff_report_free(&report);
}
END_TEST

/* What oiiotool makes of flat images: another writer. */
START_TEST(test_oiiotool_files)
{
    char command[1024], text[1024];
    const char *path = scratch_path("a.exr"), *merged = scratch_path("b.exr");
    snprintf(command, sizeof command,
             "oiiotool --pattern constant:color=0.25,0.5,0.125,0.5,3 40x30 5 "
             "--chnames R,G,B,A,Z --deepen --pattern constant:color=0,0.25,0.5,0.25,2 40x30 5 "
             "--chnames R,G,B,A,Z --deepen --deepmerge -o %s 2>&1",
             merged);
    ck_assert_msg(scratch_run(command, text, sizeof text) == 0, "%s", text);
    DeepImage deep;
    ck_assert_msg(exr_deep_read(merged, MEMORY, &deep) == RESULT_OK, "%s", result_message());
    ck_assert_uint_eq(deep.sample_count, 2 * 40 * 30);
    Image flat;
    ck_assert_int_eq(deep_flatten(&deep, &flat), RESULT_OK);
    const float expected[4] = {0.1875f, 0.625f, 0.59375f, 0.625f};
    for (int p = 0; p < 40 * 30; p++)
        ck_assert_mem_eq((float *)flat.pixels + 4 * p, expected, sizeof expected);
    image_free(&flat);
    deep_free(&deep);
    snprintf(command, sizeof command, "oiiotool --pattern constant:color=1,1,1 64x64 3 -o %s 2>&1",
             path);
    ck_assert_int_eq(scratch_run(command, text, sizeof text), 0);
    ck_assert_int_eq(refuse(path, MEMORY), RESULT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(result_message(), "deep scanlines"));
    Image image;
    char name[64];
    ck_assert_int_eq(exr_read(merged, 0, &image, name), RESULT_UNSUPPORTED);
}
END_TEST

/* Run lengths that end early, ask for more than there is or give more than there is room for; 4
 * bytes are expected. Buffers have exactly their sizes, for the sanitizer, and canaries. */
START_TEST(test_broken_runs)
{
    static const struct {
        uint8_t bytes[8];
        size_t size;
        bool good;
    } cases[] = {
        {{3, 7}, 2, true},
        {{0xfe, 1, 2, 1, 9}, 5, true},
        {{2, 7}, 2, false},
        {{4, 7}, 2, false},
        {{127, 7}, 2, false},
        {{3}, 1, false},
        {{0xfc, 1, 2, 3}, 3, false},
        {{0xfc, 1}, 2, false},
        {{0xff, 1, 0x80}, 3, false},
        {{0xff}, 1, false},
        {{0xfb, 1, 2, 3, 4, 5}, 6, false},
        {{3, 7, 0, 7}, 3, false},
        {{0}, 0, false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        uint8_t *in = malloc(cases[i].size), *out = malloc(5), *scratch = malloc(5);
        memcpy(in, cases[i].bytes, cases[i].size);
        out[4] = scratch[4] = 0xa5;
        bool good = exr_deep_unpack(EXR_COMPRESSION_RLE, in, cases[i].size, scratch, out, 4);
        ck_assert_msg(good == cases[i].good, "case %zu: %d", i, good);
        ck_assert_msg(out[4] == 0xa5 && scratch[4] == 0xa5, "case %zu wrote too far", i);
        free(in);
        free(out);
        free(scratch);
    }
}
END_TEST

/* ---- broken files --------------------------------------------------------------------------- */

START_TEST(test_truncated)
{
    const char *path = scratch_path("a.exr"), *bad = scratch_path("bad.exr");
    static char bytes[1 << 16];
    ck_assert_ptr_nonnull(freopen(scratch_path("stderr"), "w", stderr));
    DeepImage image = noise(13, 9, 4, 1);
    ck_assert_int_eq(exr_deep_write(&image, path), RESULT_OK);
    deep_free(&image);
    size_t size = scratch_read(path, bytes, sizeof bytes);
    for (size_t keep = 0; keep < size; keep += 1 + keep % 3) {
        ck_assert_int_eq(file_write(bad, bytes, keep), RESULT_OK);
        Result result = refuse(bad, MEMORY);
        ck_assert_msg(result == RESULT_BAD_INPUT, "%zu bytes: %s", keep, result_message());
        ck_assert_ptr_nonnull(strstr(result_message(), bad));
    }
    ck_assert_int_eq(refuse(scratch_path("none.exr"), MEMORY), RESULT_IO);
    ck_assert_int_eq(refuse(scratch_directory, MEMORY), RESULT_BAD_INPUT);
    fflush(stderr);
    ck_assert_uint_eq(scratch_read(scratch_path("stderr"), bytes, sizeof bytes), 0);
}
END_TEST

/* Flipped bits, bytes of extreme numbers and moved pieces must never do more than fail. The second
 * file is not compressed, so that they reach tables and samples; the third has run lengths.
 * PEEL_TEST_COUNT: cases. */
START_TEST(test_mutations)
{
    const char *path = scratch_path("a.exr"), *bad = scratch_path("bad.exr");
    static char bytes[1 << 16], broken[1 << 16];
    const char *asked = getenv("PEEL_TEST_COUNT");
    uint64_t cases = asked ? strtoull(asked, NULL, 10) : 1500;
    float values[40] = {0};
    for (int i = 0; i < 40; i++)
        values[i] = (float)i / 16;
    if (_i == 0) {
        DeepImage image = noise(13, 9, 4, 1);
        image.has_camera = true;
        ck_assert_int_eq(exr_deep_write(&image, path), RESULT_OK);
        deep_free(&image);
    } else {
        Foreign foreign = {RGBAZ, FLOATS, 4, {1, 4, 4, 8}, values, sizeof values, _i == 2};
        write_foreign(&foreign, path);
    }
    size_t size = scratch_read(path, bytes, sizeof bytes);
    uint64_t refused = 0;
    for (uint64_t seed = 0; seed < cases; seed++) {
        Random random = random_seed(seed);
        memcpy(broken, bytes, size);
        for (uint64_t edits = 1 + random_bits(&random) % 4; edits; edits--) {
            static const uint32_t extremes[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffffu, 0x10000};
            size_t at = random_bits(&random) % (size - 8);
            uint64_t kind = random_bits(&random) % 4;
            if (kind < 2)
                broken[at] ^= (char)(1 << random_bits(&random) % 8);
            else if (kind == 2)
                memcpy(broken + at, &extremes[random_bits(&random) % 6], 4);
            else
                memcpy(broken + at, bytes + random_bits(&random) % (size - 8), 8);
        }
        ck_assert_int_eq(file_write(bad, broken, size), RESULT_OK);
        DeepImage image;
        if (exr_deep_read(bad, 1 << 24, &image) == RESULT_OK) {
            Image flat;
            ck_assert_int_eq(deep_flatten(&image, &flat), RESULT_OK);
            image_free(&flat);
        } else {
            refused++;
        }
        deep_free(&image);
    }
    ck_assert_uint_gt(refused, cases / 4);
}
END_TEST

START_TEST(test_writer_failures)
{
    DeepImage image = noise(8, 8, 3, 1);
    ck_assert_int_eq(exr_deep_write(&image, scratch_path("missing/a.exr")), RESULT_IO);
    ck_assert_int_eq(exr_deep_write(&image, scratch_directory), RESULT_IO);
    for (rlim_t limit = 0; limit < 1500; limit += 100) {
        scratch_limit(limit);
        Result full = exr_deep_write(&image, scratch_path("a.exr"));
        scratch_limit(RLIM_INFINITY);
        ck_assert_msg(full == RESULT_IO && strstr(result_message(), "File too large"),
                      "limit %d: %s, %s", (int)limit, result_text(full), result_message());
    }
    ck_assert_int_eq(scratch_entries(), 0);
    /* More samples than a chunk can hold: said before anything is written or allocated. */
    image.counts[3] = image.counts[5] = 1 << 30;
    ck_assert_int_eq(exr_deep_write(&image, scratch_path("a.exr")), RESULT_UNSUPPORTED);
    ck_assert_ptr_nonnull(strstr(result_message(), "row 0 has 21474836"));
    ck_assert_int_eq(scratch_entries(), 0);
    deep_free(&image);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("exr_deep");
    TCase *tests = tcase_create("exr_deep");
    tcase_set_timeout(tests, 600);
    tcase_add_checked_fixture(tests, scratch_make, scratch_remove);
    tcase_add_test(tests, test_round_trip);
    tcase_add_test(tests, test_other_reader);
    tcase_add_test(tests, test_unsorted);
    tcase_add_test(tests, test_run_lengths);
    tcase_add_test(tests, test_half_and_more_channels);
    tcase_add_test(tests, test_foreign_refused);
    tcase_add_test(tests, test_behind_tiles);
    tcase_add_test(tests, test_oiiotool_files);
    tcase_add_test(tests, test_broken_runs);
    tcase_add_test(tests, test_truncated);
    tcase_add_loop_test(tests, test_mutations, 0, 3);
    tcase_add_test(tests, test_writer_failures);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}
