/* Constructed vectors of the directed set: cases that chance does not hit.
 *
 * Every channel of a float vector is x·f with an addend. What f is goes round, so that each
 * equation meets the cases: the destination's alpha (under: x is the source), the source's alpha (x
 * is the source) and 1 less the source's alpha (over: x is the destination). */
#include "blend/vector_values.h"
#include "number/op.h"

#include <math.h>
#include <string.h>

typedef enum Section {
    SECTION_BETWEEN = 0, /* sources at and next to the middle of two stored values */
    SECTION_PRODUCT_TIE, /* the product is half-way between two values */
    SECTION_PRODUCT_NEAR,
    SECTION_SUM_TIE, /* the product is exact, the sum half-way or next to there */
    SECTION_CANCEL,
    SECTION_TINY, /* products at the ends of the denormal range */
    SECTION_HUGE, /* sums at the greatest value */
    SECTION_ONE_MINUS,
    SECTION_COUNT
} Section;

enum {
    SECTION_SIZE = 8192, /* vectors of each but the first */
    BETWEEN_OFFSETS = 5, /* floats on either side of a middle: −2 … 2 */
    HALF_VALUES = 0x7bff /* positive halves below the greatest */
};

static uint64_t between_count(PixelFormat format)
{
    const FormatInfo *info = format_info(format);
    uint64_t values = info->kind == KIND_UNORM  ? info->unorm_max
                      : info->kind == KIND_HALF ? HALF_VALUES
                                                : 0;
    return values * BETWEEN_OFFSETS;
}

uint64_t vector_values_constructed(PixelFormat format)
{
    int sections = format_info(format)->kind == KIND_UNORM ? 2 : SECTION_COUNT - 1;
    return between_count(format) + (uint64_t)sections * SECTION_SIZE;
}

/* ---- between stored values ----------------------------------------------------------------- */

/* Half-way from stored value k to the next, as near as a float can be, and `offset` floats on. */
static float between(PixelFormat format, uint32_t k, int offset)
{
    const FormatInfo *info = format_info(format);
    float middle;
    if (info->kind == KIND_HALF)
        middle = 0.5f * (half_to_float((uint16_t)k) + half_to_float((uint16_t)(k + 1)));
    else
        middle = (float)((k + 0.5) / info->unorm_max);
    return op_from_bits(op_bits(middle) + (uint32_t)offset);
}

static void construct_between(PixelFormat format, uint64_t i, Vector *out)
{
    int offset = (int)(i % BETWEEN_OFFSETS) - BETWEEN_OFFSETS / 2;
    uint32_t k = (uint32_t)(i / BETWEEN_OFFSETS), one = vector_values_bits(format, 1.0f);
    out->source[0] = between(format, k, offset);
    out->source[1] = format_info(format)->kind == KIND_HALF
                         ? -out->source[0]
                         : op_from_bits(op_bits(vector_values_unorm(format, k + 1)) +
                                        (uint32_t)offset); /* a code: truncation falls below it */
    out->source[2] = op_from_bits(op_bits(out->source[0]) + (offset < 0 ? -40u : 40u));
    out->source[3] = out->source[0];
    for (int c = 0; c < 3; c++)
        out->destination[c] = i % 3 == 2 ? one / 3 : 0;
    out->destination[3] = one;
}

/* ---- integers ------------------------------------------------------------------------------ */

static int bit_length(uint64_t x)
{
    return 64 - __builtin_clzll(x | 1);
}

/* An odd number of so many bits; bits ≥ 2. */
static uint64_t odd(Random *random, int bits)
{
    uint64_t mask = ((uint64_t)1 << bits) - 1;
    return (random_bits(random) & mask) | (uint64_t)1 << (bits - 1) | 1;
}

/* The inverse of an odd number modulo 2^64. Each step of Newton's doubles its right bits, of which
 * x itself has 3. */
static uint64_t inverse(uint64_t x)
{
    uint64_t y = x;
    for (int i = 0; i < 5; i++)
        y *= 2 - x * y;
    return y;
}

