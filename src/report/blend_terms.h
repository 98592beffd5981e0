/* A blend equation in letters: what each step of it is called. */
#ifndef PEEL_REPORT_BLEND_TERMS_H
#define PEEL_REPORT_BLEND_TERMS_H

#include "study/blend_eval.h"

enum {
    TERMS_PART = 40,
    TERMS_STEP = 96,
    TERMS_FORMULA = 112
};

/* Of a colour channel, or of alpha. */
typedef struct TermsOf {
    char target[4];                     /* "C", "T", "A" */
    char steps[EVAL_STEPS][TERMS_STEP]; /* "a*c", "1 - a", "C + T*a*c", "C stored" */
    char formula[TERMS_FORMULA];        /* "C = C + T*a*c" */
} TermsOf;

typedef struct BlendTerms {
    TermsOf colour, alpha;
    const char *colour_means, *alpha_means; /* one clause each; "" where there is none to say */
    const char *sources;                    /* what the letters of the source are */
} BlendTerms;

void blend_terms(const EvalDesc *desc, BlendTerms *out);

const TermsOf *blend_terms_of(const BlendTerms *terms, int channel);

/* Whether a step says more than the steps before it: a factor of 1 and its product do not, nor a
 * source that is used as it was put out. Nothing that was rounded is left out. */
bool blend_terms_says(const EvalDesc *desc, const EvalLayer *layer, int channel, EvalStep step);

#endif
