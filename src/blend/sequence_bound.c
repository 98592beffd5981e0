/* The bound in which every sane arithmetic ends; its derivation is in sequence.h. */
#include "blend/sequence.h"
#include "blend/vector_values.h"

#include <math.h>

/* Values at least 0, both ends numbers of what is worked with. */
typedef struct Interval {
    double low, high;
} Interval;

/* The numbers that are worked with. */
typedef struct Grid {
    int digits, least; /* significant bits, and the exponent of the least normal number */
} Grid;

static const Grid floats = {24, -126}, halves = {11, -14};

static double unit_at(const Grid *grid, double x)
{
    int exponent;
    frexp(x, &exponent); /* x in [1/2, 1)·2^exponent */
    exponent = exponent - 1 < grid->least ? grid->least : exponent - 1;
    return ldexp(1.0, exponent - grid->digits + 1);
}

/* The neighbours of the real numbers `low` and `high`. What is below the least normal number may
 * have been flushed. */
static Interval faithful(const Grid *grid, double low, double high)
{
    double below = unit_at(grid, low), above = unit_at(grid, high);
    Interval out = {floor(low / below) * below, ceil(high / above) * above};
    if (out.low < ldexp(1.0, grid->least))
        out.low = 0.0;
    return out;
}

/* x + y, less (or more) what double's rounding made it too great (or too small). */
static double sum(double x, double y, double toward)
{
    double total = x + y, recovered = total - x;
    double error = (x - (total - recovered)) + (y - recovered);
    bool passed = toward > total ? error > 0.0 : error < 0.0;
    return passed ? nextafter(total, toward) : total;
}

static Interval add(const Grid *grid, Interval x, Interval y)
{
    return faithful(grid, sum(x.low, y.low, 0.0), sum(x.high, y.high, INFINITY));
}

/* Exact in double: numbers of a grid have at most 24 bits, and codes 16. */
static Interval multiply(const Grid *grid, Interval x, Interval y)
{
    return faithful(grid, x.low * y.low, x.high * y.high);
}

static Interval one_minus(const Grid *grid, Interval a)
{
    return faithful(grid, sum(1.0, -a.high, 0.0), sum(1.0, -a.low, INFINITY));
}

/* A quotient of integers below 2^32, which double rounds: only one that is an integer, as of 0 and
 * the greatest code, is certain to be exact. */
static Interval fetch(const Grid *grid, Interval code, uint32_t max)
{
    double low = code.low / max, high = code.high / max;
    return faithful(grid, low == floor(low) ? low : nextafter(low, 0.0),
                    high == floor(high) ? high : nextafter(high, 1.0));
}

static Interval store(const Grid *grid, Interval x, uint32_t max)
{
    Interval code = faithful(grid, x.low * max, x.high * max);
    return (Interval){fmin(floor(code.low), max), fmin(ceil(code.high), max)};
}

/* The source as it is, or as it is stored first; what a float format stores it as is itself. */
static Interval source_of(const Grid *grid, double x)
{
    return faithful(grid, x, x);
}

/* A float next to a code is stored as it, or toward zero as the one below. */
static Interval source_code(PixelFormat format, double x)
{
    double code = vector_values_bits(format, (float)x);
    return (Interval){fmin(code, floor(x * format_info(format)->unorm_max)), code};
}

static Interval hull(Interval x, Interval y)
{
    return (Interval){fmin(x.low, y.low), fmax(x.high, y.high)};
}

/* One layer on the grid's numbers. */
static void blend(const Grid *grid, const Interval source[4], Interval pixel[4])
{
    for (int c = 0; c < 3; c++)
        pixel[c] = add(grid, pixel[c], multiply(grid, source[c], pixel[3]));
    pixel[3] = multiply(grid, pixel[3], one_minus(grid, source[3]));
}

/* a·b / max of codes. */
static Interval multiply_codes(Interval a, Interval b, uint32_t max)
{
    return (Interval){floor(a.low * b.low / max), ceil(a.high * b.high / max)};
}

/* One layer on codes, all at once or each fetched into the grid, blended there and stored. */
static void blend_codes(const Grid *grid, uint32_t max, const Interval source[4], Interval pixel[4])
{
    Interval fetched[2][4];
    for (int c = 0; c < 4; c++) {
        fetched[0][c] = fetch(grid, source[c], max);
        fetched[1][c] = fetch(grid, pixel[c], max);
    }
    blend(grid, fetched[0], fetched[1]);
    Interval keep = {max - source[3].high, max - source[3].low}, transmittance = pixel[3];
    for (int c = 0; c < 4; c++) {
        Interval product = c < 3 ? multiply_codes(source[c], transmittance, max)
                                 : multiply_codes(transmittance, keep, max);
        Interval before = c < 3 ? pixel[c] : (Interval){0.0, 0.0};
        Interval codes = {fmin(before.low + product.low, max),
                          fmin(before.high + product.high, max)};
        pixel[c] = hull(codes, store(grid, fetched[1][c], max));
    }
}

void sequence_bound(PixelFormat format, int layers, const float (*source)[4], double low[4],
                    double high[4])
{
    uint32_t max = format_info(format)->unorm_max;
    bool coarse = format == FORMAT_RGBA16F || format == FORMAT_RGBA8;
    const Grid *grid = coarse ? &halves : &floats;
    double one = max ? max : 1.0;
    Interval pixel[4] = {{0, 0}, {0, 0}, {0, 0}, {one, one}};
    for (int i = 0; i < layers; i++) {
        Interval operand[4];
        for (int c = 0; c < 4; c++) {
            double x = (double)source[i][c];
            operand[c] = max ? source_code(format, x) : source_of(grid, x);
        }
        if (max)
            blend_codes(grid, max, operand, pixel);
        else
            blend(grid, operand, pixel);
    }
    for (int c = 0; c < 4; c++) {
        low[c] = pixel[c].low;
        high[c] = pixel[c].high;
    }
}

bool sequence_inside(PixelFormat format, const void *pixel, int c, const double low[4],
                     const double high[4])
{
    uint32_t bits = format_bits(format, pixel, c);
    bool codes = format_info(format)->kind == KIND_UNORM;
    double value = codes ? (double)bits : (double)format_channel(format, pixel, c);
    return low[c] <= value && value <= high[c];
}
