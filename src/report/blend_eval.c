/* The text of `peel blend eval`: its head, and one arithmetic step by step. */
#include "report/blend_eval.h"

#include "report/blend_cells.h"
#include "report/blend_page.h"

#include <math.h>
#include <string.h>

const char *blend_page_channel(int channel)
{
    static const char *const names[4] = {"red", "green", "blue", "alpha"};
    return names[channel & 3];
}

int blend_page_channels(const BlendPage *page)
{
    return format_info(page->desc->format)->channels;
}

Result blend_page_no_memory(void)
{
    return result_fail(RESULT_NO_MEMORY, "out of memory for a table");
}

/* ---- the head ---- */

static void print_formula(const BlendPage *page, const TermsOf *terms, const char *means)
{
    char line[TERMS_FORMULA + 4];
    snprintf(line, sizeof line, "  %-22s", terms->formula);
    grid_style(page->view->colour, GRID_STRONG, line, page->out);
    fprintf(page->out, "%s%s\n", *means ? "  " : "", means);
}

/* Whether the format has the start's numbers. */
static bool start_is_stored(const EvalDesc *desc)
{
    bool stored = true;
    Rational number;
    rational_init(&number);
    for (int c = 0; c < format_info(desc->format)->channels; c++) {
        const Rational *given = &desc->start->channels[c];
        rational_fetch(rational_store(given, desc->format), desc->format, &number);
        stored &= rational_equal(&number, given);
    }
    rational_clear(&number);
    return stored;
}

static void print_start(const BlendPage *page)
{
    const EvalDesc *desc = page->desc;
    float cleared[4];
    blend_eval_cleared(&desc->equation, cleared);
    fputs("  start: C = ", page->out);
    for (int c = 0; c < blend_page_channels(page); c++) {
        char text[NUMERAL_MAX];
        if (c == 3)
            fprintf(page->out, "; %s = ", page->terms.alpha.target);
        else
            fputs(c ? ", " : "", page->out);
        fputs(desc->start ? blend_cells_given(&desc->start->channels[c], text)
                          : numeral_float((double)cleared[c], text),
              page->out);
    }
    fputs(!desc->start            ? " (cleared)\n"
          : start_is_stored(desc) ? "\n"
                                  : " (rounded when it is stored)\n",
          page->out);
}

static void print_head(const BlendPage *page)
{
    const EvalDesc *desc = page->desc;
    char equation[EQUATION_TEXT], title[512];
    size_t layers = desc->layers->count;
    equation_print(&desc->equation, equation);
    int at = snprintf(title, sizeof title, "%s, %s, ", equation, format_info(desc->format)->name);
    if (page->count == 1)
        snprintf(title + at, sizeof title - (size_t)at, "%s arithmetic", page->arithmetics[0].name);
    else
        snprintf(title + at, sizeof title - (size_t)at, "%zu arithmetics", page->count);
    grid_style(page->view->colour, GRID_STRONG, title, page->out);
    fprintf(page->out, ": %zu layer%s%s\n", layers, layers == 1 ? "" : "s",
            layers == 1                           ? ""
            : blend_eval_is_over(&desc->equation) ? ", back to front"
                                                  : ", front to back");
    print_formula(page, &page->terms.colour, page->terms.colour_means);
    if (blend_page_channels(page) == 4)
        print_formula(page, &page->terms.alpha, page->terms.alpha_means);
    fprintf(page->out, "  %s\n", page->terms.sources);
    print_start(page);
}

static void print_legend(const BlendPage *page)
{
    const FormatInfo *info = format_info(page->desc->format);
    if (info->kind == KIND_UNORM)
        fprintf(page->out,
                "  codes, error: what rounding added in the step, in 1/%u and as a number\n",
                info->unorm_max);
    else
        fprintf(page->out,
                "  ULP, error: what rounding added in that step, in units in the last "
                "place of\n    %s and as a number\n",
                info->name);
    fprintf(page->out,
            "  ideal: the colours as written, blended without any rounding; the errors in its\n"
            "    row: how far the stored number is off by now; ~: rounded for this table\n");
}

/* ---- every step of a layer ---- */

