#include "compare/judge.h"

#include <math.h>
#include <string.h>

/* An edge's pixel may lie outside its neighbours' values by this share of their range. */
#define EDGE_MARGIN 0.1
enum {
    EDGES_PER = 100,    /* one in so many occupied pixels may be at an edge */
    BEYOND_PER = 10000, /* and beyond */
    BEYOND_FEW = 4
};

typedef enum Class {
    CLASS_EQUAL = 0,
    CLASS_STORED,
    CLASS_WITHIN,
    CLASS_EDGE,
    CLASS_BEYOND
} Class;

typedef struct Judging {
    const JudgeDesc *desc;
    Image expected; /* the reference as their encoding has it */
    JudgeFigures *out;
    Class worst_class;
    double worst_size, sum2;
    double sums[5]; /* of theirs, the reference's, their squares, their product */
    uint64_t finite;
} Judging;

static float at(const Image *image, size_t pixel, int channel)
{
    return ((const float *)image->pixels)[4 * pixel + (size_t)channel];
}

static GivenEncoding encoding_of(const JudgeDesc *desc, int channel)
{
    return channel < 3 ? desc->encoding : GIVEN_LINEAR;
}

/* What storing on both sides may do to a value. */
static double quantum_of(const JudgeDesc *desc, double theirs, double expected)
{
    double quantum = given_quantum(desc->format, theirs);
    if (desc->reference_format != desc->format)
        quantum += given_quantum(desc->reference_format, expected);
    return quantum * (1.0 + 1e-6);
}

static bool is_equal(const JudgeDesc *desc, size_t pixel, int channel, float theirs)
{
    if (desc->display && desc->encoding == GIVEN_SEED && desc->format == FORMAT_RGBA8 &&
        channel < 3) {
        uint8_t code = ((const uint8_t *)desc->display->pixels)[4 * pixel + (size_t)channel];
        return lrintf(theirs * 255.0f) == code;
    }
    return encoding_of(desc, channel) == GIVEN_LINEAR &&
           ulp_distance(theirs, at(desc->reference, pixel, channel)) == 0;
}

/* How far the reference may be off: from which linear value by how much. */
static double slack_of(const JudgeDesc *desc, size_t pixel, int channel, double *center)
{
    *center = (double)at(desc->reference, pixel, channel);
    if (desc->center && isfinite(at(desc->slack, pixel, channel))) {
        *center = (double)at(desc->center, pixel, channel);
        return (double)at(desc->slack, pixel, channel);
    }
    return desc->tolerance * fmax(1.0, fabs(*center));
}

static bool is_within(const JudgeDesc *desc, size_t pixel, int channel, double theirs,
                      double quantum)
{
    double center, slack = slack_of(desc, pixel, channel, &center);
    GivenEncoding encoding = encoding_of(desc, channel);
    return theirs >= given_stored_value(desc->format, encoding, center - slack) - quantum &&
           theirs <= given_stored_value(desc->format, encoding, center + slack) + quantum;
}

static Class classify(const Judging *judging, size_t pixel, int channel)
{
    const JudgeDesc *desc = judging->desc;
    float theirs = at(desc->theirs, pixel, channel);
    double expected = (double)at(&judging->expected, pixel, channel);
    if (is_equal(desc, pixel, channel, theirs))
        return CLASS_EQUAL;
    double quantum = quantum_of(desc, (double)theirs, expected);
    if (fabs((double)theirs - expected) <= quantum)
        return CLASS_STORED;
    return is_within(desc, pixel, channel, (double)theirs, quantum) ? CLASS_WITHIN : CLASS_BEYOND;
}

/* Whether all channels are between what the reference has around the pixel. */
static bool is_edge(const Judging *judging, int x, int y)
{
    const Image *expected = &judging->expected;
    size_t width = (size_t)expected->width, pixel = (size_t)y * width + (size_t)x;
    for (int c = 0; c < judging->desc->channels; c++) {
        double low = INFINITY, high = -INFINITY;
        for (int j = y > 0 ? y - 1 : y; j <= y + 1 && j < expected->height; j++)
            for (int i = x > 0 ? x - 1 : x; i <= x + 1 && i < expected->width; i++) {
                double value = (double)at(expected, (size_t)j * width + (size_t)i, c);
                low = fmin(low, value);
                high = fmax(high, value);
            }
        double theirs = (double)at(judging->desc->theirs, pixel, c);
        double margin = EDGE_MARGIN * (high - low) + quantum_of(judging->desc, theirs, high) +
                        judging->desc->tolerance;
        if (!(theirs >= low - margin && theirs <= high + margin))
            return false;
    }
    return true;
}

static double steps_between(PixelFormat format, float a, float b)
{
    const FormatInfo *info = format_info(format);
    if (isnan(a) || isnan(b))
        return -1.0;
    if (info->kind == KIND_HALF)
        return (double)ulp_distance_half(half_from_float(a), half_from_float(b));
    if (info->kind == KIND_UNORM)
        return fabs((double)a - (double)b) * (double)info->unorm_max;
    return (double)ulp_distance(a, b);
}

static void fold_worst(Judging *judging, Class class, size_t pixel, int channel)
{
    const JudgeDesc *desc = judging->desc;
    float theirs = at(desc->theirs, pixel, channel),
          expected = at(&judging->expected, pixel, channel);
    double size = fabs((double)theirs - (double)expected);
    if (isnan(size))
        size = INFINITY;
    if (class < judging->worst_class ||
        (class == judging->worst_class && judging->out->worst.is && size <= judging->worst_size))
        return;
    judging->worst_class = class;
    judging->worst_size = size;
    judging->out->worst = (JudgeWorst){
        .is = true,
        .x = (int)(pixel % (size_t)desc->theirs->width),
        .y = (int)(pixel / (size_t)desc->theirs->width),
        .channel = channel,
        .theirs = (double)theirs,
        .reference = (double)expected,
        .ulp = steps_between(desc->format, theirs, expected),
    };
}

