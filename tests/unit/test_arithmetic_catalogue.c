/* The named arithmetics, and arithmetics as text. */
#include "testing.h"

#include "base/random.h"
#include "blend/arithmetic.h"

static Arithmetic any_fields(Random *random)
{
    uint64_t bits = random_bits(random);
    return (Arithmetic){.kind = ARITHMETIC_STEPS,
                        .precision = (BlendPrecision)(bits & 3),
                        .rounding = (BlendRounding)(bits >> 2 & 3),
                        .store = (BlendRounding)(bits >> 4 & 3),
                        .product = (CodeProduct)((bits >> 6 & 15) % (CODES_RECIPROCAL + 1)),
                        .fused = bits >> 10 & 1,
                        .flush = bits >> 11 & 1,
                        .source_stored = bits >> 12 & 1,
                        .mistakes =
                            (uint32_t)(bits >> 13 & bits >> 33 & ((1u << MISTAKE_COUNT) - 1))};
}

START_TEST(test_text)
{
    for (size_t i = 0; i < arithmetic_count(); i++) {
        const ArithmeticInfo *info = arithmetic_info(i);
        char text[ARITHMETIC_TEXT];
        Arithmetic parsed;
        ck_assert_msg(arithmetic_parse(info->name, &parsed) == RESULT_OK, "%s", result_message());
        arithmetic_print(&parsed, text);
        ck_assert_str_eq(text, info->name); /* so no two are the same */
        ck_assert(strlen(info->what) > 0 && !strchr(info->what, '\n'));
        ck_assert_msg(!strstr(info->what, "the same") && strncmp(info->what, "as ", 3) != 0,
                      "%s: %s", info->name, info->what); /* each stands alone */
        ck_assert_msg(!parsed.mistakes || info->wrong, "%s", info->name);
    }
    Random random = random_seed(77);
    for (int i = 0; i < 20000; i++) {
        Arithmetic a = any_fields(&random), parsed;
        char text[ARITHMETIC_TEXT], again[ARITHMETIC_TEXT];
        arithmetic_print(&a, text);
        if (arithmetic_parse(text, &parsed) != RESULT_OK)
            ck_abort_msg("%s", result_message());
        arithmetic_print(&parsed, again);
        if (strcmp(text, again) != 0 || parsed.mistakes != a.mistakes || parsed.fused != a.fused ||
            parsed.store != a.store || parsed.product != a.product)
            ck_abort_msg("'%s' is read as '%s'", text, again);
    }
}
END_TEST

START_TEST(test_refused)
{
    static const struct {
        const char *text, *message;
    } rows[] = {
        {"",
         "arithmetic: '': expected a name, or key=value of precision, rounding, store, product, "
         "fused, flush, source-stored, mistake"},
        {"exakt", "arithmetic: 'exakt': expected a name, or key=value of precision, rounding, "
                  "store, product, fused, flush, source-stored, mistake"},
        {"store=trunc", "arithmetic: 'store=trunc': expected nearest, truncate, away or up"},
        {"fused=1", "arithmetic: 'fused=1': expected yes or no"},
        {"fused=yes,", "arithmetic: '': expected a name, or key=value of precision, rounding, "
                       "store, product, fused, flush, source-stored, mistake"},
        {"mistake=none", "arithmetic: 'mistake=none': expected a mistake, such as "
                         "factors-swapped"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        Arithmetic a;
        ck_assert_int_eq(arithmetic_parse(rows[i].text, &a), RESULT_BAD_INPUT);
        ck_assert_str_eq(result_message(), rows[i].message);
    }
    static const struct {
        const char *text;
        PixelFormat format;
        const char *reason; /* NULL: not refused */
    } pairs[] = {
        {"exact", FORMAT_RG16, "nothing is blended in this format"},
        {"exact", FORMAT_D24, "nothing is blended in this format"},
        {"codes-nearest", FORMAT_RGBA16F, "arithmetic of codes needs a unorm format"},
        {"codes-nearest", FORMAT_RGBA16, NULL},
        {"precision=double,rounding=truncate", FORMAT_RGBA8, "double operations are rounded"},
        {"codes-eight-bits", FORMAT_RGBA8, "too few bits"},
        {"codes-eight-bits", FORMAT_RGBA16, NULL},
        {"clamped-early", FORMAT_RGBA8, "unorm formats clamp the source rightly"},
        {"clamped-late", FORMAT_RGBA16F, "a late clamp"},
        {"mistake=wraps", FORMAT_RGBA8, "wrapping is of codes"},
        {"precision=codes,mistake=gamma", FORMAT_RGBA8, "this mistake is of floats"},
    };
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        Arithmetic a;
        ck_assert_int_eq(arithmetic_parse(pairs[i].text, &a), RESULT_OK);
        const char *reason =
            arithmetic_refuses(&a, &equation_info(EQUATION_UNDER)->equation, pairs[i].format);
        if (!pairs[i].reason)
            ck_assert_msg(!reason, "%s: %s", pairs[i].text, reason);
        else
            ck_assert_msg(reason && strstr(reason, pairs[i].reason), "%s: %s", pairs[i].text,
                          reason ? reason : "not refused");
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("arithmetic_catalogue");
    TCase *tcase = tcase_create("text");
    tcase_add_test(tcase, test_text);
    tcase_add_test(tcase, test_refused);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
