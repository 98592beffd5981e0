/* What the parts of the text of `peel blend eval` share. Private to src/report. */
#ifndef PEEL_REPORT_BLEND_PAGE_H
#define PEEL_REPORT_BLEND_PAGE_H

#include "report/blend_eval.h"
#include "report/blend_terms.h"
#include "report/grid.h"

typedef struct BlendPage {
    const EvalDesc *desc;
    const EvalNamed *arithmetics;
    size_t count;
    const EvalView *view;
    BlendTerms terms;
    FILE *out;
} BlendPage;

const char *blend_page_channel(int channel); /* "red"; static */
int blend_page_channels(const BlendPage *page);

/* "Layer 1 of 2: c = 1, 0, 0; a = 0.5", behind an empty line. */
void blend_page_layer(const BlendPage *page, const EvalLayer *layer);

/* Whether two channels have the same numbers all through, so that one table serves both. */
bool blend_page_same(const EvalLayer *layer, int a, int b);

/* Whether a colour channel adds nothing to what is there, and nothing was rounded: no table. */
bool blend_page_idle(const EvalLayer *layer, int channel);

/* A new grid's failure. */
Result blend_page_no_memory(void);

/* The end: the result in its forms, how many steps were rounded, under beside over. eval: done. */
Result blend_page_result(const BlendPage *page, const BlendEval *eval);

/* Of two or more arithmetics: the steps of each side by side, if they have room; their results. */
Result blend_page_several(const BlendPage *page);

#endif
