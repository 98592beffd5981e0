#include "report/html_plot.h"

#include "frame/method.h"
#include "report/html_parts.h"
#include "report/summary.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* In units of the drawing, which are pixels where the page is wide enough. */
enum {
    PLOT_WIDTH = 640,
    PLOT_HEIGHT = 440,
    PLOT_LEFT = 62,
    PLOT_RIGHT = 626,
    PLOT_TOP = 12,
    PLOT_BOTTOM = 386,
    PLOT_ROOM = 30, /* below the least error, for labels */
    LABEL_HEIGHT = 17,
    MARK_RADIUS = 6,
    RINGS = 16 /* of places for a label, each 18 farther away */
};

/* Wider than any letter of the names on average: the page's font is the reader's. */
static const double letter_width = 7.9;

typedef struct Box {
    double x0, y0, x1, y1;
} Box;

/* A method's point, its label's place, and where the line between the two ends. */
typedef struct Mark {
    const MethodInfo *method;
    double time_ms, error;
    double x, y;
    Box label;
    bool has_leader;
    double from[2], to[2];
} Mark;

typedef struct Plot {
    double x_low, x_high; /* decimal logarithms of milliseconds */
    int y_low, y_high;    /* decimal exponents; an error of 0 is at y_low, with has_zero */
    bool has_zero;
    Mark marks[METHOD_COUNT];
    size_t count;
} Plot;

static double error_of(const Threeway *report, int renderer)
{
    return report->pairs[renderer == RENDERER_GL ? 2 : 1].final.rmse;
}

/* ---- scales ---------------------------------------------------------------------------------- */

static void set_errors(Plot *plot, const Threeway *reports, size_t count)
{
    double low = INFINITY, high = 0.0;
    for (size_t i = 0; i < count; i++)
        for (int renderer = RENDERER_REF; renderer <= RENDERER_GL; renderer++) {
            double error = error_of(&reports[i], renderer);
            plot->has_zero |= error == 0.0;
            if (!isfinite(error) || error <= 0.0)
                continue;
            low = fmin(low, error);
            high = fmax(high, error);
        }
    if (high == 0.0)
        low = high = 1e-7;
    plot->y_low = (int)floor(log10(low)) - plot->has_zero;
    plot->y_high = (int)ceil(log10(high));
    if (plot->y_high < plot->y_low + 2)
        plot->y_high = plot->y_low + 2;
}

static void set_times(Plot *plot)
{
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < plot->count; i++) {
        low = fmin(low, log10(plot->marks[i].time_ms));
        high = fmax(high, log10(plot->marks[i].time_ms));
    }
    if (!plot->count)
        low = high = 0.0;
    /* A label fits on the left of every point. */
    double room = fmax(0.4 * (high - low), 0.5 * (0.8 - (high - low)));
    plot->x_low = low - room;
    plot->x_high = high + 0.5 * room;
}

static double x_of(const Plot *plot, double time_ms)
{
    double part = (log10(time_ms) - plot->x_low) / (plot->x_high - plot->x_low);
    return PLOT_LEFT + part * (PLOT_RIGHT - PLOT_LEFT);
}

static double y_at(const Plot *plot, double exponent)
{
    double part = (exponent - plot->y_low) / (plot->y_high - plot->y_low);
    return PLOT_BOTTOM - PLOT_ROOM - part * (PLOT_BOTTOM - PLOT_ROOM - PLOT_TOP);
}

static int left_first(const void *a, const void *b)
{
    const Mark *p = a, *q = b;
    if (p->time_ms != q->time_ms)
        return p->time_ms < q->time_ms ? -1 : 1;
    return (int)p->method->id - (int)q->method->id;
}

