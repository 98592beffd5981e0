/* The document of `peel driver --json`: its keys are a contract, as those of json.c. Numbers that
 * JSON has no word for are null; "hex" says them, too. */
#include "base/file.h"
#include "number/op.h"
#include "report/driver.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>

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

static json_t *number(Document *json, float x)
{
    char hex[32];
    json_t *object = json_object();
    snprintf(hex, sizeof hex, "%a", (double)x);
    put(json, object, "value", isfinite(x) ? json_real((double)x) : json_null());
    put(json, object, "hex", json_string(hex));
    return object;
}

static json_t *value(Document *json, DriverValue kind, uint32_t bits)
{
    json_t *object = NULL;
    if (kind == DRIVER_CODE) {
        object = json_object();
        put(json, object, "value", json_integer(bits));
    } else {
        object =
            number(json, kind == DRIVER_HALF ? half_to_float((uint16_t)bits) : op_from_bits(bits));
    }
    char text[16];
    snprintf(text, sizeof text, kind == DRIVER_HALF ? "0x%04x" : "0x%08x", bits);
    put(json, object, "bits", json_string(text));
    return object;
}

static json_t *example(Document *json, const DriverExample *one)
{
    json_t *object = json_object(), *inputs = json_array();
    for (int i = 0; i < one->input_count; i++) {
        json_t *input = number(json, one->inputs[i]);
        put(json, input, "name", json_string(one->input_names[i]));
        append(json, inputs, input);
    }
    put(json, object, "place", json_string(one->place));
    put(json, object, "inputs", inputs);
    put(json, object, "expected", value(json, one->value, one->expected));
    put(json, object, "got", value(json, one->value, one->got));
    return object;
}

static json_t *rule(Document *json, const DriverRule *one)
{
    json_t *object = json_object();
    put(json, object, "id", json_string(one->id));
    put(json, object, "what", json_string(one->what));
    put(json, object, "section", json_string(one->section));
    put(json, object, "relied_on", json_boolean(one->relied_on));
    put(json, object, "verdict", json_string(driver_verdict_name(one->verdict)));
    put(json, object, "samples", json_integer((json_int_t)one->samples));
    put(json, object, "differing", json_integer((json_int_t)one->differing));
    put(json, object, "max_ulp", json_integer(one->max_distance));
    put(json, object, "example", one->has_example ? example(json, &one->example) : json_null());
    put(json, object, "reason", one->reason ? json_string(one->reason) : json_null());
    return object;
}

static json_t *document(Document *json, const DriverName *name, const DriverReport *report)
{
    const struct {
        const char *key, *text;
    } texts[] = {{"vendor", name->vendor},
                 {"renderer", name->renderer},
                 {"version", name->version},
                 {"glsl", name->glsl},
                 {"arithmetic", name->mode}};
    json_t *root = json_object(), *gl = json_object(), *rules = json_array();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        put(json, gl, texts[i].key, json_string(texts[i].text));
    for (size_t i = 0; i < report->count; i++)
        append(json, rules, rule(json, &report->rules[i]));
    put(json, root, "gl", gl);
    put(json, root, "rules", rules);
    put(json, root, "exact", json_integer(report->exact));
    put(json, root, "differ", json_integer(report->differ));
    put(json, root, "broken", json_integer(report->broken));
    put(json, root, "untested", json_integer(report->untested));
    return root;
}

static int write_text(const char *text, size_t size, void *writer)
{
    return file_writer_put(writer, text, size) == RESULT_OK ? 0 : -1;
}

Result report_driver_json(const DriverName *name, const DriverReport *report, const char *path)
{
    Document json = {0};
    FileWriter writer;
    json_t *root = document(&json, name, report);
    Result result = file_writer_open(path, &writer);
    if (result == RESULT_OK) {
        int dumped =
            json.failed ? -1 : json_dump_callback(root, write_text, &writer, JSON_INDENT(1));
        file_writer_put(&writer, "\n", 1);
        bool failed = dumped != 0 && !writer.error;
        result = file_writer_close(&writer, !failed);
        if (failed)
            result = result_fail(RESULT_NO_MEMORY, "%s: out of memory for the document", path);
    }
    json_decref(root);
    return result;
}
