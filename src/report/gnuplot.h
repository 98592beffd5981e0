/* Drawings by gnuplot (Debian's gnuplot-nox), a program of its own. Private to src/report. */
#ifndef PEEL_REPORT_GNUPLOT_H
#define PEEL_REPORT_GNUPLOT_H

#include "base/result.h"

#include <stdio.h>

/* Runs a script, which `write` puts into a stream, and makes what it draws the file path.
 * UNSUPPORTED when there is no gnuplot here, INTERNAL with its first line when it complains. */
Result gnuplot_draw(void (*write)(FILE *script, const void *what), const void *what,
                    const char *path);

/* Appends text between single quotes. */
void gnuplot_quote(FILE *script, const char *text);

#endif
