/* Stored formats and blending of number/ against the driver. */
#include "driver.h"

#include "number/blend.h"

/* ---- stored formats ----------------------------------------------------------------------------
 */

/* Inputs around every code of an n-bit unorm and around the boundaries between codes. */
static void fill_codes(int round, double largest)
{
    for (int i = 0; i < VALUES; i++) {
        uint64_t pick = random_bits(&random_state);
        double code = (double)(pick % (uint64_t)(2.0 * largest + 1.0)) * 0.5;
        float near = op_from_bits(op_bits((float)(code / largest)) + (uint32_t)(pick >> 60) - 8u);
        a[i / 4][i % 4] = round == 0 ? near : driver_input((InputSet)(round - 1));
    }
    driver_upload();
}

static uint32_t stored_value(PixelFormat format, float x)
{
    switch (format) {
    case FORMAT_RGBA8:
        return unorm8_from_float(x);
    case FORMAT_RGBA16:
        return unorm16_from_float(x);
    default:
        return half_from_float(x);
    }
}

static bool is_half_nan(uint32_t half)
{
    return (half & 0x7fffu) > 0x7c00u;
}

static void check_store(PixelFormat format, GLenum internal, GLenum type, double largest)
{
    static union {
        uint8_t bytes[TEXELS][4];
        uint16_t words[TEXELS][4];
    } stored;
    GLuint program = driver_build(driver_color_output, "result = a;");
    driver_target(internal, false);
    for (int round = 0; round <= INPUT_SETS; round++) {
        /* Without AVX, infinities and more do not fit the driver's conversion to 8 bits. */
        if (format == FORMAT_RGBA8 && !fused && round > INPUT_SIGNED + 1)
            break;
        fill_codes(round, largest);
        driver_draw(program);
        gl.ReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, type, &stored);
        for (int i = 0; i < VALUES; i++) {
            uint32_t driver =
                format == FORMAT_RGBA8 ? stored.bytes[i / 4][i % 4] : stored.words[i / 4][i % 4];
            uint32_t mode = op_enter();
            uint32_t model = stored_value(format, a[i / 4][i % 4]);
            op_leave(mode);
            bool nan = format == FORMAT_RGBA16F && is_half_nan(driver) && is_half_nan(model);
            if (driver != model && !nan)
                ck_abort_msg("%s of %a: driver %u, number/format.h %u", format_info(format)->name,
                             (double)a[i / 4][i % 4], driver, model);
        }
    }
}

START_TEST(test_store)
{
    check_store(FORMAT_RGBA8, GL_RGBA8, GL_UNSIGNED_BYTE, 255.0);
    check_store(FORMAT_RGBA16, GL_RGBA16, GL_UNSIGNED_SHORT, 65535.0);
    check_store(FORMAT_RGBA16F, GL_RGBA16F, GL_HALF_FLOAT, 2048.0);
}
END_TEST

static float fetched_value(PixelFormat format, uint16_t code)
{
    switch (format) {
    case FORMAT_RGBA8:
        return unorm8_to_float((uint8_t)code);
    case FORMAT_RGBA16:
        return unorm16_to_float(code);
    default:
        return half_to_float(code);
    }
}

/* Every code of a 16-bit format; for an 8-bit one the low bytes of those. */
static void check_fetch(PixelFormat format, GLenum internal, GLenum type)
{
    static uint8_t bytes[TEXELS][4];
    static uint16_t words[TEXELS][4];
    GLuint texture;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, 1, internal, WIDTH, HEIGHT);
    gl.TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    for (int i = 0; i < VALUES; i++) {
        words[i / 4][i % 4] = (uint16_t)i;
        bytes[i / 4][i % 4] = (uint8_t)words[i / 4][i % 4];
    }
    const void *pixels = format == FORMAT_RGBA8 ? (const void *)bytes : (const void *)words;
    gl.TextureSubImage2D(texture, 0, 0, 0, WIDTH, HEIGHT, GL_RGBA, type, pixels);
    gl.BindTextureUnit(0, texture);
    driver_target(GL_RGBA32F, false);
    driver_draw(driver_build(driver_color_output, "result = a;"));
    gl.ReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, GL_FLOAT, got);
    for (int i = 0; i < VALUES; i++) {
        uint16_t code = format == FORMAT_RGBA8 ? bytes[i / 4][i % 4] : words[i / 4][i % 4];
        uint32_t mode = op_enter();
        float model = fetched_value(format, code);
        op_leave(mode);
        if (!driver_same(got[i / 4][i % 4], model))
            ck_abort_msg("%s code %u: driver %a, number/format.h %a", format_info(format)->name,
                         code, (double)got[i / 4][i % 4], (double)model);
    }
}

START_TEST(test_fetch)
{
    check_fetch(FORMAT_RGBA8, GL_RGBA8, GL_UNSIGNED_BYTE);
    check_fetch(FORMAT_RGBA16, GL_RGBA16, GL_UNSIGNED_SHORT);
    check_fetch(FORMAT_RGBA16F, GL_RGBA16F, GL_HALF_FLOAT);
}
END_TEST

