/* ARITHMETIC_EXACT against rational arithmetic, over all formats, functions and factors. */
#include "testing.h"

#include "blend_operands.h"
#include "rational_round.h"

static const PixelFormat formats[] = {FORMAT_RGBA8,   FORMAT_RGBA16, FORMAT_RGBA16F,
                                      FORMAT_RGBA32F, FORMAT_RG32F,  FORMAT_R32F};

enum {
    FORMATS = sizeof formats / sizeof *formats,
    CASES = 1000000 /* channels, in all formats together */
};

static const Arithmetic exact = {.kind = ARITHMETIC_EXACT};

/* ---- the expected result ---- */

typedef struct Operands {
    mpq_t source, destination, source_alpha, destination_alpha, one;
} Operands;

/* A source as GL clamps it and the format stores it; unorm operands are codes / greatest code. */
static void set_source(PixelFormat format, float x, mpq_t out)
{
    uint32_t most = format_info(format)->unorm_max;
    mpq_set_d(out, (double)x);
    if (!most)
        return;
    mpq_t limit;
    mpz_t code;
    mpq_init(limit);
    mpz_init(code);
    mpq_set_ui(limit, 1, 1);
    if (mpq_sgn(out) < 0)
        mpq_set_ui(out, 0, 1);
    if (mpq_cmp(out, limit) > 0)
        mpq_set(out, limit);
    mpq_set_ui(limit, most, 1);
    mpq_mul(out, out, limit);
    bool tie;
    rational_whole(out, BLEND_NEAREST_EVEN, false, code, &tie);
    mpq_set_z(out, code);
    mpq_div(out, out, limit);
    mpq_clear(limit);
    mpz_clear(code);
}

static void set_stored(PixelFormat format, const void *pixel, int channel, mpq_t out)
{
    uint32_t bits = format_bits(format, pixel, channel), most = format_info(format)->unorm_max;
    if (most) {
        mpq_set_ui(out, bits, most);
        mpq_canonicalize(out);
        return;
    }
    mpq_set_d(out, (double)format_channel(format, pixel, channel));
}

static void set_factor(BlendFactor factor, bool alpha, Operands *o, mpq_t out)
{
    switch (factor) {
    case FACTOR_ZERO:
        mpq_set_ui(out, 0, 1);
        return;
    case FACTOR_SRC_COLOR:
        mpq_set(out, o->source);
        return;
    case FACTOR_ONE_MINUS_SRC_COLOR:
        mpq_sub(out, o->one, o->source);
        return;
    case FACTOR_DST_COLOR:
        mpq_set(out, o->destination);
        return;
    case FACTOR_ONE_MINUS_DST_COLOR:
        mpq_sub(out, o->one, o->destination);
        return;
    case FACTOR_SRC_ALPHA:
        mpq_set(out, o->source_alpha);
        return;
    case FACTOR_ONE_MINUS_SRC_ALPHA:
        mpq_sub(out, o->one, o->source_alpha);
        return;
    case FACTOR_DST_ALPHA:
        mpq_set(out, o->destination_alpha);
        return;
    case FACTOR_ONE_MINUS_DST_ALPHA:
        mpq_sub(out, o->one, o->destination_alpha);
        return;
    case FACTOR_SRC_ALPHA_SATURATE:
        mpq_sub(out, o->one, o->destination_alpha);
        if (mpq_cmp(o->source_alpha, out) < 0)
            mpq_set(out, o->source_alpha);
        if (!alpha)
            return;
        break;
    default:
        break;
    }
    mpq_set_ui(out, 1, 1);
}

static uint32_t stored_bits(PixelFormat format, mpq_t value, bool negative_zero, bool *tie)
{
    const FormatInfo *info = format_info(format);
    double rounded;
    if (info->kind == KIND_UNORM) {
        mpq_t scaled;
        mpz_t code;
        mpq_init(scaled);
        mpz_init(code);
        mpq_set_ui(scaled, info->unorm_max, 1);
        mpq_mul(scaled, scaled, value);
        if (mpq_sgn(scaled) < 0)
            mpq_set_ui(scaled, 0, 1);
        rational_whole(scaled, BLEND_NEAREST_EVEN, false, code, tie);
        uint64_t bits = mpz_get_ui(code);
        mpq_clear(scaled);
        mpz_clear(code);
        return bits < info->unorm_max ? (uint32_t)bits : info->unorm_max;
    }
    rounded = rational_round(info->kind == KIND_HALF ? &rational_half : &rational_float,
                             BLEND_NEAREST_EVEN, false, value, tie);
    if (mpq_sgn(value) == 0 && negative_zero)
        rounded = -0.0;
    return info->kind == KIND_HALF ? half_from_float((float)rounded) : op_bits((float)rounded);
}

