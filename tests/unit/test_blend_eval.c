/* Blends number by number: layers as they are read, hand-computed blends, and random ones against
 * fractions computed here. */
#include "testing.h"

#include "base/random.h"
#include "number/numeral.h"
#include "study/blend_eval.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

static void read_number(const char *text, Rational *out)
{
    ck_assert_msg(numeral_read(text, strlen(text), out) == RESULT_OK, "%s: %s", text,
                  result_message());
}

/* ---- layers ---- */

static BlendLayers layers_of(int count, const char *const *texts)
{
    BlendLayers layers = {0};
    for (int i = 0; i < count; i++)
        ck_assert_msg(blend_layers_add("layer", texts[i], strlen(texts[i]), &layers) == RESULT_OK,
                      "%s", result_message());
    return layers;
}

START_TEST(colours_are_read)
{
    static const char *const texts[] = {"#ff008040", "#010203", "#ffff000080004000", "1, 2 ,3,1/2",
                                        "1 2\t3  4"};
    static const char *const expected[][4] = {{"1", "0", "128/255", "64/255"},
                                              {"1/255", "2/255", "3/255", "1"},
                                              {"1", "0", "32768/65535", "16384/65535"},
                                              {"1", "2", "3", "1/2"},
                                              {"1", "2", "3", "4"}};
    BlendLayers layers = layers_of(5, texts);
    Rational number;
    rational_init(&number);
    for (int i = 0; i < 5; i++)
        for (int c = 0; c < 4; c++) {
            read_number(expected[i][c], &number);
            ck_assert(rational_equal(&layers.colours[i].channels[c], &number));
        }
    rational_clear(&number);
    blend_layers_free(&layers);
}
END_TEST

static void check_bad(const char *text, size_t length, const char *expected)
{
    BlendLayers layers = {0};
    ck_assert_int_eq(blend_layers_add("f:3", text, length, &layers), RESULT_BAD_INPUT);
    ck_assert_msg(strstr(result_message(), "f:3: ") == result_message() &&
                      strstr(result_message(), expected),
                  "'%s': %s", text, result_message());
    blend_layers_free(&layers);
}

START_TEST(bad_colours_are_refused)
{
    check_bad("1,2,3", 5, "found 3");
    check_bad("1,2,3,4,5", 9, "found more");
    check_bad("1", 1, "found 1");
    check_bad("", 0, "expected 4 numbers");
    check_bad("1,,3,4", 6, "green: ''");
    check_bad("1,2,3,", 6, "alpha: ''");
    check_bad("1 2 x 4", 7, "blue: 'x'");
    check_bad("#12345", 6, "#rrggbbaa");
    check_bad("#ggffffff", 9, "#rrggbbaa");
}
END_TEST

static void write_text(const char *path, const char *text)
{
    FILE *out = fopen(path, "w");
    ck_assert_ptr_nonnull(out);
    fputs(text, out);
    fclose(out);
}

START_TEST(files_of_layers)
{
    char path[] = "/tmp/peel-layers-XXXXXX";
    BlendLayers layers = {0};
    close(mkstemp(path));
    write_text(path, "# a comment\n\n1,0,0,1\r\n  #00ff0080 \r\n0.5 0.5 0.5 0.5");
    ck_assert_int_eq(blend_layers_load(path, &layers), RESULT_OK);
    ck_assert_uint_eq(layers.count, 3);
    blend_layers_free(&layers);
    write_text(path, "1,0,0,1\n\n0,0,nope,1\n");
    ck_assert_int_eq(blend_layers_load(path, &layers), RESULT_BAD_INPUT);
    ck_assert_ptr_nonnull(strstr(result_message(), ":3: blue: 'nope'"));
    blend_layers_free(&layers);
    write_text(path, "\n# nothing\n");
    ck_assert_int_eq(blend_layers_load(path, &layers), RESULT_BAD_INPUT);
    unlink(path);
    ck_assert_int_eq(blend_layers_load(path, &layers), RESULT_IO);
    ck_assert_int_eq(blend_layers_load("/", &layers), RESULT_IO);
    blend_layers_free(&layers);
    for (int i = 0; i < BLEND_LAYERS_MOST; i++)
        ck_assert_int_eq(blend_layers_add("many", "#000000", 7, &layers), RESULT_OK);
    ck_assert_int_eq(blend_layers_add("many", "#000000", 7, &layers), RESULT_BAD_INPUT);
    blend_layers_free(&layers);
}
END_TEST

/* ---- blends by hand ---- */

static Arithmetic arithmetic_of(const char *text)
{
    Arithmetic arithmetic;
    ck_assert_msg(arithmetic_parse(text, &arithmetic) == RESULT_OK, "%s", result_message());
    return arithmetic;
}

