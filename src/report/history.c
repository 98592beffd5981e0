#include "report/history.h"

#include "base/memory.h"
#include "base/text.h"
#include "frame/method.h"
#include "number/format.h"
#include "number/numeral.h"
#include "report/grid.h"

#include <stdlib.h>
#include <string.h>

enum {
    FATE = 48,
    EDGES = 256,
    TESTS = 128,
    WIDE = 136, /* columns from which decimal and hexadecimal stand beside each other */
    NAME = 9,
    NAME_WIDE = 34,
    BEFORE_PASSES = 76 /* columns of a fragment's row, but for a wide name */
};

typedef struct Writer {
    const HistorySides *sides;
    HistoryStyle style;
    FILE *out;
} Writer;

static void heading(const Writer *writer, const char *text)
{
    fputc('\n', writer->out);
    grid_style(writer->style.color, GRID_STRONG, text, writer->out);
    fputc('\n', writer->out);
}

static Grid *table(const Writer *writer, const char *align)
{
    return grid_new(align, writer->style.columns, writer->style.color);
}

/* Prints a table and frees it; NULL: there was no memory for it. */
static Result end_table(const Writer *writer, Grid *grid)
{
    Result result = grid ? grid_print(grid, writer->out)
                         : result_fail(RESULT_NO_MEMORY, "out of memory for a table");
    grid_free(grid);
    return result;
}

/* ---- numbers ---- */

/* As a float where it is one, else as a double. */
static const char *decimal(double value, char out[NUMERAL_MAX])
{
    return (double)(float)value == value ? numeral_float(value, out) : numeral_double(value, out);
}

static bool is_wide(const Writer *writer)
{
    return writer->style.columns >= WIDE;
}

/* The truth's doubles are rounded to single where they find no room. */
static bool is_rounded(const Writer *writer, const History *history)
{
    return !is_wide(writer) || strcmp(history->accum_format, "double") != 0;
}

/* ---- fragments ---- */

static int nearer(const void *left, const void *right)
{
    const HistoryFragment *a = *(const HistoryFragment *const *)left;
    const HistoryFragment *b = *(const HistoryFragment *const *)right;
    if (a->distance != b->distance)
        return a->distance < b->distance ? -1 : 1;
    if (a->primitive != b->primitive)
        return a->primitive < b->primitive ? -1 : 1;
    return a < b ? -1 : a > b;
}

static GridStyle style_of(HistoryFate fate)
{
    switch (fate) {
    case HISTORY_PEELED:
    case HISTORY_BLENDED:
    case HISTORY_SEEN:
        return GRID_GOOD;
    case HISTORY_TIE:
    case HISTORY_SKIPPED:
    case HISTORY_PASS_LIMIT:
    case HISTORY_OVERFLOW:
        return GRID_WARN;
    default:
        return GRID_FAINT;
    }
}

static void describe_fate(const HistoryFragment *fragment, char out[FATE])
{
    static const char *const texts[HISTORY_FATES] = {
        [HISTORY_BLENDED] = "blended",         [HISTORY_SEEN] = "opaque surface, seen",
        [HISTORY_HIDDEN] = "hidden by opaque", [HISTORY_TIE] = "lost to a tie",
        [HISTORY_SKIPPED] = "skipped",         [HISTORY_PASS_LIMIT] = "lost to the pass limit",
        [HISTORY_OVERFLOW] = "lost: no room",  [HISTORY_INVISIBLE] = "alpha test",
        [HISTORY_MASKED] = "masked",           [HISTORY_FILL_RULE] = "fill rule: neighbour's",
        [HISTORY_CULLED] = "culled",           [HISTORY_CLIPPED] = "clipped",
    };
    if (fragment->fate == HISTORY_PEELED)
        snprintf(out, FATE, "peel %d%s", fragment->peel, fragment->back ? ", from behind" : "");
    else
        snprintf(out, FATE, "%s", texts[fragment->fate]);
}

