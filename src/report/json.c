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

typedef struct Document {
    bool failed; /* a jansson call failed: memory is exhausted */
} Document;

/* Both take over value; NULL counts as a failure. */
static void put(Document *json, json_t *object, const char *key, json_t *value)
{
    if (json_object_set_new(object, key, value))
        json->failed = true;
}

static void append(Document *json, json_t *array, json_t *value)
{
    if (json_array_append_new(array, value))
        json->failed = true;
}

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

static json_t *renderers(Document *json, const Threeway *report)
{
    json_t *object = json_object();
    for (int i = 0; i < RENDERER_COUNT; i++) {
        const Frame *frame = &report->frames[i];
        json_t *one = json_object();
        put(json, one, "time_ms", real(frame->time_ms));
        put(json, one, "cpu_ms", real(frame->cpu_ms));
        put(json, one, "threads", json_integer(frame->threads));
        put(json, one, "peels", json_integer(frame->peels));
        put(json, one, "geometry_passes", json_integer(frame->geometry_passes));
        put(json, one, "fragments_shaded", count(frame->fragments_shaded));
        put(json, one, "buffer_bytes", count(frame->buffer_bytes));
        put(json, one, "version", string(frame->version));
        put(json, one, "renderer", string(frame->renderer));
        put(json, object, threeway_renderer_name(i), one);
    }
    return object;
}

static json_t *buffers(Document *json, const PairReport *pair)
{
    json_t *array = json_array();
    for (size_t i = 0; i < pair->buffer_count; i++) {
        const BufferMetrics *buffer = &pair->buffers[i];
        json_t *one = json_object();
        put(json, one, "name", string(buffer->name));
        put(json, one, "values", count(buffer->values));
        put(json, one, "differing", count(buffer->differing));
        put(json, one, "max_ulp", json_integer(buffer->max_ulp));
        put(json, one, "max_abs", real(buffer->max_abs));
        put(json, one, "first",
            buffer->has_first
                ? json_pack("[iii]", buffer->first[0], buffer->first[1], buffer->first[2])
                : json_null());
        append(json, array, one);
    }
    return array;
}

static json_t *final_image(Document *json, const FinalMetrics *final)
{
    json_t *object = json_object();
    put(json, object, "pixels", count(final->pixels));
    put(json, object, "differing", count(final->differing));
    put(json, object, "max_abs", real(final->max_abs));
    put(json, object, "mean_abs", real(final->mean_abs));
    put(json, object, "rmse", real(final->rmse));
    put(json, object, "psnr", real(final->psnr));
    put(json, object, "max_ulp", json_integer(final->max_ulp));
    put(json, object, "nonfinite", count(final->nonfinite));
    return object;
}

static json_t *pairs(Document *json, const Threeway *report)
{
    json_t *array = json_array();
    for (int i = 0; i < 3; i++) {
        const PairReport *pair = &report->pairs[i];
        json_t *one = json_object();
        put(json, one, "a", json_string(threeway_renderer_name(pair->a)));
        put(json, one, "b", json_string(threeway_renderer_name(pair->b)));
        if (!pair->has_unaffected)
            put(json, one, "buffers", buffers(json, pair));
        put(json, one, "final", final_image(json, &pair->final));
        if (pair->has_unaffected) {
            json_t *unaffected = json_object();
            put(json, unaffected, "pixels", count(pair->unaffected.pixels));
            put(json, unaffected, "occupied", count(pair->unaffected.occupied));
            put(json, unaffected, "max_abs", real(pair->unaffected.max_abs));
            put(json, unaffected, "max_rel", real(pair->unaffected.max_rel));
            put(json, unaffected, "p99_rel", real(pair->unaffected.p99_rel));
            put(json, one, "unaffected", unaffected);
        }
        append(json, array, one);
    }
    return array;
}

static json_t *layers(Document *json, const Threeway *report)
{
    SummaryLayer rows[SUMMARY_LAYERS];
    json_t *object = json_object();
    summary_layers(report, rows);
    for (int i = 0; i < SUMMARY_LAYERS; i++)
        put(json, object, rows[i].key, count(rows[i].value));
    return object;
}

static json_t *document(Document *json, const Threeway *report)
{
    const Frame *ref = &report->frames[RENDERER_REF];
    json_t *root = json_object();
    put(json, root, "scene", string(report->scene_path));
    put(json, root, "size", json_pack("[ii]", report->desc.width, report->desc.height));
    put(json, root, "method", string(method_info(report->desc.method)->name));
    put(json, root, "passes", json_integer(ref->peels));
    put(json, root, "profile", string(report->seed_profile ? "seed" : "default"));
    put(json, root, "fma", json_boolean(ref->fused));
    put(json, root, "agree", json_boolean(report->agree));
    put(json, root, "tolerance", real(report->tolerance));
    put(json, root, "renderers", renderers(json, report));
    put(json, root, "pairs", pairs(json, report));
    put(json, root, "layers", layers(json, report));
    json_t *residual = json_object();
    put(json, residual, "max", real(ref->residual_max));
    put(json, residual, "pixels", count(ref->residual_pixels));
    put(json, root, "residual", residual);
    return root;
}

static int write_text(const char *text, size_t size, void *writer)
{
    return file_writer_put(writer, text, size) == RESULT_OK ? 0 : -1;
}

/* Takes root over. */
static Result write_document(Document *json, json_t *root, const char *path)
{
    FileWriter writer;
    Result result = file_writer_open(path, &writer);
    if (result == RESULT_OK) {
        int dumped =
            json->failed ? -1 : json_dump_callback(root, write_text, &writer, JSON_INDENT(1));
        file_writer_put(&writer, "\n", 1);
        bool failed = dumped != 0 && !writer.error;
        result = file_writer_close(&writer, !failed);
        if (failed)
            result = result_fail(RESULT_NO_MEMORY, "%s: out of memory for the document", path);
    }
    json_decref(root);
    return result;
}

Result report_json_write(const Threeway *report, const char *path)
{
    Document json = {0};
    json_t *root = document(&json, report);
    return write_document(&json, root, path);
}

Result report_json_write_all(const Threeway *reports, size_t count, const char *path)
{
    Document json = {0};
    json_t *root = json_object(), *array = json_array();
    bool agree = true;
    for (size_t i = 0; i < count; i++) {
        append(&json, array, document(&json, &reports[i]));
        agree = agree && reports[i].agree;
    }
    put(&json, root, "agree", json_boolean(agree));
    put(&json, root, "methods", array);
    return write_document(&json, root, path);
}
