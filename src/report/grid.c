#include "report/grid.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

enum {
    INDENT = 2,
    ROOMY = 100 /* columns: below that, columns stand closer */
};

typedef struct GridCell {
    char *text; /* NULL: empty */
    GridStyle style;
} GridCell;

typedef struct GridRow {
    GridCell cells[GRID_COLUMNS];
    int count;
    bool line;
} GridRow;

struct Grid {
    char align[GRID_COLUMNS + 1];
    int columns, width;
    bool colour, failed;
    int widths[GRID_COLUMNS];
    GridRow *rows;
    size_t count, room;
};

Grid *grid_new(const char *align, int width, bool colour)
{
    Grid *grid = calloc(1, sizeof *grid);
    if (!grid)
        return NULL;
    snprintf(grid->align, sizeof grid->align, "%s", align);
    grid->columns = (int)strlen(grid->align);
    grid->width = width;
    grid->colour = colour;
    return grid;
}

static void forget(Grid *grid)
{
    for (size_t i = 0; i < grid->count; i++)
        for (int c = 0; c < grid->rows[i].count; c++)
            free(grid->rows[i].cells[c].text);
    grid->count = 0;
}

void grid_free(Grid *grid)
{
    if (!grid)
        return;
    forget(grid);
    free(grid->rows);
    free(grid);
}

void grid_row(Grid *grid)
{
    if (grid->count == grid->room) {
        size_t room = grid->room ? 2 * grid->room : 32;
        GridRow *more = realloc(grid->rows, room * sizeof *more);
        if (!more) {
            grid->failed = true;
            return;
        }
        grid->rows = more;
        grid->room = room;
    }
    grid->rows[grid->count++] = (GridRow){.count = 0};
}

static void put(Grid *grid, GridStyle style, const char *format, va_list arguments)
{
    GridRow *row = grid->count ? &grid->rows[grid->count - 1] : NULL;
    if (grid->failed || !row || row->count == grid->columns)
        return;
    va_list again;
    va_copy(again, arguments);
    size_t size = (size_t)vsnprintf(NULL, 0, format, again) + 1;
    va_end(again);
    GridCell *cell = &row->cells[row->count];
    cell->style = style;
    cell->text = malloc(size);
    if (!cell->text) {
        grid->failed = true;
        return;
    }
    vsnprintf(cell->text, size, format, arguments);
    row->count++;
}

void grid_put(Grid *grid, GridStyle style, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    put(grid, style, format, arguments);
    va_end(arguments);
}

void grid_line(Grid *grid, GridStyle style, const char *format, ...)
{
    va_list arguments;
    grid_row(grid);
    va_start(arguments, format);
    put(grid, style, format, arguments);
    va_end(arguments);
    if (grid->count)
        grid->rows[grid->count - 1].line = true;
}

/* ---- printing ---- */

static void measure(const Grid *grid, int widths[GRID_COLUMNS])
{
    memcpy(widths, grid->widths, sizeof grid->widths);
    for (size_t i = 0; i < grid->count; i++)
        for (int c = 0; c < grid->rows[i].count && !grid->rows[i].line; c++) {
            int length = (int)strlen(grid->rows[i].cells[c].text);
            widths[c] = length > widths[c] ? length : widths[c];
        }
}

static int gap_of(const Grid *grid)
{
    return grid->width < ROOMY ? 1 : 2;
}

/* Where a column begins. */
static int begin_of(const Grid *grid, const int widths[GRID_COLUMNS], int column)
{
    int at = INDENT;
    for (int c = 0; c < column; c++)
        at += widths[c] ? widths[c] + gap_of(grid) : 0;
    return at;
}

int grid_needs(const Grid *grid)
{
    int widths[GRID_COLUMNS];
    measure(grid, widths);
    return begin_of(grid, widths, grid->columns) - gap_of(grid);
}

void grid_style(bool colour, GridStyle style, const char *text, FILE *out)
{
    static const char *const codes[] = {
        [GRID_HEAD] = "4",  [GRID_FAINT] = "2", [GRID_STRONG] = "1",
        [GRID_GOOD] = "32", [GRID_WARN] = "33", [GRID_BAD] = "31",
    };
    if (colour && style != GRID_PLAIN && *text)
        fprintf(out, "\033[%sm%s\033[0m", codes[style], text);
    else
        fputs(text, out);
}

/* In pieces that fit, each on a line that begins below the second column. */
static void print_wrapped(const Grid *grid, const GridCell *cell, int indent, FILE *out)
{
    int room = grid->width - indent > 20 ? grid->width - indent : 20;
    for (const char *at = cell->text; *at;) {
        char piece[512];
        int length = snprintf(piece, sizeof piece, "%.*s",
                              room < (int)sizeof piece ? room : (int)sizeof piece - 1, at);
        fprintf(out, "\n%*s", indent, "");
        grid_style(grid->colour, cell->style, piece, out);
        at += length < (int)sizeof piece ? length : (int)sizeof piece - 1;
    }
}

static void print_row(const Grid *grid, const GridRow *row, FILE *out)
{
    int at = 0;
    for (int c = 0; c < row->count; c++) {
        const GridCell *cell = &row->cells[c];
        int length = (int)strlen(cell->text), begin = begin_of(grid, grid->widths, c);
        bool last = c == grid->columns - 1;
        if (length == 0)
            continue;
        if (last && c > 0 && begin + length > grid->width) {
            print_wrapped(grid, cell, begin_of(grid, grid->widths, 1), out);
            break;
        }
        if (grid->align[c] == 'r')
            begin += grid->widths[c] - length;
        fprintf(out, "%*s", begin - at, "");
        grid_style(grid->colour, cell->style, cell->text, out);
        at = begin + length;
    }
    fputc('\n', out);
}

Result grid_print(Grid *grid, FILE *out)
{
    /* A last column that wraps must not widen anything. */
    measure(grid, grid->widths);
    for (size_t i = 0; i < grid->count && !grid->failed; i++) {
        const GridRow *row = &grid->rows[i];
        if (row->line) {
            grid_style(grid->colour, row->cells[0].style, row->cells[0].text, out);
            fputc('\n', out);
        } else {
            print_row(grid, row, out);
        }
    }
    forget(grid);
    return grid->failed ? result_fail(RESULT_NO_MEMORY, "out of memory for a table") : RESULT_OK;
}
