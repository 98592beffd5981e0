/* ARITHMETIC_STEPS: every rounding against rational arithmetic and the processor's, integer
 * formulas against their definitions, and fast paths against plain ones. */
#include "testing.h"

#include "blend/arithmetic.h"
#include "blend_operands.h"
#include "rational_round.h"

static const PixelFormat formats[] = {FORMAT_RGBA8,   FORMAT_RGBA16, FORMAT_RGBA16F,
                                      FORMAT_RGBA32F, FORMAT_RG32F,  FORMAT_R32F};

enum {
    FORMATS = sizeof formats / sizeof *formats
};

/* ---- rational numbers, rounded after each operation; zeros without their signs ---- */

static const RationalFormat *precision_format(const Arithmetic *a)
{
    return a->precision == PRECISION_HALF ? &rational_half : &rational_float;
}

static double rounded(const Arithmetic *a, mpq_t x)
{
    bool tie;
    return rational_round(precision_format(a), a->rounding, a->flush, x, &tie);
}

/* value, a finite number, times factor plus addend, rounded once. */
static double multiply_add(const Arithmetic *a, double value, double factor, double addend)
{
    mpq_t x, y;
    mpq_inits(x, y, NULL);
    mpq_set_d(x, value);
    mpq_set_d(y, factor);
    mpq_mul(x, x, y);
    mpq_set_d(y, addend);
    mpq_add(x, x, y);
    double result = rounded(a, x);
    mpq_clears(x, y, NULL);
    return result;
}

/* To the format: numbers of it, or codes. */
static double stored(PixelFormat format, BlendRounding rounding, double value)
{
    const FormatInfo *info = format_info(format);
    mpq_t x, most;
    bool tie;
    double result;
    mpq_inits(x, most, NULL);
    mpq_set_d(x, value);
    if (info->kind == KIND_UNORM) {
        mpz_t code;
        mpz_init(code);
        mpq_set_ui(most, 1, 1);
        if (mpq_sgn(x) < 0)
            mpq_set_ui(x, 0, 1);
        if (mpq_cmp(x, most) > 0)
            mpq_set(x, most);
        mpq_set_ui(most, info->unorm_max, 1);
        mpq_mul(x, x, most);
        rational_whole(x, rounding, false, code, &tie);
        result = mpz_get_d(code);
        mpz_clear(code);
    } else {
        result = rational_round(info->kind == KIND_HALF ? &rational_half : &rational_float,
                                rounding, false, x, &tie);
    }
    mpq_clears(x, most, NULL);
    return result;
}

static double fetched(const Arithmetic *a, PixelFormat format, double number)
{
    uint32_t most = format_info(format)->unorm_max;
    if (!isfinite(number))
        return number;
    mpq_t x, scale;
    mpq_inits(x, scale, NULL);
    mpq_set_d(x, number);
    Arithmetic nearest = *a;
    if (most) {
        nearest.rounding = BLEND_NEAREST_EVEN;
        mpq_set_ui(scale, most, 1);
        mpq_div(x, x, scale);
    }
    double result = rounded(&nearest, x);
    mpq_clears(x, scale, NULL);
    return result;
}

static double operand(const Arithmetic *a, PixelFormat format, float x)
{
    if (a->source_stored)
        return fetched(a, format, stored(format, a->store, (double)x));
    if (format_info(format)->kind == KIND_UNORM)
        x = x > 0.0f ? x < 1.0f ? x : 1.0f : 0.0f;
    return multiply_add(a, (double)x, 1.0, 0.0);
}

