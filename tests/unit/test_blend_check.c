/* peel blend check without files or a driver: every named arithmetic is recognised, wrong ones are
 * told from all right ones, rules count what is outside them. */
#include "testing.h"

#include "blend/vectors.h"
#include "report/blend_check.h"
#include "study/blend_check.h"
#include "study/blend_sequences.h"
#include "study/blend_wrong.h"

#include <math.h>
#include <stdio.h>

enum {
    VECTORS = 900
};

static float source[VECTORS][4];
static unsigned char destination[VECTORS * 16], results[VECTORS * 16];
static BlendReport report;

/* Directed vectors and random ones, taking turns. */
static void make_vectors(PixelFormat format)
{
    size_t bytes = format_pixel_bytes(format);
    VectorSpec directed = {.set = VECTORS_DIRECTED, .format = format};
    VectorSpec random = {.set = VECTORS_RANDOM, .format = format, .seed = 7, .count = VECTORS};
    uint64_t stride = vectors_count(&directed) / VECTORS;
    for (size_t i = 0; i < VECTORS; i++)
        vectors_make(i & 1 ? &random : &directed, i & 1 ? i : i * stride, 1, &source[i],
                     destination + i * bytes);
}

static void blend(const char *name, EquationId equation, PixelFormat format)
{
    Arithmetic arithmetic;
    ck_assert_msg(arithmetic_parse(name, &arithmetic) == RESULT_OK, "%s", result_message());
    memcpy(results, destination, VECTORS * format_pixel_bytes(format));
    arithmetic_blend(&arithmetic, &equation_info(equation)->equation, format, VECTORS,
                     (const float(*)[4])source, results);
}

static void check(EquationId equation, PixelFormat format, int threads, size_t count)
{
    BlendCheck *study;
    BlendCheckDesc desc = {.format = format,
                           .equation = equation_info(equation)->equation,
                           .worst = 4,
                           .threads = threads};
    ck_assert(blend_check_open(&desc, &study) == RESULT_OK);
    size_t half = count / 2, bytes = format_pixel_bytes(format);
    ck_assert(blend_check_add(study, VECTORS_RANDOM, 100, half, (const float(*)[4])source,
                              destination, results) == RESULT_OK);
    ck_assert(blend_check_add(study, VECTORS_RANDOM, 100 + half, count - half,
                              (const float(*)[4])source + half, destination + half * bytes,
                              results + half * bytes) == RESULT_OK);
    blend_check_finish(study, &report);
    blend_check_close(study);
}

static size_t find(const char *name)
{
    for (size_t i = 0; i < report.count; i++)
        if (strcmp(report.candidates[i].name, name) == 0)
            return i;
    return SIZE_MAX;
}

static bool gives_all(size_t i)
{
    const BlendTally *groups = report.candidates[i].groups;
    return groups[GROUP_COLOR].differing + groups[GROUP_ALPHA].differing == 0;
}

/* ---- names ----------------------------------------------------------------------------------- */

/* Format _i: all named arithmetics under two equations; where the build is slow each in one format. */
START_TEST(test_every_name)
{
    static const EquationId equations[] = {EQUATION_UNDER, EQUATION_OVER};
    PixelFormat format = arithmetic_formats[_i];
    make_vectors(format);
    for (size_t e = 0; e < 2; e++)
        for (size_t i = (size_t)_i % TESTING_SHARE; i < arithmetic_count(); i += TESTING_SHARE) {
            const ArithmeticInfo *info = arithmetic_info(i);
            const BlendEquation *equation = &equation_info(equations[e])->equation;
            if (arithmetic_refuses(&info->arithmetic, equation, format))
                continue;
            blend(info->name, equations[e], format);
            check(equations[e], format, 2, VECTORS);
            size_t at = find(info->name);
            ck_assert_msg(at < report.count && gives_all(at), "%s, %s", info->name,
                          format_info(format)->name);
            ck_assert_msg(report.candidates[at].vectors == VECTORS, "%s", info->name);
            BlendVerdict verdict = blend_verdict(&report, API_COUNT);
            ck_assert_uint_eq(blend_unexplained(&report), 0);
            bool wrong = arithmetic_is_wrong(info, format);
            ck_assert_msg(
                wrong ? verdict == BLEND_WRONG || verdict == BLEND_NAMED : verdict == BLEND_NAMED,
                "%s, %s: %s", info->name, format_info(format)->name, blend_verdict_name(verdict));
            blend_report_free(&report);
        }
}
END_TEST