static void make_plot(const Threeway *reports, size_t count, int renderer, Plot *plot)
{
    *plot = (Plot){0};
    set_errors(plot, reports, count);
    for (size_t i = 0; i < count; i++) {
        double time_ms = reports[i].frames[renderer].time_ms, error;
        error = error_of(&reports[i], renderer);
        if (isfinite(error) && isfinite(time_ms) && time_ms > 0.0)
            plot->marks[plot->count++] = (Mark){
                .method = method_info(reports[i].desc.method), .time_ms = time_ms, .error = error};
    }
    set_times(plot);
    qsort(plot->marks, plot->count, sizeof plot->marks[0], left_first);
    for (size_t i = 0; i < plot->count; i++) {
        Mark *mark = &plot->marks[i];
        mark->x = x_of(plot, mark->time_ms);
        mark->y = y_at(plot, mark->error > 0.0 ? log10(mark->error) : plot->y_low);
    }
}

/* ---- labels ---------------------------------------------------------------------------------- */

static bool overlap(const Box *a, const Box *b)
{
    return a->x0 < b->x1 && b->x0 < a->x1 && a->y0 < b->y1 && b->y0 < a->y1;
}

/* Whether the line of a mark passes through a box: looked at every 2 units. */
static bool passes(const Mark *mark, const Box *box)
{
    double dx = mark->to[0] - mark->from[0], dy = mark->to[1] - mark->from[1];
    int steps = 1 + (int)(hypot(dx, dy) / 2.0);
    for (int i = 0; mark->has_leader && i <= steps; i++) {
        double x = mark->from[0] + dx * i / steps, y = mark->from[1] + dy * i / steps;
        if (x > box->x0 && x < box->x1 && y > box->y0 && y < box->y1)
            return true;
    }
    return false;
}