static double factor_value(const Arithmetic *a, BlendFactor factor, bool alpha, double s, double d,
                           double source_alpha, double destination_alpha)
{
    switch (factor) {
    case FACTOR_ZERO:
        return 0.0;
    case FACTOR_SRC_COLOR:
        return s;
    case FACTOR_ONE_MINUS_SRC_COLOR:
        return multiply_add(a, -s, 1.0, 1.0);
    case FACTOR_DST_COLOR:
        return d;
    case FACTOR_ONE_MINUS_DST_COLOR:
        return multiply_add(a, -d, 1.0, 1.0);
    case FACTOR_SRC_ALPHA:
        return source_alpha;
    case FACTOR_ONE_MINUS_SRC_ALPHA:
        return multiply_add(a, -source_alpha, 1.0, 1.0);
    case FACTOR_DST_ALPHA:
        return destination_alpha;
    case FACTOR_ONE_MINUS_DST_ALPHA:
        return multiply_add(a, -destination_alpha, 1.0, 1.0);
    case FACTOR_SRC_ALPHA_SATURATE:
        return alpha ? 1.0 : fmin(source_alpha, multiply_add(a, -destination_alpha, 1.0, 1.0));
    default:
        return 1.0;
    }
}

typedef struct Channel {
    double s, d, source_alpha, destination_alpha;
    BlendFactor source, destination;
    BlendFunc func;
    bool alpha;
} Channel;

static double summed(const Arithmetic *a, const Channel *c)
{
    double s = c->s, d = c->d;
    if (c->func == BLEND_FUNC_MIN)
        return s < d ? s : d;
    if (c->func == BLEND_FUNC_MAX)
        return s > d ? s : d;
    double f = factor_value(a, c->source, c->alpha, s, d, c->source_alpha, c->destination_alpha);
    double g =
        factor_value(a, c->destination, c->alpha, s, d, c->source_alpha, c->destination_alpha);
    double p = isfinite(f) ? multiply_add(a, s, f, 0.0) : f;
    double q = isfinite(g) ? multiply_add(a, d, g, 0.0) : g;
    double sign_p = c->func == BLEND_FUNC_REVERSE_SUBTRACT ? -1 : 1;
    double sign_q = c->func == BLEND_FUNC_SUBTRACT ? -1 : 1;
    if (!isfinite(p) || !isfinite(q))
        return NAN; /* not compared */
    if (!a->fused)
        return multiply_add(a, sign_p * p, 1.0, sign_q * q);
    if (c->destination == FACTOR_ONE)
        return multiply_add(a, sign_p * s, f, sign_q * q);
    return multiply_add(a, sign_q * d, g, sign_p * p);
}

static Channel channel_of(const Arithmetic *a, const BlendEquation *e, PixelFormat format,
                          const float source[4], const void *pixel, int i)
{
    const FormatInfo *info = format_info(format);
    double numbers[4] = {0, 0, 0, info->unorm_max ? info->unorm_max : 1.0};
    for (int k = 0; k < info->channels; k++)
        numbers[k] = info->unorm_max ? format_bits(format, pixel, k)
                                     : (double)format_channel(format, pixel, k);
    return (Channel){.s = operand(a, format, source[i]),
                     .d = fetched(a, format, numbers[i]),
                     .source_alpha = operand(a, format, source[3]),
                     .destination_alpha = fetched(a, format, numbers[3]),
                     .source = i == 3 ? e->source_alpha : e->source,
                     .destination = i == 3 ? e->destination_alpha : e->destination,
                     .func = i == 3 ? e->func_alpha : e->func,
                     .alpha = i == 3};
}

static Arithmetic any_float(Random *random)
{
    uint64_t bits = random_bits(random);
    return (Arithmetic){.kind = ARITHMETIC_STEPS,
                        .precision = bits & 1 ? PRECISION_FLOAT : PRECISION_HALF,
                        .rounding = (BlendRounding)(bits >> 1 & 3),
                        .store = (BlendRounding)(bits >> 3 & 3),
                        .fused = bits >> 5 & 1,
                        .flush = bits >> 6 & 1,
                        .source_stored = bits >> 7 & 1};
}

