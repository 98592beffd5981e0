/* The plots of a benchmark. Private to src/report. */
#ifndef PEEL_REPORT_BENCH_PLOT_H
#define PEEL_REPORT_BENCH_PLOT_H

#include "study/bench.h"

/* What times are drawn against. */
typedef enum BenchAxis {
    BENCH_PASSES,
    BENCH_LIGHTS,
    BENCH_TRIANGLES,
    BENCH_PIXELS,
    BENCH_THREADS,
    BENCH_AXES
} BenchAxis;

const char *bench_axis_name(BenchAxis axis); /* "passes", …; static */

/* Whether the rows have at least two values of it, all of them numbers. */
bool bench_axis_varies(const BenchReport *report, BenchAxis axis);

/* Time against an axis as SVG: a curve per renderer and method, in the first of the formats, with
 * every other axis at its first value, and where that is not all there is, at its last, dashed. */
Result bench_plot_axis(const BenchReport *report, BenchAxis axis, const char *path);

/* Time against error of count rows from first on, which are of one scene, size, lights and threads;
 * rows without a time or an error above 0 are left out. */
Result bench_plot_errors(const BenchReport *report, size_t first, size_t count, const char *path);

#endif
