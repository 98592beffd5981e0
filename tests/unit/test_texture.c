/* Texels against MPFR: every code of 8 and 16 bits; and back to codes. */
#include "scene/texture.h"

#include "testing.h"

#include <mpfr.h>
#include <stdio.h>

/* code/most decoded as IEC 61966-2-1 says, with 200 bits, rounded to float once. */
static float exact_srgb(uint32_t code, uint32_t most)
{
    mpfr_t x, exponent;
    mpfr_inits2(200, x, exponent, (mpfr_ptr)NULL);
    mpfr_set_ui(x, code, MPFR_RNDN);
    mpfr_div_ui(x, x, most, MPFR_RNDN);
    mpfr_set_str(exponent, "0.04045", 10, MPFR_RNDN);
    if (mpfr_lessequal_p(x, exponent)) {
        mpfr_mul_ui(x, x, 100, MPFR_RNDN);
        mpfr_div_ui(x, x, 1292, MPFR_RNDN);
    } else {
        mpfr_mul_ui(x, x, 1000, MPFR_RNDN);
        mpfr_add_ui(x, x, 55, MPFR_RNDN);
        mpfr_div_ui(x, x, 1055, MPFR_RNDN);
        mpfr_set_str(exponent, "2.4", 10, MPFR_RNDN);
        mpfr_pow(x, x, exponent, MPFR_RNDN);
    }
    float rounded = mpfr_get_flt(x, MPFR_RNDN);
    mpfr_clears(x, exponent, (mpfr_ptr)NULL);
    return rounded;
}

static float exact_linear(uint32_t code, uint32_t most)
{
    mpfr_t x;
    mpfr_init2(x, 200);
    mpfr_set_ui(x, code, MPFR_RNDN);
    mpfr_div_ui(x, x, most, MPFR_RNDN);
    float rounded = mpfr_get_flt(x, MPFR_RNDN);
    mpfr_clear(x);
    return rounded;
}

static void all_codes(uint32_t most)
{
    for (uint32_t code = 0; code <= most; code++) {
        ck_assert_float_bits(texture_decode(TEXTURE_SRGB, code, most), exact_srgb(code, most));
        ck_assert_float_bits(texture_decode(TEXTURE_LINEAR, code, most), exact_linear(code, most));
    }
    ck_assert_float_bits(texture_decode(TEXTURE_SRGB, most, most), 1.0f);
}

START_TEST(every_texel_is_correctly_rounded)
{
    all_codes(255);
    all_codes(65535);
}
END_TEST

/* A row of 256 texels: colour code i, alpha 255 − i. */
static Image ramp(void)
{
    Image image;
    ck_assert_int_eq(image_create(256, 1, FORMAT_RGBA8, &image), RESULT_OK);
    for (int i = 0; i < 256; i++)
        memcpy(
            image_pixel(&image, i, 0),
            ((uint8_t[]){(uint8_t)i, (uint8_t)(i ^ 0x55), (uint8_t)(255 - i), (uint8_t)(255 - i)}),
            4);
    return image;
}

START_TEST(alpha_is_linear)
{
    Image image = ramp();
    Texture texture;
    ck_assert_int_eq(texture_from_image(&image, TEXTURE_SRGB, &texture), RESULT_OK);
    ck_assert_uint_eq(texture.width, 256);
    ck_assert_uint_eq(texture.height, 1);
    for (uint32_t i = 0; i < 256; i++) {
        ck_assert_float_bits(texture.texels[4 * i], exact_srgb(i, 255));
        ck_assert_float_bits(texture.texels[4 * i + 1], exact_srgb(i ^ 0x55, 255));
        ck_assert_float_bits(texture.texels[4 * i + 3], exact_linear(255 - i, 255));
    }
    free(texture.texels);
    image_free(&image);
}
END_TEST

START_TEST(sixteen_bits)
{
    Image image;
    Texture texture;
    ck_assert_int_eq(image_create(1, 2, FORMAT_RGBA16, &image), RESULT_OK);
    memcpy(image.pixels, ((uint16_t[]){0, 1, 2650, 3, 2651, 40000, 65534, 65535}), 16);
    ck_assert_int_eq(texture_from_image(&image, TEXTURE_SRGB, &texture), RESULT_OK);
    ck_assert_float_bits(texture.texels[2], exact_srgb(2650, 65535)); /* the last linear code */
    ck_assert_float_bits(texture.texels[3], exact_linear(3, 65535));
    ck_assert_float_bits(texture.texels[4], exact_srgb(2651, 65535));
    ck_assert_float_bits(texture.texels[5], exact_srgb(40000, 65535));
    ck_assert_float_bits(texture.texels[7], 1.0f);
    free(texture.texels);
    image_free(&image);
}
END_TEST

START_TEST(codes_come_back)
{
    for (int e = 0; e < 2; e++) {
        Image image = ramp(), back;
        Texture texture;
        bool exact = false;
        ck_assert_int_eq(texture_from_image(&image, (TextureEncoding)e, &texture), RESULT_OK);
        ck_assert_int_eq(texture_to_image(&texture, (TextureEncoding)e, &back, &exact), RESULT_OK);
        ck_assert(exact);
        ck_assert_mem_eq(image.pixels, back.pixels, 1024);
        free(texture.texels);
        image_free(&image);
        image_free(&back);
    }
}
END_TEST

/* Between two codes the nearer value wins, and the caller is told. */
START_TEST(nearest_codes)
{
    float low = texture_decode(TEXTURE_SRGB, 100, 255),
          high = texture_decode(TEXTURE_SRGB, 101, 255);
    float texels[4] = {low + 0.4f * (high - low), low + 0.6f * (high - low),
                       0.5f * texture_decode(TEXTURE_SRGB, 1, 255), 0.999f};
    Texture texture = {.width = 1, .height = 1, .texels = texels};
    Image image;
    bool exact = true;
    ck_assert_int_eq(texture_to_image(&texture, TEXTURE_SRGB, &image, &exact), RESULT_OK);
    const uint8_t *codes = image.pixels;
    ck_assert(!exact);
    ck_assert_uint_eq(codes[0], 100);
    ck_assert_uint_eq(codes[1], 101);
    ck_assert_uint_eq(codes[2], 0); /* as near as 1 */
    ck_assert_uint_eq(codes[3], 255);
    image_free(&image);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("texture");
    TCase *test = tcase_create("texture");
    tcase_add_checked_fixture(test, NULL, mpfr_free_cache); /* in thread-local storage */
    tcase_set_timeout(test, 120);
    tcase_add_test(test, every_texel_is_correctly_rounded);
    tcase_add_test(test, alpha_is_linear);
    tcase_add_test(test, sixteen_bits);
    tcase_add_test(test, codes_come_back);
    tcase_add_test(test, nearest_codes);
    suite_add_tcase(suite, test);
    return testing_run(suite);
}