/* 1 if the channel was compared. */
static int check_channel(const Arithmetic *a, const BlendEquation *e, PixelFormat format,
                         const float source[4], const void *before, const void *after, int i)
{
    const FormatInfo *info = format_info(format);
    Channel channel = channel_of(a, e, format, source, before, i);
    if (!isfinite(channel.s) || !isfinite(channel.d) || !isfinite(channel.source_alpha) ||
        !isfinite(channel.destination_alpha))
        return 0;
    double sum = summed(a, &channel);
    if (!isfinite(sum))
        return 0;
    double expected = stored(format, a->store, sum);
    if (info->kind == KIND_HALF && a->flush && fabs(expected) < 0x1p-14)
        expected = 0.0;
    uint32_t bits = format_bits(format, after, i);
    double got = info->unorm_max ? bits : (double)format_channel(format, after, i);
    if (got != expected) {
        char text[ARITHMETIC_TEXT], equation[EQUATION_TEXT];
        arithmetic_print(a, text);
        equation_print(e, equation);
        ck_abort_msg("%s %s %s channel %d: source %a alpha %a, destination %a alpha %a: got %a, "
                     "expected %a",
                     info->name, equation, text, i, (double)source[i], (double)source[3], channel.d,
                     channel.destination_alpha, got, expected);
    }
    return 1;
}

START_TEST(test_rationals)
{
    const char *wanted = getenv("PEEL_TEST_COUNT");
    int count = wanted ? atoi(wanted) : testing_samples(60000), compared = 0;
    PixelFormat format = formats[_i];
    Random random = random_seed(700 + (uint64_t)_i);
    for (int k = 0; k < count; k++) {
        Arithmetic a = any_float(&random);
        BlendEquation e = operands_equation(&random);
        float source[1][4], d[4];
        unsigned char before[16], after[16];
        for (int i = 0; i < 4; i++) {
            source[0][i] = operands_number(&random);
            d[i] = random_bits(&random) % 16 ? operands_number(&random) : -source[0][i];
        }
        format_store(format, d, before);
        memcpy(after, before, sizeof after);
        arithmetic_blend(&a, &e, format, 1, (const float(*)[4])source, after);
        for (int i = 0; i < format_info(format)->channels; i++)
            compared += check_channel(&a, &e, format, source[0], before, after, i);
    }
    ck_assert_int_gt(compared, count * format_info(format)->channels / 2);
}
END_TEST

/* ---- the processor's operations, with signs, NaN and infinity ---- */

static float any_float_bits(Random *random)
{
    static const float specials[] = {INFINITY, -INFINITY, NAN, 0.0f, -0.0f};
    uint64_t bits = random_bits(random);
    return bits % 8 == 0  ? specials[(bits >> 8) % 5]
           : bits % 8 < 4 ? op_from_bits((uint32_t)(bits >> 32))
                          : operands_number(random);
}

static __attribute__((noinline)) void under_kept(bool fused, const float s[4], const float d[4],
                                                 float out[4])
{
    for (int i = 0; i < 3; i++)
        out[i] = fused ? fmaf(s[i], d[3], d[i]) : s[i] * d[3] + d[i];
    float p = s[3] * 0.0f, g = 1.0f - s[3];
    out[3] = fused ? fmaf(d[3], g, p) : p + d[3] * g;
}

static __attribute__((noinline)) void under_flushed(bool fused, const float s[4], const float d[4],
                                                    float out[4])
{
    for (int i = 0; i < 3; i++)
        out[i] = op_muladd(fused, s[i], d[3], d[i]);
    float p = op_mul(s[3], 0.0f), g = op_sub(1.0f, s[3]);
    out[3] = op_muladd(fused, d[3], g, p);
}

