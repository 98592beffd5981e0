/* number/lanes.h and lanes_pow.h, ref/pipeline/shade_body.h and resolve_body.h: every width has the
 * bits of the scalar definition, and leaving lights out changes none. Bits of a NaN do not count:
 * they are made canonical where stored. */
#include "testing.h"

#include "base/random.h"
#include "batch_table.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

enum {
    WIDEST = 16,
    CASES = 4000, /* batches of the widest */
    LIGHTS = 140,
    TABLES = 5 /* at most */
};

static const float hostile[] = {0.0f,     -0.0f, NAN,      INFINITY, -INFINITY, 0x1p-149f,
                                -1e-40f,  1e20f, -1e15f,   -1e-3f,   1.0f,      -1.0f,
                                FLT_MAX,  2.0f,  0x1p-60f, -FLT_MAX, FLT_MIN,   0x1.fffffep-1f,
                                1.00001f, 1e-10f};

/* The widths that this processor has, scalar first. */
static int tables(const BatchTable *out[TABLES])
{
    int count = 0;
    out[count++] = &batch_scalar;
#ifdef BATCH_VECTORS
    out[count++] = &batch_sse2;
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        out[count++] = &batch_avx2;
    if (__builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl") &&
        __builtin_cpu_supports("fma"))
        out[count++] = &batch_avx2_for_512;
    if (__builtin_cpu_supports("avx512f"))
        out[count++] = &batch_avx512;
#endif
    return count;
}

static float pick_hostile(Random *random)
{
    return hostile[random_bits(random) % (sizeof hostile / sizeof *hostile)];
}

static bool same(float a, float b)
{
    return (a != a && b != b) || testing_bits(a) == testing_bits(b);
}

/* ---- functions ---- */

/* Special values, then every stride-th float. */
static uint64_t fill(float x[WIDEST], uint64_t at, uint64_t stride)
{
    const uint64_t specials = sizeof hostile / sizeof *hostile;
    for (int i = 0; i < WIDEST; i++, at++)
        x[i] = at < specials ? hostile[at] : op_from_bits((uint32_t)((at - specials) * stride));
    return at;
}

static void check_functions(const BatchTable *table, bool fused, const float x[WIDEST])
{
    static const float powers[] = {0.45454547f, -1.5f, 0.0f, 3.0f};
    float y[WIDEST], got[3][WIDEST];
    for (int i = 0; i < WIDEST; i++)
        y[i] = powers[(op_bits(x[i]) >> 3) % 4];
    for (int i = 0; i < WIDEST; i += table->lanes) {
        table->exp2(fused, x + i, got[0] + i);
        table->log2(fused, x + i, got[1] + i);
        table->pow(fused, x + i, y + i, got[2] + i);
    }
    for (int i = 0; i < WIDEST; i++) {
        float expected[3] = {op_exp2(fused, x[i]), op_log2(fused, x[i]), op_pow(fused, x[i], y[i])};
        for (int k = 0; k < 3; k++)
            if (!same(got[k][i], expected[k]))
                ck_abort_msg("%d lanes, %s(%a), fused %d: got %a, expected %a", table->lanes,
                             (const char *[]){"exp2", "log2", "pow"}[k], (double)x[i], fused,
                             (double)got[k][i], (double)expected[k]);
    }
}

/* PEEL_TEST_STRIDE=1 takes every float: minutes. */
START_TEST(test_functions)
{
    const char *asked = getenv("PEEL_TEST_STRIDE");
    uint64_t stride = asked ? strtoull(asked, NULL, 10) : 4093;
    const BatchTable *table[TABLES];
    int count = tables(table);
    uint32_t saved = op_enter();
    for (uint64_t at = 0; at * stride <= UINT32_MAX;) {
        float x[WIDEST];
        at = fill(x, at, stride);
        for (int i = 0; i < count; i++) {
            check_functions(table[i], false, x);
            check_functions(table[i], true, x);
        }
    }
    op_leave(saved);
}
END_TEST

START_TEST(test_kept)
{
    static const int32_t in[WIDEST] = {
        1, -1, 0, INT32_MAX, INT32_MIN, INT32_MAX - 1, 7, INT32_MAX, 0x3f800000, INT32_MAX, 5};
    const BatchTable *table[TABLES];
    int count = tables(table);
    for (int k = 0; k < count; k++) {
        int32_t out[WIDEST];
        for (int i = 0; i < WIDEST; i += table[k]->lanes)
            table[k]->kept(in + i, 99, out + i);
        for (int i = 0; i < WIDEST; i++)
            ck_assert_int_eq(out[i], in[i] == INT32_MAX ? 99 : in[i]);
    }
}
END_TEST

