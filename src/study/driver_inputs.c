#include "study/driver_inputs.h"

#include "number/op.h"

#include <math.h>
#include <string.h>

static const float specials[] = {
    0.0f,     -0.0f,   1.0f,     -1.0f,     0.5f,    2.0f,     INFINITY,    -INFINITY,
    NAN,      1e-40f,  -1e-40f,  0x1p-126f, 3.4e38f, 65504.0f, 65519.9f,    65520.0f,
    65536.0f, 6.1e-5f, 5.96e-8f, 2.98e-8f,  1e-30f,  32767.9f, 0.99999994f, 1.0000001f,
};

/* Either sign when signs is set. */
static float with_exponent(Random *random, int low, int high, bool signs)
{
    uint64_t bits = random_bits(random);
    uint32_t exponent = (uint32_t)(127 + low + (int)(bits >> 32) % (high - low + 1));
    uint32_t sign = signs ? (uint32_t)(bits >> 23 & 1) << 31 : 0;
    return op_from_bits(sign | exponent << 23 | ((uint32_t)bits & 0x7fffffu));
}

/* At a code or half-way to the next, and up to 8 ULP off. */
static float near_code(Random *random, double codes)
{
    uint64_t bits = random_bits(random);
    double code = (double)(bits % (uint64_t)(2.0 * codes + 1.0)) * 0.5;
    uint32_t exact = op_bits((float)(code / codes));
    uint32_t shift = (uint32_t)(bits >> 60);
    return op_from_bits(exact + shift < 8 ? exact : exact + shift - 8u);
}

float inputs_value(Random *random, InputSet set, double codes)
{
    switch (set) {
    case INPUT_UNIT:
        return (float)random_unit(random);
    case INPUT_SIGNED:
        return (float)random_range(random, -8.0, 8.0);
    case INPUT_WIDE:
        return with_exponent(random, -30, 29, true);
    case INPUT_POSITIVE:
        return with_exponent(random, -10, 9, false);
    case INPUT_DENORMAL: {
        uint32_t bits = (uint32_t)random_bits(random);
        return op_from_bits((bits & 0x80000000u) | (bits & 0x3ffffffu) >> (bits >> 27 & 3));
    }
    case INPUT_BITS:
        return op_from_bits((uint32_t)random_bits(random));
    case INPUT_CODES:
        return near_code(random, codes);
    default:
        break;
    }
    uint64_t pick = random_bits(random);
    size_t count = sizeof specials / sizeof *specials;
    return pick & 3 ? specials[(pick >> 2) % count] : (float)random_unit(random);
}

float inputs_bounded(PixelFormat format, float x)
{
    bool far = format == FORMAT_RGBA8 && (x >= 8e6f || x <= -8e6f);
    return !far ? x : x > 0.0f ? 1.5f : -1.5f;
}

/* ---- triangles ---- */

/* From pixels to clip space with w. */
static void place(float clip[4], double x, double y, double z, double w)
{
    clip[0] = (float)((2.0 * x / RASTER_WIDTH - 1.0) * w);
    clip[1] = (float)((2.0 * y / RASTER_HEIGHT - 1.0) * w);
    clip[2] = (float)(z * w);
    clip[3] = (float)w;
}

/* In [1/4, 16), every octave as often. */
static double random_w(Random *random)
{
    int exponent = (int)(random_bits(random) % 6) - 2;
    return ldexp(random_range(random, 1.0, 2.0), exponent);
}

static double area(const double x[3], const double y[3])
{
    return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
}

static void large(Random *random, double x[3], double y[3])
{
    do
        for (int i = 0; i < 3; i++) {
            x[i] = random_range(random, 1.0, RASTER_WIDTH - 1.0);
            y[i] = random_range(random, 1.0, RASTER_HEIGHT - 1.0);
        }
    while (fabs(area(x, y)) < 64.0);
}

/* A coordinate inside the window, rounded down to multiples of step. */
static double on_step(double value, double low, double high, double step)
{
    return floor(fmin(fmax(value, low), high) / step) * step;
}

/* Corners on multiples of half a pixel, moved by up to `off` times 1/512 of one. Every other
 * triangle is small, and every other one has a horizontal and a vertical edge, or nearly. */