static void check_number(const Rational *got, const char *expected)
{
    Rational number;
    rational_init(&number);
    read_number(expected, &number);
    char *text = numeral_fraction(got);
    ck_assert_msg(rational_equal(got, &number), "got %s, expected %s", text, expected);
    free(text);
    rational_clear(&number);
}

/* Half a red pane in front of half a green one: what the help says. */
START_TEST(eight_bits_by_hand)
{
    static const char *const texts[] = {"#ff000080", "#00ff0080"};
    BlendLayers layers = layers_of(2, texts);
    EvalDesc desc = {.equation = equation_info(EQUATION_UNDER)->equation,
                     .format = FORMAT_RGBA8,
                     .multiply = true,
                     .layers = &layers};
    Arithmetic exact = {.kind = ARITHMETIC_EXACT};
    BlendEval eval;
    ck_assert_int_eq(blend_eval_open(&desc, &exact, &eval), RESULT_OK);
    ck_assert(blend_eval_next(&eval));
    ck_assert_uint_eq(eval.layer.index, 0);
    ck_assert_uint_eq(eval.layer.channels[0].stored, 128);
    ck_assert_uint_eq(eval.layer.channels[3].stored, 127);
    check_number(&eval.see_through, "127/255");
    ck_assert(blend_eval_next(&eval));
    const EvalChannel *green = &eval.layer.channels[1];
    check_number(&green->steps[EVAL_PUT_OUT].number, "8421505/2^24");
    check_number(&green->steps[EVAL_SOURCE].number, "128/255");
    check_number(&green->steps[EVAL_SOURCE_FACTOR].number, "127/255");
    check_number(&green->steps[EVAL_SOURCE_PRODUCT].number, "16256/65025");
    check_number(&green->steps[EVAL_SUM].number, "16256/65025");
    check_number(&green->steps[EVAL_STORED].number, "64/255");
    check_number(&green->steps[EVAL_STORED].error, "64/65025"); /* 64·255 − 16256 */
    ck_assert_double_eq_tol(green->steps[EVAL_STORED].ulp, 64.0 / 255.0, 1e-15);
    check_number(&green->exact, "16256/65025");
    check_number(&green->off, "64/65025");
    check_number(&eval.layer.channels[3].exact, "16129/65025");
    ck_assert_uint_eq(eval.layer.channels[3].stored, 63);
    ck_assert(!blend_eval_next(&eval));
    ck_assert_uint_eq(eval.totals.layer, 1);
    ck_assert_int_eq(eval.totals.channel, 1);
    ck_assert_int_eq(eval.totals.step, EVAL_STORED);
    blend_eval_close(&eval);
    blend_layers_free(&layers);
}
END_TEST

/* 1/3 as a float is 11184811/2^25, 2^-25/3 too much. */
START_TEST(floats_by_hand)
{
    static const char *const texts[] = {"1,0,0,1/2", "0,1,0,1/3"};
    BlendLayers layers = layers_of(2, texts);
    EvalDesc desc = {.equation = equation_info(EQUATION_UNDER)->equation,
                     .format = FORMAT_RGBA32F,
                     .multiply = true,
                     .layers = &layers};
    Arithmetic separate = arithmetic_of("separate");
    BlendEval eval;
    ck_assert_int_eq(blend_eval_open(&desc, &separate, &eval), RESULT_OK);
    while (blend_eval_next(&eval))
        ;
    const EvalValue *alpha = eval.layer.channels[3].steps;
    check_number(&alpha[EVAL_PUT_OUT].number, "11184811/2^25");
    check_number(&alpha[EVAL_PUT_OUT].error, "0x1p-25/3");
    ck_assert_double_eq_tol(alpha[EVAL_PUT_OUT].ulp, 1.0 / 3.0, 1e-15);
    check_number(&alpha[EVAL_DESTINATION_FACTOR].number, "5592405/2^23"); /* of 22369621/2^25 */
    check_number(&alpha[EVAL_DESTINATION_FACTOR].error, "-1/2^25");
    ck_assert_double_eq(alpha[EVAL_DESTINATION_FACTOR].ulp, -0.5);
    check_number(&alpha[EVAL_STORED].number, "5592405/2^24");
    check_number(&eval.exact[1], "1/6");
    check_number(&eval.exact[3], "1/3");
    check_number(&eval.layer.channels[3].off, "-1/50331648"); /* 5592405/2^24 − 1/3 */
    blend_eval_close(&eval);
    blend_layers_free(&layers);
}
END_TEST