/* Any bits, few exponents, so that roundings matter, and hostile. */
static float pick_factor(Random *random)
{
    uint64_t bits = random_bits(random);
    if (bits % 16 == 0)
        return pick_hostile(random);
    uint32_t word = (uint32_t)(bits >> 32);
    return op_from_bits(bits % 4 ? (word & 0x81ffffff) | 0x3e000000 : word);
}

START_TEST(test_fma)
{
    const BatchTable *table[TABLES];
    int count = tables(table);
    Random random = random_seed(8);
    uint32_t saved = op_enter();
    for (int number = 0; number < 50 * CASES; number++) {
        float x[3][WIDEST], got[WIDEST];
        for (int i = 0; i < 3 * WIDEST; i++)
            x[i % 3][i / 3] = pick_factor(&random);
        for (int i = 0; i < WIDEST && number % 2; i++) /* the sum cancels, or nearly */
            x[2][i] = op_neg(op_mul(x[0][i], x[1][i]));
        /* 1 + 2^-24 and a little: in double one step above a tie of floats, and rounded up. */
        x[0][number % WIDEST] = number % 2 ? -65281.0f : 65281.0f;
        x[1][number % WIDEST] = 257.0f * 0x1p-24f;
        x[2][number % WIDEST] = (number % 2 ? -1.0f : 1.0f) * (0x1p-52f - 0x1p-75f);
        for (int k = 0; k < count; k++)
            for (int i = 0; i < WIDEST; i++) {
                if (i % table[k]->lanes == 0)
                    table[k]->fma(x[0] + i, x[1] + i, x[2] + i, got + i);
                float expected = op_fma(x[0][i], x[1][i], x[2][i]);
                if (!same(got[i], expected))
                    ck_abort_msg("%d lanes, fma(%a, %a, %a): got %a, expected %a", table[k]->lanes,
                                 (double)x[0][i], (double)x[1][i], (double)x[2][i], (double)got[i],
                                 (double)expected);
            }
    }
    op_leave(saved);
}
END_TEST

/* ---- lighting ---- */

typedef struct Case {
    View view;
    ViewLight lights[LIGHTS];
    Texel texels[WIDEST];
    ShadeForm form;
} Case;

static void unit_vector(Random *random, float out[3])
{
    double length2 = 0, v[3];
    while (length2 < 0.01) {
        length2 = 0;
        for (int i = 0; i < 3; i++) {
            v[i] = random_range(random, -1, 1);
            length2 += v[i] * v[i];
        }
    }
    for (int i = 0; i < 3; i++)
        out[i] = (float)(v[i] / sqrt(length2));
}

/* Fragments near each other, of one surface or of any. */
static void make_texels(Random *random, Texel texels[WIDEST])
{
    float normal[3], center[3];
    bool flat = random_bits(random) % 4 > 0;
    unit_vector(random, normal);
    for (int i = 0; i < 3; i++)
        center[i] = (float)random_range(random, i == 2 ? -20 : -5, i == 2 ? -1 : 5);
    for (int lane = 0; lane < WIDEST; lane++) {
        Texel *texel = &texels[lane];
        *texel = (Texel){.normal = {normal[0], normal[1], normal[2]}};
        if (!flat)
            unit_vector(random, texel->normal);
        for (int i = 0; i < 4; i++) {
            texel->position[i] = i < 3 ? center[i] + (float)random_range(random, 0, 0.1) : 1.0f;
            texel->diffuse[i] = (float)random_unit(random);
            texel->material[i] = random_bits(random) % 4 ? (float)random_unit(random)
                                                         : (float)(random_bits(random) % 2);
        }
    }
}

/* Anywhere, or within a few roundings of the plane of the first fragment. */
static void make_light(Random *random, const Texel *texel, ViewLight *out)
{
    static const float falloffs[][3] = {{1, 0.14f, 0.07f}, {1, 0, 0}, {0, 0, 1e-4f},
                                        {1e-8f, 0, 0},     {0, 1, 0}, {0, 0, 3e38f}};
    bool bright = random_bits(random) % 16 == 0, grazing = random_bits(random) % 4 == 0;
    memcpy(out->attenuation, falloffs[random_bits(random) % 6], sizeof out->attenuation);
    out->inverse_range2 =
        random_bits(random) % 2 ? (float)exp2(random_range(random, -10, 2)) : 0.0f;
    float along[3], height = 0;
    for (int i = 0; i < 3; i++) {
        out->color[i] = bright ? 1e12f : (float)random_range(random, 0, 10);
        out->position[i] = (float)random_range(random, -10, 10);
        along[i] = out->position[i] - texel->position[i];
        height += along[i] * texel->normal[i];
    }
    height -= (float)random_range(random, -1e-6, 1e-6);
    for (int i = 0; i < 3 && grazing; i++)
        out->position[i] = texel->position[i] + (along[i] - height * texel->normal[i]);
}

