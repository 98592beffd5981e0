/* The document of `peel plan --json`: its keys are a contract, as those of json.c. */
#include "frame/method.h"
#include "report/document.h"
#include "report/plan.h"

static json_t *histogram(Document *json, const uint64_t *counts, uint32_t most)
{
    json_t *array = json_array();
    for (uint32_t i = 0; i <= most; i++)
        document_append(json, array, document_count(counts[i]));
    return array;
}

static json_t *layers(Document *json, const Plan *plan)
{
    const LayerCounts *counts = &plan->layers;
    double pixels = (double)plan->desc.width * plan->desc.height;
    json_t *object = json_object();
    document_put(json, object, "max", json_integer(counts->most.fragments));
    document_put(json, object, "mean", document_real((double)counts->fragments / pixels));
    document_put(json, object, "fragments", document_count(counts->fragments));
    document_put(json, object, "histogram",
                 histogram(json, counts->histogram, counts->most.fragments));
    document_put(json, object, "distinct_max", json_integer(counts->most.peels));
    document_put(json, object, "distinct", document_count(counts->peels));
    document_put(json, object, "distinct_histogram",
                 histogram(json, counts->peel_histogram, counts->most.peels));
    return object;
}

static json_t *passes(Document *json, const Plan *plan)
{
    json_t *object = json_object();
    for (int i = 0; i < METHOD_COUNT; i++)
        document_put(json, object, method_info((MethodId)i)->name, json_integer(plan->passes[i]));
    return object;
}

static json_t *buffers(Document *json, const PlanBuffers *plan)
{
    json_t *array = json_array();
    for (size_t i = 0; i < plan->count; i++) {
        PixelFormat format = plan->items[i].format;
        bool image = format != FORMAT_NONE;
        json_t *one = json_object();
        document_put(json, one, "name", json_string(plan->items[i].name));
        document_put(json, one, "format",
                     image ? json_string(format_info(format)->name) : json_null());
        document_put(json, one, "pixel_bytes",
                     json_integer((json_int_t)(image ? format_pixel_bytes(format) : 0)));
        document_put(json, one, "bytes", document_count(plan->items[i].bytes));
        document_append(json, array, one);
    }
    return array;
}

static json_t *needs(Document *json, const Needs *plan, int from, int to, bool needed)
{
    json_t *array = json_array();
    for (int i = from; i < to; i++) {
        if (plan->items[i].needed != needed)
            continue;
        json_t *one = json_object();
        document_put(json, one, "what", json_string(needs_name((NeedId)i)));
        document_put(json, one, "why", json_string(plan->items[i].why));
        document_append(json, array, one);
    }
    return array;
}

static json_t *choices(Document *json, const PlanSearch *search)
{
    json_t *array = json_array();
    for (size_t i = 0; search && i < search->count; i++) {
        const PlanChoice *choice = &search->choices[i];
        json_t *one = json_object();
        document_put(json, one, "method", json_string(method_info(choice->method)->name));
        document_put(json, one, "passes", json_integer(choice->passes));
        document_put(json, one, "accum", json_string(format_info(choice->accum)->name));
        document_put(json, one, "gbuffer", json_string(gbuffer_name(choice->gbuffer)));
        document_put(json, one, "runs", json_integer(choice->runs));
        document_put(json, one, "cpu_ms", document_real(choice->cpu_ms));
        document_put(json, one, "wall_ms", document_real(choice->wall_ms));
        document_put(json, one, "error", document_real(choice->error));
        document_put(json, one, "pareto", json_boolean(choice->pareto));
        document_put(json, one, "chosen", json_boolean(choice->chosen));
        document_append(json, array, one);
    }
    return array;
}

static json_t *ref(Document *json, const Plan *plan)
{
    json_t *object = json_object();
    document_put(json, object, "bytes", document_count(plan->frame.buffer_bytes));
    document_put(json, object, "geometry_bytes", document_count(plan->layers.geometry_bytes));
    document_put(json, object, "cpu_ms", document_real(plan->frame.cpu_ms));
    document_put(json, object, "wall_ms", document_real(plan->frame.time_ms));
    return object;
}

Result report_plan_json(const Plan *plan, const PlanSearch *search, const char *command,
                        const char *path)
{
    Document json = {0};
    json_t *root = json_object();
    const Needs *needed = &plan->needs;
    document_put(&json, root, "scene", document_string(plan->scene_name));
    document_put(&json, root, "path", document_string(plan->scene_path));
    document_put(&json, root, "size", json_pack("[ii]", plan->desc.width, plan->desc.height));
    document_put(&json, root, "method", json_string(method_info(plan->desc.method)->name));
    document_put(&json, root, "lights", document_count(needed->lights));
    document_put(&json, root, "dark_lights", document_count(needed->dark_lights));
    document_put(&json, root, "layers", layers(&json, plan));
    document_put(&json, root, "opaque_primitives", document_count(plan->layers.opaque_primitives));
    document_put(&json, root, "transparent_primitives",
                 document_count(plan->layers.transparent_primitives));
    document_put(&json, root, "passes", passes(&json, plan));
    document_put(&json, root, "buffers", buffers(&json, &plan->buffers));
    document_put(&json, root, "bytes", document_count(plan->buffers.bytes));
    document_put(&json, root, "bytes_of_all", document_count(plan->bytes_of_all));
    document_put(&json, root, "ref", ref(&json, plan));
    document_put(&json, root, "needed", needs(&json, needed, 0, NEED_ACTED_ON, true));
    document_put(&json, root, "left_out", needs(&json, needed, 0, NEED_ACTED_ON, false));
    document_put(&json, root, "metric",
                 search ? json_string(plan_metric_name(search->metric)) : json_null());
    document_put(&json, root, "max_error", search ? document_real(search->max_error) : json_null());
    document_put(&json, root, "choices", choices(&json, search));
    document_put(&json, root, "command", command ? document_string(command) : json_null());
    return document_write(&json, root, path);
}