static double side(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool cross(const Mark *a, const Mark *b)
{
    return a->has_leader && b->has_leader &&
           side(a->from, a->to, b->from) * side(a->from, a->to, b->to) < 0.0 &&
           side(b->from, b->to, a->from) * side(b->from, b->to, a->to) < 0.0;
}

static Box point_box(const Mark *mark)
{
    const double r = MARK_RADIUS + 2;
    return (Box){mark->x - r, mark->y - r, mark->x + r, mark->y + r};
}

/* Whether mark's label and line are clear of every point, and of the labels and lines of the marks
 * before it. */
static bool is_clear(const Plot *plot, size_t index)
{
    const Mark *mark = &plot->marks[index];
    if (mark->label.x0 < PLOT_LEFT + 2 || mark->label.x1 > PLOT_RIGHT - 2 ||
        mark->label.y0 < PLOT_TOP + 2 || mark->label.y1 > PLOT_BOTTOM - 2)
        return false;
    Box own = point_box(mark);
    for (size_t i = 0; i < plot->count; i++) {
        const Mark *other = &plot->marks[i];
        Box point = point_box(other);
        if (overlap(&point, &mark->label) || (!overlap(&point, &own) && passes(mark, &point)))
            return false;
        if (i < index && (overlap(&other->label, &mark->label) || passes(mark, &other->label) ||
                          passes(other, &mark->label) || cross(mark, other)))
            return false;
    }
    return true;
}

/* Puts the label's middle at (x, y) and draws the line to its nearest edge. */
static void put_label(Mark *mark, double x, double y, bool has_leader)
{
    double half = 0.5 * letter_width * (double)strlen(mark->method->name);
    mark->label = (Box){x - half, y - 0.5 * LABEL_HEIGHT, x + half, y + 0.5 * LABEL_HEIGHT};
    mark->has_leader = has_leader;
    mark->to[0] = fmin(fmax(mark->x, mark->label.x0 - 2), mark->label.x1 + 2);
    mark->to[1] = fmin(fmax(mark->y, mark->label.y0 + 2), mark->label.y1 - 2);
    double dx = mark->to[0] - mark->x, dy = mark->to[1] - mark->y;
    double length = fmax(hypot(dx, dy), MARK_RADIUS + 1.0);
    mark->from[0] = mark->x + dx * (MARK_RADIUS + 1.0) / length;
    mark->from[1] = mark->y + dy * (MARK_RADIUS + 1.0) / length;
}

/* Puts the label into the first clear place; without one, above, and returns false. crowded: only
 * to the left, in steps up or down, which leaves the way free to points further right. */
static bool place_label(Plot *plot, size_t index, bool crowded)
{
    Mark *mark = &plot->marks[index];
    double half = 0.5 * letter_width * (double)strlen(mark->method->name);
    const double beside = half + MARK_RADIUS + 4, above = 0.5 * LABEL_HEIGHT + MARK_RADIUS + 3;
    const double near_by[][2] = {{-beside, 0.0}, {beside, 0.0}, {0.0, -above}, {0.0, above}};
    /* Multiples of half the width, and of the ring. */
    static const double rings[][2] = {{-1.0, -1.0}, {-1.0, 1.0}, {0.0, -1.0},  {0.0, 1.0},
                                      {1.0, -1.0},  {1.0, 1.0},  {-1.5, -1.0}, {1.5, -1.0},
                                      {-1.5, 1.0},  {1.5, 1.0}};
    for (int i = 0; i < (crowded ? 1 : 4); i++) {
        put_label(mark, mark->x + near_by[i][0], mark->y + near_by[i][1], false);
        if (is_clear(plot, index))
            return true;
    }
    for (int ring = 1; ring <= RINGS; ring++)
        for (int i = 0; i < (crowded ? 2 : 10); i++) {
            double reach = above + 18.0 * (ring - 1);
            put_label(mark, mark->x + rings[i][0] * (half + 4.0), mark->y + rings[i][1] * reach,
                      true);
            if (is_clear(plot, index))
                return true;
        }
    put_label(mark, mark->x, mark->y - above, false);
    return false;
}

static void place_labels(Plot *plot)
{
    bool placed = true;
    for (size_t i = 0; i < plot->count; i++)
        placed &= place_label(plot, i, false);
    for (size_t i = 0; i < plot->count && !placed; i++)
        place_label(plot, i, true);
}

/* ---- drawing --------------------------------------------------------------------------------- */

static void put_power(FileWriter *page, int exponent)
{
    if (exponent == 0)
        file_writer_print(page, "1");
    else
        file_writer_print(page, "10<tspan class=\"power\" dy=\"-5\">%s%d</tspan>",
                          exponent < 0 ? "&minus;" : "", abs(exponent));
}

static void put_error_axis(FileWriter *page, const Plot *plot)
{
    int step = 1 + (plot->y_high - plot->y_low) / 12;
    for (int exponent = plot->y_low; exponent <= plot->y_high; exponent += step) {
        double y = y_at(plot, exponent);
        file_writer_print(page,
                          "<line class=\"grid\" x1=\"%d\" y1=\"%.1f\" x2=\"%d\" y2=\"%.1f\"/>"
                          "<text class=\"tick\" text-anchor=\"end\" x=\"%d\" y=\"%.1f\">",
                          PLOT_LEFT, y, PLOT_RIGHT, y, PLOT_LEFT - 8, y + 4);
        if (plot->has_zero && exponent == plot->y_low)
            file_writer_print(page, "0");
        else
            put_power(page, exponent);
        file_writer_print(page, "</text>\n");
    }
    file_writer_print(page,
                      "<text class=\"axis\" text-anchor=\"middle\" transform=\"translate(14 %d) "
                      "rotate(-90)\">root mean square error against truth</text>\n",
                      (PLOT_TOP + PLOT_BOTTOM) / 2);
}

static void put_time_axis(FileWriter *page, const Plot *plot, int renderer)
{
    static const double steps[] = {1.0, 2.0, 5.0};
    int fine = plot->x_high - plot->x_low < 3.0 ? 3 : 1;
    for (int exponent = (int)floor(plot->x_low); exponent <= plot->x_high; exponent++)
        for (int i = 0; i < fine; i++) {
            double time_ms = steps[i] * pow(10.0, exponent), x = x_of(plot, time_ms);
            if (x < PLOT_LEFT || x > PLOT_RIGHT)
                continue;
            file_writer_print(page,
                              "<line class=\"grid\" x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\"/>"
                              "<text class=\"tick\" text-anchor=\"middle\" x=\"%.1f\" y=\"%d\">%g"
                              "</text>\n",
                              x, PLOT_TOP, x, PLOT_BOTTOM, x, PLOT_BOTTOM + 19, time_ms);
        }
    file_writer_print(page,
                      "<text class=\"axis\" text-anchor=\"middle\" x=\"%d\" y=\"%d\">wall time of "
                      "%s, milliseconds</text>\n",
                      (PLOT_LEFT + PLOT_RIGHT) / 2, PLOT_BOTTOM + 44,
                      threeway_renderer_name(renderer));
}

static void put_mark(FileWriter *page, const Mark *mark)
{
    const double r = MARK_RADIUS;
    char error[SUMMARY_NUMBER];
    file_writer_print(page, "<g><title>%s: %.1f ms, error %s</title>", mark->method->name,
                      mark->time_ms, summary_real(mark->error, error));
    if (mark->method->exact)
        file_writer_print(page, "<circle class=\"exact\" cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>",
                          mark->x, mark->y, r - 0.5);
    else
        file_writer_print(page,
                          "<path class=\"approximate\" d=\"M%.1f %.1fl%.0f %.0fl-%.0f %.0fl-%.0f "
                          "-%.0fz\"/>",
                          mark->x, mark->y - r, r, r, r, r, r, r);
    if (mark->has_leader)
        file_writer_print(
            page, "<line class=\"leader\" x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\"/>",
            mark->from[0], mark->from[1], mark->to[0], mark->to[1]);
    /* Held at the side of the point, so that letters wider or narrower than expected do not touch
     * it. */
    double middle = 0.5 * (mark->label.x0 + mark->label.x1);
    bool right = middle > mark->x + 1.0, left = middle < mark->x - 1.0;
    file_writer_print(page, "<text text-anchor=\"%s\" x=\"%.1f\" y=\"%.1f\">%s</text></g>\n",
                      right  ? "start"
                      : left ? "end"
                             : "middle",
                      right  ? mark->label.x0
                      : left ? mark->label.x1
                             : middle,
                      mark->label.y1 - 4.5, mark->method->name);
}

/* A sample of each kind of point, for the caption. */
static void put_legend(FileWriter *page)
{
    file_writer_print(page,
                      "<svg class=\"sample\" width=\"14\" height=\"14\" aria-hidden=\"true\">"
                      "<circle class=\"exact\" cx=\"7\" cy=\"7\" r=\"5.5\"/></svg> exact "
                      "<svg class=\"sample\" width=\"14\" height=\"14\" aria-hidden=\"true\">"
                      "<path class=\"approximate\" d=\"M7 1l6 6l-6 6l-6 -6z\"/></svg> approximate");
}

void html_plot(FileWriter *page, const Threeway *reports, size_t count, int renderer)
{
    Plot plot;
    make_plot(reports, count, renderer, &plot);
    place_labels(&plot);
    file_writer_print(page,
                      "<figure class=\"plot\">\n<div tabindex=\"0\" role=\"region\" "
                      "aria-label=\"Plot of %s\">\n<svg viewBox=\"0 0 %d %d\" role=\"img\" "
                      "aria-label=\"Error against time of %s, both logarithmic; the table has the "
                      "numbers\">\n",
                      threeway_renderer_name(renderer), PLOT_WIDTH, PLOT_HEIGHT,
                      threeway_renderer_name(renderer));
    put_error_axis(page, &plot);
    put_time_axis(page, &plot, renderer);
    for (size_t i = 0; i < plot.count; i++)
        put_mark(page, &plot.marks[i]);
    file_writer_print(page, "</svg>\n</div>\n<figcaption><strong>%s</strong> ",
                      threeway_renderer_name(renderer));
    put_legend(page);
    if (plot.count < count)
        file_writer_print(page, "; %zu without a finite error or a time left out",
                          count - plot.count);
    file_writer_print(page, "</figcaption>\n</figure>\n");
}
