#include "frame/method.h"
#include "report/plan.h"
#include "report/summary.h"

#include <string.h>

enum {
    ROWS_MAX = 24, /* of the histogram */
    BAR = 40
};

/* ---- layers ---- */

static double share(uint64_t part, uint64_t whole)
{
    return whole ? (double)part / (double)whole : 0.0;
}

static uint64_t pixels_of(const Plan *plan)
{
    return (uint64_t)plan->desc.width * (uint64_t)plan->desc.height;
}

/* Pixels with low … high layers. */
static uint64_t sum_of(const uint64_t *histogram, uint32_t most, uint32_t low, uint32_t high)
{
    uint64_t sum = 0;
    for (uint32_t i = low; i <= high && i <= most; i++)
        sum += histogram[i];
    return sum;
}

static void print_histogram(const Plan *plan, FILE *out)
{
    const LayerCounts *layers = &plan->layers;
    uint32_t most = layers->most.fragments, step = most / ROWS_MAX + 1;
    char bar[BAR + 1], label[32], first[SUMMARY_NUMBER], second[SUMMARY_NUMBER];
    memset(bar, '#', BAR);
    bar[BAR] = '\0';
    fprintf(out, "  %-12s %12s %7s   %12s\n", "layers", "pixels", "", "told apart");
    for (uint32_t low = 0; low <= most; low += low ? step : 1) {
        uint32_t high = low ? low + step - 1 : 0;
        uint64_t count = sum_of(layers->histogram, most, low, high);
        double part = share(count, pixels_of(plan));
        if (high > low)
            snprintf(label, sizeof label, "%u-%u", low, high < most ? high : most);
        else
            snprintf(label, sizeof label, "%u", low);
        fprintf(
            out, "  %-12s %12s %5.1f %%   %12s  %.*s\n", label, summary_count(count, first),
            100.0 * part,
            summary_count(sum_of(layers->peel_histogram, layers->most.peels, low, high), second),
            (int)(part * BAR + 0.5), bar);
    }
}

static void print_layers(const Plan *plan, FILE *out)
{
    const LayerCounts *layers = &plan->layers;
    char fragments[SUMMARY_NUMBER], peels[SUMMARY_NUMBER], opaque[SUMMARY_NUMBER];
    char transparent[SUMMARY_NUMBER];
    double mean = share(layers->fragments, pixels_of(plan));
    fprintf(out, "\nLayers: transparent fragments in front of the opaque depth\n");
    fprintf(out,
            "  at most %u a pixel, %.3g on average; %s in all, of which peeling by depth tells "
            "%s apart (at most %u)\n",
            layers->most.fragments, mean, summary_count(layers->fragments, fragments),
            summary_count(layers->peels, peels), layers->most.peels);
    fprintf(out, "  primitives on screen: %s opaque, %s transparent\n",
            summary_count(layers->opaque_primitives, opaque),
            summary_count(layers->transparent_primitives, transparent));
    print_histogram(plan, out);
}

static void print_passes(const Plan *plan, FILE *out)
{
    fprintf(out, "\nPasses over the transparent geometry for all layers%s\n",
            plan->desc.peel_test == PEEL_TEST_RAW
                ? ", with depths compared as stored (raw ones repeat and lose layers)"
                : "");
    for (int i = 0; i < METHOD_COUNT; i++)
        fprintf(out, "  %-17s %6d%s\n", method_info((MethodId)i)->name, plan->passes[i],
                method_info((MethodId)i)->exact ? "" : "  (approximate)");
}

/* ---- memory ---- */

static double mebibytes(uint64_t bytes)
{
    return (double)bytes / 1048576.0;
}

