/* Where the difference between ref and truth comes from.
 *
 * ref is rendered again with one thing changed at a time, and what changes in the image is that
 * thing's share. From truth to the picture in question there are four steps, each from the last:
 * the best that single precision can do (peel-id in 32-bit formats), where the order is the same
 * (rounding) and where it is not (order); losing what ties (peel); the method. Then everything
 * else, alone, from there: pass limit, bias, depth format and peel test, G-buffer, clamping to 1,
 * accumulation format. Shares are vectors, so they may cancel: their sum is compared with the
 * total, and what is left is unexplained, since what was changed alone also works together. */
#ifndef PEEL_STUDY_BUDGET_H
#define PEEL_STUDY_BUDGET_H

#include "study/classes.h"

typedef enum BudgetTerm {
    BUDGET_ROUNDING,
    BUDGET_ORDER,
    BUDGET_TIES,
    BUDGET_METHOD,
    BUDGET_PASSES,
    BUDGET_BIAS,
    BUDGET_DEPTH,
    BUDGET_GBUFFER,
    BUDGET_CLAMP,
    BUDGET_ACCUM,
    BUDGET_TERMS
} BudgetTerm;

/* Of differences over all channel values of the final image. */
typedef struct BudgetFigure {
    bool measured; /* false: the settings leave nothing to change */
    double max_abs, rmse;
    uint64_t pixels; /* that differ */
} BudgetFigure;

typedef struct Budget {
    BudgetFigure terms[BUDGET_TERMS], sum, total, unexplained;
    double explained;   /* 1 − squares of what is unexplained / squares of the total */
    uint64_t nonfinite; /* pixels left out: an image has a NaN or an infinity there */
    uint64_t counts[CLASS_COUNT];
    int width, height;
    uint8_t *classes; /* width · height, row 0 at the top: a PixelClass each */
} Budget;

/* desc with 32-bit formats, no limit and no bias, by another method. */
RenderDesc budget_best(const RenderDesc *desc, MethodId method);

/* Renders up to ten times. The caller frees with budget_free; on failure there is nothing to
 * free. */
Result budget_run(const Scene *scene, const RenderDesc *desc, Renderer ref, Renderer truth,
                  Budget *out);
void budget_free(Budget *budget);

const char *budget_term_key(BudgetTerm term);  /* "rounding", …; static, as below */
const char *budget_term_text(BudgetTerm term); /* one line */

#endif
