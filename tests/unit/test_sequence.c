/* blend/sequence.h: exact against sums of GMP rationals, and bounds that hold and are tight. */
#include "testing.h"

#include "base/random.h"
#include "blend/sequence.h"
#include "number/op.h"

#include <fenv.h>
#include <math.h>

static const PixelFormat formats[] = {FORMAT_RGBA8, FORMAT_RGBA16, FORMAT_RGBA16F, FORMAT_RGBA32F};
static float source[SEQUENCE_LAYERS_MAX][4];
static unsigned char pixels[SEQUENCE_LAYERS_MAX * 16];
static Rational exact[4];
static double low[4], high[4];

static void set_up(void)
{
    for (int c = 0; c < 4; c++)
        rational_init(&exact[c]);
}

static void tear_down(void)
{
    for (int c = 0; c < 4; c++)
        rational_clear(&exact[c]);
}

static int make(PixelFormat format, uint64_t index)
{
    VectorSpec spec = {VECTORS_SEQUENCES, format, 3, SEQUENCE_COUNT};
    return sequence_make(&spec, index, source);
}

/* ---- what sequences are ---- */

START_TEST(test_layers)
{
    static int counts[SEQUENCE_LAYERS_MAX + 1];
    for (uint64_t i = 0; i < SEQUENCE_COUNT; i++) {
        int layers = make(formats[_i], i), opaque = 0, clear = 0;
        counts[layers]++;
        for (int k = 0; k < layers; k++)
            for (int c = 0; c < 4; c++) {
                ck_assert(source[k][c] >= 0.0f && source[k][c] <= (c == 3 ? 1.0f : 16.0f));
                opaque += c == 3 && source[k][c] == 1.0f;
                clear += c == 3 && source[k][c] == 0.0f;
            }
        const char *what = sequence_what(i);
        if (strcmp(what, "an opaque layer in the middle") == 0)
            ck_assert_int_ge(opaque, 1);
        if (strcmp(what, "every third alpha 0") == 0)
            ck_assert_int_ge(clear, (layers + 1) / 3);
        if (strcmp(what, "all layers equal") == 0)
            ck_assert_int_eq(memcmp(source[0], source[layers - 1], sizeof *source), 0);
    }
    for (int n = 2; n <= SEQUENCE_LAYERS_MAX; n++)
        ck_assert_int_eq(counts[n], 10);
}
END_TEST

/* ---- the exact result ---- */

/* Of floats themselves, of codes n/max. */
static void operand(PixelFormat format, float x, mpq_t out)
{
    uint32_t max = format_info(format)->unorm_max;
    mpq_set_d(out, (double)x);
    if (!max)
        return;
    mpq_set_ui(out, (unsigned long)lrint((double)x * max), max);
    mpq_canonicalize(out);
}

/* The sum over layers of its colour times all transmittances before: not step by step. */
static void closed_form(PixelFormat format, int layers, int channel, mpq_t out)
{
    mpq_t term, one, value;
    mpq_inits(term, one, value, NULL);
    mpq_set_ui(one, 1, 1);
    mpq_set_ui(out, 0, 1);
    for (int k = channel == 3 ? layers : 0; k < layers || (channel == 3 && k == layers); k++) {
        if (channel == 3)
            mpq_set(term, one);
        else
            operand(format, source[k][channel], term);
        for (int j = k - 1; j >= 0; j--) {
            operand(format, source[j][3], value);
            mpq_sub(value, one, value);
            mpq_mul(term, term, value);
        }
        mpq_add(out, out, term);
    }
    mpq_clears(term, one, value, NULL);
}

static void stored_value(PixelFormat format, uint32_t bits, mpq_t out)
{
    unsigned char pixel[16] = {0};
    format_set_bits(format, pixel, 0, bits);
    uint32_t max = format_info(format)->unorm_max;
    if (max)
        mpq_set_ui(out, bits, max);
    else
        mpq_set_d(out, (double)format_channel(format, pixel, 0));
    mpq_canonicalize(out);
}

/* No neighbour is nearer, and one that is as near is odd; or, of unorm formats, clamped. */
static void check_nearest(PixelFormat format, uint32_t bits, mpq_srcptr wanted)
{
    uint32_t max = format_info(format)->unorm_max;
    mpq_t off, other;
    mpq_inits(off, other, NULL);
    stored_value(format, bits, off);
    mpq_sub(off, off, wanted);
    mpq_abs(off, off);
    for (int side = -1; side <= 1; side += 2) {
        if ((side < 0 && bits == 0) || (max && side > 0 && bits == max))
            continue;
        stored_value(format, bits + (uint32_t)side, other);
        mpq_sub(other, other, wanted);
        mpq_abs(other, other);
        int order = mpq_cmp(off, other);
        ck_assert(order < 0 || (order == 0 && bits % 2 == 0));
    }
    mpq_clears(off, other, NULL);
}