START_TEST(test_processor)
{
    const BlendEquation *under = &equation_info(EQUATION_UNDER)->equation;
    bool flush = _i & 1, fused = _i & 2;
    Arithmetic a = {.kind = ARITHMETIC_STEPS, .flush = flush, .fused = fused};
    Random random = random_seed(31 + (uint64_t)_i);
    for (int k = 0; k < testing_samples(200000); k++) {
        float source[1][4], pixel[4], expected[4];
        for (int i = 0; i < 4; i++) {
            source[0][i] = any_float_bits(&random);
            pixel[i] = any_float_bits(&random);
        }
        if (flush) {
            uint32_t mode = op_enter();
            under_flushed(fused, source[0], pixel, expected);
            op_leave(mode);
        } else {
            under_kept(fused, source[0], pixel, expected);
        }
        arithmetic_blend(&a, under, FORMAT_RGBA32F, 1, (const float(*)[4])source, pixel);
        for (int i = 0; i < 4; i++)
            if (testing_bits(pixel[i]) != testing_bits(op_canonical(expected[i])))
                ck_abort_msg("source %a alpha %a: got %a, expected %a", (double)source[0][i],
                             (double)source[0][3], (double)pixel[i], (double)expected[i]);
    }
}
END_TEST

/* ---- integers ---- */

static uint32_t product_of(CodeProduct product, PixelFormat format, uint32_t x, uint32_t y)
{
    /* s·d, and nothing is added. */
    static const BlendEquation equation =
        BLEND_EQUATION_ALL(FACTOR_DST_COLOR, FACTOR_ZERO, BLEND_FUNC_ADD);
    Arithmetic a = {.kind = ARITHMETIC_STEPS, .precision = PRECISION_CODES, .product = product};
    uint32_t most = format_info(format)->unorm_max;
    float source[1][4] = {{(float)((double)x / most), 0, 0, 0}};
    unsigned char pixel[8] = {0};
    uint16_t word = (uint16_t)y;
    if (format == FORMAT_RGBA8)
        pixel[0] = (unsigned char)y;
    else
        memcpy(pixel, &word, sizeof word);
    arithmetic_blend(&a, &equation, format, 1, (const float(*)[4])source, pixel);
    return format_bits(format, pixel, 0);
}

static void check_products(PixelFormat format, uint32_t x, uint32_t y)
{
    uint64_t most = format_info(format)->unorm_max, n = most + 1, t = (uint64_t)x * y;
    const uint64_t expected[] = {
        [CODES_NEAREST] = (2 * t + most) / (2 * most),
        [CODES_DRIVER] = (t + t / n + n / 2) / n,
        [CODES_FLOOR] = t / most,
        [CODES_SHIFT] = t / n,
        [CODES_SHIFT_ROUND] = (t + n / 2) / n,
        [CODES_SHIFT_MOST] = (t + most) / n,
        [CODES_SHIFT_STRETCH] = x * (y < n / 2 ? y : (uint64_t)y + 1) / n,
        [CODES_SHIFT_PLUS] = x * ((uint64_t)y + 1) / n,
        [CODES_RECIPROCAL] = t * (n + 1) / (n * n),
    };
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++)
        if (product_of((CodeProduct)i, format, x, y) != expected[i])
            ck_abort_msg("%s product %zu of %u and %u: got %u, expected %u",
                         format_info(format)->name, i, x, y,
                         product_of((CodeProduct)i, format, x, y), (unsigned)expected[i]);
}

START_TEST(test_products)
{
    for (uint32_t x = 0; x < 256; x++)
        for (uint32_t y = 0; y < 256; y++)
            check_products(FORMAT_RGBA8, x, y);
    Random random = random_seed(5);
    for (int i = 0; i < 100000; i++) {
        uint64_t bits = random_bits(&random);
        check_products(FORMAT_RGBA16, bits & 65535, bits >> 16 & 65535);
        check_products(FORMAT_RGBA16, 65535 - (bits >> 32 & 3), bits >> 16 & 65535);
    }
}
END_TEST

/* ---- many at a time against one by one ---- */

enum {
    BLOCK = 257
};

