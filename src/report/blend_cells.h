/* Cells of the tables of blends: a number in its forms, an error and how bad it is. */
#ifndef PEEL_REPORT_BLEND_CELLS_H
#define PEEL_REPORT_BLEND_CELLS_H

#include "number/numeral.h"
#include "report/grid.h"

/* Each returns out. "~" stands before what is rounded: the nearest float of a number that is none
 * (but doubles are exact in hexadecimal, and in decimal where they are short). */
const char *blend_cells_decimal(const Rational *number, char out[NUMERAL_MAX]);
const char *blend_cells_hex(const Rational *number, char out[NUMERAL_MAX]);
/* In units of the format's greatest code: "127.5". */
const char *blend_cells_code(const Rational *number, PixelFormat format, char out[NUMERAL_MAX]);
/* A colour as somebody wrote it: its fraction, where it is no float and that is short. */
const char *blend_cells_given(const Rational *number, char out[NUMERAL_MAX]);
/* With a sign and two or three digits; "0" for none. */
const char *blend_cells_error(double error, char out[NUMERAL_MAX]);

/* None, up to half a unit as rounding to nearest makes it, up to one, more. */
GridStyle blend_cells_style(double ulp);

/* A unorm number as its code, others as decimals. */
const char *blend_cells_stored(const Rational *number, PixelFormat format, char out[NUMERAL_MAX]);

/* Cells of a row: decimal, hexadecimal, and the code of unorm formats; the error in ULP and as a
 * number; the fraction, over the greatest code where it is one, or of one
 * that is longer than some lines its length. */
void blend_cells_number(Grid *grid, GridStyle style, const Rational *number, PixelFormat format);
void blend_cells_errors(Grid *grid, const Rational *error, double ulp);
void blend_cells_fraction(Grid *grid, int width, const Rational *number, PixelFormat format);

/* A table of those cells behind a label, with its headings. NULL without memory. */
Grid *blend_cells_grid(PixelFormat format, int width, bool colour);
void blend_cells_headings(Grid *grid, PixelFormat format, const char *label, const char *error,
                          const char *fraction);

#endif
