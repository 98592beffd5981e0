/* Aligned columns of text for a terminal: as wide as what is in them, within a width; in colours
 * where it is said to. */
#ifndef PEEL_REPORT_GRID_H
#define PEEL_REPORT_GRID_H

#include "base/result.h"

#include <stdbool.h>
#include <stdio.h>

typedef enum GridStyle {
    GRID_PLAIN = 0,
    GRID_HEAD,
    GRID_FAINT,
    GRID_STRONG,
    GRID_GOOD,
    GRID_WARN,
    GRID_BAD
} GridStyle;

enum {
    GRID_COLUMNS = 24
};

typedef struct Grid Grid;

/* align: a letter a column, 'l' or 'r'; at most GRID_COLUMNS. A first column may be 'l' only. Lines
 * are indented by 2. colour: with the terminal's colours. NULL without memory. */
Grid *grid_new(const char *align, int width, bool colour);
void grid_free(Grid *grid); /* NULL is fine */

/* A row's cells, from the first column on; a column that a row lacks is empty. All are kept until
 * they are printed. Failures (memory) stick until grid_print. */
void grid_row(Grid *grid);
void grid_put(Grid *grid, GridStyle style, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* A line that is in no column. */
void grid_line(Grid *grid, GridStyle style, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* How wide the longest row is with all columns as wide as they need to be, or `width`. */
int grid_needs(const Grid *grid);

/* Prints the rows and forgets them; columns stay as wide as they are, so that the next rows are
 * aligned with these. A last cell that finds no room gets lines of its own, below the second
 * column. */
Result grid_print(Grid *grid, FILE *out);

/* text in a style: for lines that are no grid's. */
void grid_style(bool colour, GridStyle style, const char *text, FILE *out);

#endif
