/* blend/equation.h: names, factors and functions to text and back. */
#include "testing.h"

#include "blend/equation.h"

static void check_same(const BlendEquation *got, const BlendEquation *expected, const char *text)
{
    ck_assert_msg(got->source == expected->source && got->destination == expected->destination &&
                      got->source_alpha == expected->source_alpha &&
                      got->destination_alpha == expected->destination_alpha &&
                      got->func == expected->func && got->func_alpha == expected->func_alpha,
                  "'%s' is read as another equation", text);
}

START_TEST(test_names)
{
    for (int i = 0; i < EQUATION_COUNT; i++) {
        const EquationInfo *info = equation_info((EquationId)i);
        BlendEquation parsed;
        char text[EQUATION_TEXT];
        ck_assert_msg(equation_parse(info->name, &parsed) == RESULT_OK, "%s", result_message());
        check_same(&parsed, &info->equation, info->name);
        ck_assert_int_eq(equation_id(&parsed), i); /* so no two are the same */
        equation_print(&parsed, text);
        ck_assert_str_eq(text, info->name);
        ck_assert(strlen(info->what) > 0 && !strchr(info->what, '\n'));
    }
}
END_TEST

/* As glBlendFuncSeparate would be called. */
START_TEST(test_factors)
{
    static const struct {
        const char *name, *text;
    } rows[] = {
        {"under", "dst-alpha,one,zero,one-minus-src-alpha"},
        {"over", "src-alpha,one-minus-src-alpha,one,one-minus-src-alpha"},
        {"over-premultiplied", "one,one-minus-src-alpha"},
        {"over-transmittance", "one,one-minus-src-alpha,zero,one-minus-src-alpha:add,add"},
        {"add", "one,one:add"},
        {"max", "one,one:max"},
        {"weighted-sum", "src-alpha,one,one,one"},
        {"product", "zero,one-minus-src-color"},
        {"seed", "dst-alpha,one,dst-alpha,one"},
        {"replace", "src-alpha,one-minus-src-alpha"},
        {"keep", "one-minus-dst-alpha,one"},
    };
    ck_assert_uint_eq(sizeof rows / sizeof *rows, EQUATION_COUNT);
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        BlendEquation named, factors;
        ck_assert_int_eq(equation_parse(rows[i].name, &named), RESULT_OK);
        ck_assert_msg(equation_parse(rows[i].text, &factors) == RESULT_OK, "%s", result_message());
        check_same(&factors, &named, rows[i].text);
    }
}
END_TEST

static BlendEquation numbered(int i)
{
    BlendEquation e;
    e.source = (BlendFactor)(i % FACTOR_COUNT), i /= FACTOR_COUNT;
    e.destination = (BlendFactor)(i % FACTOR_COUNT), i /= FACTOR_COUNT;
    e.source_alpha = (BlendFactor)(i % FACTOR_COUNT), i /= FACTOR_COUNT;
    e.destination_alpha = (BlendFactor)(i % FACTOR_COUNT), i /= FACTOR_COUNT;
    e.func = (BlendFunc)(i % BLEND_FUNC_COUNT);
    e.func_alpha = (BlendFunc)(i / BLEND_FUNC_COUNT);
    return e;
}

/* Every equation there is; one message of check for all of them. */
START_TEST(test_round_trip)
{
    int count = FACTOR_COUNT * FACTOR_COUNT * FACTOR_COUNT * FACTOR_COUNT * BLEND_FUNC_COUNT *
                BLEND_FUNC_COUNT;
    size_t longest = 0;
    for (int i = 0; i < count; i++) {
        BlendEquation e = numbered(i), parsed;
        char text[EQUATION_TEXT];
        equation_print(&e, text);
        longest = strlen(text) > longest ? strlen(text) : longest;
        if (equation_parse(text, &parsed) != RESULT_OK)
            ck_abort_msg("%s", result_message());
        if (memcmp(&parsed, &e, sizeof e) != 0)
            check_same(&parsed, &e, text);
    }
    ck_assert_uint_lt(longest, EQUATION_TEXT - 1); /* nothing was cut */
}
END_TEST

START_TEST(test_refused)
{
    static const struct {
        const char *text, *message;
    } rows[] = {
        {"",
         "equation: '': expected under, over, over-premultiplied, add, max, weighted-sum, product, "
         "seed, over-transmittance, replace or keep, or factors, such as one,one-minus-src-alpha"},
        {"undr",
         "equation: 'undr': expected under, over, over-premultiplied, add, max, weighted-sum, "
         "product, "
         "seed, over-transmittance, replace or keep, or factors, such as one,one-minus-src-alpha"},
        {"Under",
         "equation: 'Under': expected under, over, over-premultiplied, add, max, weighted-sum, "
         "product, "
         "seed, over-transmittance, replace or keep, or factors, such as one,one-minus-src-alpha"},
        {"one,GL_ONE",
         "equation: 'GL_ONE': expected a factor: zero, one, src-color, one-minus-src-color, "
         "dst-color, "
         "one-minus-dst-color, src-alpha, one-minus-src-alpha, dst-alpha, one-minus-dst-alpha or "
         "src-alpha-saturate"},
        {"one", "equation: 'one': expected 2 factors (source, destination) or 4 (also of alpha), "
                "found 1"},
        {"one,one,one", "equation: 'one,one,one': expected 2 factors (source, destination) or 4 "
                        "(also of alpha), found 3"},
        {"one,one,one,one,one", "equation: 'one,one,one,one,one': expected at most 4 factors, "
                                "separated by commas"},
        {"one,one,",
         "equation: '': expected a factor: zero, one, src-color, one-minus-src-color, dst-color, "
         "one-minus-dst-color, src-alpha, one-minus-src-alpha, dst-alpha, one-minus-dst-alpha or "
         "src-alpha-saturate"},
        {"one,one:",
         "equation: '': expected a function: add, subtract, reverse-subtract, min or max"},
        {"one,one:most",
         "equation: 'most': expected a function: add, subtract, reverse-subtract, min or max"},
        {"one,one:max,min,add",
         "equation: 'max,min,add': expected at most 2 functions, separated by commas"},
        {"under:max",
         "equation: 'under': expected a factor: zero, one, src-color, one-minus-src-color, "
         "dst-color, "
         "one-minus-dst-color, src-alpha, one-minus-src-alpha, dst-alpha, one-minus-dst-alpha or "
         "src-alpha-saturate"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        BlendEquation equation;
        ck_assert_int_eq(equation_parse(rows[i].text, &equation), RESULT_BAD_INPUT);
        ck_assert_str_eq(result_message(), rows[i].message);
    }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("equation");
    TCase *tcase = tcase_create("text");
    tcase_add_test(tcase, test_names);
    tcase_add_test(tcase, test_factors);
    tcase_add_test(tcase, test_round_trip);
    tcase_add_test(tcase, test_refused);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
