/* The page's section about the error budget. Private to src/report. */
#ifndef PEEL_REPORT_HTML_BUDGET_H
#define PEEL_REPORT_HTML_BUDGET_H

#include "base/file.h"
#include "study/budget.h"

#define HTML_BUDGET_PICTURE "classes.png"

/* budget NULL: nothing. */
void html_budget(FileWriter *page, const Budget *budget);
/* The picture that it shows, into dir, which exists. */
Result html_budget_picture(const Budget *budget, const char *dir);

#endif
