#include "report/summary.h"

#include "frame/method.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

const char *summary_count(uint64_t value, char out[SUMMARY_NUMBER])
{
    char digits[24];
    int length = snprintf(digits, sizeof digits, "%" PRIu64, value);
    char *end = out;
    for (int i = 0; i < length; i++) {
        if (i && (length - i) % 3 == 0)
            *end++ = ',';
        *end++ = digits[i];
    }
    *end = 0;
    return out;
}

const char *summary_real(double value, char out[SUMMARY_NUMBER])
{
    snprintf(out, SUMMARY_NUMBER, "%.3g", value);
    return out;
}

const char *summary_ulp(uint32_t value, char out[SUMMARY_NUMBER])
{
    if (value != UINT32_MAX)
        return summary_count(value, out);
    snprintf(out, SUMMARY_NUMBER, "NaN");
    return out;
}

const char *summary_psnr(double value, char out[SUMMARY_NUMBER])
{
    if (isnan(value)) /* no pixel is finite on both sides */
        snprintf(out, SUMMARY_NUMBER, "none");
    else if (isinf(value) && value > 0)
        snprintf(out, SUMMARY_NUMBER, "equal");
    else
        snprintf(out, SUMMARY_NUMBER, "%.1f dB", value);
    return out;
}

/* The end of the run of equal buffers that starts at begin. */
static size_t equal_run(const PairReport *pair, size_t begin)
{
    size_t end = begin;
    while (end < pair->buffer_count && pair->buffers[end].differing == 0)
        end++;
    return end;
}

SummaryRow summary_row_of(const BufferMetrics *buffer)
{
    SummaryRow row = {.buffers = 1,
                      .values = buffer->values,
                      .differing = buffer->differing,
                      .max_ulp = buffer->max_ulp,
                      .max_abs = buffer->max_abs,
                      .has_first = buffer->has_first};
    memcpy(row.first, buffer->first, sizeof row.first);
    snprintf(row.label, sizeof row.label, "%s", buffer->name);
    return row;
}

bool summary_row(const PairReport *pair, size_t unfolded, size_t *cursor, SummaryRow *out)
{
    size_t begin = *cursor, end = equal_run(pair, begin);
    if (begin >= pair->buffer_count)
        return false;
    *out = summary_row_of(&pair->buffers[begin]);
    *cursor = begin + 1;
    if (pair->buffer_count <= unfolded || end < begin + 3)
        return true;
    out->buffers = end - begin;
    for (size_t i = begin + 1; i < end; i++)
        out->values += pair->buffers[i].values;
    snprintf(out->label, sizeof out->label, "%s to %s", pair->buffers[begin].name,
             pair->buffers[end - 1].name);
    *cursor = end;
    return true;
}

SummaryTotals summary_totals(const PairReport *pair)
{
    SummaryTotals totals = {.buffers = pair->buffer_count};
    for (size_t i = 0; i < pair->buffer_count; i++) {
        const BufferMetrics *buffer = &pair->buffers[i];
        totals.values += buffer->values;
        totals.values_differing += buffer->differing;
        totals.buffers_differing += buffer->differing != 0;
        if (buffer->differing && !totals.first)
            totals.first = buffer;
    }
    return totals;
}

static void describe_passes(const Threeway *report, char *out, size_t size)
{
    int peels = report->frames[RENDERER_REF].peels;
    if (!method_info(report->desc.method)->exact)
        snprintf(out, size, "none, one pass");
    else if (report->desc.method == METHOD_LINKED_LIST && !report->desc.passes)
        snprintf(out, size, "%d layers, one pass", peels);
    else if (report->desc.passes)
        snprintf(out, size, "%d, limit %d", peels, report->desc.passes);
    else
        snprintf(out, size, "%d, until a peel yields no fragment", peels);
}

static void describe_lights(const Threeway *report, char *out, size_t size)
{
    int limit = report->desc.lights;
    if (limit < 0)
        snprintf(out, size, "none");
    else if (limit == 0 || (size_t)limit >= report->light_count)
        snprintf(out, size, "all %zu of the scene", report->light_count);
    else
        snprintf(out, size, "first %d of %zu", limit, report->light_count);
}

