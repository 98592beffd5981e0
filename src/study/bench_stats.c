#include "study/bench_stats.h"

#include "base/memory.h"
#include "study/pareto.h"

#include <math.h>
#include <stdlib.h>

static int ascending(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_median(double *values, int count, double *spread)
{
    qsort(values, (size_t)count, sizeof *values, ascending);
    double median = 0.5 * (values[(count - 1) / 2] + values[count / 2]);
    *spread = median > 0.0 ? (values[count - 1] - values[0]) / median : 0.0;
    return median;
}

Result bench_mark_pareto(BenchRow *rows, size_t count)
{
    double *cost = memory_array(count, sizeof *cost), *error = memory_array(count, sizeof *error);
    bool *marks = memory_array(count, sizeof *marks);
    bool room = cost && error && marks;
    for (size_t i = 0; room && i < count; i++) {
        cost[i] = rows[i].cpu_ms;
        error[i] = isfinite(rows[i].rmse) ? rows[i].rmse : NAN;
    }
    if (room)
        pareto_mark(cost, error, count, marks);
    for (size_t i = 0; room && i < count; i++)
        rows[i].pareto = marks[i];
    free(cost);
    free(error);
    free(marks);
    return room ? RESULT_OK : RESULT_NO_MEMORY;
}

bool bench_same_test(const BenchRow *a, const BenchRow *b)
{
    return a->scene == b->scene && a->format == b->format && a->width == b->width &&
           a->height == b->height && a->threads == b->threads && a->method == b->method;
}

const BenchRow *bench_partner(const BenchReport *report, const BenchRow *row, int renderer)
{
    for (size_t i = 0; i < report->count; i++) {
        const BenchRow *other = &report->rows[i];
        if (other->renderer == renderer && bench_same_test(row, other) &&
            other->lights == row->lights && other->passes == row->passes)
            return other;
    }
    return NULL;
}

BenchRatios bench_ratios(const BenchReport *report, const BenchRow *test, int renderer)
{
    BenchRatios ratios = {.least = INFINITY};
    double logarithms = 0.0;
    for (size_t i = 0; i < report->count; i++) {
        const BenchRow *ref = &report->rows[i];
        if (ref->renderer != BENCH_REF || (test && !bench_same_test(ref, test)))
            continue;
        const BenchRow *other = bench_partner(report, ref, renderer);
        if (!other || !(ref->cpu_ms > 0.0))
            continue;
        double ratio = other->cpu_ms / ref->cpu_ms;
        logarithms += log(ratio);
        ratios.least = fmin(ratios.least, ratio);
        ratios.cells++;
    }
    if (!ratios.cells)
        ratios.least = NAN;
    ratios.mean = ratios.cells ? exp(logarithms / (double)ratios.cells) : NAN;
    return ratios;
}