/* Stores a's first channel as depth, reads it back and fetches it. */
static void check_depth(PixelFormat format, GLenum internal, int round)
{
    static uint32_t codes[TEXELS];
    static float fetched[TEXELS];
    uint32_t most = format_info(format)->unorm_max;
    fill_codes(round, most ? most : 1024.0);
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthFunc(GL_ALWAYS);
    GLuint depth = driver_target(internal, true);
    driver_draw(driver_build("", "gl_FragDepth = a.x;"));
    gl.Disable(GL_DEPTH_TEST);
    GLenum type = most ? GL_UNSIGNED_INT : GL_FLOAT;
    gl.ReadPixels(0, 0, WIDTH, HEIGHT, GL_DEPTH_COMPONENT, type, codes);
    gl.BindTextureUnit(0, depth);
    driver_target(GL_R32F, false);
    driver_draw(driver_build(driver_color_output, "result = a;"));
    gl.ReadPixels(0, 0, WIDTH, HEIGHT, GL_RED, GL_FLOAT, fetched);
    gl.BindTextureUnit(0, operands[0]);
    for (int i = 0; i < TEXELS; i++) {
        uint32_t mode = op_enter();
        uint32_t code = format == FORMAT_D24   ? depth24_from_float(a[i][0])
                        : format == FORMAT_D16 ? depth16_from_float(a[i][0])
                                               : op_bits(depth32f_from_float(a[i][0]));
        float fetch = format == FORMAT_D24   ? depth24_to_float(code)
                      : format == FORMAT_D16 ? depth16_to_float(code)
                                             : op_from_bits(code);
        op_leave(mode);
        /* 24 and 16 bits are read back as 32, the leading ones repeated. */
        uint32_t widened = format == FORMAT_D24   ? code << 8 | code >> 16
                           : format == FORMAT_D16 ? code << 16 | code
                                                  : code;
        if (codes[i] != widened)
            ck_abort_msg("%s of %a: driver 0x%08x, number/format.h 0x%08x",
                         format_info(format)->name, (double)a[i][0], codes[i], widened);
        if (op_bits(fetched[i]) != op_bits(fetch))
            ck_assert_float_bits(fetched[i], fetch);
    }
}

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

START_TEST(test_depth)
{
    for (int round = 0; round <= INPUT_SETS; round++) {
        check_depth(FORMAT_D24, GL_DEPTH_COMPONENT24, round);
        check_depth(FORMAT_D16, GL_DEPTH_COMPONENT16, round);
        check_depth(FORMAT_D32F, GL_DEPTH_COMPONENT32F, round);
    }
}
END_TEST

/* ---- blending ------------------------------------------------------------------------------ */

/* Destinations are drawn first, without blending, so that they are what the format can store. */
static void check_blend(PixelFormat format, GLenum internal, GLenum type, bool seed, InputSet set)
{
    static union {
        float floats[TEXELS][4];
        uint16_t words[TEXELS][4];
    } before, after;
    size_t bytes = format_pixel_bytes(format);
    driver_fill(set);
    driver_upload();
    driver_target(internal, false);
    driver_draw(driver_build(driver_color_output, "result = b;"));
    gl.ReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, type, &before);
    if (seed)
        gl.BlendFunc(GL_DST_ALPHA, GL_ONE);
    else
        gl.BlendFuncSeparate(GL_DST_ALPHA, GL_ONE, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
    gl.Enable(GL_BLEND);
    driver_draw(driver_build(driver_color_output, "result = a;"));
    gl.Disable(GL_BLEND);
    gl.ReadPixels(0, 0, WIDTH, HEIGHT, GL_RGBA, type, &after);
    for (int i = 0; i < TEXELS; i++) {
        char *pixel = (char *)&before + (size_t)i * bytes;
        uint32_t mode = op_enter();
        (seed ? blend_opaque_seed : blend_under)(format, a[i], pixel);
        op_leave(mode);
        const char *driver = (const char *)&after + (size_t)i * bytes;
        for (int k = 0; k < 4; k++) {
            float expected = format_channel(format, pixel, k);
            float value = format_channel(format, driver, k);
            if (!driver_same(value, expected))
                ck_abort_msg(
                    "%s, %s, channel %d: source %a alpha %a, before %a alpha %a: driver %a, "
                    "number/blend.h %a",
                    format_info(format)->name, seed ? "seed" : "under", k, (double)a[i][k],
                    (double)a[i][3], (double)b[i][k], (double)b[i][3], (double)value,
                    (double)expected);
        }
    }
}

START_TEST(test_blend)
{
    for (int set = 0; set < INPUT_SETS; set++)
        for (int seed = 0; seed < 2; seed++) {
            check_blend(FORMAT_RGBA32F, GL_RGBA32F, GL_FLOAT, seed != 0, (InputSet)set);
            check_blend(FORMAT_RGBA16, GL_RGBA16, GL_UNSIGNED_SHORT, seed != 0, (InputSet)set);
            check_blend(FORMAT_RGBA16F, GL_RGBA16F, GL_HALF_FLOAT, seed != 0, (InputSet)set);
            if (fused || set <= INPUT_SIGNED) /* see check_store */
                check_blend(FORMAT_RGBA8, GL_RGBA8, GL_UNSIGNED_BYTE, seed != 0, (InputSet)set);
        }
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("formats");
    TCase *tcase = tcase_create("driver");
    tcase_set_timeout(tcase, 120);
    tcase_add_checked_fixture(tcase, driver_open_after_mode, driver_close);
    tcase_add_test(tcase, test_store);
    tcase_add_test(tcase, test_fetch);
    tcase_add_test(tcase, test_depth);
    tcase_add_test(tcase, test_depth24_order);
    tcase_add_test(tcase, test_blend);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