#define SETTING(label, ...)                                                                        \
    do {                                                                                           \
        out[n].name = label;                                                                       \
        snprintf(out[n++].value, sizeof out[0].value, __VA_ARGS__);                                \
    } while (0)

/* Those that few comparisons set, or one method has. Returns n, one more for each. */
static int add_options(const RenderDesc *desc, SummarySetting *out, int n)
{
    static const char *const weights[] = {"9", "7", "8", "10"};
    if (desc->bias > 0.0f)
        SETTING("Bias", "%g", (double)desc->bias);
    if (desc->draw_order == DRAW_ORDER_SHUFFLE)
        SETTING("Draw order", "shuffled, seed %" PRIu64, desc->draw_seed);
    else if (desc->draw_order == DRAW_ORDER_REVERSE)
        SETTING("Draw order", "reversed");
    if (desc->sort != SORT_OBJECTS || desc->method == METHOD_PAINTER)
        SETTING("Painter sorts", "%s", desc->sort == SORT_TRIANGLES ? "triangles" : "objects");
    if (desc->weight != WEIGHT_9 || desc->method == METHOD_WEIGHTED_BLENDED)
        SETTING("Weight", "equation %s", weights[desc->weight]);
    if (desc->nodes_per_pixel)
        SETTING("Nodes per pixel", "%d", desc->nodes_per_pixel);
    if (desc->post == POST_EDGES)
        SETTING("Post-process", "edges, of linked-list");
    return n;
}

int summary_settings(const Threeway *report, SummarySetting out[SUMMARY_SETTINGS])
{
    static const char *const culls[] = {"as glTF says", "opaque only (seed)", "none"};
    static const char *const ranges[] = {"", ", zero-one", ", reversed"};
    const RenderDesc *desc = &report->desc;
    int n = 0;
    SETTING("Size", "%d × %d", desc->width, desc->height);
    SETTING("Method", "%s", method_info(desc->method)->name);
    out[n].name = "Peels";
    describe_passes(report, out[n].value, sizeof out[n].value);
    n++;
    out[n].name = "Lights";
    describe_lights(report, out[n].value, sizeof out[n].value);
    n++;
    SETTING("Camera", "%d", desc->camera);
    SETTING("Time", "%g s", desc->time);
    SETTING("Profile", "%s", report->seed_profile ? "seed" : "default");
    SETTING("Depth", "%s, %s%s", format_info(render_desc_depth(desc))->name,
            desc->depth_func == DEPTH_LEQUAL ? "lequal" : "less", ranges[desc->depth_range]);
    SETTING("Accumulation", "%s", format_info(desc->accum)->name);
    SETTING("G-buffer", "%s, position %s",
            gbuffer_name(desc->method == METHOD_LINKED_LIST ? GBUFFER_COMPACT : desc->gbuffer),
            render_desc_layout(desc).position == FORMAT_NONE ? "from depth" : "stored");
    SETTING("Peel test", "%s", desc->peel_test == PEEL_TEST_RAW ? "raw" : "stored");
    SETTING("Culling", "%s", culls[desc->cull]);
    SETTING("Normals", "%s", desc->normals == NORMALS_KEPT ? "kept" : "faced");
    if (desc->shading == SHADING_PHONG)
        SETTING("Shading", "Phong, one directional light");
    else
        SETTING("Shading", "GGX, %s form%s", desc->ggx == GGX_STABLE ? "stable" : "source",
                desc->back_light ? ", back light" : "");
    SETTING("Arithmetic", "%s",
            report->frames[RENDERER_REF].fused ? "fused multiply-add" : "separate multiply, add");
    SETTING("Tolerance", "%g", report->tolerance);
    return add_options(desc, out, n);
}

#undef SETTING

