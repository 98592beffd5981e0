/* What peel explain renders for a page. */
#ifndef PEEL_CLI_EXPLAIN_PAGE_H
#define PEEL_CLI_EXPLAIN_PAGE_H

#include "cli/options.h"
#include "report/explain.h"

typedef struct ExplainPage {
    const char *dir, *file; /* dir exists */
    const char *command;    /* that makes the page again */
    size_t max_bytes;       /* 0: EXPLAIN_MAX_BYTES */
    const ExplainLesson *lesson;
} ExplainPage;

/* Renders scene by ref, gl and truth, and writes the page. *bytes, which may be NULL: its size. */
Result explain_page_write(const RenderOptions *options, const Scene *scene, const ExplainPage *page,
                          size_t *bytes);

#endif