static void print_buffers(const Plan *plan, FILE *out)
{
    const PlanBuffers *buffers = &plan->buffers;
    char bytes[SUMMARY_NUMBER];
    fprintf(out, "\nBuffers of the GL pipeline, %s\n", method_info(plan->desc.method)->name);
    fprintf(out, "  %-18s %-8s %8s %16s\n", "name", "format", "B/pixel", "bytes");
    for (size_t i = 0; i < buffers->count; i++) {
        const PlanBuffer *buffer = &buffers->items[i];
        char pixel[24] = "";
        bool image = buffer->format != FORMAT_NONE;
        if (image)
            snprintf(pixel, sizeof pixel, "%zu", format_pixel_bytes(buffer->format));
        fprintf(out, "  %-18s %-8s %8s %16s\n", buffer->name,
                image ? format_info(buffer->format)->name : "", pixel,
                summary_count(buffer->bytes, bytes));
    }
    fprintf(out, "  %-18s %-8s %8s %16s  = %.1f MiB; with nothing left out %.1f MiB\n", "all", "",
            "", summary_count(buffers->bytes, bytes), mebibytes(buffers->bytes),
            mebibytes(plan->bytes_of_all));
    fprintf(out,
            "  ref, measured: %.1f MiB at its peak, of which vertices, primitives and bins "
            "%.1f MiB; %.1f ms\n",
            mebibytes(plan->frame.buffer_bytes), mebibytes(plan->layers.geometry_bytes),
            plan->frame.time_ms);
}

/* ---- what is needed ---- */

static void print_needs(const Plan *plan, FILE *out)
{
    const Needs *needs = &plan->needs;
    fprintf(out, "\nNeeded\n");
    for (int i = 0; i < NEED_ACTED_ON; i++)
        if (needs->items[i].needed)
            fprintf(out, "  %-22s %s\n", needs_name((NeedId)i), needs->items[i].why);
    fprintf(out, "\nLeft out, without changing a bit\n");
    int left = 0;
    for (int i = 0; i < NEED_ACTED_ON; i++)
        if (!needs->items[i].needed && ++left)
            fprintf(out, "  %-22s %s\n", needs_name((NeedId)i), needs->items[i].why);
    if (needs->dark_lights > 0 && needs->lights > 0 && ++left)
        fprintf(out, "  %-22s %zu of %zu are black\n", "lights", needs->dark_lights,
                needs->lights + needs->dark_lights);
    if (left == 0)
        fprintf(out, "  nothing\n");
    fprintf(out, "\nGood to know\n");
    for (int i = NEED_ACTED_ON; i < NEED_COUNT; i++)
        fprintf(out, "  %-22s %s: %s\n", needs_name((NeedId)i),
                needs->items[i].needed ? "needed" : "not needed", needs->items[i].why);
}

void report_plan_print(const Plan *plan, FILE *out)
{
    fprintf(out, "%s (%s), %dx%d, method %s, %zu lights\n", plan->scene_name, plan->scene_path,
            plan->desc.width, plan->desc.height, method_info(plan->desc.method)->name,
            plan->needs.lights);
    print_layers(plan, out);
    print_passes(plan, out);
    print_buffers(plan, out);
    print_needs(plan, out);
}

/* ---- choices ---- */

static void print_choice(const PlanChoice *choice, FILE *out)
{
    char passes[16] = "auto", error[SUMMARY_NUMBER];
    if (choice->passes > 0)
        snprintf(passes, sizeof passes, "%d", choice->passes);
    fprintf(out, "  %-17s %6s %-8s %-8s %10.2f %10.2f %10s%s\n", method_info(choice->method)->name,
            passes, format_info(choice->accum)->name, gbuffer_name(choice->gbuffer), choice->cpu_ms,
            choice->wall_ms, summary_real(choice->error, error), choice->chosen ? "  chosen" : "");
}

/* The next of the front by time, and what was chosen; −1: no more. */
static int next_on_front(const PlanSearch *search, int last)
{
    int next = -1;
    for (int i = 0; i < (int)search->count; i++) {
        const PlanChoice *choice = &search->choices[i];
        double cost = choice->cpu_ms, from = last < 0 ? -1.0 : search->choices[last].cpu_ms;
        bool after = cost > from || (cost == from && i > last);
        if ((choice->pareto || choice->chosen) && after &&
            (next < 0 || cost < search->choices[next].cpu_ms))
            next = i;
    }
    return next;
}

void report_plan_choices(const PlanSearch *search, const char *command, FILE *out)
{
    fprintf(out,
            "\nTime of ref against error (%s) from truth: the front of %zu settings measured\n",
            plan_metric_name(search->metric), search->count);
    fprintf(out, "  %-17s %6s %-8s %-8s %10s %10s %10s\n", "method", "passes", "accum", "gbuffer",
            "CPU ms", "wall ms", "error");
    for (int i = next_on_front(search, -1); i >= 0; i = next_on_front(search, i))
        print_choice(&search->choices[i], out);
    if (command)
        fprintf(out, "\nCheapest with an error of at most %g:\n  %s\n", search->max_error, command);
}
