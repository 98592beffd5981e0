/* The document of `peel check --json`: its keys are a contract, as those of json.c. */
#include "frame/method.h"
#include "report/check.h"
#include "report/document.h"

static json_t *worst(Document *json, const JudgeWorst *pixel)
{
    if (!pixel->is)
        return json_null();
    json_t *object = json_object();
    document_put(json, object, "x", json_integer(pixel->x));
    document_put(json, object, "y", json_integer(pixel->y));
    document_put(json, object, "channel", json_integer(pixel->channel));
    document_put(json, object, "theirs", document_real(pixel->theirs));
    document_put(json, object, "theirs_hex", document_hex(pixel->theirs));
    document_put(json, object, "reference", document_real(pixel->reference));
    document_put(json, object, "reference_hex", document_hex(pixel->reference));
    document_put(json, object, "ulp", pixel->ulp < 0.0 ? json_null() : document_real(pixel->ulp));
    return object;
}

static json_t *check_step(Document *json, const CheckStep *step)
{
    const JudgeFigures *figures = &step->figures;
    json_t *object = json_object();
    document_put(json, object, "name", document_string(step->name));
    document_put(json, object, "agree", json_boolean(step->agree));
    document_put(json, object, "judged", json_boolean(step->judged));
    document_put(json, object, "note", step->note[0] ? document_string(step->note) : json_null());
    if (!step->judged)
        return object;
    document_put(json, object, "format", json_string(format_info(step->format)->name));
    document_put(json, object, "pixels", document_count(figures->pixels));
    document_put(json, object, "equal", document_count(figures->equal));
    document_put(json, object, "stored", document_count(figures->stored));
    document_put(json, object, "within", document_count(figures->within));
    document_put(json, object, "edge", document_count(figures->edge));
    document_put(json, object, "beyond", document_count(figures->beyond));
    document_put(json, object, "nonfinite", document_count(figures->nonfinite));
    document_put(json, object, "max_abs", document_real(figures->max_abs));
    document_put(json, object, "rmse", document_real(figures->rmse));
    document_put(json, object, "correlation", document_real(figures->correlation));
    document_put(json, object, "worst", worst(json, &figures->worst));
    return object;
}

static json_t *meaning(Document *json, const CheckReport *report)
{
    if (!report->reading[0])
        return json_null();
    json_t *object = json_object();
    document_put(json, object, "encoding",
                 json_string(given_encoding_name(report->meaning.encoding)));
    document_put(json, object, "flipped", json_boolean(report->meaning.rows == GIVEN_BOTTOM_UP));
    document_put(json, object, "alpha", json_string(given_alpha_name(report->meaning.alpha)));
    document_put(json, object, "sure", json_boolean(report->sure));
    document_put(json, object, "text", json_string(report->reading));
    return object;
}

Result report_check_json(const CheckReport *report, const char *path)
{
    char hint[256];
    Document json = {0};
    const RenderDesc *desc = &report->desc;
    json_t *root = json_object(), *steps = json_array();
    for (size_t i = 0; i < report->step_count; i++)
        document_append(&json, steps, check_step(&json, &report->steps[i]));
    report_check_hint(report, hint, sizeof hint);
    document_put(&json, root, "verdict", json_string(report->agree ? "agrees" : "differs"));
    document_put(&json, root, "scene", document_string(report->scene_path));
    document_put(&json, root, "theirs",
                 report->theirs ? document_string(report->theirs) : json_null());
    document_put(&json, root, "width", json_integer(desc->width));
    document_put(&json, root, "height", json_integer(desc->height));
    document_put(&json, root, "method", json_string(method_info(desc->method)->name));
    document_put(&json, root, "tolerance", document_real(report->tolerance));
    document_put(&json, root, "bound", json_boolean(desc->bound));
    document_put(&json, root, "peels", json_integer(report->frame.peels));
    document_put(&json, root, "image", meaning(&json, report));
    document_put(&json, root, "first",
                 report->first < 0 ? json_null()
                                   : document_string(report->steps[report->first].name));
    document_put(&json, root, "hint", hint[0] ? json_string(hint) : json_null());
    document_put(&json, root, "steps", steps);
    return document_write(&json, root, path);
}
