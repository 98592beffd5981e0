/* The JSON document: its keys are a contract, in lower case with underscores; more may be added.
 * What is not a finite number (the PSNR of equal images) is null. */
#include "frame/method.h"
#include "report/document.h"
#include "report/summary.h"
#include "report/table.h"

#include <stdlib.h>
#include <string.h>

static json_t *renderers(Document *json, const Threeway *report)
{
    json_t *object = json_object();
    for (int i = 0; i < RENDERER_COUNT; i++) {
        const Frame *frame = &report->frames[i];
        json_t *one = json_object();
        document_put(json, one, "time_ms", document_real(frame->time_ms));
        document_put(json, one, "cpu_ms", document_real(frame->cpu_ms));
        document_put(json, one, "threads", json_integer(frame->threads));
        document_put(json, one, "peels", json_integer(frame->peels));
        document_put(json, one, "geometry_passes", json_integer(frame->geometry_passes));
        document_put(json, one, "fragments_shaded", document_count(frame->fragments_shaded));
        document_put(json, one, "buffer_bytes", document_count(frame->buffer_bytes));
        if (frame->node_bytes) {
            document_put(json, one, "nodes", document_count(frame->nodes));
            document_put(json, one, "node_bytes", document_count(frame->node_bytes));
        }
        document_put(json, one, "version", document_text(frame->version));
        document_put(json, one, "renderer", document_text(frame->renderer));
        document_put(json, object, threeway_renderer_name(i), one);
    }
    return object;
}

static json_t *buffers(Document *json, const PairReport *pair)
{
    json_t *array = json_array();
    for (size_t i = 0; i < pair->buffer_count; i++) {
        const BufferMetrics *buffer = &pair->buffers[i];
        json_t *one = json_object();
        document_put(json, one, "name", document_text(buffer->name));
        document_put(json, one, "values", document_count(buffer->values));
        document_put(json, one, "differing", document_count(buffer->differing));
        document_put(json, one, "max_ulp", json_integer(buffer->max_ulp));
        document_put(json, one, "max_abs", document_real(buffer->max_abs));
        document_put(json, one, "first",
                     buffer->has_first
                         ? json_pack("[iii]", buffer->first[0], buffer->first[1], buffer->first[2])
                         : json_null());
        document_append(json, array, one);
    }
    return array;
}

static json_t *final_image(Document *json, const FinalMetrics *final)
{
    json_t *object = json_object();
    document_put(json, object, "pixels", document_count(final->pixels));
    document_put(json, object, "differing", document_count(final->differing));
    document_put(json, object, "max_abs", document_real(final->max_abs));
    document_put(json, object, "mean_abs", document_real(final->mean_abs));
    document_put(json, object, "rmse", document_real(final->rmse));
    document_put(json, object, "psnr", document_real(final->psnr));
    document_put(json, object, "max_ulp", json_integer(final->max_ulp));
    document_put(json, object, "nonfinite", document_count(final->nonfinite));
    return object;
}

static json_t *pairs(Document *json, const Threeway *report)
{
    json_t *array = json_array();
    for (int i = 0; i < 3; i++) {
        const PairReport *pair = &report->pairs[i];
        json_t *one = json_object();
        document_put(json, one, "a", json_string(threeway_renderer_name(pair->a)));
        document_put(json, one, "b", json_string(threeway_renderer_name(pair->b)));
        if (!pair->has_unaffected)
            document_put(json, one, "buffers", buffers(json, pair));
        document_put(json, one, "final", final_image(json, &pair->final));
        if (pair->has_unaffected) {
            json_t *unaffected = json_object();
            document_put(json, unaffected, "pixels", document_count(pair->unaffected.pixels));
            document_put(json, unaffected, "occupied", document_count(pair->unaffected.occupied));
            document_put(json, unaffected, "max_abs", document_real(pair->unaffected.max_abs));
            document_put(json, unaffected, "max_rel", document_real(pair->unaffected.max_rel));
            document_put(json, unaffected, "p99_rel", document_real(pair->unaffected.p99_rel));
            document_put(json, unaffected, "p999_rel", document_real(pair->unaffected.p999_rel));
            document_put(json, one, "unaffected", unaffected);
        }
        if (pair->has_bound) {
            json_t *bound = json_object();
            document_put(json, bound, "pixels", document_count(pair->bound.pixels));
            document_put(json, bound, "exceeded", document_count(pair->bound.exceeded));
            document_put(json, bound, "unbounded", document_count(pair->bound.unbounded));
            document_put(json, bound, "max_ratio", document_real(pair->bound.max_ratio));
            document_put(json, bound, "median_ratio", document_real(pair->bound.median_ratio));
            document_put(json, bound, "p99_ratio", document_real(pair->bound.p99_ratio));
            document_put(json, bound, "median", document_real(pair->bound.median));
            document_put(json, bound, "p99", document_real(pair->bound.p99));
            document_put(json, bound, "rounding_median",
                         document_real(pair->bound.rounding_median));
            document_put(json, bound, "rounding_p99", document_real(pair->bound.rounding_p99));
            document_put(json, one, "bound", bound);
        }
        document_append(json, array, one);
    }
    return array;
}