/* A letter for each pass; where there are more than columns, how many more. */
static void describe_tests(const Writer *writer, const History *history, size_t index,
                           char out[TESTS])
{
    static const char letters[HISTORY_TESTS] = {
        [HISTORY_KEPT] = 'K',    [HISTORY_OPAQUE_DEPTH] = 'o', [HISTORY_PREVIOUS_DEPTH] = 'p',
        [HISTORY_BETWEEN] = 'b', [HISTORY_DEPTH_TEST] = 'd',   [HISTORY_ALPHA_TEST] = 'a'};
    int passes = history->fragments[index].passes, shown = passes;
    int room = writer->style.columns - BEFORE_PASSES - (is_wide(writer) ? NAME_WIDE - NAME : 0);
    room = room < TESTS - 8 ? room : TESTS - 8;
    if (passes > room)
        shown = room > 5 ? room - 5 : 0;
    for (int i = 0; i < shown; i++)
        out[i] = letters[history_test(history, index, i)];
    out[shown] = 0;
    if (shown < passes)
        snprintf(out + shown, (size_t)(TESTS - shown), "+%d", passes - shown);
}

static void put_fragment(const Writer *writer, const History *history,
                         const HistoryFragment *fragment, Grid *grid)
{
    const Scene *scene = writer->sides->scene;
    const char *instance = scene->instances[fragment->instance].name;
    const char *material = scene->materials[fragment->material].name;
    char depth[NUMERAL_MAX], fate[FATE], name[NAME_WIDE + 1], tests[TESTS];
    bool wide = is_wide(writer);
    snprintf(name, wide ? sizeof name : NAME + 1, "%s%s%s", instance ? instance : "",
             wide ? " / " : "", wide && material ? material : "");
    text_make_line(name);
    describe_fate(fragment, fate);
    describe_tests(writer, history, (size_t)(fragment - history->fragments), tests);
    grid_row(grid);
    grid_put(grid, GRID_PLAIN, "%u", fragment->primitive);
    grid_put(grid, GRID_PLAIN, "%s", name);
    grid_put(grid, GRID_PLAIN, "%c", fragment->front ? 'F' : 'B');
    grid_put(grid, GRID_PLAIN, "%s", decimal(fragment->depth, depth));
    grid_put(grid, GRID_PLAIN, "%.5g", fragment->distance);
    grid_put(grid, GRID_PLAIN, "%.3g", fragment->surface.base[3]);
    grid_put(grid, style_of(fragment->fate), "%s", fate);
    grid_put(grid, GRID_PLAIN, "%s", tests);
}

/* Edge functions only where the fill rule has something to say, or there is room. */
static void put_edges(const Writer *writer, const HistoryFragment *fragment, Grid *grid)
{
    char text[EDGES];
    int length = 0;
    bool through = false;
    for (int i = 0; i < 3; i++)
        through = through || fragment->edge[i] == 0;
    if (!fragment->has_edges || (!through && !is_wide(writer)))
        return;
    for (int i = 0; i < 3; i++)
        length += snprintf(text + length, (size_t)(EDGES - length), " %lld%s",
                           (long long)fragment->edge[i],
                           fragment->edge[i] != 0 ? ""
                           : fragment->owned[i]   ? " (through the centre: its own)"
                                                  : " (through the centre: the neighbour's)");
    grid_line(grid, GRID_FAINT, "           edges%s", text);
}

