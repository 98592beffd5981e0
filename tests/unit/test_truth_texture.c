/* ref/truth/texture.c against values by hand and a sum over the endless lattice of texels; masks
 * and textured surfaces in whole pictures. */
#include "base/random.h"
#include "ref/truth/radiance.h"
#include "truth_stage.h"

#include <math.h>

/* ---- sampling ------------------------------------------------------------------------------- */

typedef struct Sample {
    double u, expected;
} Sample;

/* Red at u of a row of four texels 0, 1/4, 1/2, 1; the same down a column. */
static void check_row(TextureWrap wrap, bool nearest, const Sample *samples, size_t count)
{
    float texels[16] = {0};
    const float red_of[4] = {0, 0.25f, 0.5f, 1};
    for (int i = 0; i < 4; i++)
        texels[4 * i] = red_of[i];
    const Texture row = {4, 1, texels, wrap, WRAP_MIRROR, nearest},
                  column = {1, 4, texels, WRAP_MIRROR, wrap, nearest};
    for (size_t i = 0; i < count; i++) {
        double across[4], down[4], u = samples[i].u, expected = samples[i].expected;
        texture_lookup(&row, (const double[]){u, 0.3}, across);
        texture_lookup(&column, (const double[]){0.3, u}, down);
        EXPECT(across[0] == expected && down[0] == expected,
               "wrap %d, nearest %d, u %.17g: got %.17g and %.17g, expected %.17g", wrap, nearest,
               u, across[0], down[0], expected);
    }
}

START_TEST(test_nearest_row)
{
    /* A border between texels belongs to the one after it. */
    const Sample repeat[] = {{0, 0},      {0.25, 0.25},  {0x1.fffffffffffffp-3, 0},
                             {0.5, 0.5},  {0.75, 1},     {1, 0},
                             {2.625, .5}, {-0.25, 1},    {-0.375, 0.5},
                             {-7, 0},     {-0x1p-60, 0}, {1e15, 0},
                             {NAN, 0},    {INFINITY, 0}};
    const Sample clamp[] = {{0, 0},  {0.25, 0.25},  {0.75, 1},      {1, 1},  {9, 1},
                            {-9, 0}, {INFINITY, 1}, {-INFINITY, 0}, {NAN, 0}};
    /* Backwards it belongs to the one before: the border is where the mirrored coordinate says. */
    const Sample mirror[] = {{0, 0},        {0.25, 0.25},  {1, 1},      {1.25, 1}, {1.5, .5},
                             {2, 0},        {-0.25, 0.25}, {-0.125, 0}, {-1, 1},   {3.125, 1},
                             {-1.75, 0.25}, {-1e15, 0},    {NAN, 0}};
    check_row(WRAP_REPEAT, true, repeat, sizeof repeat / sizeof *repeat);
    check_row(WRAP_CLAMP, true, clamp, sizeof clamp / sizeof *clamp);
    check_row(WRAP_MIRROR, true, mirror, sizeof mirror / sizeof *mirror);
}
END_TEST

START_TEST(test_bilinear_row)
{
    const Sample repeat[] = {{0.125, 0}, {0.375, 0.25},   {0.25, 0.125},  {0.75, 0.75}, {0, 0.5},
                             {1, 0.5},   {-0.0625, 0.75}, {0.0625, 0.25}, {-3.125, 1}};
    const Sample clamp[] = {{0.125, 0},  {0.25, 0.125}, {0, 0}, {0.0625, 0},    {1, 1},
                            {0.9375, 1}, {-5, 0},       {5, 1}, {0.8125, 0.875}};
    const Sample mirror[] = {{0.25, 0.125},  {0, 0},        {1, 1},      {1.25, 0.75},
                             {-0.25, 0.125}, {2.25, 0.125}, {1.0625, 1}, {-1.0625, 1}};
    check_row(WRAP_REPEAT, false, repeat, sizeof repeat / sizeof *repeat);
    check_row(WRAP_CLAMP, false, clamp, sizeof clamp / sizeof *clamp);
    check_row(WRAP_MIRROR, false, mirror, sizeof mirror / sizeof *mirror);
}
END_TEST

