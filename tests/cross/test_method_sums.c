/* The methods that sum in one pass: ref against OpenGL bit for bit, and what each promises. */
#include "methods.h"

#include <math.h>

static const MethodId sums[] = {METHOD_WEIGHTED_AVERAGE, METHOD_WEIGHTED_SUM,
                                METHOD_WEIGHTED_BLENDED};
static const char *const sum_names[] = {"weighted-average.sum", "weighted-sum.sum",
                                        "weighted-blended.sum"};
static const RenderDesc window = {.width = 192, .height = 20};

START_TEST(test_bits)
{
    uint64_t fragments = 0;
    for (uint64_t i = 1; i <= 14; i++) {
        Bits bits;
        methods_check_soup(1000 * (uint64_t)_i + i, sums[_i], &bits);
        fragments += bits.layers.fragments;
        ck_assert_uint_eq(bits.layers.lost_to_ties, 0);
    }
    ck_assert_uint_gt(fragments, 0);
}
END_TEST

/* ---- draw order ----------------------------------------------------------------------------- */

/* Most additions of a pixel, less one. */
static double additions(const Frame *frame)
{
    return (double)frame->layers.max - 1.0;
}

/* Each of n − 1 additions is off by at most u of a partial sum, which no later one exceeds; both
 * orders are, so the sums differ by at most 2·(n − 1)·u of the greater, (1 + u)^n aside. A half is
 * truncated: u = 2^-10, and 2^-24 among denormals. All terms are at least 0. */
static uint64_t check_orders(const Soup *soup, RenderDesc desc, const char *name)
{
    Image a, b;
    Frame first, second;
    uint64_t differing = 0;
    bool half = desc.accum != FORMAT_RGBA32F;
    desc.width = 97;
    desc.height = 61;
    methods_buffer(&soup->scene, &desc, name, &a, &first);
    desc.draw_order = DRAW_ORDER_REVERSE;
    methods_buffer(&soup->scene, &desc, name, &b, &second);
    double unit = half ? 0x1p-10 : 0x1p-24, tiny = half ? 0x1p-24 : 0x1p-149;
    double bound = 2.1 * additions(&first);
    for (int y = 0; y < a.height; y++)
        for (int x = 0; x < a.width; x++)
            for (int c = 0; c < 4; c++) {
                double p = (double)format_channel(a.format, image_pixel(&a, x, y), c);
                double q = (double)format_channel(b.format, image_pixel(&b, x, y), c);
                differing += p != q;
                ck_assert_msg(p >= 0.0 && fabs(p - q) <= bound * (unit * fmax(p, q) + tiny),
                              "%s at (%d, %d), channel %d: %a, reversed %a", name, x, y, c, p, q);
            }
    image_free(&a);
    image_free(&b);
    frame_free(&first);
    frame_free(&second);
    return differing;
}

START_TEST(test_draw_order)
{
    static Soup soup;
    static const PixelFormat formats[] = {FORMAT_RGBA32F, FORMAT_RGBA16F};
    for (int f = 0; f < 2; f++) {
        uint64_t differing = 0;
        for (uint64_t seed = 1; seed <= 6; seed++) {
            Random random = random_seed(seed);
            soup_make(&random, &soup);
            RenderDesc desc = {.method = sums[_i], .accum = formats[f], .cull = CULL_NONE};
            differing += check_orders(&soup, desc, sum_names[_i]);
        }
        ck_assert_uint_gt(differing, 0);
    }
}
END_TEST

/* ---- few fragments -------------------------------------------------------------------------- */

static Frame render(const Scene *scene, RenderDesc desc)
{
    Frame frame;
    methods_ok(pipeline_render(scene, &desc, NULL, &frame));
    return frame;
}

static void assert_equal_pixels(const Image *a, const Image *b, size_t from, size_t count)
{
    for (size_t i = 4 * from; i < 4 * (from + count); i++)
        ck_assert_float_bits(((const float *)a->pixels)[i], ((const float *)b->pixels)[i]);
}

/* The greatest difference, relative to the expected value and at least 2^-20 of absolute one. */
static double distance(const Frame *got, const Frame *expected)
{
    double most = 0.0;
    const float *p = got->final.pixels, *q = expected->final.pixels;
    for (int i = 0; i < 4 * got->final.width * got->final.height; i++) {
        double relative = fabs((double)p[i] - (double)q[i]) / fmax(fabs((double)q[i]), 0x1p-20);
        most = fmax(most, relative);
    }
    return most;
}

/* Where no fragment is, and where all are as good as invisible, the picture is that without them.
 */