static Result print_fragments(const Writer *writer, const History *history)
{
    static const char *const heads[] = {"primitive", "instance", "",     "depth",
                                        "distance",  "alpha",    "fate", "passes"};
    size_t count = history->fragment_count;
    if (count == 0) {
        fprintf(writer->out, "\nNo triangle at this pixel.\n");
        return RESULT_OK;
    }
    const HistoryFragment **sorted = memory_array(count, sizeof *sorted);
    Grid *grid = table(writer, "lllllrrl");
    if (!sorted || !grid) {
        free(sorted);
        return end_table(writer, grid);
    }
    for (size_t i = 0; i < count; i++)
        sorted[i] = &history->fragments[i];
    qsort(sorted, count, sizeof *sorted, nearer);
    heading(writer, "Fragments, near to far");
    grid_row(grid);
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++)
        grid_put(grid, GRID_PLAIN, "%s", heads[i]);
    for (size_t i = 0; i < count; i++) {
        put_fragment(writer, history, sorted[i], grid);
        put_edges(writer, sorted[i], grid);
    }
    free(sorted);
    Result result = end_table(writer, grid);
    fprintf(writer->out,
            "F, B: front or back face. Passes: K kept; rejected by the o opaque depth,\n"
            "p previous depth, d depth test, a alpha test; b between dual peeling's depths.\n");
    return result;
}

/* ---- blending ---- */

/* Two columns of text and four channels, which in a wide terminal stand there in both forms. */
static Grid *values_table(const Writer *writer, bool rounded)
{
    return table(writer, is_wide(writer) && rounded ? "llllllllll" : "llllll");
}

static void put_texts(Grid *grid, const char *first, const char *second)
{
    grid_row(grid);
    grid_put(grid, GRID_PLAIN, "%s", first);
    grid_put(grid, GRID_PLAIN, "%s", second);
}

static void put_values(const Writer *writer, Grid *grid, const char *const texts[2],
                       const double *values, int channels, bool rounded)
{
    char text[NUMERAL_MAX];
    double value[4] = {0};
    bool below = !is_wide(writer) || !rounded;
    for (int i = 0; i < channels; i++)
        value[i] = rounded ? (double)(float)values[i] : values[i];
    put_texts(grid, texts[0], texts[1]);
    for (int i = 0; i < 4; i++)
        grid_put(grid, GRID_PLAIN, "%s", i < channels ? decimal(value[i], text) : "");
    if (below)
        put_texts(grid, "", "");
    for (int i = 0; i < channels; i++)
        grid_put(grid, below ? GRID_FAINT : GRID_PLAIN, "%s", numeral_hex(value[i], text));
}