/* What view_build makes of lights that scene_validate accepts. */
static void set_reach(Case *made)
{
    double reach = 0;
    for (size_t i = 0; i < made->view.light_count; i++) {
        const float *p = made->lights[i].position;
        reach = fmax(reach, sqrt((double)p[0] * p[0] + (double)p[1] * p[1] + (double)p[2] * p[2]));
    }
    made->view.light_reach = reach < 0x1p46 ? (float)(reach * 1.00001 + 1e-6) : 0.0f;
}

static void scale(Case *made, int exponent)
{
    for (int i = 0; i < 3; i++) {
        for (size_t k = 0; k < made->view.light_count; k++)
            made->lights[k].position[i] = ldexpf(made->lights[k].position[i], exponent);
        for (int lane = 0; lane < WIDEST; lane++)
            made->texels[lane].position[i] = ldexpf(made->texels[lane].position[i], exponent);
    }
}

/* Makes one of an object's floats hostile. */
static void spoil(Random *random, void *object, size_t bytes)
{
    float value = pick_hostile(random);
    memcpy((char *)object + random_bits(random) % (bytes / sizeof value) * sizeof value, &value,
           sizeof value);
}

static void make_case(Random *random, Case *out)
{
    *out = (Case){
        .view = {.light_count = random_bits(random) % (LIGHTS + 1), .ambient = {0.25f, 0, 1}}};
    out->view.lights = out->lights;
    out->view.ranged = random_bits(random) % 2;
    out->form = (ShadeForm){
        .model = random_bits(random) % 32 ? SHADING_GGX : SHADING_PHONG,
        .ggx = random_bits(random) % 2 ? GGX_STABLE : GGX_SOURCE,
        .back_light = random_bits(random) % 4 == 0,
    };
    make_texels(random, out->texels);
    for (size_t i = 0; i < out->view.light_count; i++) {
        make_light(random, &out->texels[0], &out->lights[i]);
        if (!out->view.ranged)
            out->lights[i].inverse_range2 = 0;
    }
    if (random_bits(random) % 4 == 0)
        scale(out, (int)(random_bits(random) % 120) - 70);
    set_reach(out);
    for (int i = 0; i < 4 && random_bits(random) % 4 == 0; i++)
        spoil(random, &out->texels[random_bits(random) % WIDEST], sizeof(Texel));
    if (random_bits(random) % 16 == 0 && out->view.light_count > 0) {
        spoil(random, &out->lights[random_bits(random) % out->view.light_count], sizeof(ViewLight));
        out->view.light_reach = 0;
    }
}

static void check_case(const BatchTable *table, const Case *made, bool skip, uint64_t number)
{
    float expected[WIDEST][4], got[WIDEST][4];
    for (int i = 0; i < WIDEST; i++)
        batch_scalar.shade(&made->view, &made->form, false, made->texels + i, expected + i);
    for (int i = 0; i < WIDEST; i += table->lanes)
        table->shade(&made->view, &made->form, skip, made->texels + i, got + i);
    for (int i = 0; i < WIDEST; i++)
        for (int k = 0; k < 4; k++)
            if (!same(got[i][k], expected[i][k]))
                ck_abort_msg("case %llu, %d lanes, skip %d, fragment %d, channel %d: got %a, "
                             "expected %a",
                             (unsigned long long)number, table->lanes, skip, i, k,
                             (double)got[i][k], (double)expected[i][k]);
}

START_TEST(test_shade)
{
    const BatchTable *table[TABLES];
    int count = tables(table);
    uint64_t lights = 0, lit = 0;
    uint32_t saved = op_enter();
    for (uint64_t number = 0; number < CASES; number++) {
        Random random = random_seed(number);
        Case made;
        make_case(&random, &made);
        for (int i = 0; i < count; i++) {
            check_case(table[i], &made, true, number);
            check_case(table[i], &made, false, number);
        }
        lights += made.view.light_count;
        lit += (uint64_t)table[count - 1]->select(&made.view, &made.form, made.texels);
    }
    op_leave(saved);
    printf("%d lanes at once: %llu of %llu lights not skipped\n", table[count - 1]->lanes,
           (unsigned long long)lit, (unsigned long long)lights);
}
END_TEST

/* Eight lights behind a plane, eight before it, 1 to 8 away: the first are skipped, unless
 * something speaks against it, and those too far. */