START_TEST(test_nothing)
{
    static Soup soup;
    static const double depths[] = {2.0, 3.0};
    RenderDesc desc = window;
    desc.method = sums[_i];
    methods_squares(&soup, depths, 2, 0.5f);
    soup.scene.background[1] = 0.3f;
    for (int i = 1; i < 12; i += 3) /* the rows in the middle */
        soup.meshes[0].position[i] *= 0.25f;
    soup.materials[3].alpha_mode = ALPHA_OPAQUE;
    soup.instances[1].material = 3;
    Frame with = render(&soup.scene, desc);
    soup.instances[0] = soup.instances[1];
    soup.scene.instance_count = 1;
    Frame without = render(&soup.scene, desc);
    ck_assert_int_eq(with.peels, 1);
    ck_assert_int_eq(without.peels, 0);
    ck_assert_uint_gt(with.layers.fragments, 0);
    assert_equal_pixels(&with.final, &without.final, 0, 192); /* the topmost row */
    ck_assert(memcmp(with.final.pixels, without.final.pixels, 192 * 20 * 16) != 0);
    frame_free(&with);
    frame_free(&without);
}
END_TEST

START_TEST(test_alpha_0)
{
    static Soup soup;
    static const double depths[] = {2.0};
    RenderDesc desc = window;
    Bits bits;
    desc.method = sums[_i];
    methods_squares(&soup, depths, 1, 1e-4f); /* drawn, and discarded by the alpha test */
    soup.scene.background[2] = 0.7f;
    bits_compare(&soup.scene, &desc, &bits);
    ck_assert_msg(bits.differing == 0, "%s", bits.difference);
    Frame frame = render(&soup.scene, desc);
    ck_assert_int_eq(frame.peels, 0);
    ck_assert_uint_eq(frame.layers.fragments, 192 * 20);
    ck_assert_uint_eq(frame.fragments_shaded, 0);
    const float *pixel = frame.final.pixels;
    for (int i = 0; i < 192 * 20; i++, pixel += 4) {
        ck_assert_float_bits(pixel[2], 0.7f);
        ck_assert_float_bits(pixel[3], 0.0f);
    }
    frame_free(&frame);
}
END_TEST

/* Nothing is transmitted where every alpha is 1, however many there are; a sum says less than
 * nothing is. */
START_TEST(test_alpha_1)
{
    static Soup soup;
    static const double depths[] = {2.0, 3.0, 5.0};
    RenderDesc desc = window;
    desc.method = sums[_i];
    methods_squares(&soup, depths, 3, 1.0f);
    Frame frame = render(&soup.scene, desc);
    const float *pixel = frame.final.pixels;
    for (int i = 0; i < 192 * 20; i++, pixel += 4)
        ck_assert_float_bits(pixel[3], sums[_i] == METHOD_WEIGHTED_SUM ? 3.0f : 1.0f);
    frame_free(&frame);
}
END_TEST

/* One layer is what peeling makes of it: of the source's colour, three to six roundings of half an
 * ULP; of its alpha, 1 − (1 − a), half an ULP of 1, so 1/a as much relative to it. */
START_TEST(test_one_layer)
{
    static Soup soup;
    static const float alphas[] = {0.1f, 0.3f, 0.77f, 1.0f};
    double most = 0.0;
    for (int k = 0; k < 4; k++)
        for (int weight = WEIGHT_9; weight <= WEIGHT_10; weight++) {
            const double depths[] = {1.5 + 7.0 * k};
            RenderDesc desc = window, peel = window;
            desc.method = sums[_i];
            desc.weight = (WeightEquation)weight;
            methods_squares(&soup, depths, 1, alphas[k]);
            soup.scene.background[0] = 0.25f;
            Frame got = render(&soup.scene, desc), expected = render(&soup.scene, peel);
            double bound = (8.0 + 2.0 / (double)alphas[k]) * 0x1p-24, d = distance(&got, &expected);
            ck_assert_msg(d <= bound, "alpha %g: %g, bound %g", (double)alphas[k], d, bound);
            most = fmax(most, d);
            frame_free(&got);
            frame_free(&expected);
        }
    ck_assert(sums[_i] == METHOD_WEIGHTED_SUM ? most == 0.0 : most > 0.0);
}
END_TEST

/* Equal layers are what a weighted average assumes: it is then exact. */
START_TEST(test_equal_layers)
{
    static Soup soup;
    static const double depths[] = {2.0, 2.0, 2.0, 2.0};
    RenderDesc desc = window;
    desc.method = METHOD_WEIGHTED_AVERAGE;
    methods_squares(&soup, depths, 4, 0.3f);
    Image sum;
    Frame frame;
    methods_buffer(&soup.scene, &desc, sum_names[0], &sum, &frame);
    const float *s = sum.pixels, *f = frame.final.pixels;
    for (int i = 0; i < 192 * 20; i++, s += 4, f += 4) {
        double a = (double)s[3] / 4.0, over = 0.0;
        for (int n = 0; n < 4; n++)
            over = (double)s[0] / 4.0 + over * (1.0 - a);
        ck_assert_double_eq_tol((double)f[0], over, 1e-6 * over);
        ck_assert_double_eq_tol((double)f[3], 1.0 - pow(1.0 - a, 4.0), 1e-6);
    }
    image_free(&sum);
    frame_free(&frame);
}
END_TEST

