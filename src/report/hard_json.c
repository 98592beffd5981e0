/* The document of `peel hard --json`: its keys are a contract, as those of json.c. What is not a
 * finite number (a bound where there is none) is null. */
#include "frame/method.h"
#include "report/document.h"
#include "report/hard.h"

/* What a method does not trace is null. */
static void put_layers(Document *json, json_t *object, const HardRow *row)
{
    const struct {
        const char *key;
        uint64_t value;
    } counts[] = {{"fragments", row->layers.fragments},
                  {"deepest", row->layers.max},
                  {"lost_to_ties", row->layers.lost_to_ties},
                  {"lost_to_pass_limit", row->layers.lost_to_pass_limit},
                  {"lost_to_overflow", row->layers.lost_to_overflow},
                  {"repeated", row->layers.repeated},
                  {"order_inversions", row->inversions},
                  {"set_differs", row->sets},
                  {"opaque_flips", row->flips}};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        document_put(json, object, counts[i].key,
                     row->structure ? document_count(counts[i].value) : json_null());
}

static json_t *configuration(Document *json, const HardRow *row)
{
    const RenderDesc *desc = &row->config.desc;
    json_t *object = json_object();
    document_put(json, object, "name", json_string(row->config.name));
    document_put(json, object, "method", json_string(method_info(desc->method)->name));
    document_put(json, object, "depth", json_string(format_info(render_desc_depth(desc))->name));
    document_put(json, object, "accum", json_string(format_info(desc->accum)->name));
    put_layers(json, object, row);
    document_put(json, object, "ref_gl_differing", document_count(row->ref_gl));
    document_put(json, object, "ref_gl_max_ulp", document_count(row->max_ulp_gl));
    document_put(json, object, "max_abs", document_real(row->max_abs));
    document_put(json, object, "rmse", document_real(row->rmse));
    document_put(json, object, "max_ulp", document_count(row->max_ulp_truth));
    document_put(json, object, "error", document_real(row->error));
    document_put(json, object, "bound", document_real(row->bound));
    document_put(json, object, "nonfinite", document_count(row->nonfinite));
    document_put(json, object, "note",
                 row->config.note ? json_string(row->config.note) : json_null());
    document_put(json, object, "pass", json_boolean(row->pass));
    document_put(json, object, "failure", row->pass ? json_null() : json_string(row->failure));
    return object;
}

static json_t *hard_case(Document *json, const HardReport *report)
{
    json_t *object = json_object(), *rows = json_array();
    for (size_t i = 0; i < report->row_count; i++)
        document_append(json, rows, configuration(json, &report->rows[i]));
    document_put(json, object, "name", json_string(report->hard->name));
    document_put(json, object, "why", json_string(report->scene->why));
    document_put(json, object, "source", json_string(report->scene->source));
    document_put(json, object, "expected", json_string(report->hard->ought));
    document_put(json, object, "size", json_integer(report->hard->size));
    document_put(json, object, "failed", document_count(report->failed));
    document_put(json, object, "configurations", rows);
    return object;
}

Result report_hard_json(const HardReport *reports, size_t case_count, const char *path)
{
    Document json = {0};
    HardTotals totals = {0};
    json_t *root = json_object(), *cases = json_array();
    for (size_t i = 0; i < case_count; i++) {
        document_append(&json, cases, hard_case(&json, &reports[i]));
        report_hard_add(&reports[i], &totals);
    }
    document_put(&json, root, "cases", cases);
    document_put(&json, root, "configurations", document_count(totals.rows));
    document_put(&json, root, "failed", document_count(totals.failed));
    document_put(&json, root, "nonfinite", document_count(totals.nonfinite_rows));
    document_put(&json, root, "ref_gl_differing", document_count(totals.differing_rows));
    return document_write(&json, root, path);
}
