/* The document of `peel driver --json`: its keys are a contract, as those of json.c. Numbers that
 * JSON has no word for are null; "hex" says them, too. */
#include "number/op.h"
#include "report/document.h"
#include "report/driver.h"

#include <stdlib.h>

static json_t *number(Document *json, float x)
{
    json_t *object = json_object();
    document_put(json, object, "value", document_real((double)x));
    document_put(json, object, "hex", document_hex((double)x));
    return object;
}

static json_t *value(Document *json, DriverValue kind, uint32_t bits)
{
    json_t *object = NULL;
    if (kind == DRIVER_CODE) {
        object = json_object();
        document_put(json, object, "value", json_integer(bits));
    } else {
        object =
            number(json, kind == DRIVER_HALF ? half_to_float((uint16_t)bits) : op_from_bits(bits));
    }
    char text[16];
    snprintf(text, sizeof text, kind == DRIVER_HALF ? "0x%04x" : "0x%08x", bits);
    document_put(json, object, "bits", json_string(text));
    return object;
}

static json_t *example(Document *json, const DriverExample *one)
{
    json_t *object = json_object(), *inputs = json_array();
    for (int i = 0; i < one->input_count; i++) {
        json_t *input = number(json, one->inputs[i]);
        document_put(json, input, "name", json_string(one->input_names[i]));
        document_append(json, inputs, input);
    }
    document_put(json, object, "place", json_string(one->place));
    document_put(json, object, "inputs", inputs);
    document_put(json, object, "expected", value(json, one->value, one->expected));
    document_put(json, object, "got", value(json, one->value, one->got));
    return object;
}

static json_t *rule(Document *json, const DriverRule *one)
{
    json_t *object = json_object();
    document_put(json, object, "id", json_string(one->id));
    document_put(json, object, "what", json_string(one->what));
    document_put(json, object, "section", json_string(one->section));
    document_put(json, object, "relied_on", json_boolean(one->relied_on));
    document_put(json, object, "verdict", json_string(driver_verdict_name(one->verdict)));
    document_put(json, object, "samples", document_count(one->samples));
    document_put(json, object, "differing", document_count(one->differing));
    document_put(json, object, "max_ulp", json_integer(one->max_distance));
    document_put(json, object, "example",
                 one->has_example ? example(json, &one->example) : json_null());
    document_put(json, object, "reason", one->reason ? json_string(one->reason) : json_null());
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
        document_put(json, gl, texts[i].key, json_string(texts[i].text));
    for (size_t i = 0; i < report->count; i++)
        document_append(json, rules, rule(json, &report->rules[i]));
    document_put(json, root, "gl", gl);
    document_put(json, root, "rules", rules);
    document_put(json, root, "exact", json_integer(report->exact));
    document_put(json, root, "differ", json_integer(report->differ));
    document_put(json, root, "broken", json_integer(report->broken));
    document_put(json, root, "untested", json_integer(report->untested));
    return root;
}

Result report_driver_json(const DriverName *name, const DriverReport *report, const char *path)
{
    Document json = {0};
    json_t *root = document(&json, name, report);
    return document_write(&json, root, path);
}