/* An X of at most `bits` bits for which X·F, without its first `keep` bits, is a tie: F is odd. */
static uint64_t tie_factor(Random *random, uint64_t f, int bits, int keep)
{
    int width = keep + 1 - bit_length(f);
    if (width > bits)
        width = bits;
    if (width < 2)
        width = 2;
    uint64_t x = odd(random, width);
    for (int i = 0; i < 64 && bit_length(x * f) != keep + 1; i++)
        x = odd(random, width < bits && i % 2 ? width + 1 : width);
    return x;
}

/* The same, but one unit of the exact product beside a tie or beside a value. */
static uint64_t near_factor(Random *random, uint64_t f, int bits, int keep)
{
    for (int i = 0; i < 256; i++) {
        int rest = bits + bit_length(f) - keep - (int)(random_bits(random) & 1);
        if (rest < 2 || rest > bits)
            break;
        uint64_t choice = random_bits(random), mask = ((uint64_t)1 << rest) - 1;
        uint64_t target = (choice & 2 ? (uint64_t)1 << (rest - 1) : 0) + (choice & 1 ? 1 : mask);
        uint64_t x = (target * inverse(f) & mask) | (odd(random, bits) & ~mask);
        if (bit_length(x * f) == keep + rest)
            return x;
    }
    return tie_factor(random, f, bits, keep);
}

/* ---- floats and halves ----------------------------------------------------------------------- */

typedef struct Case {
    PixelFormat format;
    Section section;
    Random random;
    int keep;           /* bits that the rounding in question keeps: 24, or 11 of halves */
    int stored;         /* bits of a stored number */
    uint64_t factor[2]; /* odd integers: dA and sA of factor·2^-bits, or 1 − sA */
    double f[2];        /* their values */
    bool complement;    /* the second is 1 − sA */
} Case;

static double power(Random *random, int low, int high)
{
    return ldexp(1.0, low + (int)(random_bits(random) % (uint64_t)(high - low + 1)));
}

static double sign(Random *random)
{
    return random_bits(random) % 4 ? 1.0 : -1.0;
}

/* How many bits the factors have, so that the other factor has enough for what is wanted. */
static void choose_factors(Case *work)
{
    bool half = work->stored == 11, near = work->section == SECTION_PRODUCT_NEAR;
    int bits[2] = {12, 12};
    if (half && work->keep == 11)
        bits[0] = bits[1] = near ? 11 : 6;
    else if (half)
        bits[0] = 11, bits[1] = near ? 22 : 14;
    else if (near)
        bits[0] = bits[1] = 24;
    if (work->section == SECTION_SUM_TIE)
        bits[0] = bits[1] = 3;
    for (int i = 0; i < 2; i++) {
        work->factor[i] = odd(&work->random, bits[i]);
        work->f[i] = ldexp((double)work->factor[i], -bits[i]);
    }
}

/* x, of at most `bits` bits, for factor number `which`; *addend: what goes with it. */
static double choose_tie(Case *work, int which, int bits, double *addend)
{
    uint64_t f = work->factor[which];
    int keep = work->keep;
    uint64_t x = work->section == SECTION_PRODUCT_TIE ? tie_factor(&work->random, f, bits, keep)
                                                      : near_factor(&work->random, f, bits, keep);
    double scale = power(&work->random, -5, 3) * ldexp(1.0, -bit_length(x));
    *addend =
        random_bits(&work->random) & 1 ? 0.0 : sign(&work->random) * power(&work->random, -6, 4);
    return sign(&work->random) * (double)x * scale;
}

/* x·f ends at half a unit of the addend's last place, or below. */
static double choose_sum_tie(Case *work, int which, int bits, double *addend)
{
    Random *random = &work->random;
    int below = random_bits(random) & 1 ? 0 : 1 + (int)(random_bits(random) % 3);
    uint64_t f = work->factor[which], mask = ((uint64_t)2 << below) - 1;
    uint64_t half = (uint64_t)1 << below;
    uint64_t target = below ? half + (random_bits(random) & 1 ? 1 : mask) : half;
    uint64_t x =
        (target * inverse(f) & mask) | (random_bits(random) & ((1u << (bits - 4)) - 1) & ~mask);
    int width = work->stored == 11 && work->keep == 24 ? 11 : work->keep;
    int exponent = (int)(random_bits(random) % 5) - 2;
    uint64_t kept = odd(random, width) - (random_bits(random) & 1);
    *addend = sign(random) * ldexp((double)kept, exponent - width);
    int last = exponent - work->keep - 1 - below; /* of x·F */
    return ldexp((double)x, last) * ((double)f / work->f[which]);
}