void summary_pair_exact(const Threeway *report, char out[SUMMARY_LINE])
{
    const PairReport *pair = &report->pairs[0];
    SummaryTotals totals = summary_totals(pair);
    char values[SUMMARY_NUMBER], differing[SUMMARY_NUMBER];
    summary_count(totals.values, values);
    summary_count(totals.values_differing, differing);
    if (totals.first)
        snprintf(out, SUMMARY_LINE,
                 "ref and gl differ in %s of %s values, in %zu of %zu buffers; first in %s at "
                 "x %d, y %d, channel %d.",
                 differing, values, totals.buffers_differing, totals.buffers, totals.first->name,
                 totals.first->first[0], totals.first->first[1], totals.first->first[2]);
    else if (pair->final.differing)
        snprintf(out, SUMMARY_LINE,
                 "ref and gl agree bit for bit in %zu buffers, but their final images differ in "
                 "%s pixels.",
                 totals.buffers, summary_count(pair->final.differing, differing));
    else
        snprintf(out, SUMMARY_LINE, "ref and gl agree bit for bit: %s values in %zu buffers.",
                 values, totals.buffers);
    size_t length = strlen(out);
    if (report->structure.layers.lost_to_overflow)
        snprintf(out + length, SUMMARY_LINE - length,
                 " Lists had too little room; in gl it depends on threads what is lost, so no "
                 "equality is claimed.");
}

void summary_pair_truth(const Threeway *report, char out[SUMMARY_LINE])
{
    const PairReport *pair = &report->pairs[1];
    const UnaffectedMetrics *unaffected = &pair->unaffected;
    if (!method_is_judged(&report->desc)) {
        char most[SUMMARY_NUMBER], rmse[SUMMARY_NUMBER], nonfinite[SUMMARY_NUMBER];
        int length = snprintf(
            out, SUMMARY_LINE,
            "ref and truth: %s %s, so it is not judged; largest difference %s, root mean square "
            "%s.",
            method_info(report->desc.method)->name,
            method_info(report->desc.method)->exact ? "draws outlines, which truth has not"
                                                    : "approximates",
            summary_real(pair->final.max_abs, most), summary_real(pair->final.rmse, rmse));
        if (pair->final.nonfinite)
            snprintf(out + length, (size_t)(SUMMARY_LINE - length),
                     " Not finite, which is a fault: %s pixels.",
                     summary_count(pair->final.nonfinite, nonfinite));
        return;
    }
    if (!report->structure.same_scene) {
        char flips[SUMMARY_NUMBER], sets[SUMMARY_NUMBER], again[SUMMARY_NUMBER];
        snprintf(out, SUMMARY_LINE,
                 "ref and truth differ: they see other surfaces, %s opaque pixels and %s fragments "
                 "are not the same; %s fragments were peeled again.",
                 summary_count(report->structure.opaque_flips, flips),
                 summary_count(report->structure.set_differs, sets),
                 summary_count(report->structure.layers.repeated, again));
        return;
    }
    if (!unaffected->pixels) {
        snprintf(out, SUMMARY_LINE,
                 "ref and truth cannot be compared: no pixel has the same fragments in the same "
                 "order on both sides.");
        return;
    }
    char p99[SUMMARY_NUMBER], same[SUMMARY_NUMBER], all[SUMMARY_NUMBER];
    snprintf(out, SUMMARY_LINE,
             "ref and truth %s: 99th percentile of the relative difference %s (tolerance %g) over "
             "%s of %s pixels%s.",
             unaffected->p99_rel <= report->tolerance ? "agree" : "differ",
             summary_real(unaffected->p99_rel, p99), report->tolerance,
             summary_count(unaffected->pixels, same), summary_count(pair->final.pixels, all),
             report->structure.known ? ", those with the same fragments in the same order" : "");
    size_t length = strlen(out);
    if (unaffected->p99_rel <= report->tolerance)
        return;
    if (report->seed_profile)
        snprintf(out + length, SUMMARY_LINE - length,
                 " The seed profile stores in 8 and 16 bits, coarser than this tolerance allows.");
    else if (render_desc_layout(&report->desc).normal == FORMAT_RG16)
        snprintf(out + length, SUMMARY_LINE - length,
                 " The compact G-buffer stores in 8 and 16 bits, coarser than this tolerance "
                 "allows.");
}

