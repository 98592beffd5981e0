/* What shows each wrong arithmetic: by format and equation the simplest vector whose result no
 * right arithmetic gives. Computed from the sets of vectors, not stored. */
#ifndef PEEL_STUDY_BLEND_WRONG_H
#define PEEL_STUDY_BLEND_WRONG_H

#include "study/blend_check.h"

typedef struct BlendWrong {
    const ArithmeticInfo *info;
    PixelFormat format;
    EquationId equation;
    bool shown; /* it differs from every right arithmetic */
    bool alone; /* on one vector from all of them at once: then that is the example; else one where
                 * it differs from the exact result */
    BlendExample example; /* expected: the exact result; if shown */
} BlendWrong;

typedef struct BlendWrongList {
    BlendWrong
        *rows; /* by arithmetic, then format, then equation; those that are refused are out */
    size_t count;
} BlendWrongList;

/* formats: bits 1 << place in arithmetic_formats, 0 for all; equation EQUATION_COUNT: all that have
 * a name. effort: vectors to look at for each pair. The caller frees with blend_wrong_free. */
Result blend_wrong_list(unsigned formats, EquationId equation, size_t effort, BlendWrongList *out);
void blend_wrong_free(BlendWrongList *list);

/* The row of the arithmetic and format with the simplest vector, over all equations; NULL where no
 * equation shows it. *shown and *all: how many equations show it, and how many there are. */
const BlendWrong *blend_wrong_simplest(const BlendWrongList *list, const ArithmeticInfo *info,
                                       PixelFormat format, int *shown, int *all);

#endif