static double choose_cancel(Case *work, int which, double *addend)
{
    Random *random = &work->random;
    double x = sign(random) * random_range(random, 1.0, 2.0) * power(random, -3, 3);
    x = work->stored == 11 ? half_to_float(half_from_float((float)x)) : (float)x;
    float product = (float)(x * work->f[which]);
    int off = (int)(random_bits(random) % 5) - 2;
    if (work->stored == 11) /* of the sum that is stored, or of the float sum */
        *addend = -half_to_float((uint16_t)(half_from_float(product) + off));
    else
        *addend = -op_from_bits(op_bits(product) + (uint32_t)off);
    return x;
}

static double choose_tiny(Case *work, int which, double *addend)
{
    static const double floats[] = {0x1p-126, 0x1p-126 - 0x1p-150, 0x1p-149,
                                    0x1p-150, 0x1.8p-149,          0x1.4p-147};
    static const double halves[] = {0x1p-14, 0x1p-14 - 0x1p-25, 0x1p-24,
                                    0x1p-25, 0x1.8p-24,         0x1.4p-22};
    Random *random = &work->random;
    uint64_t pick = random_bits(random);
    double target = (work->stored == 11 ? halves : floats)[pick % 6];
    float x = (float)(target / work->f[which]);
    *addend = pick & 0x700 ? 0.0 : sign(random) * target * (double)(pick >> 16 & 3);
    return sign(random) * (double)op_from_bits(op_bits(x) + (uint32_t)(pick >> 32) % 3 - 1);
}

static double choose_huge(Case *work, int which, double *addend)
{
    static const double floats[] = {0x1.fffffep+127, 0x1.ffffffp+127, 0x1.fffffefp+127, 0x1p+128};
    static const double halves[] = {65504.0, 65520.0, 65519.99609375, 65536.0};
    Random *random = &work->random;
    uint64_t pick = random_bits(random);
    double target = (work->stored == 11 ? halves : floats)[pick % 4] * sign(random);
    double part = pick & 0x300 ? random_range(random, 0.25, 0.75) : 1.0;
    float x = (float)(target * part / work->f[which]);
    x = op_from_bits(op_bits(x) + (uint32_t)(pick >> 32) % 3 - 1);
    *addend = part == 1.0 ? 0.0 : (float)(target - (double)x * work->f[which]);
    return x;
}

static double choose(Case *work, int which, int bits, double *addend)
{
    switch (work->section) {
    case SECTION_PRODUCT_TIE:
    case SECTION_PRODUCT_NEAR:
        return choose_tie(work, which, bits, addend);
    case SECTION_SUM_TIE:
        return choose_sum_tie(work, which, bits, addend);
    case SECTION_CANCEL:
        return choose_cancel(work, which, addend);
    case SECTION_TINY:
        return choose_tiny(work, which, addend);
    case SECTION_HUGE:
        return choose_huge(work, which, addend);
    default:
        *addend = random_unit(&work->random);
        return random_unit(&work->random);
    }
}

/* Alphas for which 1 − alpha is half-way between two values, or one unit beside. */
static double one_minus_tie(Case *work)
{
    Random *random = &work->random;
    uint64_t pick = random_bits(random);
    int bits = pick & 1 ? work->keep : 24;
    double a = ldexp((double)odd(random, 2 + (int)((pick >> 8) % (uint64_t)(work->stored - 2))),
                     -bits - 1);
    if (pick & 2)
        a += pick & 4 ? ldexp(a, -22) : -ldexp(a, -22);
    return pick & 24 ? a : -2.0 * a;
}