/* Folds the pixel's values into the averages: equal ones differ by nothing, whatever rounding the
 * reference's own display shares with them. Returns whether all of theirs are finite. */
static bool fold_values(Judging *judging, size_t pixel, bool equal)
{
    int channels = judging->desc->channels, colors = channels < 3 ? channels : 3;
    double theirs = 0.0, expected = 0.0;
    bool finite = true, comparable = true;
    for (int c = 0; c < channels; c++) {
        double a = (double)at(judging->desc->theirs, pixel, c);
        double b = (double)at(&judging->expected, pixel, c);
        finite = finite && (isfinite(a) || !isfinite(b));
        comparable = comparable && isfinite(a) && isfinite(b);
        theirs += c < colors ? a : 0.0;
        expected += c < colors ? b : 0.0;
    }
    if (!comparable)
        return finite;
    for (int c = 0; c < channels && !equal; c++) {
        double d = fabs((double)at(judging->desc->theirs, pixel, c) -
                        (double)at(&judging->expected, pixel, c));
        judging->sum2 += d * d;
        judging->out->max_abs = fmax(judging->out->max_abs, d);
    }
    const double terms[5] = {theirs, expected, theirs * theirs, expected * expected,
                             theirs * expected};
    for (int i = 0; i < 5; i++)
        judging->sums[i] += terms[i];
    judging->finite++;
    return true;
}

static void judge_pixel(Judging *judging, int x, int y)
{
    const JudgeDesc *desc = judging->desc;
    JudgeFigures *out = judging->out;
    size_t pixel = (size_t)y * (size_t)desc->theirs->width + (size_t)x;
    Class classes[4], worst = CLASS_EQUAL;
    for (int c = 0; c < desc->channels; c++) {
        classes[c] = classify(judging, pixel, c);
        worst = classes[c] > worst ? classes[c] : worst;
    }
    bool finite = fold_values(judging, pixel, worst == CLASS_EQUAL);
    if (worst == CLASS_BEYOND && finite && is_edge(judging, x, y))
        worst = CLASS_EDGE;
    out->nonfinite += !finite;
    uint64_t *const counts[] = {&out->equal, &out->stored, &out->within, &out->edge, &out->beyond};
    ++*counts[worst];
    for (int c = 0; c < desc->channels && worst > CLASS_EQUAL; c++)
        if (classes[c] > CLASS_EQUAL)
            fold_worst(judging, worst, pixel, c);
}

/* The reference in their encoding; what is not compared is left 0. */
static Result encode(Judging *judging)
{
    const JudgeDesc *desc = judging->desc;
    Result result = image_create(desc->reference->width, desc->reference->height, FORMAT_RGBA32F,
                                 &judging->expected);
    if (result != RESULT_OK)
        return result;
    float *out = judging->expected.pixels;
    for (size_t i = 0; i < judging->out->pixels; i++)
        for (int c = 0; c < desc->channels; c++)
            out[4 * i + (size_t)c] = (float)given_stored_value(desc->format, encoding_of(desc, c),
                                                               (double)at(desc->reference, i, c));
    return RESULT_OK;
}

/* Pixels unlike the top left one in a channel: the others are taken for background. */
static uint64_t count_occupied(const Image *reference, uint64_t pixels)
{
    uint64_t count = 0;
    const char *first = reference->pixels;
    for (uint64_t i = 0; i < pixels; i++)
        count += memcmp(first + i * sizeof(float[4]), first, sizeof(float[4])) != 0;
    return count ? count : pixels;
}

static double correlation(const Judging *judging)
{
    const double *s = judging->sums, n = (double)judging->finite;
    double a = n * s[2] - s[0] * s[0], b = n * s[3] - s[1] * s[1];
    if (!(a > 1e-12 * n * s[2]) || !(b > 1e-12 * n * s[3]))
        return 1.0;
    return (n * s[4] - s[0] * s[1]) / sqrt(a * b);
}

Result judge(const JudgeDesc *desc, JudgeFigures *out)
{
    int width = desc->reference->width, height = desc->reference->height;
    *out = (JudgeFigures){.pixels = (uint64_t)width * (uint64_t)height};
    Judging judging = {.desc = desc, .out = out};
    if (desc->theirs->width != width || desc->theirs->height != height)
        return result_fail(RESULT_INTERNAL, "judge: expected images of one size");
    Result result = encode(&judging);
    if (result != RESULT_OK)
        return result;
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            judge_pixel(&judging, x, y);
    image_free(&judging.expected);
    out->occupied = count_occupied(desc->reference, out->pixels);
    if (judging.finite)
        out->rmse = sqrt(judging.sum2 / ((double)judging.finite * desc->channels));
    out->correlation = correlation(&judging);
    uint64_t beyond = out->occupied / BEYOND_PER, few = out->occupied / EDGES_PER;
    if (beyond < BEYOND_FEW)
        beyond = few < BEYOND_FEW ? few : BEYOND_FEW;
    out->agree =
        out->edge <= out->occupied / EDGES_PER && out->beyond <= beyond && out->nonfinite == 0;
    return RESULT_OK;
}