START_TEST(test_exact)
{
    PixelFormat format = formats[_i];
    mpq_t expected;
    mpq_init(expected);
    for (uint64_t i = 0; i < 2400; i += i < 200 ? 1 : 61 * TESTING_SHARE) {
        int layers = make(format, i);
        sequence_exact(format, layers, (const float(*)[4])source, exact);
        sequence_round(format, exact, pixels);
        for (int c = 0; c < 4; c++) {
            if (layers < 64 || c == 1) {
                closed_form(format, layers, c, expected);
                ck_assert_msg(mpq_equal(expected, exact[c].value), "sequence %d, channel %d",
                              (int)i, c);
            }
            check_nearest(format, format_bits(format, pixels, c), exact[c].value);
        }
    }
    mpq_clear(expected);
}
END_TEST

/* Two layers by hand: 1/2 red, then 1/4 of white. */
START_TEST(test_by_hand)
{
    static const float layers[2][4] = {{0.5f, 0, 0, 0.5f}, {0.25f, 0.25f, 0.25f, 0.25f}};
    static const float expected[4] = {0.625f, 0.125f, 0.125f, 0.375f};
    float pixel[4];
    sequence_exact(FORMAT_RGBA32F, 2, layers, exact);
    sequence_round(FORMAT_RGBA32F, exact, pixel);
    sequence_bound(FORMAT_RGBA32F, 2, layers, low, high);
    for (int c = 0; c < 4; c++) {
        ck_assert_float_bits(pixel[c], expected[c]);
        ck_assert_double_eq(low[c], (double)expected[c]); /* nothing is rounded */
        ck_assert_double_eq(high[c], (double)expected[c]);
    }
}
END_TEST

/* ---- the bound ---- */

static void check_inside(PixelFormat format, const void *pixel, uint64_t index, const char *what)
{
    for (int c = 0; c < 4; c++)
        ck_assert_msg(sequence_inside(format, pixel, c, low, high),
                      "%s of %s, sequence %d (%s), channel %d: %.9g is not in [%.9g, %.9g]", what,
                      format_info(format)->name, (int)index, sequence_what(index), c,
                      (double)format_channel(format, pixel, c), low[c], high[c]);
}

START_TEST(test_bound_holds_right_arithmetics)
{
    PixelFormat format = formats[_i];
    size_t size = format_pixel_bytes(format);
    const BlendEquation *under = &equation_info(EQUATION_UNDER)->equation;
    uint32_t checked = 0;
    for (uint64_t i = 0; i < SEQUENCE_COUNT; i += i < 100 ? 1 : 59 * TESTING_SHARE) {
        int layers = make(format, i);
        const float(*sources)[4] = (const float(*)[4])source;
        sequence_bound(format, layers, sources, low, high);
        sequence_exact(format, layers, sources, exact);
        sequence_round(format, exact, pixels);
        check_inside(format, pixels, i, "the rounded exact result");
        for (size_t k = 0; k < arithmetic_count(); k++) {
            const ArithmeticInfo *info = arithmetic_info(k);
            if (arithmetic_is_wrong(info, format) ||
                arithmetic_refuses(&info->arithmetic, under, format))
                continue;
            sequence_blend(&info->arithmetic, format, layers, sources, pixels);
            check_inside(format, pixels + (size_t)(layers - 1) * size, i, info->name);
            checked++;
        }
    }
    ck_assert_uint_ge(checked, 1000);
}
END_TEST

/* x to either neighbour with so many digits, at random; exactly what it is where it is one. */
static double either(Random *random, int digits, int least, double x)
{
    int exponent;
    frexp(x, &exponent);
    double unit = ldexp(1.0, (exponent - 1 < least ? least : exponent - 1) - digits + 1);
    double down = floor(x / unit) * unit;
    if (random_bits(random) % 16 == 0 && x < ldexp(1.0, least))
        return 0.0; /* flushed */
    return down == x || random_bits(random) & 1 ? down : down + unit;
}

/* Any faithful arithmetic of so many digits, whose stores go to either side, too. */
static void faithful_layer(Random *random, PixelFormat format, int digits, const float layer[4],
                           double pixel[4])
{
    uint32_t max = format_info(format)->unorm_max;
    int least = digits == 11 ? -14 : digits == 24 ? -126 : -1022;
    int stored = format == FORMAT_RGBA16F ? 11 : 24, stored_least = stored == 11 ? -14 : -126;
    double s[4], d[4];
    for (int c = 0; c < 4; c++) {
        s[c] = max ? either(random, digits, least, (double)layer[c]) : (double)layer[c];
        if (!max && random_bits(random) & 1)
            s[c] = either(random, stored, stored_least, s[c]);
        d[c] = max ? either(random, digits, least, pixel[c] / max) : pixel[c];
    }
    for (int c = 0; c < 4; c++) {
        double x = c < 3 ? either(random, digits, least, s[c] * d[3])
                         : either(random, digits, least, 1.0 - s[3]);
        x = either(random, digits, least, c < 3 ? d[c] + x : d[3] * x);
        if (max)
            pixel[c] = fmin(floor(either(random, digits, least, x * max) +
                                  (random_bits(random) & 1 ? 0.0 : 0.5)),
                            max);
        else
            pixel[c] = either(random, stored, stored_least, x);
    }
}

