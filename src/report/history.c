#include "report/history.h"

#include "frame/method.h"
#include "number/format.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    NUMBER = 32,
    WIDE = 136, /* columns from which decimal and hexadecimal stand beside each other */
    NAME = 9,
    NAME_WIDE = 34,
    BEFORE_PASSES = 74 /* columns of a fragment's row, but for a wide name */
};

typedef enum Tone {
    TONE_HEADING,
    TONE_GOOD,
    TONE_WEAK,
    TONE_LOST
} Tone;

typedef struct Writer {
    const HistorySides *sides;
    HistoryStyle style;
    FILE *out;
} Writer;

static const char *tone(const Writer *writer, Tone tone)
{
    static const char *const codes[] = {"\033[1m", "\033[32m", "\033[2m", "\033[33m"};
    return writer->style.color ? codes[tone] : "";
}

static const char *plain(const Writer *writer)
{
    return writer->style.color ? "\033[0m" : "";
}

static void heading(const Writer *writer, const char *text)
{
    fprintf(writer->out, "\n%s%s%s\n", tone(writer, TONE_HEADING), text, plain(writer));
}

/* ---- numbers ---- */

/* The shortest decimal that reads back: as a float where it is one, else as a double. */
static const char *decimal(double value, char out[NUMBER])
{
    bool single = (double)(float)value == value || isnan(value);
    for (int digits = 1; digits <= 17; digits++) {
        snprintf(out, NUMBER, "%.*g", digits, value);
        double back = strtod(out, NULL);
        if (single ? (float)back == (float)value : back == value)
            break;
    }
    return out;
}

static const char *hexadecimal(double value, char out[NUMBER])
{
    snprintf(out, NUMBER, "%a", value);
    return out;
}

static bool is_wide(const Writer *writer)
{
    return writer->style.columns >= WIDE;
}

/* Columns of a number of a history: the truth's doubles are rounded to single where they find no
 * room. */
static int width_of(const Writer *writer, const History *history)
{
    return is_wide(writer) && strcmp(history->accum_format, "double") == 0 ? 22 : 14;
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

static Tone tone_of(HistoryFate fate)
{
    switch (fate) {
    case HISTORY_PEELED:
    case HISTORY_BLENDED:
    case HISTORY_SEEN:
        return TONE_GOOD;
    case HISTORY_TIE:
    case HISTORY_SKIPPED:
    case HISTORY_PASS_LIMIT:
    case HISTORY_OVERFLOW:
        return TONE_LOST;
    default:
        return TONE_WEAK;
    }
}

static void describe_fate(const HistoryFragment *fragment, char out[NUMBER + 16])
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
        snprintf(out, NUMBER + 16, "peel %d%s", fragment->peel,
                 fragment->back ? ", from behind" : "");
    else
        snprintf(out, NUMBER + 16, "%s", texts[fragment->fate]);
}

/* A letter for each pass; where there are more than columns, how many more. */
static void print_tests(const Writer *writer, const History *history, size_t index)
{
    static const char letters[HISTORY_TESTS] = {
        [HISTORY_KEPT] = 'K',    [HISTORY_OPAQUE_DEPTH] = 'o', [HISTORY_PREVIOUS_DEPTH] = 'p',
        [HISTORY_BETWEEN] = 'b', [HISTORY_DEPTH_TEST] = 'd',   [HISTORY_ALPHA_TEST] = 'a'};
    int passes = history->fragments[index].passes, shown = passes;
    int room = writer->style.columns - BEFORE_PASSES - (is_wide(writer) ? NAME_WIDE - NAME : 0);
    if (passes > room)
        shown = room > 5 ? room - 5 : 0;
    for (int i = 0; i < shown; i++)
        fputc(letters[history_test(history, index, i)], writer->out);
    if (shown < passes)
        fprintf(writer->out, "+%d", passes - shown);
}