static void on_grid(Random *random, int off, double x[3], double y[3])
{
    double reach = random_bits(random) & 1 ? 6.0 : 60.0;
    bool upright = random_bits(random) & 1;
    for (int i = 0; i < 3; i++) {
        double from_x = i ? x[0] + random_range(random, -reach, reach)
                          : random_range(random, 1.0, RASTER_WIDTH - 1.0);
        double from_y = i ? y[0] + random_range(random, -reach, reach)
                          : random_range(random, 1.0, RASTER_HEIGHT - 1.0);
        x[i] = on_step(upright && i == 2 ? x[0] : from_x, 1.0, RASTER_WIDTH - 1.0, 0.5);
        y[i] = on_step(upright && i == 1 ? y[0] : from_y, 1.0, RASTER_HEIGHT - 1.0, 0.5);
    }
    for (int i = 0; i < 3 && off; i++) {
        x[i] += (double)((int)(random_bits(random) % (uint64_t)(2 * off + 1)) - off) / 512.0;
        y[i] += (double)((int)(random_bits(random) % (uint64_t)(2 * off + 1)) - off) / 512.0;
    }
}

void inputs_triangle(Random *random, TriangleKind kind, float clip[3][4], float varying[3][4])
{
    double x[3], y[3];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++) {
            clip[i][k] = (float)random_range(random, -2.0, 2.0);
            varying[i][k] = (float)random_range(random, -8.0, 8.0);
        }
    if (kind == TRIANGLE_CLIPPED) {
        for (int i = 0; i < 3; i++)
            clip[i][3] = (float)random_range(random, -0.5, 2.0);
        return;
    }
    if (kind == TRIANGLE_HALF_PIXEL)
        on_grid(random, 0, x, y);
    else if (kind == TRIANGLE_SUBPIXEL)
        on_grid(random, 3, x, y);
    else
        large(random, x, y);
    for (int i = 0; i < 3; i++) {
        double w = kind == TRIANGLE_PERSPECTIVE ? random_w(random) : 1.0;
        place(clip[i], x[i], y[i], random_range(random, -1.0, 1.0), w);
    }
}

int inputs_grid(Random *random, float clip[][4])
{
    enum {
        SIDE = 24
    };
    float corners[SIDE + 1][SIDE + 1][4];
    bool perspective = random_bits(random) & 1;
    for (int j = 0; j <= SIDE; j++)
        for (int i = 0; i <= SIDE; i++) {
            bool inner_x = i > 0 && i<SIDE, inner_y = j> 0 && j < SIDE;
            double x = i + (inner_x ? random_range(random, -0.2, 0.2) : 0.0);
            double y = j + (inner_y ? random_range(random, -0.2, 0.2) : 0.0);
            double w = perspective ? random_w(random) : 1.0;
            place(corners[j][i], x * RASTER_WIDTH / SIDE, y * RASTER_HEIGHT / SIDE, 0.0, w);
            if (!inner_x) /* exactly on the border */
                corners[j][i][0] = i ? corners[j][i][3] : -corners[j][i][3];
            if (!inner_y)
                corners[j][i][1] = j ? corners[j][i][3] : -corners[j][i][3];
        }
    int count = 0;
    for (int j = 0; j < SIDE; j++)
        for (int i = 0; i < SIDE; i++) {
            const float *quad[] = {corners[j][i], corners[j][i + 1], corners[j + 1][i + 1],
                                   corners[j + 1][i]};
            static const int order[2][6] = {{0, 1, 2, 0, 2, 3}, {0, 1, 3, 3, 1, 2}};
            const int *pick = order[random_bits(random) & 1];
            for (int k = 0; k < 6; k++)
                memcpy(clip[3 * count + k], quad[pick[k]], 4 * sizeof(float));
            count += 2;
        }
    return count;
}

int inputs_complexity(float x)
{
    uint32_t bits = op_bits(x), mantissa = bits & 0x7fffffu, exponent = bits >> 23 & 255u;
    int significant = mantissa ? 24 - __builtin_ctz(mantissa) : 1;
    int away = (int)exponent - 127;
    return exponent == 0 && mantissa == 0 ? 0 : significant + (away < 0 ? -away : away) / 4;
}