/* Each wrong one is called wrong, by its name, for some format and equation. */
START_TEST(test_wrong_is_caught)
{
    for (size_t i = 0; i < arithmetic_count(); i++) {
        const ArithmeticInfo *info = arithmetic_info(i);
        bool caught = !info->wrong;
        for (int f = 0; f < ARITHMETIC_FORMATS && !caught; f++)
            for (int e = 0; e < EQUATION_COUNT && !caught; e++) {
                PixelFormat format = arithmetic_formats[f];
                const BlendEquation *equation = &equation_info((EquationId)e)->equation;
                if (arithmetic_refuses(&info->arithmetic, equation, format))
                    continue;
                make_vectors(format);
                blend(info->name, (EquationId)e, format);
                check((EquationId)e, format, 2, VECTORS);
                caught = blend_verdict(&report, API_COUNT) == BLEND_WRONG &&
                         report.candidates[blend_best_whole(&report)].info == info;
                blend_report_free(&report);
            }
        ck_assert_msg(caught, "%s is nowhere told from the others", info->name);
    }
}
END_TEST

/* With fewer digits than the format's numbers have: wrong there, and right elsewhere. */
START_TEST(test_wrong_in_longer_formats)
{
    static const char *const names[] = {"half", "half-fused", "half-truncated"};
    PixelFormat format = arithmetic_formats[_i];
    bool longer = format != FORMAT_RGBA8 && format != FORMAT_RGBA16F;
    make_vectors(format);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        blend(names[i], EQUATION_OVER, format);
        check(EQUATION_OVER, format, 2, VECTORS);
        ck_assert_msg(blend_verdict(&report, API_COUNT) == (longer ? BLEND_WRONG : BLEND_NAMED),
                      "%s, %s", names[i], format_info(format)->name);
        blend_report_free(&report);
    }
}
END_TEST

/* What --list says: the vector of each row is one that no right arithmetic gives. */
START_TEST(test_list)
{
    BlendWrongList list;
    size_t alone = 0;
    ck_assert(blend_wrong_list(1u << 0 | 1u << 2, EQUATION_UNDER, 3000, &list) == RESULT_OK);
    ck_assert_uint_gt(list.count, 10);
    for (size_t r = 0; r < list.count; r++) {
        const BlendWrong *row = &list.rows[r];
        const BlendEquation *equation = &equation_info(row->equation)->equation;
        const BlendExample *example = &row->example;
        ck_assert(arithmetic_is_wrong(row->info, row->format) && row->equation == EQUATION_UNDER);
        for (size_t i = 0; i < arithmetic_count() && row->alone; i++) {
            const ArithmeticInfo *info = arithmetic_info(i);
            if (arithmetic_refuses(&info->arithmetic, equation, row->format) ||
                (arithmetic_is_wrong(info, row->format) && info != row->info))
                continue;
            BlendSteps steps[4];
            arithmetic_steps(&info->arithmetic, equation, row->format, example->source,
                             example->pixel, steps);
            uint32_t apart = format_ulp(format_info(row->format)->kind,
                                        steps[example->channel].stored, example->got);
            ck_assert_msg((apart == 0) == (info == row->info), "%s by %s", row->info->name,
                          info->name);
        }
        alone += row->alone;
    }
    ck_assert_uint_gt(alone, list.count / 2);
    blend_wrong_free(&list);
}
END_TEST