static void choose_alphas(Case *work)
{
    Random *random = &work->random;
    choose_factors(work);
    for (int i = 0; i < 2; i++) {
        if (work->section == SECTION_CANCEL || work->section == SECTION_TINY)
            work->f[i] = (float)random_range(random, 0.5, 1.0);
        if (work->section == SECTION_HUGE)
            work->f[i] = (float)random_range(random, 1.0, 2.0);
        if (work->section == SECTION_ONE_MINUS)
            work->f[i] = (float)one_minus_tie(work);
    }
    if (work->stored == 11)
        work->f[0] = half_to_float(half_from_float((float)work->f[0]));
    /* 1 less a float between 1/2 and 2 is exact; f[1] is what the blend then multiplies by. */
    work->complement = work->section != SECTION_ONE_MINUS && random_bits(random) & 1;
}

static void construct_float(PixelFormat format, Section section, uint64_t i, Vector *out)
{
    bool half = format_info(format)->kind == KIND_HALF;
    Case work = {.format = format, .section = section, .stored = half ? 11 : 24};
    work.random = random_seed((uint64_t)section << 32 ^ i);
    random_bits(&work.random);
    work.keep = half && i & 1 ? 11 : 24;
    choose_alphas(&work);
    out->source[3] = (float)(work.complement ? 1.0 - work.f[1] : work.f[1]);
    out->destination[3] = vector_values_bits(format, (float)work.f[0]);
    for (int c = 0; c < 3; c++) {
        int turn = (int)((i / 2 + (uint64_t)c) % 3), which = turn > 0;
        double addend;
        bool destination = which && work.complement;
        double x = choose(&work, which, destination ? work.stored : work.keep, &addend);
        out->source[c] = (float)(destination ? addend : x);
        out->destination[c] = vector_values_bits(format, (float)(destination ? x : addend));
    }
}

/* ---- codes ----------------------------------------------------------------------------------- */

/* A code whose product with f is just below or above half-way between two codes: ab mod max is
 * (max − 1)/2 or (max + 1)/2. f has no factor in common with max. */
static uint32_t half_way_code(uint32_t max, uint32_t f, bool above)
{
    int64_t a = max, b = f, u = 0, v = 1; /* v·f ≡ b modulo max */
    while (b > 1) {
        int64_t q = a / b, rest = a - q * b, next = u - q * v;
        a = b;
        b = rest;
        u = v;
        v = next;
    }
    uint64_t inverted = (uint64_t)(v < 0 ? v + max : v);
    return (uint32_t)(inverted * ((max + (above ? 1u : 0u)) / 2) % max);
}

static uint32_t coprime(Random *random, uint32_t max)
{
    uint32_t f;
    do
        f = 1 + (uint32_t)(random_bits(random) % (max - 1));
    while (f % 3 == 0 || f % 5 == 0 || f % 17 == 0 || f % 257 == 0); /* 65535's; 255 has three */
    return f;
}

static void construct_code(PixelFormat format, Section section, uint64_t i, Vector *out)
{
    uint32_t max = format_info(format)->unorm_max;
    Random random = random_seed((uint64_t)section << 32 ^ i);
    random_bits(&random);
    uint32_t transmittance = coprime(&random, max), keep = coprime(&random, max);
    uint32_t alpha = random_bits(&random) & 1 ? max - keep : keep;
    out->source[3] = vector_values_unorm(format, alpha);
    out->destination[3] = transmittance;
    for (int c = 0; c < 3; c++) {
        bool above = random_bits(&random) & 1, over = (i + (uint64_t)c) % 3 > 0;
        uint32_t product = half_way_code(max, over ? keep : transmittance, above);
        uint32_t other = (uint32_t)(random_bits(&random) % (max + 1));
        if (section == SECTION_PRODUCT_TIE)
            other = 0;
        bool destination = over && alpha != keep;
        out->source[c] = vector_values_unorm(format, destination ? other : product);
        out->destination[c] = destination ? product : other;
    }
}

void vector_values_construct(PixelFormat format, uint64_t i, Vector *out)
{
    uint64_t first = between_count(format);
    if (i < first) {
        construct_between(format, i, out);
        return;
    }
    i -= first;
    Section section = (Section)(1 + i / SECTION_SIZE);
    if (format_info(format)->kind == KIND_UNORM)
        construct_code(format, section, i % SECTION_SIZE, out);
    else
        construct_float(format, section, i % SECTION_SIZE, out);
}
