/* Blends of `peel blend eval` as aligned text and as JSON. */
#ifndef PEEL_REPORT_BLEND_EVAL_H
#define PEEL_REPORT_BLEND_EVAL_H

#include "study/blend_eval.h"

#include <stdio.h>

typedef struct EvalNamed {
    const char *name; /* as it was asked for; borrowed */
    Arithmetic arithmetic;
    bool wrong; /* of a named one */
} EvalNamed;

typedef struct EvalView {
    int width; /* columns; at least 40 */
    bool colour;
    bool brief; /* a line a layer instead of one a step */
} EvalView;

/* Evaluates as it prints. One arithmetic: every step; two or more: side by side as far as the width
 * has room, else their results. None of them may be refused. */
Result report_blend_eval_print(const EvalDesc *desc, const EvalNamed *arithmetics, size_t count,
                               const EvalView *view, FILE *out);

/* The document of `peel blend eval --json`, with every step of every arithmetic. Exact fractions of
 * running results are left out where they are longer than 1000 characters, but for the last. */
Result report_blend_eval_json(const EvalDesc *desc, const EvalNamed *arithmetics, size_t count,
                              const char *path);

#endif