START_TEST(test_without_a_name)
{
    char name[REPORT_BLEND_NAME];
    make_vectors(FORMAT_RGBA16F);
    blend("precision=float,store=up", EQUATION_UNDER, FORMAT_RGBA16F);
    check(EQUATION_UNDER, FORMAT_RGBA16F, 2, VECTORS);
    report_blend_name(&report, name);
    ck_assert_str_eq(name, "store=up");
    ck_assert_uint_eq(blend_unexplained(&report), 0);
    ck_assert_int_eq(blend_verdict(&report, API_GL), BLEND_UNNAMED);
    blend_report_free(&report);
}
END_TEST

START_TEST(test_color_and_alpha)
{
    char name[REPORT_BLEND_NAME];
    make_vectors(FORMAT_RGBA16F);
    blend("separate", EQUATION_OVER, FORMAT_RGBA16F);
    static uint16_t colors[VECTORS][4];
    memcpy(colors, results, sizeof colors);
    blend("half", EQUATION_OVER, FORMAT_RGBA16F);
    for (size_t i = 0; i < VECTORS; i++)
        memcpy(results + 8 * i, colors[i], 6);
    check(EQUATION_OVER, FORMAT_RGBA16F, 2, VECTORS);
    report_blend_name(&report, name);
    ck_assert_str_eq(name, "colour separate, alpha half");
    ck_assert_int_eq(blend_verdict(&report, API_COUNT), BLEND_NAMED);
    ck_assert_uint_eq(blend_unexplained(&report), 0);
    blend_report_free(&report);
}
END_TEST

/* One value of all is moved: it is found, with what it should have been. */
START_TEST(test_one_value)
{
    make_vectors(FORMAT_RGBA8);
    blend("codes-driver", EQUATION_UNDER, FORMAT_RGBA8);
    unsigned char right = results[4 * 777 + 1];
    results[4 * 777 + 1] = (unsigned char)(right < 128 ? right + 3 : right - 3);
    check(EQUATION_UNDER, FORMAT_RGBA8, 2, VECTORS);
    size_t at = find("codes-driver");
    const BlendCandidate *one = &report.candidates[at];
    ck_assert_uint_eq(blend_unexplained(&report), 1);
    ck_assert_uint_eq(one->groups[GROUP_COLOR].differing, 1);
    ck_assert_uint_eq(one->groups[GROUP_COLOR].max_ulp, 3);
    ck_assert_uint_eq(one->groups[GROUP_ALPHA].differing, 0);
    ck_assert_uint_eq(one->simplest.index, 877);
    ck_assert_int_eq(one->simplest.channel, 1);
    ck_assert_uint_eq(one->simplest.expected, right);
    ck_assert_uint_eq(one->simplest.got, results[4 * 777 + 1]);
    ck_assert_int_eq(one->worst_count, 1);
    ck_assert_int_eq(blend_verdict(&report, API_COUNT), BLEND_OUTSIDE);
    blend_report_free(&report);
}
END_TEST

START_TEST(test_worst_in_order)
{
    make_vectors(FORMAT_RGBA8);
    blend("factors-swapped", EQUATION_UNDER, FORMAT_RGBA8);
    check(EQUATION_UNDER, FORMAT_RGBA8, 1, VECTORS);
    const BlendCandidate one = report.candidates[find("exact")];
    ck_assert_int_eq(one.worst_count, 4);
    for (int i = 1; i < 4; i++)
        ck_assert(one.worst[i].ulp < one.worst[i - 1].ulp ||
                  (one.worst[i].ulp == one.worst[i - 1].ulp &&
                   one.worst[i].complexity >= one.worst[i - 1].complexity));
    uint32_t color = one.groups[GROUP_COLOR].max_ulp, alpha = one.groups[GROUP_ALPHA].max_ulp;
    ck_assert_uint_eq(one.worst[0].ulp, color > alpha ? color : alpha);
    BlendExample simplest = one.simplest;
    uint64_t differing = one.groups[GROUP_COLOR].differing;
    blend_report_free(&report);
    check(EQUATION_UNDER, FORMAT_RGBA8, 3, VECTORS); /* threads change nothing */
    ck_assert_uint_eq(report.candidates[find("exact")].groups[GROUP_COLOR].differing, differing);
    ck_assert_uint_eq(report.candidates[find("exact")].simplest.index, simplest.index);
    ck_assert_int_eq(report.candidates[find("exact")].simplest.channel, simplest.channel);
    blend_report_free(&report);
}
END_TEST

