/* The end of `peel blend eval`: what came out, and under beside over. */
#include "report/blend_cells.h"
#include "report/blend_page.h"

#include <math.h>
#include <string.h>

static Result print_channels(const BlendPage *page, const BlendEval *eval)
{
    PixelFormat format = page->desc->format;
    Grid *grid = blend_cells_grid(format, page->view->width, page->view->colour);
    if (!grid)
        return blend_page_no_memory();
    fprintf(page->out, "\nResult: what is stored, and how far it is off the ideal\n");
    blend_cells_headings(grid, format, "result", "off", "ideal");
    for (int c = 0; c < blend_page_channels(page); c++) {
        const EvalChannel *channel = &eval->layer.channels[c];
        grid_row(grid);
        grid_put(grid, GRID_PLAIN, "%s", blend_page_channel(c));
        blend_cells_number(grid, GRID_STRONG, &channel->steps[EVAL_STORED].number, format);
        blend_cells_errors(grid, &channel->off, channel->off_ulp);
        blend_cells_fraction(grid, page->view->width, &channel->exact, format);
    }
    Result result = grid_print(grid, page->out);
    grid_free(grid);
    return result;
}

static void print_totals(const BlendPage *page, const BlendEval *eval)
{
    const EvalTotals *totals = &eval->totals;
    const char *unit = format_info(page->desc->format)->kind == KIND_UNORM ? "codes" : "ULP";
    fprintf(page->out, "  %llu rounding%s", (unsigned long long)totals->rounded,
            totals->rounded == 1 ? "" : "s");
    if (totals->rounded)
        fprintf(page->out, ", at most %.3g %s: layer %zu, %s, %s", totals->largest_ulp, unit,
                totals->layer + 1, blend_page_channel(totals->channel),
                blend_terms_of(&page->terms, totals->channel)->steps[totals->step]);
    fputc('\n', page->out);
}

static void put_ulp(Grid *grid, double ulp)
{
    char text[NUMERAL_MAX];
    grid_put(grid, blend_cells_style(ulp), "%s", blend_cells_error(ulp, text));
}

static void add_sides(const BlendPage *page, const EvalSides *sides, Grid *grid)
{
    static const char *const headings[] = {"",           "under",       "over",      "ideal",
                                           "under-over", "under-ideal", "over-ideal"};
    PixelFormat format = page->desc->format;
    char text[NUMERAL_MAX];
    grid_row(grid);
    for (size_t i = 0; i < sizeof headings / sizeof *headings; i++)
        grid_put(grid, GRID_HEAD, "%s", headings[i]);
    for (int c = 0; c < 4; c++) {
        grid_row(grid);
        grid_put(grid, GRID_PLAIN, "%s", c == 3 ? page->terms.alpha.target : blend_page_channel(c));
        grid_put(grid, GRID_PLAIN, "%s", blend_cells_stored(&sides->under[c], format, text));
        grid_put(grid, GRID_PLAIN, "%s", blend_cells_stored(&sides->over[c], format, text));
        grid_put(grid, GRID_PLAIN, "%s", blend_cells_stored(&sides->exact[c], format, text));
        put_ulp(grid, sides->between_ulp[c]);
        put_ulp(grid, sides->under_ulp[c]);
        put_ulp(grid, sides->over_ulp[c]);
    }
}

static Result print_sides(const BlendPage *page, const BlendEval *eval)
{
    EvalSides sides;
    blend_eval_sides(eval, &sides);
    Result result = RESULT_OK;
    bool unorm = format_info(page->desc->format)->kind == KIND_UNORM;
    if (sides.refusal) {
        fprintf(page->out, "  (under and over side by side: %s)\n", sides.refusal);
    } else {
        Grid *grid = grid_new("lrrrrrr", page->view->width, page->view->colour);
        fprintf(page->out,
                "\nThe same layers under each other (front to back) and over each other (back to\n"
                "  front)%s\n",
                unorm ? ", in codes" : "; differences in ULP");
        if (grid)
            add_sides(page, &sides, grid);
        result = grid ? grid_print(grid, page->out) : blend_page_no_memory();
        grid_free(grid);
    }
    blend_eval_sides_free(&sides);
    return result;
}

Result blend_page_result(const BlendPage *page, const BlendEval *eval)
{
    Result result = print_channels(page, eval);
    if (result != RESULT_OK)
        return result;
    print_totals(page, eval);
    return print_sides(page, eval);
}
