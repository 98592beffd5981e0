/* Stored formats and blending of number/ against the driver. */
#include "labs.h"

#include "blend/equation.h"

static const PixelFormat colors[] = {FORMAT_RGBA32F, FORMAT_RGBA16F, FORMAT_RGBA16, FORMAT_RGBA8,
                                     FORMAT_RG16};
static const PixelFormat depths[] = {FORMAT_D32F, FORMAT_D24, FORMAT_D16};

enum {
    COLORS = sizeof colors / sizeof *colors,
    ACCUMULATIONS = 4, /* the first of them */
    DEPTHS = sizeof depths / sizeof *depths
};

static LabsDistance distance_of(PixelFormat format)
{
    FormatKind kind = format_info(format)->kind;
    return kind == KIND_FLOAT ? labs_float : kind == KIND_HALF ? labs_half : labs_code;
}

/* Inputs around every code of the format and around the boundaries between codes, or any. */
static void fill(PixelFormat format, int set)
{
    uint32_t most = format_info(format)->unorm_max;
    labs_fill((InputSet)(1 << set), most ? most : 2048.0);
}

/* Without AVX, infinities and more do not fit the driver's conversion to 8 bits. */
static bool fits(PixelFormat format, int set)
{
    return format != FORMAT_RGBA8 || model.fused || 1 << set < INPUT_WIDE ||
           1 << set == INPUT_CODES;
}

static void check_colors(Experiment experiment, int count)
{
    for (int i = 0; i < count; i++)
        for (int set = 0; set < INPUT_SETS; set++) {
            experiment.format = colors[i];
            if (!fits(colors[i], set))
                continue;
            fill(colors[i], set);
            labs_assert_equal(&experiment, distance_of(colors[i]), format_info(colors[i])->name,
                              set);
        }
}

START_TEST(test_store)
{
    check_colors((Experiment){.kind = EXPERIMENT_STORE}, COLORS);
}
END_TEST

START_TEST(test_clear)
{
    check_colors((Experiment){.kind = EXPERIMENT_CLEAR, .count = 4096}, COLORS);
}
END_TEST

/* Every code of a 16-bit format; for an 8-bit one the low bytes of those. */
START_TEST(test_fetch)
{
    for (int i = 1; i < COLORS; i++) {
        Experiment experiment = {.kind = EXPERIMENT_FETCH, .format = colors[i]};
        labs_assert_equal(&experiment, labs_float, format_info(colors[i])->name, 0);
    }
}
END_TEST

START_TEST(test_depth)
{
    for (int i = 0; i < DEPTHS; i++)
        for (int set = 0; set < INPUT_SETS; set++) {
            Experiment experiment = {.kind = EXPERIMENT_DEPTH_STORE, .format = depths[i]};
            fill(depths[i], set);
            labs_assert_equal(&experiment, distance_of(depths[i]), format_info(depths[i])->name,
                              set);
        }
}
END_TEST

/* What the peel tests of 24-bit depths rely on (gl/shaders/geometry.frag.glsl): fetched values are
 * in the order of the integers, all distinct but the last two. */
START_TEST(test_depth24_order)
{
    uint32_t mode = op_enter();
    for (uint32_t code = 0; code < 0xfffffe; code++)
        if (!(depth24_to_float(code) < depth24_to_float(code + 1)))
            ck_abort_msg("depths %u and %u are fetched out of order", code, code + 1);
    bool equal = depth24_to_float(0xfffffe) == depth24_to_float(0xffffff);
    op_leave(mode);
    ck_assert(equal);
}
END_TEST

START_TEST(test_blend)
{
    check_colors(
        (Experiment){.kind = EXPERIMENT_BLEND, .equation = equation_info((EquationId)_i)->equation},
        ACCUMULATIONS);
}
END_TEST

/* Targets of one and two channels. */
START_TEST(test_blend_narrow)
{
    static const PixelFormat narrow[] = {FORMAT_R32F, FORMAT_RG32F};
    static const EquationId ids[] = {EQUATION_ADD, EQUATION_PRODUCT, EQUATION_MAX};
    for (int i = 0; i < 2; i++)
        for (int set = 0; set < INPUT_SETS; set++) {
            Experiment experiment = {.kind = EXPERIMENT_BLEND,
                                     .equation = equation_info(ids[_i])->equation,
                                     .format = narrow[i]};
            fill(narrow[i], set);
            labs_assert_equal(&experiment, labs_float, format_info(narrow[i])->name, set);
        }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("formats");
    TCase *tcase = tcase_create("driver");
    tcase_set_timeout(tcase, 120);
    tcase_add_checked_fixture(tcase, labs_open, labs_close);
    tcase_add_test(tcase, test_store);
    tcase_add_test(tcase, test_clear);
    tcase_add_test(tcase, test_fetch);
    tcase_add_test(tcase, test_depth);
    tcase_add_test(tcase, test_depth24_order);
    tcase_add_loop_test(tcase, test_blend, 0, EQUATION_COUNT);
    tcase_add_loop_test(tcase, test_blend_narrow, 0, 3);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
