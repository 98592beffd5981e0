/* compare/perceive.h: differences that are plainly seen, and some that are not. */
#include "testing.h"

#include "compare/perceive.h"

#include <math.h>

enum {
    SIDE = 64
};

/* A colour image; the caller frees it. */
static Planes grey_image(int width, int height, float level)
{
    static const char *const names[] = {"R", "G", "B"};
    Planes planes;
    ck_assert_int_eq(planes_create(width, height, 3, 0, "image", &planes), RESULT_OK);
    for (int c = 0; c < 3; c++) {
        ck_assert_int_eq(planes_name(&planes.planes[c], names[c]), RESULT_OK);
        for (int i = 0; i < width * height; i++)
            planes.planes[c].bits[i] = testing_bits(level);
    }
    return planes;
}

static uint64_t seen(Planes *a, Planes *b)
{
    uint64_t count;
    ck_assert_int_eq(perceive_count(a, b, 0, &count), RESULT_OK);
    planes_free(a);
    planes_free(b);
    return count;
}

static uint64_t seen_greys(float a, float b)
{
    Planes planes_a = grey_image(SIDE, SIDE, a), planes_b = grey_image(SIDE, SIDE, b);
    return seen(&planes_a, &planes_b);
}

/* Of 50 cd/m² the threshold is 3.3, of 5 it is 0.9. */
START_TEST(test_luminance)
{
    ck_assert_uint_eq(seen_greys(0.5f, 0.5f), 0);
    ck_assert_uint_eq(seen_greys(0.5f, 0.53f), 0);
    ck_assert_uint_eq(seen_greys(0.5f, 0.54f), SIDE * SIDE);
    ck_assert_uint_eq(seen_greys(0.05f, 0.055f), 0);
    ck_assert_uint_eq(seen_greys(0.05f, 0.065f), SIDE * SIDE);
    ck_assert_uint_eq(seen_greys(0.0f, 0.0f), 0);
    ck_assert_uint_eq(seen_greys(NAN, 0.0f), 0); /* counts as black */
    ck_assert_uint_eq(seen_greys(-1.0f, INFINITY), 0);
}
END_TEST

START_TEST(test_place)
{
    Planes a = grey_image(SIDE, SIDE, 0.5f), b = grey_image(SIDE, SIDE, 0.5f);
    for (int c = 0; c < 3; c++)
        b.planes[c].bits[SIDE * 5 + 7] = testing_bits(1.0f);
    ck_assert_uint_eq(seen(&a, &b), 1);
}
END_TEST

/* Another colour of one luminance; in the dark it fades. */
START_TEST(test_colour)
{
    Planes a = grey_image(SIDE, SIDE, 0.5f), b = grey_image(SIDE, SIDE, 0.5f);
    for (int i = 0; i < SIDE * SIDE; i++) {
        b.planes[0].bits[i] = testing_bits(0.6f);
        b.planes[1].bits[i] = testing_bits(0.4702f);
    }
    ck_assert_uint_eq(seen(&a, &b), SIDE * SIDE);
    a = grey_image(SIDE, SIDE, 0.02f);
    b = grey_image(SIDE, SIDE, 0.02f);
    for (int i = 0; i < SIDE * SIDE; i++) {
        b.planes[0].bits[i] = testing_bits(0.024f);
        b.planes[1].bits[i] = testing_bits(0.018811f);
    }
    ck_assert_uint_eq(seen(&a, &b), 0);
}
END_TEST

/* Contrast around a difference hides it. */
START_TEST(test_masking)
{
    uint64_t counts[2];
    for (int busy = 0; busy < 2; busy++) {
        Planes a = grey_image(512, SIDE, 0.5f), b = grey_image(512, SIDE, 0.5f);
        for (int i = 0; i < 512 * SIDE; i++)
            for (int c = 0; c < 3; c++) {
                float level = busy ? (float)((i ^ i / 512) & 1) * 0.8f + 0.1f : 0.5f;
                a.planes[c].bits[i] = testing_bits(level);
                b.planes[c].bits[i] = testing_bits(level + 0.05f);
            }
        counts[busy] = seen(&a, &b);
    }
    ck_assert_uint_eq(counts[0], 512 * SIDE);
    ck_assert_uint_eq(counts[1], 0);
}
END_TEST

/* Codes are encoded as sRGB is: 188 is 0.503 of the light, not 0.737. */
START_TEST(test_encoded)
{
    Planes a = grey_image(SIDE, SIDE, 0.503f), b = grey_image(SIDE, SIDE, 0.0f);
    for (int c = 0; c < 3; c++) {
        b.planes[c].kind = KIND_UNORM;
        b.planes[c].unorm_max = 255;
        for (int i = 0; i < SIDE * SIDE; i++)
            b.planes[c].bits[i] = 188;
    }
    ck_assert_uint_eq(seen(&a, &b), 0);
}
END_TEST

START_TEST(test_small)
{
    for (int width = 1; width <= 3; width++)
        for (int height = 1; height <= 3; height++) {
            Planes a = grey_image(width, height, 0.5f), b = grey_image(width, height, 1.0f);
            ck_assert(perceive_possible(&a, &b));
            ck_assert_uint_eq(seen(&a, &b), (uint64_t)(width * height));
        }
    Planes a = grey_image(1, 1, 0.5f), b = grey_image(1, 1, 1.0f);
    b.planes[1].name[0] = 'Y';
    ck_assert(!perceive_possible(&a, &b));
    planes_free(&a);
    planes_free(&b);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("perceive");
    TCase *tcase = tcase_create("perceive");
    tcase_add_test(tcase, test_luminance);
    tcase_add_test(tcase, test_place);
    tcase_add_test(tcase, test_colour);
    tcase_add_test(tcase, test_masking);
    tcase_add_test(tcase, test_encoded);
    tcase_add_test(tcase, test_small);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