/* A fused operation adds the product of 48 digits: shown whole, and rounded once. */
START_TEST(fused_by_hand)
{
    static const char *const texts[] = {"0,0,0,0.1", "0,0,0,0.1"};
    BlendLayers layers = layers_of(2, texts);
    EvalDesc desc = {.equation = equation_info(EQUATION_UNDER)->equation,
                     .format = FORMAT_RGBA32F,
                     .layers = &layers};
    Arithmetic fused = arithmetic_of("fused");
    BlendEval eval;
    ck_assert_int_eq(blend_eval_open(&desc, &fused, &eval), RESULT_OK);
    while (blend_eval_next(&eval))
        ;
    const EvalValue *alpha = eval.layer.channels[3].steps;
    check_number(&alpha[EVAL_DESTINATION].number, "7549747/2^23");
    check_number(&alpha[EVAL_DESTINATION_FACTOR].number, "7549747/2^23");
    check_number(&alpha[EVAL_DESTINATION_PRODUCT].number, "56998679764009/2^46");
    check_number(&alpha[EVAL_DESTINATION_PRODUCT].error, "0");
    check_number(&alpha[EVAL_SUM].number, "1698693/2^21");
    ck_assert_double_gt(fabs(alpha[EVAL_SUM].ulp), 0.0);
    ck_assert_double_le(fabs(alpha[EVAL_SUM].ulp), 0.5);
    blend_eval_close(&eval);
    blend_layers_free(&layers);
}
END_TEST

START_TEST(specials_by_hand)
{
    static const char *const texts[] = {"nan,inf,-inf,1", "1e40,1e-46,1,0"};
    BlendLayers layers = layers_of(2, texts);
    EvalDesc desc = {.equation = equation_info(EQUATION_ADD)->equation,
                     .format = FORMAT_RGBA16F,
                     .layers = &layers};
    Arithmetic exact = {.kind = ARITHMETIC_EXACT};
    BlendEval eval;
    ck_assert_int_eq(blend_eval_open(&desc, &exact, &eval), RESULT_OK);
    ck_assert(blend_eval_next(&eval));
    ck_assert_int_eq(eval.layer.channels[0].exact.kind, RATIONAL_NAN);
    ck_assert_double_eq(eval.layer.channels[0].off_ulp, 0.0); /* NaN is NaN */
    ck_assert_uint_eq(eval.layer.channels[1].stored, 0x7c00);
    ck_assert_uint_eq(eval.layer.channels[2].stored, 0xfc00);
    ck_assert_double_eq(eval.layer.channels[2].off_ulp, 0.0);
    ck_assert(blend_eval_next(&eval));
    ck_assert(isinf(eval.layer.channels[0].steps[EVAL_PUT_OUT].ulp)); /* 1e40 is no float */
    ck_assert_uint_eq(eval.layer.channels[0].stored & 0x7fffu, 0x7e00);
    check_number(&eval.layer.channels[1].steps[EVAL_PUT_OUT].number, "0");
    check_number(&eval.layer.channels[1].steps[EVAL_PUT_OUT].error, "-1e-46");
    ck_assert_uint_eq(eval.layer.channels[2].stored, 0xfc00);
    ck_assert(isinf(eval.totals.largest_ulp));
    blend_eval_close(&eval);
    blend_layers_free(&layers);
}
END_TEST

/* ---- random blends against fractions ---- */

static float random_float(Random *random)
{
    static const float specials[] = {
        0.0f,     -0.0f,           1.0f,  0x1p-149f,     0x1.fffffep-127f, INFINITY,
        65504.0f, 0x1.fffffep127f, -1.0f, 0x1.fffffep-1f};
    uint32_t bits = (uint32_t)random_bits(random);
    float x;
    if (bits % 8 == 0)
        return specials[(bits >> 8) % (sizeof specials / sizeof *specials)];
    if (bits % 8 < 6)
        return (float)(bits >> 8) * 0x1p-24f;
    memcpy(&x, &bits, sizeof x);
    return x == x ? x : 0.5f;
}

static BlendLayers random_layers(Random *random, int count)
{
    BlendLayers layers = {0};
    for (int i = 0; i < count; i++) {
        ck_assert_int_eq(blend_layers_add("layer", "#000000", 7, &layers), RESULT_OK);
        for (int c = 0; c < 4; c++)
            rational_set((double)random_float(random), &layers.colours[i].channels[c]);
    }
    return layers;
}

/* Within a layer: the sum is s·f + d·g and all errors of the way, and what is stored is that, maybe
 * clamped, and an error. */
