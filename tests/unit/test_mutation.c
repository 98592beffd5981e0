/* The catalogue of known mistakes: its names and texts, and those that are settings. */
#include "testing.h"

#include "frame/mutation.h"

#include <stdio.h>

static bool is_line(const char *text)
{
    size_t length = strlen(text);
    return length > 20 && length < 240 && !strchr(text, '\n') && text[length - 1] != '.';
}

/* Lower-case words and numbers between single hyphens. */
static bool is_kebab(const char *name)
{
    size_t length = strlen(name);
    return length > 0 && strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789-") == length &&
           name[0] != '-' && name[length - 1] != '-' && !strstr(name, "--");
}

START_TEST(test_texts)
{
    for (int i = 0; i < MUTATION_COUNT; i++) {
        const MutationInfo *info = mutation_info((MutationId)i);
        ck_assert_msg(info->name && info->cause && info->cure, "mutation %d has no text", i);
        ck_assert_msg(is_kebab(info->name), "'%s'", info->name);
        ck_assert_msg(is_line(info->cause), "%s: '%s'", info->name, info->cause);
        ck_assert_msg(strlen(info->cure) > 10 && !strchr(info->cure, '\n'), "%s: '%s'", info->name,
                      info->cure);
        ck_assert_int_eq(mutation_find(info->name), i); /* so that none is there twice */
    }
    ck_assert_int_eq(mutation_find("never-made"), MUTATION_COUNT);
    ck_assert_int_eq(mutation_find(""), MUTATION_COUNT);
    ck_assert_int_ge(MUTATION_COUNT, 36);
    ck_assert_int_lt(MUTATION_COUNT, 64);
}
END_TEST

/* Names that others rely on. */
START_TEST(test_stable_names)
{
    static const char *const names[] = {
        "not-premultiplied",         "premultiplied-twice",  "over-front-to-back",
        "destination-alpha-zero",    "background-forgotten", "opaque-depth-ignored",
        "transmittance-as-coverage", "layers-reversed",      "passes-short"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        ck_assert_msg(mutation_find(names[i]) != MUTATION_COUNT, "%s", names[i]);
}
END_TEST

START_TEST(test_settings)
{
    RenderDesc desc = {.width = 5, .height = 4, .passes = 3}, out;
    mutation_apply(&desc, &out);
    ck_assert_int_eq(memcmp(&desc, &out, sizeof desc), 0);

    desc.mutations = mutation_bit(MUTATION_PASSES_6) | mutation_bit(MUTATION_DEPTH_16) |
                     mutation_bit(MUTATION_PEEL_BIAS_1E_3) | mutation_bit(MUTATION_RAW_PEEL_TEST) |
                     mutation_bit(MUTATION_NORMALS_NOT_FLIPPED) |
                     mutation_bit(MUTATION_ACCUMULATION_HALF);
    mutation_apply(&desc, &out);
    ck_assert_uint_eq(out.mutations, 0);
    ck_assert_int_eq(out.width, 5);
    ck_assert_int_eq(out.passes, 6);
    ck_assert_int_eq(out.depth, FORMAT_D16);
    ck_assert_float_bits(out.bias, 1e-3f);
    ck_assert_int_eq(out.peel_test, PEEL_TEST_RAW);
    ck_assert_int_eq(out.normals, NORMALS_KEPT);
    ck_assert_int_eq(out.accum, FORMAT_RGBA16F);
    ck_assert_int_eq(out.method, METHOD_PEEL);

    /* A setting beside a mistake that is none. */
    desc.mutations =
        mutation_bit(MUTATION_OBJECTS_SORTED) | mutation_bit(MUTATION_BACKGROUND_FORGOTTEN);
    mutation_apply(&desc, &out);
    ck_assert_uint_eq(out.mutations, mutation_bit(MUTATION_BACKGROUND_FORGOTTEN));
    ck_assert_int_eq(out.method, METHOD_PAINTER);
    ck_assert_int_eq(out.passes, 3);
}
END_TEST

START_TEST(test_exclusion)
{
    RenderDesc desc = {.width = 1, .height = 1}, out;
    ck_assert(mutation_excludes(MUTATION_DEPTH_16, MUTATION_DEPTH_24));
    ck_assert(mutation_excludes(MUTATION_PASSES_8, MUTATION_PASSES_SHORT));
    ck_assert(!mutation_excludes(MUTATION_DEPTH_16, MUTATION_PASSES_4));
    ck_assert(!mutation_excludes(MUTATION_MISSING_1_OVER_PI, MUTATION_LIGHTS_OFF_BY_ONE));
    for (int a = 0; a < MUTATION_COUNT; a++)
        for (int b = 0; b < MUTATION_COUNT; b++)
            ck_assert_int_eq(mutation_excludes((MutationId)a, (MutationId)b),
                             mutation_excludes((MutationId)b, (MutationId)a));
    desc.mutations = mutation_bit(MUTATION_NOT_PREMULTIPLIED) |
                     mutation_bit(MUTATION_PREMULTIPLIED_TWICE) |
                     mutation_bit(MUTATION_PASSES_SHORT) | mutation_bit(MUTATION_PASSES_4);
    mutation_apply(&desc, &out);
    ck_assert_uint_eq(out.mutations, mutation_bit(MUTATION_PREMULTIPLIED_TWICE));
    ck_assert_int_eq(out.passes, 4);
    desc.mutations = mutation_bit(MUTATION_DEPTH_16) | mutation_bit(MUTATION_DEPTH_24) |
                     mutation_bit(MUTATION_ACCUMULATION_8_BIT) |
                     mutation_bit(MUTATION_ACCUMULATION_HALF_ROUNDED);
    mutation_apply(&desc, &out);
    ck_assert_int_eq(out.depth, FORMAT_D24);
    ck_assert_int_eq(out.accum, FORMAT_RGBA32F);
    ck_assert_uint_eq(out.mutations, mutation_bit(MUTATION_ACCUMULATION_HALF_ROUNDED));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("mutation");
    TCase *all = tcase_create("all");
    tcase_add_test(all, test_texts);
    tcase_add_test(all, test_stable_names);
    tcase_add_test(all, test_settings);
    tcase_add_test(all, test_exclusion);
    suite_add_tcase(suite, all);
    return testing_run(suite);
}
