#include "report/blend_cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The nearest double; how much of it is the number itself. */
typedef enum Nearness {
    NEAR_FLOAT = 0,
    NEAR_DOUBLE,
    NEAR_NEITHER
} Nearness;

static Nearness nearness(const Rational *number, double *nearest)
{
    Rational back;
    *nearest = rational_to_double(number);
    if (number->kind != RATIONAL_FINITE)
        return NEAR_FLOAT;
    rational_init(&back);
    rational_set(isfinite(*nearest) ? *nearest : 0.0, &back);
    bool exact = rational_equal(&back, number);
    rational_clear(&back);
    bool is_float = (double)(float)*nearest == *nearest;
    return !exact ? NEAR_NEITHER : is_float ? NEAR_FLOAT : NEAR_DOUBLE;
}

const char *blend_cells_decimal(const Rational *number, char out[NUMERAL_MAX])
{
    double nearest;
    Nearness near = nearness(number, &nearest);
    if (near == NEAR_FLOAT)
        return numeral_float(nearest, out);
    char text[NUMERAL_MAX];
    if (near == NEAR_DOUBLE && strlen(numeral_double(nearest, text)) <= 14)
        return strcpy(out, text);
    snprintf(out, NUMERAL_MAX, "~%s", numeral_float(nearest, text));
    return out;
}

const char *blend_cells_hex(const Rational *number, char out[NUMERAL_MAX])
{
    double nearest;
    char text[NUMERAL_MAX];
    if (nearness(number, &nearest) != NEAR_NEITHER)
        return numeral_hex(nearest, out);
    snprintf(out, NUMERAL_MAX, "~%s", numeral_hex((double)rational_to_float(number), text));
    return out;
}

const char *blend_cells_code(const Rational *number, PixelFormat format, char out[NUMERAL_MAX])
{
    Rational code;
    rational_init(&code);
    rational_set((double)format_info(format)->unorm_max, &code);
    rational_mul(number, &code, &code);
    double nearest;
    Nearness near = nearness(&code, &nearest);
    double thousandths = nearest * 1000.0;
    bool short_one = near != NEAR_NEITHER && thousandths == floor(thousandths);
    if (!isfinite(nearest) || short_one)
        numeral_float(nearest, out);
    else
        snprintf(out, NUMERAL_MAX, "~%.3f", nearest);
    rational_clear(&code);
    return out;
}

const char *blend_cells_error(double error, char out[NUMERAL_MAX])
{
    if (isnan(error))
        return strcpy(out, "nan");
    if (error == 0.0)
        return strcpy(out, "0");
    snprintf(out, NUMERAL_MAX, "%+.*g", fabs(error) < 0.001 ? 2 : 3, error);
    return out;
}

const char *blend_cells_given(const Rational *number, char out[NUMERAL_MAX])
{
    blend_cells_decimal(number, out);
    char *fraction = out[0] == '~' ? numeral_fraction(number) : NULL;
    if (fraction && strlen(fraction) < 20)
        strcpy(out, fraction);
    free(fraction);
    return out;
}

GridStyle blend_cells_style(double ulp)
{
    double size = fabs(ulp);
    return size == 0.0 ? GRID_FAINT : size <= 0.5 ? GRID_GOOD : size <= 1.0 ? GRID_WARN : GRID_BAD;
}

const char *blend_cells_stored(const Rational *number, PixelFormat format, char out[NUMERAL_MAX])
{
    if (format_info(format)->kind == KIND_UNORM)
        return blend_cells_code(number, format, out);
    return blend_cells_decimal(number, out);
}

void blend_cells_number(Grid *grid, GridStyle style, const Rational *number, PixelFormat format)
{
    char text[NUMERAL_MAX];
    grid_put(grid, style, "%s", blend_cells_decimal(number, text));
    grid_put(grid, GRID_FAINT, "%s", blend_cells_hex(number, text));
    if (format_info(format)->kind == KIND_UNORM)
        grid_put(grid, style, "%s", blend_cells_code(number, format, text));
}

void blend_cells_errors(Grid *grid, const Rational *error, double ulp)
{
    char text[NUMERAL_MAX];
    GridStyle style = blend_cells_style(ulp);
    grid_put(grid, style, "%s", blend_cells_error(ulp, text));
    grid_put(grid, style, "%s", blend_cells_error(rational_to_double(error), text));
}

void blend_cells_fraction(Grid *grid, int width, const Rational *number, PixelFormat format)
{
    uint32_t most = format_info(format)->unorm_max;
    uint32_t code = most ? rational_store(number, format) : 0;
    Rational stored;
    rational_init(&stored);
    if (most)
        rational_fetch(code, format, &stored);
    bool is_code = most && rational_equal(&stored, number) && code > 0 && code < most;
    rational_clear(&stored);
    char *text = numeral_fraction(number);
    size_t length = strlen(text);
    if (is_code) /* 63/255 says more than 21/85 */
        grid_put(grid, GRID_PLAIN, "%u/%u", code, most);
    else if (length > 3 * (size_t)width)
        grid_put(grid, GRID_FAINT, "(%zu characters)", length);
    else
        grid_put(grid, GRID_PLAIN, "%s", text);
    free(text);
}

Grid *blend_cells_grid(PixelFormat format, int width, bool colour)
{
    return grid_new(format_info(format)->kind == KIND_UNORM ? "lllrrrl" : "lllrrl", width, colour);
}

void blend_cells_headings(Grid *grid, PixelFormat format, const char *label, const char *error,
                          const char *fraction)
{
    bool unorm = format_info(format)->kind == KIND_UNORM;
    grid_row(grid);
    grid_put(grid, GRID_HEAD, "%s", label);
    grid_put(grid, GRID_HEAD, "decimal");
    grid_put(grid, GRID_HEAD, "hexadecimal");
    if (unorm)
        grid_put(grid, GRID_HEAD, "code");
    grid_put(grid, GRID_HEAD, unorm ? "codes" : "ULP");
    grid_put(grid, GRID_HEAD, "%s", error);
    grid_put(grid, GRID_HEAD, "%s", fraction);
}
