#include "report/bench_plot.h"

#include "frame/method.h"
#include "report/bench.h"
#include "report/gnuplot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *const colors[BENCH_RENDERERS] = {"#1f5fae", "#b3261e", "#c77700", "#17653a"};

const char *bench_axis_name(BenchAxis axis)
{
    static const char *const names[BENCH_AXES] = {"passes", "lights", "triangles", "pixels",
                                                  "threads"};
    return names[axis];
}

static double value_of(const BenchReport *report, const BenchRow *row, BenchAxis axis)
{
    switch (axis) {
    case BENCH_PASSES:
        return row->passes ? (double)row->passes : (double)NAN;
    case BENCH_LIGHTS:
        return row->lights;
    case BENCH_TRIANGLES:
        return (double)scene_triangle_count(report->plan->scenes[row->scene].scene);
    case BENCH_PIXELS:
        return (double)row->width * (double)row->height;
    default:
        return row->threads;
    }
}

/* As a tick says it. */
static void label_of(const BenchReport *report, const BenchRow *row, BenchAxis axis, char *text,
                     size_t size)
{
    const char *scene = report->plan->scenes[row->scene].scene->name;
    double value = value_of(report, row, axis);
    if (axis == BENCH_PIXELS)
        snprintf(text, size, "%dx%d", row->width, row->height);
    else if (axis == BENCH_TRIANGLES)
        snprintf(text, size, "%.60s", scene);
    else if (isnan(value))
        snprintf(text, size, "auto passes");
    else
        snprintf(text, size, "%.0f %s", value, bench_axis_name(axis));
}

bool bench_axis_varies(const BenchReport *report, BenchAxis axis)
{
    bool varies = false;
    for (size_t i = 0; i < report->count; i++) {
        double value = value_of(report, &report->rows[i], axis);
        if (!(value > 0.0))
            return false;
        varies |= value != value_of(report, &report->rows[0], axis);
    }
    return varies;
}

/* ---- scales ---------------------------------------------------------------------------------- */

typedef struct Range {
    double low, high;
} Range;

static void extend(Range *range, double value)
{
    range->low = fmin(range->low, value);
    range->high = fmax(range->high, value);
}

/* Ticks at 1, 2 and 5 times the powers of ten, or, over many, at those; the range ends at ticks. */
static void put_scale(FILE *script, const char *axis, Range range)
{
    static const double steps[] = {1.0, 2.0, 5.0};
    bool fine = range.high < 1e3 * range.low;
    double low = 0.0, high = 0.0;
    fprintf(script, "set %stics (", axis);
    const char *separator = "";
    for (int power = (int)floor(log10(range.low)); !(high >= range.high); power++)
        for (int i = 0; i < (fine ? 3 : 1) && !(high >= range.high); i++) {
            double tick = steps[i] * pow(10.0, power);
            if (tick <= range.low * (1.0 + 1e-9) || low == 0.0)
                low = tick;
            high = tick;
            fprintf(script, "%s'%g' %.9g", separator, tick, tick);
            separator = ", ";
        }
    if (high <= low)
        high = 2.0 * low;
    fprintf(script, ") nomirror\nset logscale %s\nset %srange [%.9g:%.9g]\n", axis, axis, low,
            high);
}

static void put_head(FILE *script, const char *x, const char *y)
{
    fprintf(script,
            "set terminal svg size 720,420 dynamic font 'sans-serif,13' background '#ffffff'\n"
            "set grid back linecolor '#dddddd'\nset border 3 linecolor '#566070'\n"
            "set key below reverse Left noenhanced\n"
            "set xlabel '%s'\nset ylabel '%s'\n",
            x, y);
}

/* ---- time against an axis -------------------------------------------------------------------- */

typedef struct AxisPlot {
    const BenchReport *report;
    BenchAxis axis;
} AxisPlot;

/* The first row, and the last in its format: the ends at which other axes are held. */
static const BenchRow *end_of(const BenchReport *report, int end)
{
    const BenchRow *row = &report->rows[end ? report->count - 1 : 0];
    while (row->format != report->rows[0].format)
        row--;
    return row;
}

static bool is_held(const AxisPlot *plot, const BenchRow *row, int end)
{
    const BenchRow *held = end_of(plot->report, end);
    for (int other = 0; other < BENCH_AXES; other++) {
        double a = value_of(plot->report, row, (BenchAxis)other);
        double b = value_of(plot->report, held, (BenchAxis)other);
        if (other != (int)plot->axis && a != b && !(isnan(a) && isnan(b)))
            return false;
    }
    /* Lights and triangles both follow the scene where all of it is asked for. */
    return row->format == 0 && (plot->axis == BENCH_TRIANGLES || row->scene == held->scene);
}