void blend_page_layer(const BlendPage *page, const EvalLayer *layer)
{
    const EvalDesc *desc = page->desc;
    char numbers[4][NUMERAL_MAX], heading[320];
    for (int c = 0; c < 4; c++)
        blend_cells_given(&layer->given->channels[c], numbers[c]);
    bool straight = desc->multiply || blend_eval_takes_straight(&desc->equation);
    snprintf(heading, sizeof heading, "Layer %zu of %zu: %s = %s, %s, %s; a = %s", layer->index + 1,
             desc->layers->count, straight ? "c" : "s", numbers[0], numbers[1], numbers[2],
             numbers[3]);
    fputc('\n', page->out);
    grid_style(page->view->colour, GRID_STRONG, heading, page->out);
    fputc('\n', page->out);
}

bool blend_page_same(const EvalLayer *layer, int a, int b)
{
    const EvalChannel *x = &layer->channels[a], *y = &layer->channels[b];
    return b < 3 && rational_equal(&layer->given->channels[a], &layer->given->channels[b]) &&
           x->before == y->before && x->stored == y->stored && rational_equal(&x->exact, &y->exact);
}

bool blend_page_idle(const EvalLayer *layer, int c)
{
    const EvalChannel *channel = &layer->channels[c];
    bool rounded = !rational_is_zero(&channel->off);
    for (EvalStep step = 0; step < EVAL_STEPS; step++)
        rounded |= !rational_is_zero(&channel->steps[step].error);
    return c < 3 && !rounded && rational_is_zero(&channel->steps[EVAL_PUT_OUT].number) &&
           channel->before == channel->stored;
}

static void add_channel(const BlendPage *page, const EvalLayer *layer, int c, Grid *grid)
{
    const EvalDesc *desc = page->desc;
    const TermsOf *terms = blend_terms_of(&page->terms, c);
    const EvalChannel *channel = &layer->channels[c];
    if (blend_page_idle(layer, c)) {
        grid_row(grid);
        grid_put(grid, GRID_STRONG, "  %s stays", terms->target);
        blend_cells_number(grid, GRID_STRONG, &channel->steps[EVAL_STORED].number, desc->format);
        return;
    }
    for (EvalStep step = 0; step < EVAL_STEPS; step++) {
        const EvalValue *value = &channel->steps[step];
        GridStyle style = step == EVAL_STORED ? GRID_STRONG : GRID_PLAIN;
        if (!blend_terms_says(desc, layer, c, step))
            continue;
        grid_row(grid);
        grid_put(grid, style, "  %s", terms->steps[step]);
        blend_cells_number(grid, style, &value->number, desc->format);
        blend_cells_errors(grid, &value->error, value->ulp);
        blend_cells_fraction(grid, page->view->width, &value->number, desc->format);
    }
    grid_row(grid);
    grid_put(grid, GRID_PLAIN, "  %s ideal", terms->target);
    blend_cells_number(grid, GRID_PLAIN, &channel->exact, desc->format);
    blend_cells_errors(grid, &channel->off, channel->off_ulp);
    blend_cells_fraction(grid, page->view->width, &channel->exact, desc->format);
}

/* What the layers done let through, where no channel says so. */
static void add_transmittance(const BlendPage *page, const BlendEval *eval, Grid *grid)
{
    if (blend_eval_alpha(&page->desc->equation) != EVAL_COVERAGE)
        return;
    grid_row(grid);
    grid_put(grid, GRID_PLAIN, "  let through");
    blend_cells_number(grid, GRID_PLAIN, &eval->see_through, page->desc->format);
    grid_put(grid, GRID_PLAIN, "%s", ""); /* exact by definition */
    grid_put(grid, GRID_PLAIN, "%s", "");
    blend_cells_fraction(grid, page->view->width, &eval->see_through, page->desc->format);
}

static Result print_layer(const BlendPage *page, const BlendEval *eval, Grid *grid)
{
    const EvalLayer *layer = &eval->layer;
    int channels = blend_page_channels(page);
    blend_page_layer(page, layer);
    blend_cells_headings(grid, page->desc->format, "step", "error", "fraction");
    for (int c = 0, next; c < channels; c = next) {
        char names[64];
        int at = snprintf(names, sizeof names, "%s", blend_page_channel(c));
        for (next = c + 1; next < channels && blend_page_same(layer, c, next); next++)
            at += snprintf(names + at, sizeof names - (size_t)at, ", %s", blend_page_channel(next));
        grid_line(grid, GRID_PLAIN, "  %s", names);
        add_channel(page, layer, c, grid);
    }
    add_transmittance(page, eval, grid);
    return grid_print(grid, page->out);
}

