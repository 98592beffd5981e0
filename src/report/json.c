/* The JSON document: its keys are a contract, in lower case with underscores; more may be added.
 * What is not a finite number (the PSNR of equal images) is null. */
#include "base/file.h"
#include "frame/method.h"
#include "report/summary.h"
#include "report/table.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static json_t *real(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static json_t *count(uint64_t value)
{
    return json_integer((json_int_t)value);
}

/* JSON is UTF-8; a path need not be. Where it is not, its bytes beyond ASCII become '?'. */
static json_t *string(const char *text)
{
    json_t *value = json_string(text);
    if (value)
        return value;
    char *ascii = strdup(text);
    for (char *c = ascii; c && *c; c++)
        if ((unsigned char)*c > 126)
            *c = '?';
    value = ascii ? json_string(ascii) : NULL;
    free(ascii);
    return value;
}

static json_t *renderers(const Threeway *report)
{
    json_t *object = json_object();
    for (int i = 0; i < RENDERER_COUNT; i++) {
        const Frame *frame = &report->frames[i];
        json_t *one = json_object();
        json_object_set_new(one, "time_ms", real(frame->time_ms));
        json_object_set_new(one, "cpu_ms", real(frame->cpu_ms));
        json_object_set_new(one, "threads", json_integer(frame->threads));
        json_object_set_new(one, "peels", json_integer(frame->peels));
        json_object_set_new(one, "buffer_bytes", count(frame->buffer_bytes));
        json_object_set_new(one, "version", string(frame->version));
        json_object_set_new(one, "renderer", string(frame->renderer));
        json_object_set_new(object, threeway_renderer_name(i), one);
    }
    return object;
}

static json_t *buffers(const PairReport *pair)
{
    json_t *array = json_array();
    for (size_t i = 0; i < pair->buffer_count; i++) {
        const BufferMetrics *buffer = &pair->buffers[i];
        json_t *one = json_object();
        json_object_set_new(one, "name", string(buffer->name));
        json_object_set_new(one, "values", count(buffer->values));
        json_object_set_new(one, "differing", count(buffer->differing));
        json_object_set_new(one, "max_ulp", json_integer(buffer->max_ulp));
        json_object_set_new(one, "max_abs", real(buffer->max_abs));
        json_object_set_new(one, "first",
                            buffer->has_first ? json_pack("[iii]", buffer->first[0],
                                                          buffer->first[1], buffer->first[2])
                                              : json_null());
        json_array_append_new(array, one);
    }
    return array;
}

static json_t *final_image(const FinalMetrics *final)
{
    json_t *object = json_object();
    json_object_set_new(object, "pixels", count(final->pixels));
    json_object_set_new(object, "differing", count(final->differing));
    json_object_set_new(object, "max_abs", real(final->max_abs));
    json_object_set_new(object, "mean_abs", real(final->mean_abs));
    json_object_set_new(object, "rmse", real(final->rmse));
    json_object_set_new(object, "psnr", real(final->psnr));
    json_object_set_new(object, "max_ulp", json_integer(final->max_ulp));
    json_object_set_new(object, "nonfinite", count(final->nonfinite));
    return object;
}

static json_t *pairs(const Threeway *report)
{
    json_t *array = json_array();
    for (int i = 0; i < 3; i++) {
        const PairReport *pair = &report->pairs[i];
        json_t *one = json_object();
        json_object_set_new(one, "a", json_string(threeway_renderer_name(pair->a)));
        json_object_set_new(one, "b", json_string(threeway_renderer_name(pair->b)));
        if (!pair->has_unaffected)
            json_object_set_new(one, "buffers", buffers(pair));
        json_object_set_new(one, "final", final_image(&pair->final));
        if (pair->has_unaffected) {
            json_t *unaffected = json_object();
            json_object_set_new(unaffected, "pixels", count(pair->unaffected.pixels));
            json_object_set_new(unaffected, "max_abs", real(pair->unaffected.max_abs));
            json_object_set_new(unaffected, "max_rel", real(pair->unaffected.max_rel));
            json_object_set_new(unaffected, "p99_rel", real(pair->unaffected.p99_rel));
            json_object_set_new(one, "unaffected", unaffected);
        }
        json_array_append_new(array, one);
    }
    return array;
}

static json_t *layers(const Threeway *report)
{
    SummaryLayer rows[SUMMARY_LAYERS];
    json_t *object = json_object();
    summary_layers(report, rows);
    for (int i = 0; i < SUMMARY_LAYERS; i++)
        json_object_set_new(object, rows[i].key, count(rows[i].value));
    return object;
}

static json_t *document(const Threeway *report)
{
    const Frame *ref = &report->frames[RENDERER_REF];
    json_t *root = json_object();
    json_object_set_new(root, "scene", string(report->scene_path));
    json_object_set_new(root, "size", json_pack("[ii]", report->desc.width, report->desc.height));
    json_object_set_new(root, "method", string(method_info(report->desc.method)->name));
    json_object_set_new(root, "passes", json_integer(ref->peels));
    json_object_set_new(root, "profile", string(report->seed_profile ? "seed" : "default"));
    json_object_set_new(root, "fma", json_boolean(ref->fused));
    json_object_set_new(root, "agree", json_boolean(report->agree));
    json_object_set_new(root, "tolerance", real(report->tolerance));
    json_object_set_new(root, "renderers", renderers(report));
    json_object_set_new(root, "pairs", pairs(report));
    json_object_set_new(root, "layers", layers(report));
    json_t *residual = json_object();
    json_object_set_new(residual, "max", real(ref->residual_max));
    json_object_set_new(residual, "pixels", count(ref->residual_pixels));
    json_object_set_new(root, "residual", residual);
    return root;
}

static int put(const char *text, size_t size, void *writer)
{
    return file_writer_put(writer, text, size) == RESULT_OK ? 0 : -1;
}

Result report_json_write(const Threeway *report, const char *path)
{
    json_t *root = document(report);
    FileWriter writer;
    Result result = file_writer_open(path, &writer);
    if (result == RESULT_OK) {
        int dumped = root ? json_dump_callback(root, put, &writer, JSON_INDENT(1)) : -1;
        file_writer_put(&writer, "\n", 1);
        bool failed = dumped != 0 && !writer.error;
        result = file_writer_close(&writer, !failed);
        if (failed)
            result = result_fail(RESULT_NO_MEMORY, "%s: out of memory for the document", path);
    }
    json_decref(root);
    return result;
}