/* Rows run down, all four channels are sampled, and each axis wraps in its own way. */
START_TEST(test_two_axes)
{
    float texels[16];
    for (int i = 0; i < 16; i++)
        texels[i] = (float)i / 16;
    Texture texture = {2, 2, texels, WRAP_CLAMP, WRAP_REPEAT, true};
    double rgba[4];
    for (int i = 0; i < 4; i++) {
        const double uv[2] = {i % 2 * 0.5 + 0.25, i / 2 * 0.5 + 0.25};
        for (int nearest = 0; nearest < 2; nearest++) {
            texture.nearest = nearest;
            texture_lookup(&texture, uv, rgba);
            for (int k = 0; k < 4; k++)
                ck_assert_double_eq(rgba[k], (4 * i + k) / 16.0);
        }
    }
    texture.nearest = false;
    texture_lookup(&texture, (const double[]){0.5, 0.5}, rgba);
    ck_assert_double_eq(rgba[0], 6 / 16.0);
    texture_lookup(&texture, (const double[]){-1, 1}, rgba); /* left; between bottom and top */
    ck_assert_double_eq(rgba[1], 5 / 16.0);
    texture_lookup(&texture, (const double[]){0.375, 0.625}, rgba); /* 1/4 right, 3/4 down */
    ck_assert_double_eq(rgba[2], (2 + 0.25 * 4 + 0.75 * 8) / 16.0);
}
END_TEST

/* One texel is the same everywhere, to the bit, whatever uv is. */
START_TEST(test_one_texel)
{
    static const double values[] = {0,   1,        -1,    0.5,    -0.3,      7.3,
                                    NAN, INFINITY, 1e300, -1e300, -INFINITY, -0x1p-1074};
    float texel[4] = {0.1f, 0.2f, 0.7f, 0.9f};
    for (int i = 0; i < 12 * 12 * 18; i++) {
        const double uv[2] = {values[i % 12], values[i / 12 % 12]};
        int mode = i / 144;
        const Texture texture = {
            1, 1, texel, (TextureWrap)(mode % 3), (TextureWrap)(mode / 3 % 3), mode / 9};
        double rgba[4];
        texture_lookup(&texture, uv, rgba);
        for (int k = 0; k < 4; k++)
            EXPECT(rgba[k] == (double)texel[k], "uv %g %g, channel %d: %.17g", uv[0], uv[1], k,
                   rgba[k]);
    }
}
END_TEST

/* Texel k of the endless row that the wrap mode makes of `size` texels. */
static long wrapped(TextureWrap wrap, long k, long size)
{
    if (wrap == WRAP_CLAMP)
        return k < 0 ? 0 : k >= size ? size - 1 : k;
    long period = wrap == WRAP_MIRROR ? 2 * size : size;
    long in_period = (k % period + period) % period;
    return in_period < size ? in_period : period - 1 - in_period;
}

/* How much texel k of the endless row counts at x texels from its start. */
static long double weight(bool nearest, long k, long double x)
{
    if (nearest)
        return k == floorl(x);
    return fmaxl(0, 1 - fabsl(x - ((long double)k + 0.5L)));
}

static long double lattice_sum(const Texture *texture, const double uv[2], int channel)
{
    long double x = (long double)uv[0] * texture->width, y = (long double)uv[1] * texture->height;
    long double sum = 0;
    for (long row = lroundl(y) - 2; row <= lroundl(y) + 2; row++) {
        for (long column = lroundl(x) - 2; column <= lroundl(x) + 2; column++) {
            long at = wrapped(texture->wrap_t, row, texture->height) * texture->width +
                      wrapped(texture->wrap_s, column, texture->width);
            sum += weight(texture->nearest, row, y) * weight(texture->nearest, column, x) *
                   (long double)texture->texels[4 * at + channel];
        }
    }
    return sum;
}

static bool near_border(double u, uint32_t size)
{
    long double x = (long double)u * size;
    return fabsl(x - roundl(x)) < 1e-9L;
}