static void print_fragment(const Writer *writer, const History *history,
                           const HistoryFragment *fragment)
{
    const Scene *scene = writer->sides->scene;
    const char *instance = scene->instances[fragment->instance].name;
    const char *material = scene->materials[fragment->material].name;
    char depth[NUMBER], fate[NUMBER + 16], name[64];
    bool wide = is_wide(writer);
    int room = wide ? NAME_WIDE : NAME;
    snprintf(name, sizeof name, "%s%s%s", instance ? instance : "", wide ? " / " : "",
             wide && material ? material : "");
    describe_fate(fragment, fate);
    fprintf(writer->out, "%9u  %-*.*s %c %-11s %8.5g %5.3g  %s%-22s%s ", fragment->primitive, room,
            room, name, fragment->front ? 'F' : 'B', decimal(fragment->depth, depth),
            fragment->distance, fragment->surface.base[3], tone(writer, tone_of(fragment->fate)),
            fate, plain(writer));
    print_tests(writer, history, (size_t)(fragment - history->fragments));
    fputc('\n', writer->out);
}

/* Edge functions only where the fill rule has something to say, or there is room. */
static void print_edges(const Writer *writer, const HistoryFragment *fragment)
{
    bool through = false;
    for (int i = 0; i < 3; i++)
        through = through || fragment->edge[i] == 0;
    if (!fragment->has_edges || (!through && !is_wide(writer)))
        return;
    fprintf(writer->out, "%s           edges ", tone(writer, TONE_WEAK));
    for (int i = 0; i < 3; i++)
        fprintf(writer->out, " %lld%s", (long long)fragment->edge[i],
                fragment->edge[i] != 0 ? ""
                : fragment->owned[i]   ? " (through the centre: its own)"
                                       : " (through the centre: the neighbour's)");
    fprintf(writer->out, "%s\n", plain(writer));
}

static void print_fragments(const Writer *writer, const History *history)
{
    size_t count = history->fragment_count;
    const HistoryFragment **sorted = calloc(count + 1, sizeof *sorted);
    if (!sorted || count == 0) {
        fprintf(writer->out, "\nNo triangle at this pixel.\n");
        free(sorted);
        return;
    }
    for (size_t i = 0; i < count; i++)
        sorted[i] = &history->fragments[i];
    qsort(sorted, count, sizeof *sorted, nearer);
    heading(writer, "Fragments, near to far");
    fprintf(writer->out, "%9s  %-*s %c %-11s %8s %5s  %-22s %s\n", "primitive",
            is_wide(writer) ? NAME_WIDE : NAME, "instance", ' ', "depth", "distance", "alpha",
            "fate", "passes");
    for (size_t i = 0; i < count; i++) {
        print_fragment(writer, history, sorted[i]);
        print_edges(writer, sorted[i]);
    }
    fprintf(writer->out,
            "F, B: front or back face. Passes: K kept; rejected by the o opaque depth,\n"
            "p previous depth, d depth test, a alpha test; b between dual peeling's depths.\n");
    free(sorted);
}

/* ---- blending ---- */

