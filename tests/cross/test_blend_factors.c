/* number/blend.h's model against the driver: all pairs of factors with all functions, and factors
 * and functions of colours and alpha mixed, in all formats. PEEL_TEST_STRIDE=1 runs all pairs,
 * otherwise every third. */
#include "labs.h"

#include "blend/equation.h"
#include "number/blend.h"

static const PixelFormat formats[] = {FORMAT_RGBA8,   FORMAT_RGBA16, FORMAT_RGBA16F,
                                      FORMAT_RGBA32F, FORMAT_RG32F,  FORMAT_R32F};

enum {
    FORMATS = sizeof formats / sizeof *formats,
    SUMS = 3, /* functions with factors */
    PAIRS = SUMS * FACTOR_COUNT * FACTOR_COUNT
};

static int stride(void)
{
    const char *wanted = getenv("PEEL_TEST_STRIDE");
    int value = wanted ? atoi(wanted) : 3;
    return value > 0 ? value : 1;
}

/* Without AVX, infinities and more do not fit the driver's conversion to 8 bits. */
static bool fits(PixelFormat format, InputSet set)
{
    return format != FORMAT_RGBA8 || model.fused || set < INPUT_WIDE || set == INPUT_CODES;
}

static void check(PixelFormat format, const BlendEquation *equation, InputSet set)
{
    if (!fits(format, set))
        return;
    const FormatInfo *info = format_info(format);
    LabsDistance distance = info->kind == KIND_FLOAT  ? labs_float
                            : info->kind == KIND_HALF ? labs_half
                                                      : labs_code;
    char what[EQUATION_TEXT + 16], text[EQUATION_TEXT];
    equation_print(equation, text);
    snprintf(what, sizeof what, "%s %s", info->name, text);
    Experiment experiment = {.kind = EXPERIMENT_BLEND, .format = format, .equation = *equation};
    labs_fill(set, info->unorm_max ? info->unorm_max : 2048.0);
    labs_assert_equal(&experiment, distance, what, (int)set);
}

/* Special values, and one other set after the other. */
static void check_sets(PixelFormat format, const BlendEquation *equation, int turn)
{
    static const InputSet sets[] = {INPUT_SIGNED, INPUT_WIDE,  INPUT_DENORMAL, INPUT_UNIT,
                                    INPUT_BITS,   INPUT_CODES, INPUT_POSITIVE};
    check(format, equation, INPUT_SPECIAL);
    check(format, equation, sets[turn % (int)(sizeof sets / sizeof *sets)]);
}

START_TEST(test_pairs)
{
    for (int i = _i % stride(), turn = 0; i < PAIRS; i += stride(), turn++) {
        BlendFactor s = (BlendFactor)(i % FACTOR_COUNT);
        BlendFactor d = (BlendFactor)(i / FACTOR_COUNT % FACTOR_COUNT);
        BlendFunc func = (BlendFunc)(i / (FACTOR_COUNT * FACTOR_COUNT));
        BlendEquation equation = BLEND_EQUATION_ALL(s, d, func);
        check_sets(formats[_i], &equation, turn);
    }
}
END_TEST

/* Alpha's factors are often what the driver looks at together with the colours', so equal ones are
 * drawn often. */
static BlendEquation mixed(Random *random)
{
    BlendEquation e;
    uint64_t bits = random_bits(random);
    e.source = (BlendFactor)(random_bits(random) % FACTOR_COUNT);
    e.destination = bits & 3 ? (BlendFactor)(random_bits(random) % FACTOR_COUNT) : e.source;
    e.source_alpha = bits & 4 ? (BlendFactor)(random_bits(random) % FACTOR_COUNT) : e.source;
    e.destination_alpha =
        bits & 24 ? (BlendFactor)(random_bits(random) % FACTOR_COUNT) : e.source_alpha;
    e.func = (BlendFunc)(random_bits(random) % BLEND_FUNC_COUNT);
    e.func_alpha = bits & 32 ? (BlendFunc)(random_bits(random) % BLEND_FUNC_COUNT) : e.func;
    return e;
}

START_TEST(test_mixed)
{
    Random random = random_seed(400 + (uint64_t)_i);
    for (int turn = 0; turn < 180 / stride(); turn++) {
        BlendEquation equation = mixed(&random);
        check_sets(formats[_i], &equation, turn);
    }
}
END_TEST

/* ref's functions are instances of the model: what they store is what it stores. */
START_TEST(test_named)
{
    static const struct {
        void (*blend)(PixelFormat format, const float source[4], void *pixel);
        EquationId id;
    } rows[] = {
        {blend_under, EQUATION_UNDER},     {blend_opaque_seed, EQUATION_SEED},
        {blend_add, EQUATION_ADD},         {blend_over, EQUATION_OVER_TRANSMITTANCE},
        {blend_product, EQUATION_PRODUCT}, {blend_max, EQUATION_MAX},
        {blend_replace, EQUATION_REPLACE}, {blend_keep, EQUATION_KEEP},
    };
    for (size_t row = 0; row < sizeof rows / sizeof *rows; row++)
        for (int set = 0; set < INPUT_SETS; set++) {
            const BlendEquation *equation = &equation_info(rows[row].id)->equation;
            size_t bytes = format_pixel_bytes(formats[_i]);
            labs_fill((InputSet)(1 << set), 255.0);
            uint32_t mode = op_enter();
            for (int i = 0; i < EXPERIMENT_TEXELS; i += 7) {
                unsigned char x[16], y[16];
                format_store(formats[_i], b[i], x);
                memcpy(y, x, sizeof y);
                rows[row].blend(formats[_i], a[i], x);
                blend_pixels(equation, false, formats[_i], 1, (const float(*)[4]) & a[i], y);
                if (memcmp(x, y, bytes) != 0)
                    ck_abort_msg("%s: the function's pixel is not the model's",
                                 equation_info(rows[row].id)->name);
            }
            op_leave(mode);
        }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("blend_factors");
    TCase *tcase = tcase_create("driver");
    tcase_set_timeout(tcase, 300);
    tcase_add_checked_fixture(tcase, labs_open, labs_close);
    tcase_add_loop_test(tcase, test_pairs, 0, FORMATS);
    tcase_add_loop_test(tcase, test_mixed, 0, FORMATS);
    tcase_add_loop_test(tcase, test_named, 0, FORMATS);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