/* ---- rules ----------------------------------------------------------------------------------- */

/* The tallies after one value. */
static void judge(EquationId equation, PixelFormat format, const float value[4], const void *pixel,
                  uint32_t got, BlendRuleTally tallies[BLEND_RULES])
{
    BlendCase one = {&equation_info(equation)->equation, format, 0, value, pixel, false};
    blend_rules_start(format, tallies);
    blend_rules_add(&one, (BlendPlace){VECTORS_RANDOM, 0}, got, tallies);
}

static const BlendRuleTally *rule(const BlendRuleTally *tallies, const char *name,
                                  const char *source_part)
{
    for (int i = 0; i < BLEND_RULES; i++)
        if (strcmp(tallies[i].info->name, name) == 0 &&
            strstr(tallies[i].info->source, source_part))
            return &tallies[i];
    ck_abort_msg("no rule %s, %s", name, source_part);
}

/* By hand: 10 + 20 codes. OpenGL and Vulkan have either neighbour of a sum that was rounded to
 * float, Direct3D 0.6 codes, dEQP 4, piglit 3/256. */
START_TEST(test_rules_codes)
{
    static const struct {
        uint32_t got;
        unsigned gl, d3d11, deqp, piglit;
    } cases[] = {{30, 0, 0, 0, 0}, {31, 0, 1, 0, 0}, {32, 1, 1, 0, 0}, {33, 1, 1, 0, 1},
                 {34, 1, 1, 0, 1}, {35, 1, 1, 1, 1}, {26, 1, 1, 0, 1}, {25, 1, 1, 1, 1}};
    BlendRuleTally tallies[BLEND_RULES];
    const float value[4] = {(float)(10 / 255.0)};
    const unsigned char pixel[4] = {20};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        judge(EQUATION_ADD, FORMAT_RGBA8, value, pixel, cases[i].got, tallies);
        ck_assert_uint_eq(rule(tallies, "OpenGL", "17.3.6")->outside, cases[i].gl);
        ck_assert_uint_eq(rule(tallies, "Vulkan", "")->outside, cases[i].gl);
        ck_assert_uint_eq(rule(tallies, "Direct3D", "17.5, 3.1")->outside, cases[i].d3d11);
        ck_assert_uint_eq(rule(tallies, "dEQP, GLES 3", "")->outside, cases[i].deqp);
        ck_assert_uint_eq(rule(tallies, "dEQP, Vulkan", "")->outside, cases[i].deqp);
        ck_assert_uint_eq(rule(tallies, "piglit", "")->outside, cases[i].piglit);
        ck_assert_uint_eq(rule(tallies, "OpenGL", "17.3.6")->judged, 1);
        ck_assert(!rule(tallies, "WebGPU tests", "")->applies);
        ck_assert_double_eq_tol(rule(tallies, "OpenGL", "17.3.6")->largest,
                                fabs(30.0 - cases[i].got), 1e-9);
    }
}
END_TEST

static uint32_t bits(float x)
{
    return testing_bits(x);
}