static void check_errors(const BlendEval *eval, int c)
{
    const EvalValue *steps = eval->layer.channels[c].steps;
    Rational sum, product;
    rational_init(&sum);
    rational_init(&product);
    rational_mul(&steps[EVAL_SOURCE].number, &steps[EVAL_SOURCE_FACTOR].number, &sum);
    rational_mul(&steps[EVAL_DESTINATION].number, &steps[EVAL_DESTINATION_FACTOR].number, &product);
    rational_add(&sum, &product, &sum);
    rational_add(&sum, &steps[EVAL_SOURCE_PRODUCT].error, &sum);
    rational_add(&sum, &steps[EVAL_DESTINATION_PRODUCT].error, &sum);
    rational_add(&sum, &steps[EVAL_SUM].error, &sum);
    if (sum.kind == RATIONAL_FINITE)
        ck_assert(rational_equal(&sum, &steps[EVAL_SUM].number));
    if (format_info(eval->desc.format)->kind == KIND_UNORM)
        rational_clamp(&sum, &sum);
    rational_add(&sum, &steps[EVAL_STORED].error, &sum);
    if (sum.kind == RATIONAL_FINITE)
        ck_assert(rational_equal(&sum, &steps[EVAL_STORED].number));
    rational_clear(&sum);
    rational_clear(&product);
}

/* The exact arithmetic's result is its own sum, rounded once by other code. */
static void check_exact(const BlendEval *eval, int c)
{
    const EvalChannel *channel = &eval->layer.channels[c];
    PixelFormat format = eval->desc.format;
    uint32_t expected = rational_store(&channel->steps[EVAL_SUM].number, format);
    FormatKind kind = format_info(format)->kind;
    bool zero = (expected & 0x7fffffffu) == 0 || (kind == KIND_HALF && (expected & 0x7fffu) == 0);
    ck_assert_msg(zero || format_ulp(kind, channel->stored, expected) == 0,
                  "%s, channel %d: got %08x, expected %08x", format_info(format)->name, c,
                  channel->stored, expected);
    for (EvalStep step = EVAL_SOURCE_FACTOR; step < EVAL_STORED; step++)
        ck_assert(rational_is_zero(&channel->steps[step].error));
}

START_TEST(random_blends_add_up)
{
    static const PixelFormat formats[] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16,
                                          FORMAT_RGBA8,   FORMAT_RG32F,   FORMAT_R32F};
    static const char *const names[] = {"exact", "separate", "fused", "separate-truncated",
                                        "codes-nearest"};
    Random random = random_seed(20);
    uint64_t blends = 0;
    for (int round = 0; round < 3000; round++) {
        BlendEquation equation = {.source = random_bits(&random) % FACTOR_COUNT,
                                  .destination = random_bits(&random) % FACTOR_COUNT,
                                  .source_alpha = random_bits(&random) % FACTOR_COUNT,
                                  .destination_alpha = random_bits(&random) % FACTOR_COUNT};
        BlendLayers layers = random_layers(&random, 3);
        EvalDesc desc = {.equation = equation, .format = formats[round % 6], .layers = &layers};
        Arithmetic arithmetic = arithmetic_of(names[round % 5]);
        BlendEval eval;
        if (arithmetic_refuses(&arithmetic, &equation, desc.format) == NULL) {
            unsigned char all[16];
            ck_assert_int_eq(blend_eval_open(&desc, &arithmetic, &eval), RESULT_OK);
            while (blend_eval_next(&eval))
                for (int c = 0; c < format_info(desc.format)->channels; c++, blends++) {
                    check_errors(&eval, c);
                    if (arithmetic.kind == ARITHMETIC_EXACT)
                        check_exact(&eval, c);
                }
            blend_eval_all(&desc, &arithmetic, all);
            ck_assert_mem_eq(all, eval.pixel, format_pixel_bytes(desc.format));
            blend_eval_close(&eval);
        } else {
            ck_assert_int_eq(blend_eval_open(&desc, &arithmetic, &eval), RESULT_UNSUPPORTED);
        }
        blend_layers_free(&layers);
    }
    ck_assert_uint_gt(blends, 20000);
}
END_TEST