static json_t *layers(Document *json, const Threeway *report)
{
    SummaryLayer rows[SUMMARY_LAYERS];
    json_t *object = json_object();
    summary_layers(report, rows);
    for (int i = 0; i < SUMMARY_LAYERS; i++)
        document_put(json, object, rows[i].key, document_count(rows[i].value));
    return object;
}

static json_t *budget_figure(Document *json, const BudgetFigure *figure)
{
    json_t *object = json_object();
    document_put(json, object, "max_abs", document_real(figure->max_abs));
    document_put(json, object, "rmse", document_real(figure->rmse));
    document_put(json, object, "pixels", document_count(figure->pixels));
    return object;
}

static json_t *budget(Document *json, const Budget *budget)
{
    json_t *object = json_object(), *terms = json_object();
    for (int i = 0; i < BUDGET_TERMS; i++)
        if (budget->terms[i].measured)
            document_put(json, terms, budget_term_key((BudgetTerm)i),
                         budget_figure(json, &budget->terms[i]));
    document_put(json, object, "terms", terms);
    document_put(json, object, "sum", budget_figure(json, &budget->sum));
    document_put(json, object, "total", budget_figure(json, &budget->total));
    document_put(json, object, "unexplained", budget_figure(json, &budget->unexplained));
    document_put(json, object, "explained", document_real(budget->explained));
    document_put(json, object, "nonfinite", document_count(budget->nonfinite));
    return object;
}

static json_t *classes(Document *json, const Budget *budget)
{
    json_t *object = json_object();
    for (int i = 0; i < CLASS_COUNT; i++)
        document_put(json, object, class_key((PixelClass)i), document_count(budget->counts[i]));
    return object;
}

static json_t *document(Document *json, const Threeway *report)
{
    const Frame *ref = &report->frames[RENDERER_REF];
    const MethodInfo *method = method_info(report->desc.method);
    json_t *root = json_object();
    document_put(json, root, "scene", document_text(report->scene_path));
    document_put(json, root, "size", json_pack("[ii]", report->desc.width, report->desc.height));
    document_put(json, root, "method", document_text(method->name));
    document_put(json, root, "exact", json_boolean(method->exact));
    document_put(json, root, "passes", json_integer(ref->peels));
    document_put(json, root, "profile", document_text(report->seed_profile ? "seed" : "default"));
    document_put(json, root, "fma", json_boolean(ref->fused));
    document_put(json, root, "agree", json_boolean(report->agree));
    document_put(json, root, "tolerance", document_real(report->tolerance));
    document_put(json, root, "renderers", renderers(json, report));
    document_put(json, root, "pairs", pairs(json, report));
    document_put(json, root, "layers", layers(json, report));
    json_t *residual = json_object();
    document_put(json, residual, "max", document_real(ref->residual_max));
    document_put(json, residual, "pixels", document_count(ref->residual_pixels));
    document_put(json, root, "residual", residual);
    if (report->budget) {
        document_put(json, root, "budget", budget(json, report->budget));
        document_put(json, root, "classes", classes(json, report->budget));
    }
    return root;
}

Result report_json_write(const Threeway *report, const char *path)
{
    Document json = {0};
    json_t *root = document(&json, report);
    return document_write(&json, root, path);
}

Result report_json_write_all(const Threeway *reports, size_t count, const char *path)
{
    Document json = {0};
    json_t *root = json_object(), *array = json_array();
    bool agree = true;
    for (size_t i = 0; i < count; i++) {
        document_append(&json, array, document(&json, &reports[i]));
        agree = agree && reports[i].agree;
    }
    document_put(&json, root, "agree", json_boolean(agree));
    document_put(&json, root, "methods", array);
    return document_write(&json, root, path);
}