/* 1/2 + 1/4 in floats: half a unit for Direct3D, one for OpenGL's 17.3.6, 1e-5 for its 2.3.4. */
START_TEST(test_rules_floats)
{
    BlendRuleTally tallies[BLEND_RULES];
    const float value[4] = {0.5f}, pixel[4] = {0.25f};
    uint32_t sum = bits(value[0] + pixel[0]);
    for (uint32_t off = 0; off < 3; off++) {
        judge(EQUATION_ADD, FORMAT_RGBA32F, value, pixel, sum + off, tallies);
        ck_assert_uint_eq(rule(tallies, "Direct3D", "17.5, 3.1")->outside, off > 0);
        ck_assert_uint_eq(rule(tallies, "OpenGL", "17.3.6")->outside, off > 1);
        ck_assert_uint_eq(rule(tallies, "OpenGL", "2.3.4")->outside, 0);
    }
    judge(EQUATION_ADD, FORMAT_RGBA32F, value, pixel, bits(0.750009f), tallies);
    ck_assert_uint_eq(rule(tallies, "OpenGL", "2.3.4")->outside, 1);
    ck_assert_uint_eq(rule(tallies, "dEQP, Vulkan", "")->outside, 0);
    judge(EQUATION_ADD, FORMAT_RGBA32F, value, pixel, bits(0.750011f), tallies);
    ck_assert_uint_eq(rule(tallies, "dEQP, Vulkan", "")->outside, 1);
    judge(EQUATION_ADD, FORMAT_RGBA32F, value, pixel, bits(NAN), tallies);
    ck_assert_uint_eq(rule(tallies, "OpenGL", "2.3.4")->outside, 1);
}
END_TEST

/* Keep in r32f: the alpha that is not there is 1, so s·(1 − 1) + d is d, and nothing is rounded.
 * The driver computes s + 1·(d − s), which loses a d far below s. */
START_TEST(test_rules_keep_one_channel)
{
    BlendRuleTally tallies[BLEND_RULES];
    const float value[4] = {2.0f}, pixel[4] = {0x1p-25f};
    const Arithmetic driver = {.kind = ARITHMETIC_DRIVER, .fused = true};
    const BlendEquation *keep = &equation_info(EQUATION_KEEP)->equation;
    BlendSteps steps[4];
    arithmetic_steps(&driver, keep, FORMAT_R32F, value, pixel, steps);
    ck_assert_uint_eq(steps[0].stored, bits(0.0f));
    for (int i = 0; i < 2; i++) {
        judge(EQUATION_KEEP, FORMAT_R32F, value, pixel, i ? steps[0].stored : bits(pixel[0]),
              tallies);
        ck_assert_uint_eq(rule(tallies, "OpenGL", "2.3.4")->outside, i);
        ck_assert_uint_eq(rule(tallies, "OpenGL", "17.3.6")->outside, i);
        ck_assert_uint_eq(rule(tallies, "Vulkan", "")->outside, i);
        ck_assert_uint_eq(rule(tallies, "Direct3D", "17.5, 3.1")->outside, i);
    }
}
END_TEST

/* What rules say nothing of is not counted; a NaN that Direct3D wants back is. */
START_TEST(test_rules_unstated)
{
    static const float values[][4] = {{INFINITY}, {0x1p-130f}, {3e38f}};
    BlendRuleTally tallies[BLEND_RULES];
    const float pixel[4] = {3e38f}, zero[4] = {0.0f}, nan[4] = {NAN};
    for (size_t i = 0; i < 3; i++) {
        judge(EQUATION_ADD, FORMAT_RGBA32F, values[i], i == 2 ? pixel : zero, 0, tallies);
        for (int r = 0; r < BLEND_RULES; r++)
            ck_assert_uint_eq(tallies[r].outside, 0);
        ck_assert_uint_eq(rule(tallies, "OpenGL", "17.3.6")->unstated, 1);
    }
    judge(EQUATION_ADD, FORMAT_RGBA32F, nan, zero, bits(NAN), tallies);
    ck_assert_uint_eq(rule(tallies, "Direct3D", "NaN")->outside, 0);
    judge(EQUATION_ADD, FORMAT_RGBA32F, nan, zero, 0, tallies);
    ck_assert_uint_eq(rule(tallies, "Direct3D", "NaN")->outside, 1);
    ck_assert(blend_rules_broken(tallies, API_D3D11));
    ck_assert(!blend_rules_broken(tallies, API_GL));
    ck_assert(!blend_rules_broken(tallies, API_COUNT)); /* OpenGL is kept */
}
END_TEST

/* Right arithmetics that claim an API's precision keep its rules on every vector. So does the
 * driver's where there is alpha; elsewhere it leaves out products with 1 - 1, whose NaN Direct3D
 * wants, and its r32f lerp d + a*(s - d) loses an s that is far below d. */