/* The ideal under-blend is sum(a·c·prod(1 − a of those in front)); over it is the same. */
START_TEST(ideal_is_the_same_both_ways)
{
    Random random = random_seed(21);
    static const EquationId equations[] = {
        EQUATION_UNDER, EQUATION_OVER, EQUATION_OVER_PREMULTIPLIED, EQUATION_OVER_TRANSMITTANCE};
    for (int round = 0; round < 200; round++) {
        BlendLayers layers = random_layers(&random, 1 + round % 7);
        mpq_t colour, through, term;
        mpq_inits(colour, through, term, NULL);
        mpq_set_ui(through, 1, 1);
        for (size_t i = 0; i < layers.count; i++) {
            for (int c = 0; c < 4; c++)
                rational_set_ratio((unsigned long)(random_bits(&random) % 101), 100,
                                   &layers.colours[i].channels[c]);
            mpq_mul(term, layers.colours[i].channels[0].value, layers.colours[i].channels[3].value);
            mpq_mul(term, term, through);
            mpq_add(colour, colour, term);
            mpq_set_ui(term, 1, 1);
            mpq_sub(term, term, layers.colours[i].channels[3].value);
            mpq_mul(through, through, term);
        }
        for (int e = 0; e < 4; e++) {
            Arithmetic exact = {.kind = ARITHMETIC_EXACT};
            EvalDesc desc = {.equation = equation_info(equations[e])->equation,
                             .format = round % 2 ? FORMAT_RGBA8 : FORMAT_RGBA32F,
                             .multiply = equations[e] != EQUATION_OVER,
                             .layers = &layers};
            BlendEval eval;
            ck_assert_int_eq(blend_eval_open(&desc, &exact, &eval), RESULT_OK);
            while (blend_eval_next(&eval))
                ;
            ck_assert(mpq_equal(eval.exact[0].value, colour));
            ck_assert(mpq_equal(eval.see_through.value, through));
            Rational alpha;
            rational_init(&alpha);
            rational_copy(&eval.exact[3], &alpha);
            if (blend_eval_alpha(&desc.equation) == EVAL_COVERAGE)
                rational_one_minus(&alpha, &alpha);
            ck_assert(mpq_equal(alpha.value, through));
            rational_clear(&alpha);
            blend_eval_close(&eval);
        }
        mpq_clears(colour, through, term, NULL);
        blend_layers_free(&layers);
    }
}
END_TEST

/* Numbers that no rounding touches: under, over and the ideal are one, whatever the start is. */
START_TEST(sides_agree_on_exact_numbers)
{
    static const char *const texts[] = {"1,0,1/4,1/2", "0,1,1/2,3/4", "1,1,1,1/4"};
    BlendLayers layers = layers_of(3, texts);
    BlendColour start;
    blend_colour_init(&start);
    ck_assert_int_eq(blend_colour_read("start", "1/8,1/4,1/2,3/4", 15, 4, &start), RESULT_OK);
    static const EquationId equations[] = {
        EQUATION_UNDER, EQUATION_OVER, EQUATION_OVER_PREMULTIPLIED, EQUATION_OVER_TRANSMITTANCE};
    for (int i = 0; i < 8; i++) {
        Arithmetic separate = arithmetic_of("separate");
        EvalDesc desc = {.equation = equation_info(equations[i % 4])->equation,
                         .format = FORMAT_RGBA32F,
                         .multiply = equations[i % 4] != EQUATION_OVER,
                         .layers = &layers,
                         .start = i < 4 ? NULL : &start};
        BlendEval eval;
        EvalSides sides;
        ck_assert_int_eq(blend_eval_open(&desc, &separate, &eval), RESULT_OK);
        while (blend_eval_next(&eval))
            ;
        ck_assert_uint_eq(eval.totals.rounded, 0);
        blend_eval_sides(&eval, &sides);
        ck_assert_ptr_null(sides.refusal);
        for (int c = 0; c < 4; c++) {
            ck_assert(rational_equal(&sides.under[c], &sides.exact[c]));
            ck_assert(rational_equal(&sides.over[c], &sides.exact[c]));
            ck_assert_double_eq(sides.between_ulp[c], 0.0);
        }
        blend_eval_sides_free(&sides);
        blend_eval_close(&eval);
    }
    blend_colour_clear(&start);
    blend_layers_free(&layers);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("blend_eval");
    TCase *layers = tcase_create("layers");
    tcase_add_test(layers, colours_are_read);
    tcase_add_test(layers, bad_colours_are_refused);
    tcase_add_test(layers, files_of_layers);
    suite_add_tcase(suite, layers);
    TCase *blends = tcase_create("blends");
    tcase_set_timeout(blends, 60);
    tcase_add_test(blends, eight_bits_by_hand);
    tcase_add_test(blends, floats_by_hand);
    tcase_add_test(blends, fused_by_hand);
    tcase_add_test(blends, specials_by_hand);
    tcase_add_test(blends, random_blends_add_up);
    tcase_add_test(blends, ideal_is_the_same_both_ways);
    tcase_add_test(blends, sides_agree_on_exact_numbers);
    suite_add_tcase(suite, blends);
    return testing_run(suite);
}
