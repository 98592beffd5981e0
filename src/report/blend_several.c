/* Several arithmetics in `peel blend eval`: their steps side by side, and what came out of each. */
#include "report/blend_cells.h"
#include "report/blend_page.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- step by step ---- */

enum {
    SIDE_MOST = (GRID_COLUMNS - 1) / 2 /* a number and its error each */
};

static bool any_says(const BlendPage *page, const BlendEval *evals, int c, EvalStep step)
{
    for (size_t i = 0; i < page->count; i++)
        if (blend_terms_says(page->desc, &evals[i].layer, c, step))
            return true;
    return false;
}

static void add_pair(const BlendPage *page, const Rational *number, double ulp, GridStyle style,
                     Grid *grid)
{
    char text[NUMERAL_MAX];
    bool unorm = format_info(page->desc->format)->kind == KIND_UNORM;
    grid_put(grid, style, "%s",
             unorm ? blend_cells_code(number, page->desc->format, text)
                   : blend_cells_decimal(number, text));
    grid_put(grid, blend_cells_style(ulp), "%s", blend_cells_error(ulp, text));
}

static void add_channel(const BlendPage *page, const BlendEval *evals, int c, Grid *grid)
{
    const TermsOf *terms = blend_terms_of(&page->terms, c);
    bool idle = true;
    for (size_t i = 0; i < page->count; i++)
        idle &= blend_page_idle(&evals[i].layer, c);
    if (idle) {
        grid_row(grid);
        grid_put(grid, GRID_STRONG, "  %s stays", terms->target);
    }
    for (size_t i = 0; i < page->count && idle; i++) {
        const EvalValue *value = &evals[i].layer.channels[c].steps[EVAL_STORED];
        add_pair(page, &value->number, value->ulp, GRID_STRONG, grid);
    }
    for (EvalStep step = 0; step < EVAL_STEPS && !idle; step++) {
        GridStyle style = step == EVAL_STORED ? GRID_STRONG : GRID_PLAIN;
        if (!any_says(page, evals, c, step))
            continue;
        grid_row(grid);
        grid_put(grid, style, "  %s", terms->steps[step]);
        for (size_t i = 0; i < page->count; i++) {
            const EvalValue *value = &evals[i].layer.channels[c].steps[step];
            add_pair(page, &value->number, value->ulp, style, grid);
        }
    }
    if (idle)
        return;
    grid_row(grid);
    grid_put(grid, GRID_PLAIN, "  %s ideal", terms->target);
    for (size_t i = 0; i < page->count; i++) {
        const EvalChannel *channel = &evals[i].layer.channels[c];
        add_pair(page, &channel->exact, channel->off_ulp, GRID_PLAIN, grid);
    }
}

static bool all_same(const BlendPage *page, const BlendEval *evals, int a, int b)
{
    for (size_t i = 0; i < page->count; i++)
        if (!blend_page_same(&evals[i].layer, a, b))
            return false;
    return true;
}

static void add_layer(const BlendPage *page, const BlendEval *evals, Grid *grid)
{
    int channels = blend_page_channels(page);
    bool unorm = format_info(page->desc->format)->kind == KIND_UNORM;
    grid_row(grid);
    grid_put(grid, GRID_HEAD, unorm ? "step (codes)" : "step");
    for (size_t i = 0; i < page->count; i++) {
        grid_put(grid, GRID_HEAD, "%s", page->arithmetics[i].name);
        grid_put(grid, GRID_HEAD, unorm ? "error" : "ULP");
    }
    for (int c = 0, next; c < channels; c = next) {
        char names[64];
        int at = snprintf(names, sizeof names, "%s", blend_page_channel(c));
        for (next = c + 1; next < channels && all_same(page, evals, c, next); next++)
            at += snprintf(names + at, sizeof names - (size_t)at, ", %s", blend_page_channel(next));
        grid_line(grid, GRID_PLAIN, "  %s", names);
        add_channel(page, evals, c, grid);
    }
}

static Result print_layers(const BlendPage *page, BlendEval *evals, Grid *grid, bool *fits)
{
    Result result = RESULT_OK;
    while (result == RESULT_OK) {
        for (size_t i = 0; i < page->count; i++)
            if (!blend_eval_next(&evals[i]))
                return RESULT_OK;
        add_layer(page, evals, grid);
        if (evals[0].done == 1)
            *fits = grid_needs(grid) <= page->view->width;
        if (!*fits)
            return RESULT_OK;
        blend_page_layer(page, &evals[0].layer);
        result = grid_print(grid, page->out);
    }
    return result;
}