/* ---- weights -------------------------------------------------------------------------------- */

/* The paper's equations 7 to 10; d: window depth. */
static double paper_weight(WeightEquation equation, double z, double a, double d)
{
    switch (equation) {
    case WEIGHT_7:
        return a * fmax(1e-2, fmin(3e3, 10 / (1e-5 + pow(z / 5, 2) + pow(z / 200, 6))));
    case WEIGHT_8:
        return a * fmax(1e-2, fmin(3e3, 10 / (1e-5 + pow(z / 10, 3) + pow(z / 200, 6))));
    case WEIGHT_10:
        return a * fmax(1e-2, 3e3 * pow(1 - d, 3));
    default:
        return a * fmax(1e-2, fmin(3e3, 0.03 / (1e-5 + pow(z / 200, 4))));
    }
}

START_TEST(test_weights)
{
    static Soup soup;
    static const double depths[] = {0.14, 0.5, 3.0, 30.0, 100.0, 400.0, 900.0};
    int low = 0, high = 0;
    for (size_t k = 0; k < sizeof depths / sizeof *depths; k++)
        for (int range = 0; range <= DEPTH_RANGE_REVERSED; range++) {
            double z = depths[k], d = (1.0 - 0.125 / z) / (1.0 - 0.125 / 1000.0);
            RenderDesc desc = window;
            Image sum;
            Frame frame;
            desc.method = METHOD_WEIGHTED_BLENDED;
            desc.weight = (WeightEquation)_i;
            desc.depth_range = (DepthRange)range;
            methods_squares(&soup, &depths[k], 1, 0.5f);
            methods_buffer(&soup.scene, &desc, sum_names[2], &sum, &frame);
            double w = paper_weight(desc.weight, z, 0.5, d);
            low += w == 0.5 * 1e-2;
            high += w == 0.5 * 3e3;
            /* 1 − d loses what d is rounded by. */
            double bound = 1e-5 + (_i == WEIGHT_10 && range == DEPTH_RANGE_GL ? 1e-6 / (1 - d) : 0);
            for (int i = 0; i < 192 * 20; i++) {
                double got = (double)((const float *)sum.pixels)[4 * i + 3];
                ck_assert_double_eq_tol(got, 0.5 * w, bound * w);
            }
            image_free(&sum);
            frame_free(&frame);
        }
    ck_assert_int_gt(low, 0);
    ck_assert(high > 0 || _i == WEIGHT_9 || _i == WEIGHT_10); /* which never reach it */
}
END_TEST

/* In sums of 32 bits, where the last bit of a weight shows. */
START_TEST(test_weight_bits)
{
    static Soup soup;
    for (uint64_t seed = 1; seed <= 3; seed++) {
        RenderDesc desc = {.width = 97,
                           .height = 61,
                           .method = METHOD_WEIGHTED_BLENDED,
                           .weight = (WeightEquation)_i};
        Random random = random_seed(seed);
        Bits bits;
        soup_make_kind(&random, SOUP_PERSPECTIVE, desc.width, desc.height, &soup);
        bits_compare(&soup.scene, &desc, &bits);
        ck_assert_msg(bits.differing == 0, "seed %llu: %s", (unsigned long long)seed,
                      bits.difference);
        ck_assert_uint_gt(bits.layers.fragments, 0);
    }
}
END_TEST

/* ---- halves --------------------------------------------------------------------------------- */

START_TEST(test_overflow)
{
    static Soup soup;
    static const double depths[] = {2.0, 3.0, 4.0};
    RenderDesc desc = window;
    Bits bits;
    desc.method = sums[_i];
    methods_squares(&soup, depths, 3, 0.5f);
    for (int c = 0; c < 3; c++)
        soup.lights[0].color[c] = 1e7f;
    for (int f = 0; f < 2; f++) {
        desc.accum = f ? FORMAT_RGBA16F : FORMAT_RGBA32F;
        bits_compare(&soup.scene, &desc, &bits);
        ck_assert_msg(bits.differing == 0, "%s", bits.difference);
        ck_assert((bits.layers.overflowed > 0) == f);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sums");
    TCase *tcase = tcase_create("sums");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, test_bits, 0, 3);
    tcase_add_loop_test(tcase, test_draw_order, 0, 3);
    tcase_add_loop_test(tcase, test_nothing, 0, 3);
    tcase_add_loop_test(tcase, test_alpha_0, 0, 3);
    tcase_add_loop_test(tcase, test_alpha_1, 0, 3);
    tcase_add_loop_test(tcase, test_one_layer, 0, 3);
    tcase_add_test(tcase, test_equal_layers);
    tcase_add_loop_test(tcase, test_weights, WEIGHT_9, WEIGHT_10 + 1);
    tcase_add_loop_test(tcase, test_weight_bits, WEIGHT_9, WEIGHT_10 + 1);
    tcase_add_loop_test(tcase, test_overflow, 0, 3);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