static bool ends_differ(const AxisPlot *plot)
{
    const BenchReport *report = plot->report;
    return !is_held(plot, end_of(report, 0), 1);
}

/* Whether the two ends have other values of it; of triangles: other scenes. */
static bool differs(const BenchReport *report, BenchAxis axis)
{
    const BenchRow *a = end_of(report, 0), *b = end_of(report, 1);
    double x = value_of(report, a, axis), y = value_of(report, b, axis);
    return axis == BENCH_TRIANGLES ? a->scene != b->scene : x != y && !(isnan(x) && isnan(y));
}

/* "gl, peel, 16 lights": what distinguishes this curve. */
static void name_curve(const AxisPlot *plot, int renderer, MethodId method, int end, char *text,
                       size_t size)
{
    const BenchReport *report = plot->report;
    int length = snprintf(text, size, "%s", bench_renderer_name(renderer));
    if (report->plan->method_count > 1)
        length += snprintf(text + length, size - (size_t)length, ", %s", method_info(method)->name);
    for (int other = 0; other < BENCH_AXES && ends_differ(plot); other++) {
        char label[80];
        if (other == (int)plot->axis || !differs(report, (BenchAxis)other))
            continue;
        label_of(report, end_of(report, end), (BenchAxis)other, label, sizeof label);
        length += snprintf(text + length, size - (size_t)length, ", %s", label);
    }
}

/* The points of a curve as a data block; returns how many. */
static int put_curve(FILE *script, const AxisPlot *plot, int renderer, MethodId method, int end)
{
    int points = 0;
    fprintf(script, "$curve_%d_%d_%d << END\n", renderer, (int)method, end);
    for (size_t i = 0; i < plot->report->count; i++) {
        const BenchRow *row = &plot->report->rows[i];
        if (row->renderer != renderer || row->method != method || !is_held(plot, row, end) ||
            !(row->cpu_ms > 0.0))
            continue;
        fprintf(script, "%.9g %.9g\n", value_of(plot->report, row, plot->axis), row->cpu_ms);
        points++;
    }
    fprintf(script, "END\n");
    return points;
}

static void put_axis(FILE *script, const AxisPlot *plot)
{
    const BenchReport *report = plot->report;
    Range range = {INFINITY, 0.0}, values = {INFINITY, 0.0};
    fprintf(script, "set xtics nomirror (");
    for (size_t i = 0; i < report->count; i++) {
        const BenchRow *row = &report->rows[i];
        char label[80];
        double value = value_of(report, row, plot->axis);
        label_of(report, row, plot->axis, label, sizeof label);
        if (plot->axis == BENCH_PIXELS)
            fprintf(script, "%s'%s' %.9g", i ? ", " : "", label, value);
        else
            fprintf(script, "%s'%.0f' %.9g", i ? ", " : "", value, value);
        extend(&values, value);
        if (row->cpu_ms > 0.0)
            extend(&range, row->cpu_ms);
    }
    double room = pow(values.high / values.low, 0.08);
    fprintf(script, ")\nset logscale x\nset xrange [%.9g:%.9g]\n", values.low / room,
            values.high * room);
    if (range.high > 0.0)
        put_scale(script, "y", range);
}

static void write_axis(FILE *script, const void *what)
{
    const AxisPlot *plot = what;
    const BenchPlan *plan = plot->report->plan;
    bool curves[BENCH_RENDERERS][BENCH_AXIS_MAX][2] = {{{false}}};
    put_head(script, bench_axis_name(plot->axis), "CPU time, ms");
    put_axis(script, plot);
    for (int r = 0; r < BENCH_RENDERERS; r++)
        for (int m = 0; m < plan->method_count; m++)
            for (int end = 0; end < (ends_differ(plot) ? 2 : 1); end++)
                curves[r][m][end] = put_curve(script, plot, r, plan->methods[m], end) > 0;
    const char *separator = "plot ";
    for (int r = 0; r < BENCH_RENDERERS; r++)
        for (int m = 0; m < plan->method_count; m++)
            for (int end = 0; end < 2; end++) {
                char name[256];
                if (!curves[r][m][end])
                    continue;
                name_curve(plot, r, plan->methods[m], end, name, sizeof name);
                fprintf(script,
                        "%s$curve_%d_%d_%d smooth unique with linespoints linewidth 2 "
                        "pointtype %d dashtype %d linecolor '%s' title ",
                        separator, r, (int)plan->methods[m], end, 4 + m, 1 + end, colors[r]);
                gnuplot_quote(script, name);
                separator = ", \\\n  ";
            }
    fprintf(script, "\n");
}

