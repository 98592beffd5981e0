/* blend/vectors.h: that sets are what they say, the same everywhere, and hit what they are for. */
#include "testing.h"

#include "blend/sequence.h"
#include "blend/vector_file.h"
#include "blend/vector_values.h"
#include "number/op.h"

#include <math.h>
#include <stdio.h>

static const PixelFormat formats[] = {FORMAT_RGBA8,   FORMAT_RGBA16, FORMAT_RGBA16F,
                                      FORMAT_RGBA32F, FORMAT_RG32F,  FORMAT_R32F};
enum {
    FORMATS = sizeof formats / sizeof *formats,
    BLOCK = 4096
};

static float source[BLOCK][4];
static unsigned char pixels[BLOCK * 16];

/* ---- exhaustive ---- */

static unsigned char *seen_triples[6];

static void see(unsigned char *seen, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t triple = a << 16 | b << 8 | c;
    if (seen[triple / 8] >> triple % 8 & 1)
        ck_abort_msg("triple %u %u %u a second time", a, b, c);
    seen[triple / 8] |= (unsigned char)(1u << triple % 8);
}

/* As each of 2^24 is new, all of them are there. */
START_TEST(test_exhaustive)
{
    VectorSpec spec = {VECTORS_EXHAUSTIVE, FORMAT_RGBA8, 0, 0};
    static uint16_t pairs[256][256];
    uint32_t fewest = UINT32_MAX;
    ck_assert_uint_eq(vectors_count(&spec), 1u << 24);
    for (int i = 0; i < 6; i++)
        seen_triples[i] = calloc(1u << 21, 1);
    for (uint64_t first = 0; first < 1u << 24; first += BLOCK) {
        vectors_make(&spec, first, BLOCK, source, pixels);
        for (int v = 0; v < BLOCK; v++) {
            const unsigned char *d = pixels + 4 * v;
            uint32_t s[4];
            for (int c = 0; c < 4; c++)
                s[c] = (uint32_t)(source[v][c] * 255.0f + 0.5f);
            for (int c = 0; c < 3; c++) {
                see(seen_triples[c], s[c], d[3], d[c]);
                see(seen_triples[3 + c], s[c], s[3], d[c]);
            }
            pairs[s[3]][d[3]]++;
        }
    }
    for (int a = 0; a < 256; a++)
        for (int b = 0; b < 256; b++)
            fewest = pairs[a][b] < fewest ? pairs[a][b] : fewest;
    ck_assert_uint_eq(fewest, 256);
}
END_TEST

/* Sources of unorm formats are codes however they are stored: to nearest in float or in double. */
START_TEST(test_codes)
{
    static const VectorSet sets[] = {VECTORS_EXHAUSTIVE, VECTORS_RANDOM};
    for (int i = 0; i < 4; i++) {
        VectorSpec spec = {sets[i / 2], i % 2 ? FORMAT_RGBA16 : FORMAT_RGBA8, 5, BLOCK};
        float max = i % 2 ? 65535.0f : 255.0f;
        vectors_make(&spec, 0, BLOCK, source, pixels);
        for (int v = 0; v < BLOCK; v++)
            for (int c = 0; c < 4; c++) {
                float x = source[v][c];
                uint32_t code = (uint32_t)lrint((double)x * (double)max);
                ck_assert_float_bits(x, vector_values_unorm(spec.format, code));
                ck_assert_int_eq(lrintf(x * max), (long)code);
            }
    }
}
END_TEST

/* ---- the same bytes ---- */

static void digest_set(const VectorSpec *spec, size_t block, char out[VECTOR_DIGEST_TEXT])
{
    VectorDigest *digest = vector_digest_create();
    uint64_t count = vectors_count(spec);
    size_t size = format_pixel_bytes(spec->format);
    for (uint64_t first = 0; first < count; first += block) {
        size_t some = count - first < block ? (size_t)(count - first) : block;
        vectors_make(spec, first, some, source, pixels);
        for (size_t v = 0; v < some; v++) {
            vector_digest_put(digest, source[v], sizeof source[v]);
            vector_digest_put(digest, pixels + v * size, size);
        }
    }
    vector_digest_finish(digest, out);
}