START_TEST(test_against_lattice)
{
    Random random = random_seed((uint64_t)_i + 1);
    float texels[4 * 7 * 7];
    for (int i = 0; i < 4 * 7 * 7; i++)
        texels[i] = (float)random_unit(&random);
    int compared = 0;
    for (int i = 0; i < 20000; i++) {
        uint32_t bits = random_bits(&random);
        Texture texture = {1 + bits % 7, 1 + bits / 7 % 7, texels, .nearest = bits >> 31};
        texture.wrap_s = (TextureWrap)(bits / 49 % 3);
        texture.wrap_t = (TextureWrap)(bits / 147 % 3);
        double range = i % 4 ? 3 : 100;
        double uv[2] = {random_range(&random, -range, range), random_range(&random, -range, range)};
        if (i % 8 == 0 && !texture.nearest)
            uv[0] = floor(uv[0] * 28) / 28; /* on borders and centres */
        if (texture.nearest &&
            (near_border(uv[0], texture.width) || near_border(uv[1], texture.height)))
            continue;
        double rgba[4];
        texture_lookup(&texture, uv, rgba);
        for (int k = 0; k < 4; k++) {
            double expected = (double)lattice_sum(&texture, uv, k);
            EXPECT(fabs(rgba[k] - expected) <= 2e-13,
                   "%u×%u, wrap %d %d, nearest %d, uv %.17g %.17g: got %.17g, expected %.17g",
                   texture.width, texture.height, texture.wrap_s, texture.wrap_t, texture.nearest,
                   uv[0], uv[1], rgba[k], expected);
        }
        compared++;
    }
    ck_assert_int_gt(compared, 19900);
}
END_TEST

START_TEST(test_material)
{
    float first[4] = {0.5f, 0.25f, 0.125f, 0.75f}, second[4] = {0.3f, 0.5f, 0.25f, 0.6f};
    const Texture textures[2] = {{1, 1, first, .nearest = true}, {1, 1, second, .nearest = true}};
    Material material = {.base_color = {1, 0.5f, 0.1f, 0.2f},
                         .roughness = 0.7f,
                         .metallic = 0.9f,
                         .occlusion = 0.4f};
    MaterialSample sample;
    for (int mode = 0; mode < 4; mode++) {
        bool colored = mode & 1, rough = mode & 2;
        material.base_color_texture = colored ? 1 : 0;
        material.metallic_roughness_texture = rough ? 2 : 0;
        texture_material(mode ? textures : NULL, &material, (const double[]){0.5, 0.5}, &sample);
        for (int i = 0; i < 4; i++)
            ck_assert_double_eq(sample.base_color[i],
                                material.base_color[i] * (colored ? (double)first[i] : 1));
        ck_assert_double_eq(sample.roughness, (double)0.7f * (rough ? 0.5 : 1));
        ck_assert_double_eq(sample.metallic, (double)0.9f * (rough ? 0.25 : 1));
        ck_assert_double_eq(sample.occlusion, 0.4f);
    }
}
END_TEST

/* ---- pictures ------------------------------------------------------------------------------- */

/* u to the right and v down over the quad, 0 to 1. */
static float square_uv[8] = {0, 1, 1, 1, 1, 0, 0, 0};
static const RenderDesc small = {.width = 8, .height = 8, .threads = 1};

/* Gives quad `index` the texture, over all of it. */
static Material *put_texture(Stage *stage, int index, Texture *texture)
{
    stage->scene.textures = texture;
    stage->scene.texture_count = 1;
    stage->meshes[index].uv = square_uv;
    stage->materials[index].base_color_texture = 1;
    return &stage->materials[index];
}

static void render(const Stage *stage, const RenderDesc *desc, Frame *frame)
{
    ck_assert_int_eq(truth_render(&stage->scene, desc, NULL, frame), RESULT_OK);
}

static void check_pixel(const Frame *frame, int x, int y, const float expected[4])
{
    const float *final = image_pixel(&frame->final, x, y);
    for (int i = 0; i < 4; i++)
        EXPECT(final[i] == expected[i], "pixel %d,%d channel %d: got %a, expected %a", x, y, i,
               (double) final[i], (double)expected[i]);
}

/* A masked quad with holes in a checkerboard, between two transparent ones: the one behind shows
 * through the holes only, the one in front everywhere. */