void summary_residual(const Threeway *report, char out[SUMMARY_LINE])
{
    const Frame *frame = &report->frames[RENDERER_REF];
    char pixels[SUMMARY_NUMBER];
    out[0] = 0;
    if (frame->residual_pixels)
        snprintf(out, SUMMARY_LINE,
                 "The pass limit hides fragments in %s pixels; up to %.3g of their light would "
                 "still pass (residual transmittance).",
                 summary_count(frame->residual_pixels, pixels), frame->residual_max);
}

void summary_nodes(const Threeway *report, char out[SUMMARY_LINE])
{
    const Frame *frame = &report->frames[RENDERER_REF];
    char nodes[SUMMARY_NUMBER], lost[SUMMARY_NUMBER];
    out[0] = 0;
    if (!frame->node_bytes)
        return;
    int length = snprintf(out, SUMMARY_LINE, "The lists need %s nodes x %u bytes = %.1f MiB",
                          summary_count(frame->nodes, nodes), (unsigned)frame->node_bytes,
                          (double)frame->nodes * (double)frame->node_bytes / 1048576.0);
    uint64_t overflow = report->structure.layers.lost_to_overflow;
    if (overflow)
        snprintf(out + length, (size_t)(SUMMARY_LINE - length),
                 "; there was no room for %s of them.", summary_count(overflow, lost));
    else
        snprintf(out + length, (size_t)(SUMMARY_LINE - length), ".");
}

void summary_overflow(const Threeway *report, char out[SUMMARY_LINE])
{
    char pixels[SUMMARY_NUMBER];
    uint64_t overflowed = report->structure.layers.overflowed;
    out[0] = 0;
    if (overflowed)
        snprintf(out, SUMMARY_LINE, "Sums left the range of their format (%s) in %s pixels.",
                 format_info(report->desc.accum)->name, summary_count(overflowed, pixels));
}

void summary_speed(const Threeway *report, char out[SUMMARY_LINE])
{
    double ref = report->frames[RENDERER_REF].time_ms, gl = report->frames[RENDERER_GL].time_ms;
    out[0] = 0;
    if (ref > 0 && gl > 0)
        snprintf(out, SUMMARY_LINE, "gl took %.2f times the wall time of ref.", gl / ref);
}

void summary_layers(const Threeway *report, SummaryLayer out[SUMMARY_LAYERS])
{
    const StructureReport *structure = &report->structure;
    const LayerStats *layers = &structure->layers;
    const SummaryLayer rows[SUMMARY_LAYERS] = {
        {"max", "most transparent fragments in one pixel", layers->max},
        {"fragments", "transparent fragments in front of the opaque depth", layers->fragments},
        {"lost_to_ties", "of those never peeled: equal depth", layers->lost_to_ties},
        {"lost_to_pass_limit", "of those never peeled: passes ended first",
         layers->lost_to_pass_limit},
        {"lost_to_overflow", "nodes that a list had no room for", layers->lost_to_overflow},
        {"order_inversions", "neighbours that truth orders the other way",
         structure->order_inversions},
        {"coverage_differs", "fragments that exact, unsnapped coverage would change",
         layers->coverage_differs},
        {"opaque_flips", "pixels whose nearest opaque triangle differs", structure->opaque_flips},
        {"repeated", "peeled again at the depth of the previous peel", layers->repeated},
        {"overflowed", "pixels with a sum that left its format's range", layers->overflowed},
        {"set_differs", "fragments that only one side has, ties and limit apart",
         structure->set_differs},
        {"exact_comparisons", "of truth's comparisons of depths, in exact arithmetic",
         layers->exact_comparisons},
        {"ties", "fragments at exactly the depth of the one in front, by proof", layers->ties},
        {"undecided", "of truth's comparisons, without a result", layers->undecided},
    };
    memcpy(out, rows, sizeof rows);
}