static Result print_layers(const BlendPage *page, BlendEval *eval)
{
    const EvalView *view = page->view;
    Grid *grid = blend_cells_grid(page->desc->format, view->width, view->colour);
    Result result = grid ? RESULT_OK : blend_page_no_memory();
    while (result == RESULT_OK && blend_eval_next(eval))
        result = print_layer(page, eval, grid);
    grid_free(grid);
    return result;
}

/* ---- a line a layer ---- */

static void add_brief_headings(const BlendPage *page, Grid *grid)
{
    grid_row(grid);
    grid_put(grid, GRID_HEAD, "layer");
    grid_put(grid, GRID_HEAD, "a");
    for (int c = 0; c < blend_page_channels(page); c++)
        grid_put(grid, GRID_HEAD, "%s", c == 3 ? page->terms.alpha.target : blend_page_channel(c));
    grid_put(grid, GRID_HEAD, "off");
    grid_put(grid, GRID_HEAD, "let through");
}

/* The largest of the channels' distances from the ideal blend; NaN where one has none. */
static double worst_off(const BlendEval *eval)
{
    double worst = 0.0;
    for (int c = 0; c < format_info(eval->desc.format)->channels; c++) {
        double ulp = eval->layer.channels[c].off_ulp;
        if (isnan(ulp))
            return ulp;
        if (fabs(ulp) > fabs(worst))
            worst = ulp;
    }
    return worst;
}

static void add_brief(const BlendEval *eval, Grid *grid)
{
    char text[NUMERAL_MAX];
    double worst = worst_off(eval);
    grid_row(grid);
    grid_put(grid, GRID_PLAIN, "%zu", eval->layer.index + 1);
    grid_put(grid, GRID_FAINT, "%s", blend_cells_given(&eval->layer.given->channels[3], text));
    for (int c = 0; c < format_info(eval->desc.format)->channels; c++)
        grid_put(grid, GRID_PLAIN, "%s",
                 blend_cells_stored(&eval->layer.channels[c].steps[EVAL_STORED].number,
                                    eval->desc.format, text));
    grid_put(grid, blend_cells_style(worst), "%s", blend_cells_error(worst, text));
    grid_put(grid, GRID_FAINT, "%.6g", rational_to_double(&eval->see_through));
}

static Result print_brief(const BlendPage *page, BlendEval *eval)
{
    static const char aligns[5][10] = {"", "rrrrr", "rrrrrr", "rrrrrrr", "rrrrrrrr"};
    bool unorm = format_info(page->desc->format)->kind == KIND_UNORM;
    Grid *grid = grid_new(aligns[blend_page_channels(page)], page->view->width, page->view->colour);
    if (!grid)
        return blend_page_no_memory();
    fprintf(page->out,
            "\nStored after each layer%s; off: %s of the channel farthest from the ideal,\n"
            "  the same blend without any rounding; let through: the product of 1 - a\n",
            unorm ? ", in codes" : "", unorm ? "codes" : "ULP");
    add_brief_headings(page, grid);
    while (blend_eval_next(eval))
        add_brief(eval, grid);
    Result result = grid_print(grid, page->out);
    grid_free(grid);
    return result;
}

/* ---- the whole ---- */

static Result print_one(const BlendPage *page)
{
    BlendEval eval;
    Result result = blend_eval_open(page->desc, &page->arithmetics[0].arithmetic, &eval);
    if (result != RESULT_OK)
        return result;
    if (!page->view->brief)
        print_legend(page);
    result = page->view->brief ? print_brief(page, &eval) : print_layers(page, &eval);
    if (result == RESULT_OK)
        result = blend_page_result(page, &eval);
    blend_eval_close(&eval);
    return result;
}

Result report_blend_eval_print(const EvalDesc *desc, const EvalNamed *arithmetics, size_t count,
                               const EvalView *view, FILE *out)
{
    BlendPage page = {
        .desc = desc, .arithmetics = arithmetics, .count = count, .view = view, .out = out};
    blend_terms(desc, &page.terms);
    print_head(&page);
    return count == 1 ? print_one(&page) : blend_page_several(&page);
}