static void digest_sequences(const VectorSpec *spec, char out[VECTOR_DIGEST_TEXT])
{
    static float layers[SEQUENCE_LAYERS_MAX][4];
    VectorDigest *digest = vector_digest_create();
    for (uint64_t i = 0; i < spec->count; i++)
        vector_digest_put(digest, layers, (size_t)sequence_make(spec, i, layers) * sizeof *layers);
    vector_digest_finish(digest, out);
}

/* A change of any vector must change VECTORS_VERSION and these. */
static const char *const golden[VECTORS_SET_COUNT][FORMATS] = {
#include "vectors_golden.h"
};

START_TEST(test_golden)
{
    for (int s = 0; s < VECTORS_SET_COUNT; s++)
        for (int f = 0; f < FORMATS; f++) {
            VectorSpec spec = {(VectorSet)s, formats[f], 1, s == VECTORS_RANDOM ? 65536 : 2550};
            char digest[VECTOR_DIGEST_TEXT] = "";
            if (vectors_check(&spec) != RESULT_OK)
                ck_assert_ptr_null(golden[s][f]);
            else if (s == VECTORS_SEQUENCES)
                digest_sequences(&spec, digest);
            else
                digest_set(&spec, BLOCK, digest);
            if (getenv("PEEL_TEST_GOLDEN") && *digest)
                printf("[%d][%d] = \"%s\",\n", s, f, digest);
            else if (*digest)
                ck_assert_msg(golden[s][f] && strcmp(golden[s][f], digest) == 0,
                              "%s of %s: %s, expected %s (PEEL_TEST_GOLDEN=1 prints new ones)",
                              vectors_set_name(spec.set), format_info(spec.format)->name, digest,
                              golden[s][f]);
        }
}
END_TEST

/* Any part can be made alone. */
START_TEST(test_parts)
{
    VectorSpec spec = {VECTORS_DIRECTED, formats[_i], 1, 0};
    char whole[VECTOR_DIGEST_TEXT], parts[VECTOR_DIGEST_TEXT];
    digest_set(&spec, BLOCK, whole);
    digest_set(&spec, 1001, parts);
    ck_assert_str_eq(whole, parts);
    spec = (VectorSpec){VECTORS_RANDOM, formats[_i], 77, 5000};
    digest_set(&spec, BLOCK, whole);
    digest_set(&spec, 7, parts);
    ck_assert_str_eq(whole, parts);
    spec.seed++;
    digest_set(&spec, BLOCK, parts);
    ck_assert_str_ne(whole, parts);
}
END_TEST

/* ---- directed ---- */

/* Whether x, which is exact, is half-way between two numbers of so many bits. */
static bool is_tie(double x, int digits)
{
    int exponent;
    double scaled = ldexp(fabs(frexp(x, &exponent)), digits);
    return scaled - floor(scaled) == 0.5;
}

/* Within a 2^-8 of a unit of a tie, or of a number, but not there. */
static bool is_near(double x, int digits)
{
    int exponent;
    double scaled = 2.0 * ldexp(fabs(frexp(x, &exponent)), digits);
    double off = fabs(scaled - nearbyint(scaled));
    return off > 0.0 && off <= 0x1p-8;
}

typedef enum Hit {
    PRODUCT_TIE,
    PRODUCT_NEAR,
    SUM_TIE,
    CANCELS,
    DENORMAL_END,
    OVERFLOW_END,
    ONE_MINUS_TIE,
    HITS
} Hit;

static const char *const hit_names[HITS] = {"product ties",  "product near ties", "sum ties",
                                            "cancellations", "denormal ends",     "overflow ends",
                                            "ties of 1 - a"};

