#include "compare/metrics.h"

#include "base/memory.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static void fold_value(BufferMetrics *metrics, PixelFormat format, const unsigned char *a,
                       const unsigned char *b, int x, int y, int channel)
{
    const FormatInfo *info = format_info(format);
    uint32_t ulp =
        format_ulp(info->kind, format_bits(format, a, channel), format_bits(format, b, channel));
    if (ulp == 0)
        return;
    metrics->differing++;
    if (ulp > metrics->max_ulp)
        metrics->max_ulp = ulp;
    double difference = fabs((double)format_channel(format, a, channel) -
                             (double)format_channel(format, b, channel));
    if (difference > metrics->max_abs) /* false for NaN, which max_ulp shows */
        metrics->max_abs = difference;
    if (!metrics->has_first) {
        metrics->has_first = true;
        metrics->first[0] = x;
        metrics->first[1] = y;
        metrics->first[2] = channel;
    }
}

void metrics_buffer(BufferMetrics *metrics, PixelFormat format, int x, int y, int width, int height,
                    const void *a, size_t a_row_bytes, const void *b, size_t b_row_bytes)
{
    int channels = format_info(format)->channels;
    size_t pixel_bytes = format_pixel_bytes(format), row_bytes = (size_t)width * pixel_bytes;
    metrics->values += (uint64_t)width * (uint64_t)height * (uint64_t)channels;
    for (int row = 0; row < height; row++) {
        const unsigned char *row_a = (const unsigned char *)a + (size_t)row * a_row_bytes;
        const unsigned char *row_b = (const unsigned char *)b + (size_t)row * b_row_bytes;
        if (memcmp(row_a, row_b, row_bytes) == 0)
            continue;
        for (int column = 0; column < width; column++)
            for (int channel = 0; channel < channels; channel++)
                fold_value(metrics, format, row_a + (size_t)column * pixel_bytes,
                           row_b + (size_t)column * pixel_bytes, x + column, y + row, channel);
    }
}

static bool is_finite4(const float *p)
{
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]) && isfinite(p[3]);
}

void metrics_final(const Image *a, const Image *b, FinalMetrics *out)
{
    *out = (FinalMetrics){.pixels = (uint64_t)a->width * (uint64_t)a->height};
    const float *pa = a->pixels, *pb = b->pixels;
    double sum = 0.0, sum2 = 0.0;
    for (uint64_t i = 0; i < out->pixels; i++, pa += 4, pb += 4) {
        bool differs = false;
        for (int c = 0; c < 4; c++) {
            uint32_t ulp = ulp_distance(pa[c], pb[c]);
            differs |= ulp != 0;
            if (ulp > out->max_ulp)
                out->max_ulp = ulp;
        }
        out->differing += differs;
        if (!is_finite4(pa) || !is_finite4(pb)) {
            out->nonfinite++;
            continue;
        }
        for (int c = 0; differs && c < 4; c++) {
            double d = fabs((double)pa[c] - (double)pb[c]);
            sum += d;
            sum2 += d * d;
            if (d > out->max_abs)
                out->max_abs = d;
        }
    }
    double values = 4.0 * (double)(out->pixels - out->nonfinite);
    if (values > 0.0) {
        out->mean_abs = sum / values;
        out->rmse = sqrt(sum2 / values);
    }
    out->psnr = out->rmse > 0.0 ? -20.0 * log10(out->rmse) : INFINITY;
    if (values == 0.0 && out->differing > 0)
        out->psnr = NAN;
}

/* The value that would be at `rank` if values were sorted: Hoare's selection. Reorders them. */
static float select_rank(float *values, size_t count, size_t rank)
{
    size_t low = 0, high = count - 1;
    while (low < high) {
        float pivot = values[low + (high - low) / 2];
        size_t i = low, j = high;
        for (;;) {
            while (values[i] < pivot)
                i++;
            while (values[j] > pivot)
                j--;
            if (i >= j)
                break;
            float swapped = values[i];
            values[i++] = values[j];
            values[j--] = swapped;
        }
        if (rank <= j)
            high = j;
        else
            low = j + 1;
    }
    return values[rank];
}

/* Nearest rank: the least value that at least thousandths / 1000 of the values do not exceed; 0 of
 * none. */
static double percentile(float *values, size_t count, size_t thousandths)
{
    return count ? (double)select_rank(values, count, (count * thousandths + 999) / 1000 - 1) : 0.0;
}