START_TEST(test_rules_keep)
{
    static const char *const names[] = {"driver", "exact", "fused", "separate"};
    PixelFormat format = arithmetic_formats[_i];
    make_vectors(format);
    for (int e = 0; e < EQUATION_COUNT; e++)
        for (size_t i = format_info(format)->channels < 4; i < 4; i++) {
            blend(names[i], (EquationId)e, format);
            check((EquationId)e, format, 2, VECTORS);
            for (int api = 0; api < API_SUITE; api++)
                ck_assert_msg(!blend_rules_broken(report.rules, (BlendApi)api), "%s, %s, %s: %s",
                              names[i], equation_info((EquationId)e)->name,
                              format_info(format)->name, blend_api_name((BlendApi)api));
            blend_report_free(&report);
        }
}
END_TEST

/* ---- sequences ------------------------------------------------------------------------------- */

START_TEST(test_sequences)
{
    static float layers[SEQUENCE_LAYERS_MAX][4];
    static unsigned char pixels[SEQUENCE_LAYERS_MAX * 16];
    bool given[SEQUENCE_LAYERS_MAX] = {false};
    VectorSpec spec = {.set = VECTORS_SEQUENCES, .format = FORMAT_RGBA8, .seed = 1, .count = 60};
    Arithmetic arithmetic;
    SequenceReport right, wrong;
    ck_assert(arithmetic_parse("codes-floor", &arithmetic) == RESULT_OK);
    ck_assert(sequence_report_start(FORMAT_RGBA8, &right) == RESULT_OK);
    ck_assert(sequence_report_start(FORMAT_RGBA8, &wrong) == RESULT_OK);
    for (uint64_t i = 0; i < spec.count; i++) {
        int count = sequence_make(&spec, i, layers);
        sequence_blend(&arithmetic, FORMAT_RGBA8, count, (const float(*)[4])layers, pixels);
        memset(given, 0, sizeof given);
        given[count - 1] = true;
        ck_assert(sequence_report_add(&right, i, count, (const float(*)[4])layers, pixels, given) ==
                  RESULT_OK);
        if (i == 33)
            pixels[4 * (count - 1) + 3] ^= 0x80; /* transmittance */
        ck_assert(sequence_report_add(&wrong, i, count, (const float(*)[4])layers, pixels, given) ==
                  RESULT_OK);
    }
    ck_assert_uint_eq(right.values, 240);
    ck_assert_uint_eq(right.outside, 0);
    ck_assert_str_eq(right.candidates[sequence_report_best(&right)].info->name, "codes-floor");
    ck_assert_uint_eq(wrong.outside, 1);
    ck_assert_uint_eq(wrong.worst.index, 33);
    ck_assert_int_eq(wrong.worst.channel, 3);
    ck_assert_uint_eq(sequence_report_best(&wrong), SIZE_MAX);
    sequence_report_free(&right);
    sequence_report_free(&wrong);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("blend_check");
    TCase *tcase = tcase_create("check");
    tcase_set_timeout(tcase, 240);
    tcase_add_loop_test(tcase, test_every_name, 0, ARITHMETIC_FORMATS);
    tcase_add_test(tcase, test_wrong_is_caught);
    tcase_add_loop_test(tcase, test_wrong_in_longer_formats, 0, ARITHMETIC_FORMATS);
    tcase_add_test(tcase, test_list);
    tcase_add_test(tcase, test_without_a_name);
    tcase_add_test(tcase, test_color_and_alpha);
    tcase_add_test(tcase, test_one_value);
    tcase_add_test(tcase, test_worst_in_order);
    tcase_add_test(tcase, test_rules_codes);
    tcase_add_test(tcase, test_rules_floats);
    tcase_add_test(tcase, test_rules_keep_one_channel);
    tcase_add_test(tcase, test_rules_unstated);
    tcase_add_loop_test(tcase, test_rules_keep, 0, ARITHMETIC_FORMATS);
    tcase_add_test(tcase, test_sequences);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