/* One operation x·f + addend of an equation. */
static void count_hits(double x, double f, double addend, int digits, double least, double most,
                       uint32_t hits[HITS])
{
    double product = x * f, sum = product + addend; /* the product is exact in double */
    if (!isfinite(sum) || x == 0.0)
        return;
    hits[PRODUCT_TIE] += fabs(product) > least && is_tie(product, digits);
    hits[PRODUCT_NEAR] += fabs(product) > least && is_near(product, digits);
    hits[SUM_TIE] += addend != 0.0 && sum - product == addend && sum - addend == product &&
                     is_tie(sum, digits) && !is_tie(product, digits);
    hits[CANCELS] += sum != 0.0 && fabs(sum) < fabs(product) * ldexp(8.0, -digits);
    hits[DENORMAL_END] += fabs(fabs(product) / least - 1.0) < ldexp(4.0, -digits);
    hits[OVERFLOW_END] += fabs(fabs(sum) / most - 1.0) < ldexp(4.0, -digits);
}

/* By the three factors: destination's alpha (under), source's alpha, 1 less it (over). */
static void count_vector(PixelFormat format, const float s[4], const unsigned char *pixel,
                         int digits, uint32_t hits[3][HITS])
{
    bool half = format_info(format)->kind == KIND_HALF;
    double least = half ? 0x1p-14 : 0x1p-126, most = half ? 65520.0 : 0x1.ffffffp127;
    double d[4];
    for (int c = 0; c < 4; c++)
        d[c] = (double)format_channel(format, pixel, c);
    for (int c = 0; c < 3; c++) {
        count_hits((double)s[c], d[3], d[c], digits, least, most, hits[0]);
        count_hits((double)s[c], (double)s[3], d[c], digits, least, most, hits[1]);
        count_hits(d[c], (double)(1.0f - s[3]), (double)s[c], digits, least, most, hits[2]);
    }
    hits[0][ONE_MINUS_TIE] += is_tie(1.0 - d[3], 24);
    hits[1][ONE_MINUS_TIE] += is_tie(1.0 - (double)s[3], digits);
    hits[2][ONE_MINUS_TIE] += is_tie(1.0 - (double)s[3], 24);
}

/* Each case comes up in every role, hundreds of times; in half formats of both precisions, but for
 * what a half, as the factor of a float result, cannot bring about. */
START_TEST(test_constructed)
{
    static const int precisions[] = {24, 24, 11};
    VectorSpec spec = {VECTORS_DIRECTED, _i ? FORMAT_RGBA16F : FORMAT_RGBA32F, 0, 0};
    uint64_t first = VECTOR_SPECIALS * VECTOR_SPECIALS * VECTOR_SPECIALS;
    uint32_t hits[3][HITS] = {{0}};
    for (uint64_t i = first; i < vectors_count(&spec); i++) {
        vectors_make(&spec, i, 1, source, pixels);
        count_vector(spec.format, source[0], pixels, precisions[_i], hits);
    }
    for (int role = 0; role < 3; role++)
        for (int h = 0; h < HITS; h++)
            if (_i != 1 || h <= SUM_TIE || (h == ONE_MINUS_TIE && role))
                ck_assert_msg(hits[role][h] >= 500, "%s, factor %d: %s: %u, expected 500",
                              format_info(spec.format)->name, role, hit_names[h], hits[role][h]);
}
END_TEST

/* For every two neighbouring stored values a source on either side of their middle, within three
 * floats of it; of halves the middle itself, too. */
START_TEST(test_between)
{
    PixelFormat format = _i == 0 ? FORMAT_RGBA8 : _i == 1 ? FORMAT_RGBA16 : FORMAT_RGBA16F;
    VectorSpec spec = {VECTORS_DIRECTED, format, 0, 0};
    uint64_t at = VECTOR_SPECIALS * VECTOR_SPECIALS * VECTOR_SPECIALS;
    uint32_t max = format_info(format)->unorm_max, values = max ? max : 0x7bff;
    for (uint32_t k = 0; k < values; k++) {
        uint32_t below = 0, above = 0, middle = 0;
        for (int i = 0; i < 5; i++, at++) {
            vectors_make(&spec, at, 1, source, pixels);
            double low = max ? k : half_to_float((uint16_t)k);
            double high = max ? k + 1.0 : half_to_float((uint16_t)(k + 1));
            double x = (double)source[0][0] * (max ? max : 1.0), half = 0.5 * (low + high);
            ck_assert(fabs(x - half) <= fabs(half) * 0x1p-21);
            below += x < half;
            above += x > half;
            middle += x == half;
        }
        ck_assert_msg(below >= 2 && above >= 2 && (max || middle == 1), "value %u", k);
    }
}
END_TEST

