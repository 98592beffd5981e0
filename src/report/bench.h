/* A benchmark as text, JSON and a page. */
#ifndef PEEL_REPORT_BENCH_H
#define PEEL_REPORT_BENCH_H

#include "study/bench.h"

#include <stdio.h>

/* A table of the rows from first on, which are of one scene, size, lights and threads. */
void report_bench_print(const BenchReport *report, size_t first, FILE *out);

/* For every test (scene, size, threads, method, formats) the ratios of CPU time of gl to ref and
 * gl-early to ref, passes down and lights across; geometric means and minima. Nothing without rows
 * of ref and one of these. */
void report_bench_print_ratios(const BenchReport *report, FILE *out);

/* The document of `peel bench --json`, written to a temporary name and renamed. */
Result report_bench_json(const BenchReport *report, const char *path);

/* Makes dir if it is missing and writes index.html, style.css, bench.css and plots, each to a
 * temporary name and renamed. command: what repeats it. UNSUPPORTED without gnuplot. */
Result report_bench_html(const BenchReport *report, const char *command, const char *dir);

/* "4", or "auto" for 0. text: room for it. */
enum {
    REPORT_BENCH_PASSES = 16
};
const char *report_bench_passes(int passes, char text[REPORT_BENCH_PASSES]);

#endif