START_TEST(test_select)
{
    const BatchTable *table[TABLES];
    int count = tables(table);
    static const struct {
        const char *name;
        float normal_z, position_x, diffuse, metallic, reach, range;
        bool back_light;
        int lights;
    } rows[] = {
        {"plane", 1, 0, 1, 0, 20, 0, false, 8},
        {"range", 1, 0, 1, 0, 20, 3.5f, false, 3},
        {"range, back light", 1, 0, 1, 0, 20, 3.5f, true, 16},
        {"back light", 1, 0, 1, 0, 20, 0, true, 16},
        {"reach not known", 1, 0, 1, 0, 0, 0, false, 16},
        {"long normal", 1.000001f, 0, 1, 0, 20, 0, false, 16},
        {"no normal", NAN, 0, 1, 0, 20, 0, false, 16},
        {"far away", 1, 0x1p48f, 1, 0, 20, 0, false, 16},
        {"colour above 1", 1, 0, 1.0000002f, 0, 20, 0, false, 16},
        {"colour below 0", 1, 0, -0.1f, 0, 20, 0, false, 16},
        {"metallic above 1", 1, 0, 1, 1.5f, 20, 0, false, 16},
        {"no metallic", 1, 0, 1, NAN, 20, 0, false, 16},
    };
    for (size_t row = 0; row < sizeof rows / sizeof *rows; row++)
        for (int i = 0; i < count; i++) {
            ViewLight lights[16] = {{.position = {0}}};
            for (int k = 0; k < 16; k++) {
                lights[k].position[2] = k < 8 ? -6.0f - (float)k : -12.0f + (float)k;
                if (rows[row].range > 0)
                    lights[k].inverse_range2 = 1 / (rows[row].range * rows[row].range);
            }
            View view = {.light_count = 16,
                         .lights = lights,
                         .light_reach = rows[row].reach,
                         .ranged = rows[row].range > 0};
            ShadeForm form = {.back_light = rows[row].back_light};
            Texel texels[WIDEST];
            for (int lane = 0; lane < WIDEST; lane++)
                texels[lane] = (Texel){.normal = {0, 0, 1}, .position = {0, 0, -5}};
            Texel *texel = &texels[table[i]->lanes - 1];
            texel->normal[2] = rows[row].normal_z;
            texel->position[0] = rows[row].position_x;
            texel->diffuse[1] = rows[row].diffuse;
            texel->material[1] = rows[row].metallic;
            int got = table[i]->select(&view, &form, texels);
            ck_assert_msg(got == rows[row].lights, "%s, %d lanes: %d lights, expected %d",
                          rows[row].name, table[i]->lanes, got, rows[row].lights);
        }
}
END_TEST

/* ---- resolve ---- */

static void check_resolve(const BatchTable *table, const View *view, bool fused,
                          const float accum[WIDEST][4], const float weight[WIDEST])
{
    float got[WIDEST][4], expected[4];
    uint8_t display[WIDEST][4], display_expected[4];
    for (int i = 0; i < WIDEST; i += table->lanes)
        table->resolve(view, fused, accum + i, weight + i, got + i, display + i);
    for (int i = 0; i < WIDEST; i++) {
        shade_final(view, accum[i], weight[i], expected);
        shade_display(fused, expected, display_expected);
        for (int k = 0; k < 4; k++)
            if (testing_bits(got[i][k]) != testing_bits(expected[k]) ||
                display[i][k] != display_expected[k])
                ck_abort_msg("%d lanes, channel %d, fused %d: got %a and %d, expected %a and %d",
                             table->lanes, k, fused, (double)got[i][k], display[i][k],
                             (double)expected[k], display_expected[k]);
    }
}

START_TEST(test_resolve)
{
    const BatchTable *table[TABLES];
    int count = tables(table);
    Random random = random_seed(7);
    uint32_t saved = op_enter();
    for (int number = 0; number < 20 * CASES; number++) {
        View view = {0};
        float accum[WIDEST][4], weight[WIDEST];
        for (int i = 0; i < 3; i++)
            view.background[i] = random_bits(&random) % 2 ? (float)random_unit(&random) : 0.0f;
        for (int i = 0; i < WIDEST; i++) {
            for (int k = 0; k < 4; k++)
                accum[i][k] = random_bits(&random) % 16
                                  ? (float)exp2(random_range(&random, -20, 10))
                                  : pick_hostile(&random);
            weight[i] =
                random_bits(&random) % 16 ? (float)random_unit(&random) : pick_hostile(&random);
        }
        for (int i = 0; i < count; i++)
            check_resolve(table[i], &view, number % 2, (const float(*)[4])accum, weight);
    }
    op_leave(saved);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("batch");
    TCase *tests = tcase_create("batch");
    tcase_set_timeout(tests, 1800);
    tcase_add_test(tests, test_kept);
    tcase_add_test(tests, test_fma);
    tcase_add_test(tests, test_functions);
    tcase_add_test(tests, test_shade);
    tcase_add_test(tests, test_select);
    tcase_add_test(tests, test_resolve);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}