static const char *equation_text(const char *equation)
{
    static const struct {
        const char *name, *text;
    } rows[] = {
        {"under", "under: C = C + T*source, T = T*(1 - a)"},
        {"over", "over: C = source + (1 - a)*C, T = T*(1 - a)"},
        {"opaque_seed", "the original's opaque pass: all channels += T*source"},
        {"add", "sum: all channels += source"},
        {"product", "product: *= 1 - source"},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        if (strcmp(rows[i].name, equation) == 0)
            return rows[i].text;
    return equation;
}

static void put_step(const Writer *writer, Grid *grid, const HistoryStep *step, bool rounded)
{
    const char *const source[] = {step->step, "source"};
    const char *const after[] = {"", step->stored ? "after" : "(after)"};
    put_values(writer, grid, source, step->source, 4, rounded);
    put_values(writer, grid, after, step->after, step->channels, rounded);
}

static Result print_steps(const Writer *writer, const History *history)
{
    static const char *const heads[] = {"R", "G", "B", "alpha / T"};
    static const char *const before[] = {"", "before"};
    char line[160];
    const char *target = "", *equation = "";
    bool rounded = is_rounded(writer, history);
    Grid *grid = values_table(writer, rounded);
    for (size_t i = 0; i < history->step_count && grid; i++) {
        const HistoryStep *step = &history->steps[i];
        if (strcmp(step->target, target) != 0 || strcmp(step->equation, equation) != 0) {
            if (grid_print(grid, writer->out) != RESULT_OK)
                break;
            snprintf(line, sizeof line, "%s of %s, %s; %s", i ? "Then" : "Blend steps",
                     history->renderer, step->format, equation_text(step->equation));
            heading(writer, line);
            put_texts(grid, step->target, "");
            for (int k = 0; k < 4; k++)
                grid_put(grid, GRID_PLAIN, "%s", heads[k]);
            put_values(writer, grid, before, step->before, step->channels, rounded);
        }
        target = step->target;
        equation = step->equation;
        put_step(writer, grid, step, rounded);
    }
    return end_table(writer, grid);
}

/* ---- side by side ---- */

static void put_ulps(const Writer *writer, Grid *grid, const History *history, const double *values)
{
    const History *ref = writer->sides->ref;
    if (!ref || history == ref)
        return;
    put_texts(grid, "", "ULP");
    for (int i = 0; i < 4; i++)
        grid_put(grid, GRID_PLAIN, "%u", ulp_distance((float)values[i], (float)ref->final[i]));
}

static Result print_sides(const Writer *writer)
{
    const HistorySides *sides = writer->sides;
    const History *all[] = {sides->ref, sides->gl, sides->truth};
    Grid *grid = values_table(writer, true);
    heading(writer, "Final colour, linear, over the background; coverage");
    for (int i = 0; i < 3 && grid; i++) {
        const char *const texts[] = {all[i] ? all[i]->renderer : "", ""};
        if (!all[i])
            continue;
        put_values(writer, grid, texts, all[i]->final, 4, true);
        put_ulps(writer, grid, all[i], all[i]->final);
    }
    Result result = end_table(writer, grid);
    fprintf(writer->out, "  display");
    for (int i = 0; i < 3; i++)
        if (all[i])
            fprintf(writer->out, "  %s %d,%d,%d", all[i]->renderer, all[i]->display[0],
                    all[i]->display[1], all[i]->display[2]);
    fputc('\n', writer->out);
    if (sides->missing)
        fprintf(writer->out, "  gl is not here: %s\n", sides->missing);
    return result;
}

/* ---- all ---- */

static const History *first_of(const HistorySides *sides)
{
    return sides->ref ? sides->ref : sides->gl ? sides->gl : sides->truth;
}

static bool same_steps(const History *a, const History *b)
{
    if (a->step_count != b->step_count)
        return false;
    for (size_t i = 0; i < a->step_count; i++)
        if (memcmp(a->steps[i].source, b->steps[i].source, sizeof a->steps[i].source) != 0 ||
            memcmp(a->steps[i].after, b->steps[i].after, sizeof a->steps[i].after) != 0)
            return false;
    return true;
}

static Result print_others(const Writer *writer, const History *shown)
{
    const HistorySides *sides = writer->sides;
    Result result = RESULT_OK;
    if (sides->gl && sides->gl != shown && same_steps(shown, sides->gl))
        fprintf(writer->out, "\ngl: the same steps, bit for bit (sources recomputed by ref).\n");
    else if (sides->gl && sides->gl != shown)
        result = print_steps(writer, sides->gl);
    if (result == RESULT_OK && sides->truth && sides->truth != shown)
        result = print_steps(writer, sides->truth);
    return result;
}

Result report_history(const HistorySides *sides, HistoryStyle style, FILE *out)
{
    Writer writer = {sides, style, out};
    const History *history = first_of(sides);
    Text summary = {0};
    char line[256];
    if (!history)
        return RESULT_OK;
    history_summary(history, &summary);
    snprintf(line, sizeof line, "%s %d,%d: %s", sides->scene_name, history->x, history->y,
             summary.bytes ? summary.bytes : "");
    grid_style(style.color, GRID_STRONG, line, out);
    fprintf(out, "\n%s at %dx%d, method %s, accumulation %s, depth %s\n", history->renderer,
            sides->width, sides->height, method_info(history->method)->name, history->accum_format,
            history->depth_format);
    Result result = summary.result;
    text_free(&summary);
    if (history->note)
        fprintf(out, "(%s)\n", history->note);
    if (result == RESULT_OK)
        result = print_fragments(&writer, history);
    if (result == RESULT_OK)
        result = print_steps(&writer, history);
    if (result == RESULT_OK)
        result = print_others(&writer, history);
    return result == RESULT_OK ? print_sides(&writer) : result;
}
