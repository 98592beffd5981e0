/* Error against time as a drawing in the page. Private to src/report. */
#ifndef PEEL_REPORT_HTML_PLOT_H
#define PEEL_REPORT_HTML_PLOT_H

#include "base/file.h"
#include "study/threeway.h"

/* Appends a figure: a point for each report, x its renderer's wall time, y the root mean square
 * error of its final image against truth, both logarithmic; an error of 0 has a line of its own at
 * the bottom. The range of errors is that of ref and gl together, so that both figures compare.
 * reports: count of them, at most METHOD_COUNT. renderer: RENDERER_REF or RENDERER_GL. */
void html_plot(FileWriter *page, const Threeway *reports, size_t count, int renderer);

#endif