START_TEST(test_mask)
{
    float texels[16] = {0};
    for (int i = 0; i < 4; i++) {
        texels[4 * i + 2] = 1;
        texels[4 * i + 3] = i == 0 || i == 3 ? 0.5f : 0.4375f;
    }
    Texture texture = {2, 2, texels, .nearest = true};
    Stage *stage = stage_new();
    add_quad(stage, 1.5f, 4, green);
    add_quad(stage, 2, 2, blue);
    add_quad(stage, 2.5f, 4, red);
    Material *masked = put_texture(stage, 1, &texture);
    masked->alpha_mode = ALPHA_MASK;
    masked->alpha_cutoff = 0.5f; /* an alpha equal to it stays */
    Frame frame;
    render(stage, &small, &frame);
    for (int i = 0; i < 64; i++) {
        bool hole = (i % 8 < 4) != (i / 8 < 4);
        check_pixel(&frame, i % 8, i / 8,
                    hole ? (const float[]){0.375f, 0.25f, 0, 0.625f}
                         : (const float[]){0, 0.25f, 0.75f, 1});
    }
    ck_assert_uint_eq(frame.layers.fragments, 64 + 32);
    ck_assert_uint_eq(frame.layers.coverage_differs, 0);
    frame_free(&frame);
    masked->base_color[3] = 0.9375f; /* times alpha 1/2: below the cutoff everywhere */
    render(stage, &small, &frame);
    ck_assert_uint_eq(frame.layers.fragments, 128);
    frame_free(&frame);
    masked->alpha_mode = ALPHA_OPAQUE; /* ignores alpha */
    render(stage, &small, &frame);
    check_pixel(&frame, 7, 0, (const float[]){0, 0.25f, 0.75f, 1});
    ck_assert_uint_eq(frame.layers.fragments, 64);
    frame_free(&frame);
    free(stage);
}
END_TEST

/* A quad whose right and top edges pass just beyond pixel centres: snapping moves them
 * onto the centres, and the pixels there are lost. */
static Material *add_unsure_quad(Stage *stage, float depth, const float color[4])
{
    return add_quad(stage, depth, (2.5f + 0.4f / 256) / 4 * depth, color);
}

static uint64_t coverage_differs(const Stage *stage)
{
    Frame frame;
    render(stage, &small, &frame);
    uint64_t count = frame.layers.coverage_differs;
    frame_free(&frame);
    return count;
}

/* A hole exists under neither kind of coverage: it makes no difference at its own edge, and hides
 * none behind it. */
START_TEST(test_mask_and_exact_coverage)
{
    float texel[4] = {1, 1, 1, 0};
    Texture texture = {1, 1, texel, .nearest = true};
    Stage *stage = stage_new();
    add_unsure_quad(stage, 2, red);
    uint64_t expected = coverage_differs(stage);
    ck_assert_uint_gt(expected, 4);
    add_quad(stage, 1.5f, 4, blue);
    Material *masked = put_texture(stage, 1, &texture);
    ck_assert_uint_eq(coverage_differs(stage), 0); /* hidden */
    masked->alpha_mode = ALPHA_MASK;
    masked->alpha_cutoff = 0.5f;
    ck_assert_uint_eq(coverage_differs(stage), expected);
    free(stage);

    stage = stage_new();
    add_unsure_quad(stage, 2, blue);
    masked = put_texture(stage, 0, &texture);
    ck_assert_uint_eq(coverage_differs(stage), expected);
    masked->alpha_mode = ALPHA_MASK;
    masked->alpha_cutoff = 0.5f;
    ck_assert_uint_eq(coverage_differs(stage), 0);
    free(stage);
}
END_TEST

/* A transparent quad with a gradient of colour and alpha, over the background. */
START_TEST(test_blended_texture)
{
    float texels[8] = {1, 0, 0.5f, 0, 0, 1, 0.5f, 1};
    Texture texture = {2, 1, texels, WRAP_CLAMP, WRAP_CLAMP, false};
    Stage *stage = stage_new();
    add_quad(stage, 2, 2, (const float[]){1, 0.5f, 1, 0.5f});
    put_texture(stage, 0, &texture);
    memcpy(stage->scene.background, (const float[]){0, 0, 1}, sizeof(float[3]));
    Frame frame;
    render(stage, &small, &frame);
    for (int i = 0; i < 64; i++) {
        double f = fmin(fmax((i % 8 + 0.5) / 4 - 0.5, 0), 1), alpha = 0.5 * f;
        const float expected[4] = {(float)(alpha * (1 - f)), (float)(alpha * 0.5 * f),
                                   (float)(alpha * 0.5 + 1 - alpha), (float)alpha};
        check_pixel(&frame, i % 8, i / 8, expected);
    }
    ck_assert_uint_eq(frame.layers.fragments, 64); /* where alpha is 0, too */
    frame_free(&frame);
    stage->meshes[0].uv = NULL; /* sampled at (0, 0) */
    render(stage, &small, &frame);
    for (int i = 0; i < 64; i++)
        check_pixel(&frame, i % 8, i / 8, (const float[]){0, 0, 1, 0});
    ck_assert_uint_eq(frame.layers.fragments, 64);
    frame_free(&frame);
    texels[3] = 1;
    render(stage, &small, &frame);
    check_pixel(&frame, 7, 7, (const float[]){0.5f, 0, 0.75f, 0.5f});
    frame_free(&frame);
    free(stage);
}
END_TEST