static void check_block(const Arithmetic *a, const BlendEquation *e, PixelFormat format,
                        Random *random)
{
    static float source[BLOCK][4];
    static unsigned char before[16 * BLOCK], after[16 * BLOCK];
    size_t bytes = format_pixel_bytes(format);
    for (int k = 0; k < BLOCK; k++) {
        float d[4];
        for (int i = 0; i < 4; i++) {
            source[k][i] = any_float_bits(random);
            d[i] = any_float_bits(random);
        }
        format_store(format, d, &before[bytes * (size_t)k]);
    }
    memcpy(after, before, sizeof after);
    arithmetic_blend(a, e, format, BLOCK, (const float(*)[4])source, after);
    for (size_t k = 0; k < BLOCK; k++) {
        BlendSteps steps[4];
        arithmetic_steps(a, e, format, source[k], &before[bytes * k], steps);
        for (int i = 0; i < format_info(format)->channels; i++)
            if (format_bits(format, &after[bytes * k], i) != steps[i].stored) {
                char text[ARITHMETIC_TEXT], equation[EQUATION_TEXT];
                arithmetic_print(a, text);
                equation_print(e, equation);
                ck_abort_msg("%s %s %s channel %d of source %a: 0x%x in a block, 0x%x alone",
                             format_info(format)->name, equation, text, i, (double)source[k][i],
                             format_bits(format, &after[bytes * k], i), steps[i].stored);
            }
    }
}

START_TEST(test_blocks)
{
    Random random = random_seed(12);
    for (size_t n = 0; n < arithmetic_count(); n++)
        for (int f = 0; f < FORMATS; f++)
            for (int k = 0; k < EQUATION_COUNT + testing_samples(30); k++) {
                const Arithmetic *a = &arithmetic_info(n)->arithmetic;
                BlendEquation e = k < EQUATION_COUNT ? equation_info((EquationId)k)->equation
                                                     : operands_equation(&random);
                if (!arithmetic_refuses(a, &e, formats[f]))
                    check_block(a, &e, formats[f], &random);
            }
}
END_TEST

/* ---- values of the steps, by hand ---- */

START_TEST(test_values)
{
    const BlendEquation *under = &equation_info(EQUATION_UNDER)->equation;
    Arithmetic a;
    ck_assert_int_eq(arithmetic_parse("separate-truncated", &a), RESULT_OK);
    const float source[4] = {0.75f, 0, 0, 0.25f};
    const uint8_t pixel[4] = {51, 0, 0, 255}; /* 1/5 */
    BlendSteps steps[4];
    arithmetic_steps(&a, under, FORMAT_RGBA8, source, pixel, steps);
    ck_assert(!steps[0].codes);
    ck_assert(steps[0].source == 0.75 && steps[0].source_factor == 1.0);
    ck_assert(steps[0].destination == (double)0.2f && steps[0].destination_product == (double)0.2f);
    ck_assert(steps[0].sum == (double)(0.75f + 0.2f));
    ck_assert_uint_eq(steps[0].stored, 242); /* 242.25 */
    ck_assert(steps[3].source_product == 0.0 && steps[3].destination_factor == 0.75);
    ck_assert_uint_eq(steps[3].stored, 191); /* 191.25 */
    ck_assert_int_eq(arithmetic_parse("codes-nearest", &a), RESULT_OK);
    arithmetic_steps(&a, under, FORMAT_RGBA8, source, pixel, steps);
    ck_assert(steps[0].codes);
    ck_assert(steps[0].source == 191 && steps[0].source_factor == 255 && steps[0].sum == 242);
    ck_assert(steps[3].destination_factor == 191 && steps[3].stored == 191);
    ck_assert_int_eq(arithmetic_parse("exact", &a), RESULT_OK);
    arithmetic_steps(&a, under, FORMAT_RGBA32F, (const float[4]){0x1.000002p+0f, 0, 0, 0x1p-60f},
                     (const float[4]){0x1p-100f, 0, 0, 0x1.000002p+0f}, steps);
    ck_assert(steps[0].source_product == 0x1.000004000004p+0);
    ck_assert(steps[3].destination_factor != steps[3].destination_factor); /* no double holds it */
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("arithmetic_steps");
    TCase *tcase = tcase_create("steps");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, test_rationals, 0, FORMATS);
    tcase_add_loop_test(tcase, test_processor, 0, 4);
    tcase_add_test(tcase, test_products);
    tcase_add_test(tcase, test_blocks);
    tcase_add_test(tcase, test_values);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