/* Zeros have the sign of IEEE's operations, which the products' own signs decide. */
static bool zero_is_negative(BlendFunc func, float source, float destination, mpq_t f, mpq_t g,
                             bool products_are_zero)
{
    bool p = signbit(source) != (mpq_sgn(f) < 0), q = signbit(destination) != (mpq_sgn(g) < 0);
    if (func == BLEND_FUNC_SUBTRACT)
        q = !q;
    if (func == BLEND_FUNC_REVERSE_SUBTRACT)
        p = !p;
    return products_are_zero && p && q;
}

/* A factor's zero may be −0 where it is an operand: f and g have no such sign, so these cases are
 * left out. */
static bool has_negative_zero(const float source[4], const float destination[4])
{
    for (int i = 0; i < 4; i++)
        if ((source[i] == 0.0f && signbit(source[i])) ||
            (destination[i] == 0.0f && signbit(destination[i])))
            return true;
    return false;
}

static uint32_t expected_bits(const BlendEquation *e, PixelFormat format, const float source[4],
                              const void *pixel, int channel, Operands *o, bool *tie)
{
    bool alpha = channel == 3, four = format_info(format)->channels == 4;
    float stored[4];
    format_fetch(format, pixel, stored);
    set_source(format, source[channel], o->source);
    set_source(format, source[3], o->source_alpha);
    set_stored(format, pixel, channel, o->destination);
    mpq_set_ui(o->destination_alpha, 1, 1);
    if (four)
        set_stored(format, pixel, 3, o->destination_alpha);
    BlendFunc func = alpha ? e->func_alpha : e->func;
    mpq_t f, g;
    mpq_inits(f, g, NULL);
    set_factor(alpha ? e->source_alpha : e->source, alpha, o, f);
    set_factor(alpha ? e->destination_alpha : e->destination, alpha, o, g);
    bool negative = false;
    if (func == BLEND_FUNC_MIN || func == BLEND_FUNC_MAX) {
        bool destination = (mpq_cmp(o->source, o->destination) < 0) == (func == BLEND_FUNC_MAX);
        mpq_set(f, destination ? o->destination : o->source);
    } else {
        mpq_mul(o->source, o->source, f);
        mpq_mul(o->destination, o->destination, g);
        bool zeros = mpq_sgn(o->source) == 0 && mpq_sgn(o->destination) == 0;
        negative = zero_is_negative(func, source[channel], stored[channel], f, g, zeros);
        if (func == BLEND_FUNC_ADD)
            mpq_add(f, o->source, o->destination);
        else if (func == BLEND_FUNC_SUBTRACT)
            mpq_sub(f, o->source, o->destination);
        else
            mpq_sub(f, o->destination, o->source);
    }
    uint32_t bits = stored_bits(format, f, negative, tie);
    mpq_clears(f, g, NULL);
    return bits;
}

static void report(PixelFormat format, const BlendEquation *e, const float s[4], const void *pixel,
                   int channel, uint32_t got, uint32_t expected)
{
    char text[EQUATION_TEXT];
    float d[4];
    equation_print(e, text);
    format_fetch(format, pixel, d);
    ck_abort_msg("%s %s channel %d of source (%a, %a, %a, %a) destination (%a, %a, %a, %a): got "
                 "0x%08x, expected 0x%08x",
                 format_info(format)->name, text, channel, (double)s[0], (double)s[1], (double)s[2],
                 (double)s[3], (double)d[0], (double)d[1], (double)d[2], (double)d[3], got,
                 expected);
}

