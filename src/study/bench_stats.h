/* What the figures of a benchmark come to. */
#ifndef PEEL_STUDY_BENCH_STATS_H
#define PEEL_STUDY_BENCH_STATS_H

#include "study/bench.h"

/* Median, and (greatest − least) / median, of count ≥ 1 values, which are sorted. An even count has
 * the mean of the middle two; a median of 0 a spread of 0. */
double bench_median(double *values, int count, double *spread);

/* Marks the rows that no other is as fast as, in CPU time, and as exact as, and better in one of
 * the two. A row without an error is never marked. NO_MEMORY: none is. */
Result bench_mark_pareto(BenchRow *rows, size_t count);

/* CPU times of a renderer over those of ref in cells of equal settings. */
typedef struct BenchRatios {
    size_t cells;
    double mean, least; /* geometric mean; NaN without cells */
} BenchRatios;

/* Whether two rows differ in passes and lights, or renderer, alone. */
bool bench_same_test(const BenchRow *a, const BenchRow *b);

/* The row of `renderer` with all else as row's; NULL when there is none. */
const BenchRow *bench_partner(const BenchReport *report, const BenchRow *row, int renderer);

/* The cells of test (of a row of ref's, or NULL: all). */
BenchRatios bench_ratios(const BenchReport *report, const BenchRow *test, int renderer);

#endif