START_TEST(test_bound_holds_faithful_ones)
{
    PixelFormat format = formats[_i];
    uint32_t max = format_info(format)->unorm_max;
    static const int precisions[][3] = {{11, 24, 50}, {24, 30, 50}, {11, 24, 50}, {24, 30, 50}};
    Random random = random_seed(9);
    for (uint64_t i = 0; i < SEQUENCE_COUNT; i += i < 300 ? 1 : 29 * TESTING_SHARE) {
        int layers = make(format, i);
        sequence_bound(format, layers, (const float(*)[4])source, low, high);
        for (int run = 0; run < 12; run++) {
            double pixel[4] = {0, 0, 0, max ? max : 1.0};
            for (int k = 0; k < layers; k++)
                faithful_layer(&random, format, precisions[_i][run % 3], source[k], pixel);
            for (int c = 0; c < 4; c++)
                ck_assert_msg(low[c] <= pixel[c] && pixel[c] <= high[c],
                              "sequence %d (%s), channel %d: %.9g is not in [%.9g, %.9g]", (int)i,
                              sequence_what(i), c, pixel[c], low[c], high[c]);
        }
    }
}
END_TEST

/* The processor's own directed roundings are the ends of the bound: it is as narrow as can be. */
static void directed(int layers, int mode, float out[4])
{
    volatile float pixel[4] = {0, 0, 0, 1};
    int saved = fegetround();
    fesetround(mode);
    for (int k = 0; k < layers; k++) {
        for (int c = 0; c < 3; c++) {
            volatile float product = source[k][c] * pixel[3];
            pixel[c] = pixel[c] + product;
        }
        volatile float keep = 1.0f - source[k][3];
        pixel[3] = pixel[3] * keep;
    }
    fesetround(saved);
    for (int c = 0; c < 4; c++)
        out[c] = pixel[c];
}

START_TEST(test_bound_is_tight)
{
    uint32_t compared = 0;
    for (uint64_t i = 0; i < SEQUENCE_COUNT; i++) {
        float down[4], up[4];
        int layers = make(FORMAT_RGBA32F, i);
        sequence_bound(FORMAT_RGBA32F, layers, (const float(*)[4])source, low, high);
        directed(layers, FE_DOWNWARD, down);
        directed(layers, FE_UPWARD, up);
        if (low[3] != 0.0 && low[3] < 0x1p-80)
            continue; /* products that may be flushed */
        for (int c = 0; c < 4 && low[3] != 0.0; c++) {
            ck_assert_double_eq(low[c], (double)down[c]);
            ck_assert_double_eq(high[c], (double)up[c]);
            compared++;
        }
    }
    ck_assert_uint_ge(compared, 2000);
}
END_TEST

/* Of codes: within three of the exact result after two layers, and not everything after many. */
START_TEST(test_bound_is_no_excuse)
{
    static const Arithmetic swapped = {.kind = ARITHMETIC_STEPS,
                                       .mistakes = 1u << MISTAKE_FACTORS_SWAPPED};
    PixelFormat format = formats[_i];
    size_t size = format_pixel_bytes(format);
    uint32_t outside = 0;
    for (uint64_t i = 0; i < SEQUENCE_COUNT; i += (uint64_t)3 * TESTING_SHARE) {
        int layers = make(format, i);
        const float(*sources)[4] = (const float(*)[4])source;
        sequence_bound(format, layers, sources, low, high);
        if (layers == 2 && _i < 2)
            for (int c = 0; c < 4; c++)
                ck_assert(high[c] - low[c] <= 6.0);
        sequence_blend(&swapped, format, layers, sources, pixels);
        bool inside = true;
        for (int c = 0; c < 4; c++)
            inside = inside &&
                     sequence_inside(format, pixels + (size_t)(layers - 1) * size, c, low, high);
        outside += !inside;
    }
    ck_assert_uint_ge(outside, SEQUENCE_COUNT / 3 / TESTING_SHARE / 2);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("sequence");
    TCase *tcase = tcase_create("sequence");
    tcase_set_timeout(tcase, 300);
    tcase_add_checked_fixture(tcase, set_up, tear_down);
    tcase_add_loop_test(tcase, test_layers, 0, 4);
    tcase_add_loop_test(tcase, test_exact, 0, 4);
    tcase_add_test(tcase, test_by_hand);
    tcase_add_loop_test(tcase, test_bound_holds_right_arithmetics, 0, 4);
    tcase_add_loop_test(tcase, test_bound_holds_faithful_ones, 0, 4);
    tcase_add_test(tcase, test_bound_is_tight);
    tcase_add_loop_test(tcase, test_bound_is_no_excuse, 0, 4);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