/* One blend of random operands in the format; returns how many channels were halfway. */
static int check_one(PixelFormat format, Random *random, Operands *o)
{
    BlendEquation e = operands_equation(random);
    float source[1][4], d[4];
    do
        for (int i = 0; i < 4; i++) {
            source[0][i] = operands_number(random);
            d[i] = random_bits(random) % 16 ? operands_number(random) : -source[0][i];
        }
    while (has_negative_zero(source[0], d));
    unsigned char pixel[16], blended[16];
    format_store(format, d, pixel);
    format_fetch(format, pixel, d);
    if (has_negative_zero(source[0], d))
        return 0;
    memcpy(blended, pixel, sizeof pixel);
    arithmetic_blend(&exact, &e, format, 1, (const float(*)[4])source, blended);
    int ties = 0;
    for (int i = 0; i < format_info(format)->channels; i++) {
        bool tie;
        uint32_t expected = expected_bits(&e, format, source[0], pixel, i, o, &tie);
        uint32_t got = format_bits(format, blended, i);
        if (got != expected)
            report(format, &e, source[0], pixel, i, got, expected);
        ties += tie;
    }
    return ties;
}

START_TEST(test_rationals)
{
    const char *wanted = getenv("PEEL_TEST_COUNT");
    int count = (wanted ? atoi(wanted) : CASES) / FORMATS, ties = 0;
    PixelFormat format = formats[_i];
    Random random = random_seed(90 + (uint64_t)_i);
    Operands o;
    mpq_inits(o.source, o.destination, o.source_alpha, o.destination_alpha, o.one, NULL);
    mpq_set_ui(o.one, 1, 1);
    for (int done = 0; done < count; done += format_info(format)->channels)
        ties += check_one(format, &random, &o);
    mpq_clears(o.source, o.destination, o.source_alpha, o.destination_alpha, o.one, NULL);
    if (format_info(format)->kind != KIND_UNORM)
        ck_assert_int_ge(ties, count / 200);
    else
        ck_assert_int_eq(ties, 0); /* the greatest code is odd */
}
END_TEST

/* All triples of 8 bits, in the under-blend's red and alpha. */
START_TEST(test_under8)
{
    const BlendEquation *under = &equation_info(EQUATION_UNDER)->equation;
    for (unsigned s = 0; s < 256; s++)
        for (unsigned alpha = 0; alpha < 256; alpha++)
            for (unsigned d = 0; d < 256; d += 3) {
                float x = (float)((double)s / 255.0);
                float source[1][4] = {{x, 0, 0, x}};
                uint8_t pixel[4] = {(uint8_t)d, 0, 0, (uint8_t)alpha};
                arithmetic_blend(&exact, under, FORMAT_RGBA8, 1, (const float(*)[4])source, pixel);
                unsigned red = (2 * (s * alpha + 255 * d) + 255) / 510;
                unsigned left = (2 * alpha * (255 - s) + 255) / 510;
                if (pixel[0] != (red < 255 ? red : 255) || pixel[3] != left)
                    ck_abort_msg("s %u, T %u, d %u: got %u and %u, expected %u and %u", s, alpha, d,
                                 pixel[0], pixel[3], red < 255 ? red : 255, left);
            }
}
END_TEST

typedef struct Special {
    const char *equation;
    float source, source_alpha, destination, destination_alpha, expected;
} Special;