/* *fits: whether they were printed. */
static Result print_steps(const BlendPage *page, bool *fits)
{
    BlendEval evals[SIDE_MOST];
    char align[GRID_COLUMNS + 1] = "l";
    size_t opened = 0;
    Result result = RESULT_OK;
    *fits = page->count <= SIDE_MOST;
    if (!*fits || page->count == 0)
        return RESULT_OK;
    for (; opened < page->count && result == RESULT_OK; opened += result == RESULT_OK) {
        strcat(align, "lr");
        result = blend_eval_open(page->desc, &page->arithmetics[opened].arithmetic, &evals[opened]);
    }
    Grid *grid = grid_new(align, page->view->width, page->view->colour);
    if (result == RESULT_OK)
        result = grid ? print_layers(page, evals, grid, fits) : blend_page_no_memory();
    grid_free(grid);
    for (size_t i = 0; i < opened; i++)
        blend_eval_close(&evals[i]);
    return result;
}

/* ---- what came out ---- */

static double worse(double a, double b)
{
    return isnan(a) || isnan(b) ? NAN : fabs(b) > fabs(a) ? b : a;
}

/* exact: the exact blend, done; its arithmetic is any. */
static void add_result(const BlendPage *page, const EvalNamed *named, const BlendEval *exact,
                       Grid *grid)
{
    PixelFormat format = page->desc->format;
    unsigned char pixel[16];
    char text[NUMERAL_MAX];
    double off = 0.0, between = 0.0;
    Rational number, difference;
    rational_init(&number);
    rational_init(&difference);
    blend_eval_all(page->desc, &named->arithmetic, pixel);
    grid_row(grid);
    grid_put(grid, named->wrong ? GRID_BAD : GRID_PLAIN, "%s%s", named->name,
             named->wrong ? " (wrong)" : "");
    for (int c = 0; c < blend_page_channels(page); c++) {
        rational_fetch(format_bits(format, pixel, c), format, &number);
        grid_put(grid, GRID_PLAIN, "%s", blend_cells_stored(&number, format, text));
        off = worse(off, blend_eval_distance(&number, &exact->exact[c], &exact->exact[c], format));
    }
    grid_put(grid, blend_cells_style(off), "%s", blend_cells_error(off, text));
    BlendEval own = *exact; /* borrows its numbers */
    own.arithmetic = named->arithmetic;
    EvalSides sides;
    blend_eval_sides(&own, &sides);
    for (int c = 0; c < 4 && !sides.refusal; c++)
        between = worse(between, sides.between_ulp[c]);
    grid_put(grid, sides.refusal ? GRID_FAINT : blend_cells_style(between), "%s",
             sides.refusal ? "-" : blend_cells_error(between, text));
    blend_eval_sides_free(&sides);
    rational_clear(&number);
    rational_clear(&difference);
}

static void add_exact(const BlendPage *page, const BlendEval *eval, Grid *grid)
{
    char text[NUMERAL_MAX];
    grid_row(grid);
    grid_put(grid, GRID_FAINT, "(ideal)");
    for (int c = 0; c < blend_page_channels(page); c++)
        grid_put(grid, GRID_FAINT, "%s",
                 blend_cells_stored(&eval->exact[c], page->desc->format, text));
}

static Result print_results(const BlendPage *page)
{
    static const char aligns[5][8] = {"", "lrrr", "lrrrr", "lrrrrr", "lrrrrrr"};
    BlendEval eval;
    bool unorm = format_info(page->desc->format)->kind == KIND_UNORM;
    Result result = blend_eval_open(page->desc, &page->arithmetics[0].arithmetic, &eval);
    if (result != RESULT_OK)
        return result;
    while (blend_eval_next(&eval))
        ;
    Grid *grid = grid_new(aligns[blend_page_channels(page)], page->view->width, page->view->colour);
    fprintf(page->out,
            "\nResults%s; ideal: the colours as written, without any rounding;\n"
            "  off: the channel farthest from that; under-over: the layers under each other,\n"
            "  less over each other\n",
            unorm ? " in codes" : ", differences in ULP");
    if (grid) {
        grid_row(grid);
        grid_put(grid, GRID_HEAD, "arithmetic");
        for (int c = 0; c < blend_page_channels(page); c++)
            grid_put(grid, GRID_HEAD, "%s",
                     c == 3 ? page->terms.alpha.target : blend_page_channel(c));
        grid_put(grid, GRID_HEAD, "off");
        grid_put(grid, GRID_HEAD, "under-over");
        add_exact(page, &eval, grid);
        for (size_t i = 0; i < page->count; i++)
            add_result(page, &page->arithmetics[i], &eval, grid);
    }
    result = grid ? grid_print(grid, page->out) : blend_page_no_memory();
    grid_free(grid);
    blend_eval_close(&eval);
    return result;
}

Result blend_page_several(const BlendPage *page)
{
    bool printed = true;
    Result result = page->view->brief ? RESULT_OK : print_steps(page, &printed);
    if (!printed)
        fprintf(page->out, "  (%d columns have no room for the steps of %zu arithmetics)\n",
                page->view->width, page->count);
    return result == RESULT_OK ? print_results(page) : result;
}