/* A slanted, lit quad, both textures: each pixel has the material of the point where its ray meets
 * the plane, uv being linear on the plane. */
START_TEST(test_perspective)
{
    Random random = random_seed(3);
    float texels[2][4 * 5 * 3];
    for (int i = 0; i < 4 * 5 * 3; i++) {
        texels[0][i] = (float)random_unit(&random);
        texels[1][i] = (float)random_unit(&random);
    }
    Texture textures[2] = {{5, 3, texels[0], WRAP_MIRROR, WRAP_REPEAT, false},
                           {3, 5, texels[1], WRAP_REPEAT, WRAP_MIRROR, false}};
    float uv[8];
    Stage *stage = stage_new();
    add_quad(stage, 2, 8, blue);
    for (int k = 0; k < 4; k++) { /* z = −2 + y/4 */
        float *p = &stage->positions[0][3 * k];
        p[2] = -2 + p[1] / 4;
        uv[2 * k] = p[0];
        uv[2 * k + 1] = p[1] - 0.25f * p[0];
    }
    put_texture(stage, 0, textures)->metallic_roughness_texture = 2;
    stage->meshes[0].uv = uv;
    stage->materials[0].metallic = 1;
    stage->scene.texture_count = 2;
    stage->scene.light_count = 1;
    stage->lights[0] = (Light){{0.5, 1.25, -1}, {2, 3, 4}, {0, 0, 1}, 0};
    ViewLight light = {{0.5f, 1.25f, -1}, {2, 3, 4}, {0, 0, 1}, 0};
    View view = {.light_count = 1, .lights = &light, .ambient = {1, 1, 1}};
    Frame frame;
    const RenderDesc desc = {.width = 96, .height = 96};
    render(stage, &desc, &frame);
    for (int i = 0; i < 96 * 96; i++) {
        double x = (i % 96 + 0.5) / 48 - 1, y = 1 - (i / 96 + 0.5) / 48;
        double depth = 2 / (1 + y / 4); /* of the plane along the ray (x, y, −1) */
        if (depth > 2.9)
            continue;
        Surface surface = {.position = {x * depth, y * depth, -depth}, .normal = {0, 0, 1}};
        const double at[2] = {x * depth, y * depth - 0.25 * x * depth};
        texture_material(textures, &stage->materials[0], at, &surface.material);
        double rgb[3];
        radiance_shade(&view, &surface, rgb);
        const float *final = image_pixel(&frame.final, i % 96, i / 96);
        for (int k = 0; k < 3; k++)
            EXPECT(fabs(final[k] - rgb[k]) <= 1e-7 * fmax(1, rgb[k]),
                   "pixel %d,%d: got %.9g, expected %.9g", i % 96, i / 96, (double) final[k],
                   rgb[k]);
    }
    frame_free(&frame);
    free(stage);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("truth_texture");
    TCase *tests = tcase_create("truth_texture");
    tcase_set_timeout(tests, 120);
    tcase_add_test(tests, test_nearest_row);
    tcase_add_test(tests, test_bilinear_row);
    tcase_add_test(tests, test_two_axes);
    tcase_add_test(tests, test_one_texel);
    tcase_add_loop_test(tests, test_against_lattice, 0, 4);
    tcase_add_test(tests, test_material);
    tcase_add_test(tests, test_mask);
    tcase_add_test(tests, test_mask_and_exact_coverage);
    tcase_add_test(tests, test_blended_texture);
    tcase_add_test(tests, test_perspective);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}