static void print_values(const Writer *writer, const char *first, const char *second,
                         const double *values, int channels, int width)
{
    char text[NUMBER];
    bool wide = is_wide(writer) && width < 20;
    double rounded[4];
    for (int i = 0; i < channels; i++)
        rounded[i] = width < 20 ? (double)(float)values[i] : values[i];
    values = rounded;
    fprintf(writer->out, "  %-10s %-7s", first, second);
    for (int i = 0; i < channels; i++)
        fprintf(writer->out, " %-*s", wide ? 12 : width, decimal(values[i], text));
    if (!wide)
        fprintf(writer->out, "\n  %-10s %-7s%s", "", "", tone(writer, TONE_WEAK));
    for (int i = 0; i < channels; i++)
        fprintf(writer->out, " %-*s", width, hexadecimal(values[i], text));
    fprintf(writer->out, "%s\n", plain(writer));
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

static void print_steps(const Writer *writer, const History *history)
{
    char line[160];
    const char *target = "", *equation = "";
    int width = width_of(writer, history);
    for (size_t i = 0; i < history->step_count; i++) {
        const HistoryStep *step = &history->steps[i];
        if (strcmp(step->target, target) != 0 || strcmp(step->equation, equation) != 0) {
            snprintf(line, sizeof line, "%s of %s, %s; %s", i ? "Then" : "Blend steps",
                     history->renderer, step->format, equation_text(step->equation));
            heading(writer, line);
            fprintf(writer->out, "  %-10s %-7s %-*s %-*s %-*s %s\n", step->target, "", width, "R",
                    width, "G", width, "B", "alpha / T");
            print_values(writer, "", "before", step->before, step->channels, width);
        }
        target = step->target;
        equation = step->equation;
        print_values(writer, step->step, "source", step->source, 4, width);
        print_values(writer, "", step->stored ? "after" : "(after)", step->after, step->channels,
                     width);
    }
}

/* ---- side by side ---- */

static void print_ulps(const Writer *writer, const History *history, const double *values)
{
    const History *ref = writer->sides->ref;
    if (!ref || history == ref)
        return;
    fprintf(writer->out, "  %-10s %-7s", "", "ULP");
    for (int i = 0; i < 4; i++)
        fprintf(writer->out, " %-*u", is_wide(writer) ? 12 : 14,
                ulp_distance((float)values[i], (float)ref->final[i]));
    fputc('\n', writer->out);
}

static void print_sides(const Writer *writer)
{
    const HistorySides *sides = writer->sides;
    const History *all[] = {sides->ref, sides->gl, sides->truth};
    heading(writer, "Final colour, linear, over the background; coverage");
    for (int i = 0; i < 3; i++) {
        double rounded[4];
        if (!all[i])
            continue;
        for (int k = 0; k < 4; k++)
            rounded[k] = (double)(float)all[i]->final[k];
        print_values(writer, all[i]->renderer, "", rounded, 4, 14);
        print_ulps(writer, all[i], rounded);
    }
    fprintf(writer->out, "  %-10s", "display");
    for (int i = 0; i < 3; i++)
        if (all[i])
            fprintf(writer->out, "  %s %d,%d,%d", all[i]->renderer, all[i]->display[0],
                    all[i]->display[1], all[i]->display[2]);
    fputc('\n', writer->out);
    if (sides->missing)
        fprintf(writer->out, "  gl is not here: %s\n", sides->missing);
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

static void print_others(const Writer *writer, const History *shown)
{
    const HistorySides *sides = writer->sides;
    if (sides->gl && sides->gl != shown && same_steps(shown, sides->gl))
        fprintf(writer->out, "\ngl: the same steps, bit for bit (sources recomputed by ref).\n");
    else if (sides->gl && sides->gl != shown)
        print_steps(writer, sides->gl);
    if (sides->truth && sides->truth != shown)
        print_steps(writer, sides->truth);
}

void report_history(const HistorySides *sides, HistoryStyle style, FILE *out)
{
    Writer writer = {sides, style, out};
    const History *history = first_of(sides);
    Text summary = {0};
    if (!history)
        return;
    history_summary(history, &summary);
    fprintf(out, "%s%s %d,%d: %s%s\n", tone(&writer, TONE_HEADING), sides->scene_name, history->x,
            history->y, summary.bytes ? summary.bytes : "", plain(&writer));
    fprintf(out, "%s at %dx%d, method %s, accumulation %s, depth %s\n", history->renderer,
            sides->width, sides->height, method_info(history->method)->name, history->accum_format,
            history->depth_format);
    text_free(&summary);
    if (history->note)
        fprintf(out, "(%s)\n", history->note);
    print_fragments(&writer, history);
    print_steps(&writer, history);
    print_others(&writer, history);
    print_sides(&writer);
}
