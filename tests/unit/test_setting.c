/* frame/setting.h: every choice comes back, sets one thing, and is off by default. */
#include "testing.h"

#include "frame/setting.h"

START_TEST(test_choices)
{
    RenderDesc plain = {.width = 1};
    for (int i = 0; i < SETTING_COUNT; i++) {
        SettingId id = (SettingId)i;
        int choices = setting_choice_count(id);
        ck_assert_ptr_nonnull(setting_info(id)->name);
        ck_assert_int_ge(choices, 2);
        ck_assert_int_eq(setting_get(&plain, id), 0);
        for (int choice = 0; choice < choices; choice++) {
            RenderDesc desc = {.width = 1};
            setting_put(&desc, id, choice);
            ck_assert_int_eq(setting_get(&desc, id), choice);
            for (int k = 0; k < SETTING_COUNT; k++)
                if (k != i)
                    ck_assert_int_eq(setting_get(&desc, (SettingId)k), 0);
        }
    }
}
END_TEST

/* The order of names is that of the enumerations. */
START_TEST(test_names)
{
    RenderDesc desc = {.width = 1};
    setting_put(&desc, SETTING_DEPTH_RANGE, 2);
    ck_assert_str_eq(setting_info(SETTING_DEPTH_RANGE)->choices[2], "reversed");
    ck_assert(desc.depth_range == DEPTH_RANGE_REVERSED);
    for (int i = 0; i < setting_choice_count(SETTING_ACCUM); i++) {
        setting_put(&desc, SETTING_ACCUM, i);
        ck_assert_str_eq(setting_info(SETTING_ACCUM)->choices[i], format_info(desc.accum)->name);
    }
    for (int i = 0; i < setting_choice_count(SETTING_DEPTH); i++) {
        setting_put(&desc, SETTING_DEPTH, i);
        ck_assert_str_eq(setting_info(SETTING_DEPTH)->choices[i], format_info(desc.depth)->name);
    }
    for (int i = 0; i < setting_choice_count(SETTING_GBUFFER); i++)
        ck_assert_str_eq(setting_info(SETTING_GBUFFER)->choices[i], gbuffer_name((GBufferFormat)i));
    for (int i = 0; i < setting_choice_count(SETTING_SIMD); i++)
        ck_assert_str_eq(setting_info(SETTING_SIMD)->choices[i], simd_name((SimdChoice)i));
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("setting");
    TCase *tcase = tcase_create("setting");
    tcase_add_test(tcase, test_choices);
    tcase_add_test(tcase, test_names);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