static const Special specials[] = {
    /* NaN and infinity by IEEE's operations. */
    {"add", INFINITY, 1, -INFINITY, 1, NAN},
    {"add", INFINITY, 1, 3, 1, INFINITY},
    {"one,one:subtract", INFINITY, 1, INFINITY, 1, NAN},
    {"one,one:reverse-subtract", INFINITY, 1, 3, 1, -INFINITY},
    {"under", INFINITY, 1, 0, 0, NAN},
    {"under", 1, 1, INFINITY, 1, INFINITY},
    {"product", INFINITY, 1, 2, 1, NAN}, /* the source times 0 */
    {"zero,src-alpha", NAN, 1, 2, 1, NAN},
    {"over", 1, INFINITY, 1, 1, NAN},
    {"src-alpha,zero", 1, INFINITY, 2, 1, INFINITY},
    {"max", NAN, 1, 2, 1, 2}, /* a number rather than NaN */
    {"max", 2, 1, NAN, 1, 2},
    {"max", NAN, 1, NAN, 1, NAN},
    {"one,one:min", -INFINITY, 1, 2, 1, -INFINITY},
    /* Zeros. */
    {"add", -0.0f, 1, -0.0f, 1, -0.0f},
    {"add", -0.0f, 1, 0.0f, 1, 0.0f},
    {"add", 3, 1, -3, 1, 0.0f},
    {"one,one:subtract", 0.0f, 1, 0.0f, 1, 0.0f},
    {"one,one:subtract", -0.0f, 1, 0.0f, 1, -0.0f},
    {"product", 1, 1, -2, 1, 0.0f},
    {"zero,zero", -1, 1, -2, 1, -0.0f},
    {"max", -0.0f, 1, 0.0f, 1, 0.0f},
    {"max", 0.0f, 1, -0.0f, 1, 0.0f},
    {"one,one:min", 0.0f, 1, -0.0f, 1, -0.0f},
    {"one,one:min", -0.0f, 1, 0.0f, 1, -0.0f},
    /* Overflow, and what rounds to nothing. */
    {"add", 0x1.fffffep127f, 1, 0x1p103f, 1, INFINITY}, /* half-way: to even */
    {"add", 0x1.fffffep127f, 1, 0x1.fffffep102f, 1, 0x1.fffffep127f},
    {"src-alpha,zero", 0x1p-149f, 0.5f, 0, 1, 0.0f}, /* half-way: to even */
    {"src-alpha,zero", -0x1p-149f, 0.5f, 0, 1, -0.0f},
    {"src-alpha,zero", 0x1p-149f, 0x1.000002p-1f, 0, 1, 0x1p-149f},
    {"src-alpha,one", 0x1.8p-149f, 1, 0, 1, 0x1p-148f},
    /* 1 − x is not rounded: x·(1 − 2^-60) rounds up again, d − d·2^-60 + 2^-90 does not. */
    {"one,one-minus-src-alpha", 0, 0x1p-60f, 1, 1, 1.0f},
    {"src-alpha,one-minus-src-alpha", 1, 0x1p-60f, 1, 1, 1.0f},
    /* The sum is exact before it is rounded: 1 + 2^-24 is a tie, 1 + 2^-24 + 2^-100 is not. */
    {"src-alpha,one", 0x1p-24f, 1, 1, 1, 1.0f},
    {"src-alpha,one", 0x1.000002p-24f, 1, 1, 1, 0x1.000002p+0f},
    {"src-alpha-saturate,one-minus-src-color", 0x1p-50f, 0x1p-50f, 1, 1, 1.0f},
};

START_TEST(test_special)
{
    const Special *row = &specials[_i];
    BlendEquation equation;
    ck_assert_msg(equation_parse(row->equation, &equation) == RESULT_OK, "%s", result_message());
    float source[1][4] = {{row->source, 0, 0, row->source_alpha}};
    float pixel[4] = {row->destination, 0, 0, row->destination_alpha};
    arithmetic_blend(&exact, &equation, FORMAT_RGBA32F, 1, (const float(*)[4])source, pixel);
    if (row->expected != row->expected)
        ck_assert_uint_eq(testing_bits(pixel[0]), 0x7fc00000u);
    else
        ck_assert_float_bits(pixel[0], row->expected);
}
END_TEST

/* 65520 is half-way between 65504 and what is infinite. */
START_TEST(test_half_overflow)
{
    static const struct {
        float source;
        uint16_t expected;
    } rows[] = {{65519.996f, 0x7bff}, {65520.0f, 0x7c00}, {-65520.0f, 0xfc00}, {0x1p-25f, 0},
                {0x1.000002p-25f, 1}, {0x1.8p-24f, 2},    {NAN, 0x7e00}};
    const BlendEquation *add = &equation_info(EQUATION_ADD)->equation;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        float source[1][4] = {{rows[i].source, 0, 0, 0}};
        uint16_t pixel[4] = {0};
        arithmetic_blend(&exact, add, FORMAT_RGBA16F, 1, (const float(*)[4])source, pixel);
        ck_assert_uint_eq(pixel[0], rows[i].expected);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("arithmetic_exact");
    TCase *tcase = tcase_create("rational");
    tcase_set_timeout(tcase, 300);
    tcase_add_loop_test(tcase, test_rationals, 0, FORMATS);
    tcase_add_test(tcase, test_under8);
    tcase_add_loop_test(tcase, test_special, 0, (int)(sizeof specials / sizeof *specials));
    tcase_add_test(tcase, test_half_overflow);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