Result metrics_unaffected(const Image *a, const Image *b, const uint8_t *same,
                          UnaffectedMetrics *out)
{
    size_t pixels = (size_t)a->width * (size_t)a->height, empty = 0;
    *out = (UnaffectedMetrics){0};
    float *relative = memory_array(pixels, sizeof *relative);
    if (!relative)
        return RESULT_NO_MEMORY;
    const float *pa = a->pixels, *pb = b->pixels;
    for (size_t i = 0; i < pixels; i++) {
        if (same[i] == STRUCTURE_DIFFERS || !is_finite4(pa + 4 * i) || !is_finite4(pb + 4 * i))
            continue;
        double worst = 0.0;
        for (int c = 0; c < 4; c++) {
            double d = fabs((double)pa[4 * i + (size_t)c] - (double)pb[4 * i + (size_t)c]);
            out->max_abs = fmax(out->max_abs, d);
            worst = fmax(worst, d / fmax(1.0, fabs((double)pb[4 * i + (size_t)c])));
        }
        out->max_rel = fmax(out->max_rel, worst);
        /* Occupied pixels from the front, the others from the back. */
        size_t at = same[i] == STRUCTURE_SAME ? out->occupied++ : pixels - ++empty;
        relative[at] = (float)worst;
    }
    out->pixels = out->occupied + empty;
    double occupied = percentile(relative, out->occupied, 990);
    double occupied999 = percentile(relative, out->occupied, 999);
    memmove(relative + out->occupied, relative + pixels - empty, empty * sizeof *relative);
    out->p99_rel = fmax(occupied, percentile(relative, out->pixels, 990));
    out->p999_rel = fmax(occupied999, percentile(relative, out->pixels, 999));
    free(relative);
    return RESULT_OK;
}

/* A NaN is beyond every bound but an infinite one. */
static double bound_ratio(float a, float b, float bound)
{
    double difference = fabs((double)a - (double)b);
    if (difference <= 0.0 || bound > FLT_MAX)
        return 0.0;
    return difference < (double)INFINITY && bound > 0.0f ? difference / (double)bound
                                                         : (double)INFINITY;
}

static double greatest4(const Image *image, size_t pixel)
{
    const float *values = (const float *)image->pixels + 4 * pixel;
    return (double)fmaxf(fmaxf(values[0], values[1]), fmaxf(values[2], values[3]));
}

/* One pixel's figures: its ratio, and its greatest bounds. */
static void add_bound(const Image *a, const Frame *truth, size_t pixel, float *lists[3],
                      BoundMetrics *out)
{
    const float *pa = a->pixels, *pb = truth->final.pixels, *most = truth->bound.pixels;
    double ratio = 0.0, greatest = greatest4(&truth->bound, pixel);
    for (size_t c = 4 * pixel; c < 4 * pixel + 4; c++)
        ratio = fmax(ratio, bound_ratio(pa[c], pb[c], most[c]));
    out->unbounded += greatest > (double)FLT_MAX;
    out->max_ratio = fmax(out->max_ratio, ratio);
    if (ratio > 1.0 && !out->exceeded++) {
        out->has_first = true;
        out->first[0] = (int)(pixel % (size_t)a->width);
        out->first[1] = (int)(pixel / (size_t)a->width);
    }
    lists[0][out->pixels] = (float)ratio;
    lists[1][out->pixels] = (float)greatest;
    lists[2][out->pixels++] = (float)greatest4(&truth->rounding, pixel);
}

Result metrics_bound(const Image *a, const Frame *truth, const uint8_t *same, BoundMetrics *out)
{
    size_t pixels = (size_t)a->width * (size_t)a->height;
    *out = (BoundMetrics){0};
    float *values = memory_array(3 * pixels, sizeof *values);
    if (!values)
        return RESULT_NO_MEMORY;
    float *lists[3] = {values, values + pixels, values + 2 * pixels};
    for (size_t i = 0; i < pixels; i++)
        if (same[i] == STRUCTURE_SAME)
            add_bound(a, truth, i, lists, out);
    out->median_ratio = percentile(lists[0], out->pixels, 500);
    out->p99_ratio = percentile(lists[0], out->pixels, 990);
    out->median = percentile(lists[1], out->pixels, 500);
    out->p99 = percentile(lists[1], out->pixels, 990);
    out->rounding_median = percentile(lists[2], out->pixels, 500);
    out->rounding_p99 = percentile(lists[2], out->pixels, 990);
    free(values);
    return RESULT_OK;
}