/* Products of codes next to half-way between two codes, which is as near as they come. */
START_TEST(test_constructed_codes)
{
    VectorSpec spec = {VECTORS_DIRECTED, _i ? FORMAT_RGBA16 : FORMAT_RGBA8, 0, 0};
    uint32_t max = _i ? 65535 : 255, hits[3] = {0};
    uint64_t first = VECTOR_SPECIALS * VECTOR_SPECIALS * VECTOR_SPECIALS + 5 * (uint64_t)max;
    for (uint64_t i = first; i < vectors_count(&spec); i++) {
        vectors_make(&spec, i, 1, source, pixels);
        for (int c = 0; c < 3; c++) {
            uint64_t s = (uint64_t)lrint((double)source[0][c] * max);
            uint64_t alpha = (uint64_t)lrint((double)source[0][3] * max);
            uint64_t d = format_bits(spec.format, pixels, c),
                     t = format_bits(spec.format, pixels, 3);
            uint64_t products[3] = {s * t, s * alpha, d * (max - alpha)};
            for (int role = 0; role < 3; role++)
                hits[role] += products[role] % max - max / 2 < 2;
        }
    }
    for (int role = 0; role < 3; role++)
        ck_assert_uint_ge(hits[role], 10000);
}
END_TEST

/* ---- refusals ---- */

START_TEST(test_refused)
{
    VectorSpec spec = {VECTORS_EXHAUSTIVE, FORMAT_RGBA32F, 0, 0};
    ck_assert_int_eq(vectors_check(&spec), RESULT_BAD_INPUT);
    ck_assert_str_eq(result_message(), "exhaustive vectors of rgba32f: expected rgba8 or rgba16");
    spec = (VectorSpec){VECTORS_SEQUENCES, FORMAT_RG32F, 0, 1};
    ck_assert_int_eq(vectors_check(&spec), RESULT_BAD_INPUT);
    ck_assert_str_eq(result_message(), "sequences of rg32f: expected a format with alpha");
    spec = (VectorSpec){VECTORS_RANDOM, FORMAT_D24, 0, 1};
    ck_assert_int_eq(vectors_check(&spec), RESULT_BAD_INPUT);
    ck_assert_ptr_nonnull(strstr(result_message(), "vectors of d24: expected rgba8, rgba16"));
    spec = (VectorSpec){VECTORS_RANDOM, FORMAT_RGBA8, (uint64_t)1 << 53, 1};
    ck_assert_int_eq(vectors_check(&spec), RESULT_BAD_INPUT);
    spec.seed = VECTORS_NUMBER_MAX;
    ck_assert_int_eq(vectors_check(&spec), RESULT_OK);
    spec.count = (uint64_t)1 << 53;
    ck_assert_int_eq(vectors_check(&spec), RESULT_BAD_INPUT);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("vectors");
    TCase *tcase = tcase_create("vectors");
    tcase_set_timeout(tcase, 300);
    tcase_add_test(tcase, test_exhaustive);
    tcase_add_test(tcase, test_codes);
    tcase_add_test(tcase, test_golden);
    tcase_add_loop_test(tcase, test_parts, 0, FORMATS);
    tcase_add_loop_test(tcase, test_constructed, 0, 3);
    tcase_add_loop_test(tcase, test_between, 0, 3);
    tcase_add_loop_test(tcase, test_constructed_codes, 0, 2);
    tcase_add_test(tcase, test_refused);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