Result bench_plot_axis(const BenchReport *report, BenchAxis axis, const char *path)
{
    const AxisPlot plot = {report, axis};
    return gnuplot_draw(write_axis, &plot, path);
}

/* ---- time against error ---------------------------------------------------------------------- */

typedef struct ErrorPlot {
    const BenchReport *report;
    size_t first, count;
} ErrorPlot;

static bool has_place(const BenchRow *row)
{
    return row->cpu_ms > 0.0 && isfinite(row->rmse) && row->rmse > 0.0;
}

static int put_points(FILE *script, const ErrorPlot *plot, int renderer, Range *times,
                      Range *errors)
{
    int points = 0;
    fprintf(script, "$points_%d << END\n", renderer);
    for (size_t i = plot->first; i < plot->first + plot->count; i++) {
        const BenchRow *row = &plot->report->rows[i];
        if (row->renderer != renderer || !has_place(row))
            continue;
        fprintf(script, "%.9g %.9g\n", row->cpu_ms, row->rmse);
        extend(times, row->cpu_ms);
        extend(errors, row->rmse);
        points++;
    }
    fprintf(script, "END\n");
    return points;
}

/* Whether a label beside b would touch that of a. */
static bool is_near(const BenchRow *a, const BenchRow *b, Range times, Range errors)
{
    double x = fabs(log(a->cpu_ms / b->cpu_ms)) / log(4.0 * times.high / times.low);
    double y = fabs(log(a->rmse / b->rmse)) / log(4.0 * errors.high / errors.low);
    return x < 0.3 && y < 0.045;
}

/* What a row is, as far as rows of the plot may differ. */
static void put_label(FILE *script, const BenchPlan *plan, const BenchRow *row)
{
    char passes[REPORT_BENCH_PASSES];
    fprintf(script, " \"");
    if (plan->method_count > 1)
        fprintf(script, "%s ", method_info(row->method)->name);
    fprintf(script, "%s%s", report_bench_passes(row->passes, passes),
            row->passes == 1 ? " pass" : " passes");
    if (plan->format_count > 1)
        fprintf(script, " %s", plan->formats[row->format].name);
    fprintf(script, "\"");
}

/* The front, and what its points are where there is room to say it. */
static int put_front(FILE *script, const ErrorPlot *plot, Range times, Range errors)
{
    const BenchRow *labelled[BENCH_AXIS_MAX];
    int points = 0, labels = 0;
    fprintf(script, "$front << END\n");
    for (size_t i = plot->first; i < plot->first + plot->count; i++) {
        const BenchRow *row = &plot->report->rows[i];
        bool room = labels < BENCH_AXIS_MAX;
        if (!row->pareto || !has_place(row))
            continue;
        for (int k = 0; k < labels && room; k++)
            room = !is_near(labelled[k], row, times, errors);
        fprintf(script, "%.9g %.9g", row->cpu_ms, row->rmse);
        if (room)
            put_label(script, plot->report->plan, labelled[labels++] = row);
        fprintf(script, room ? "\n" : " \"\"\n");
        points++;
    }
    fprintf(script, "END\n");
    return points;
}

static void write_errors(FILE *script, const void *what)
{
    const ErrorPlot *plot = what;
    Range times = {INFINITY, 0.0}, errors = {INFINITY, 0.0};
    int points[BENCH_RENDERERS];
    put_head(script, "CPU time, ms", "root mean square error against truth");
    for (int r = 0; r < BENCH_RENDERERS; r++)
        points[r] = put_points(script, plot, r, &times, &errors);
    int front = put_front(script, plot, times, errors);
    /* Room for the labels on the right. */
    put_scale(script, "x", (Range){times.low, 2.0 * times.high});
    put_scale(script, "y", errors);
    const char *separator = "plot ";
    for (int r = 0; r < BENCH_RENDERERS; r++)
        if (points[r] > 0) {
            fprintf(script,
                    "%s$points_%d with points pointtype 7 pointsize 0.7 linecolor '%s' title '%s'",
                    separator, r, colors[r], bench_renderer_name(r));
            separator = ", \\\n  ";
        }
    if (front > 0)
        fprintf(script,
                "%s$front using 1:2 with points pointtype 6 pointsize 1.4 linewidth 1.5 linecolor "
                "'#1b2029' title 'Pareto front'",
                separator);
    if (front > 0)
        fprintf(script,
                ", \\\n  $front using 1:2:3 with labels noenhanced left offset 1.2,0.4 font "
                "',11' notitle");
    fprintf(script, "\n");
}

Result bench_plot_errors(const BenchReport *report, size_t first, size_t count, const char *path)
{
    const ErrorPlot plot = {report, first, count};
    return gnuplot_draw(write_errors, &plot, path);
}
