/* Reading JSON lines. */
#include "base/json_memory.h"
#include "blend/sequence.h"
#include "blend/vector_parts.h"
#include "number/op.h"

#include <float.h>
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <string.h>

/* The next line as an object, which the caller gives back. */
static Result next_object(VectorReader *reader, const char *what, json_t **out)
{
    json_error_t error;
    char quote[VECTOR_QUOTE];
    Result result = vector_read_line(reader, what);
    if (result != RESULT_OK)
        return result;
    json_memory_begin();
    *out = json_loadb(reader->line, reader->length, JSON_REJECT_DUPLICATES, &error);
    result = json_memory_check(reader->path, RESULT_OK);
    if (result != RESULT_OK) {
        json_decref(*out);
        return result;
    }
    if (!*out)
        return vector_read_fail(reader, "column %d: %s, expected %s", error.column,
                                vector_read_quote(error.text, quote), what);
    if (json_is_object(*out))
        return RESULT_OK;
    json_decref(*out);
    return vector_read_fail(reader, "expected an object: %s", what);
}

static Result take_count(const VectorReader *reader, const json_t *object, const char *name,
                         uint64_t *out)
{
    const json_t *value = json_object_get(object, name);
    json_int_t number = json_integer_value(value);
    if (!json_is_integer(value) || number < 0 || number >> 53)
        return vector_read_fail(reader, "expected \"%s\", an integer from 0 to 2^53 - 1", name);
    *out = (uint64_t)number;
    return RESULT_OK;
}

static Result take_text(const VectorReader *reader, const json_t *object, const char *name,
                        const char **out)
{
    *out = json_string_value(json_object_get(object, name));
    return *out ? RESULT_OK : vector_read_fail(reader, "expected \"%s\", a text", name);
}

static Result take_head(const VectorReader *reader, const json_t *object, VectorHeader *header)
{
    const char *text, *arithmetic = json_string_value(json_object_get(object, "arithmetic"));
    Result result = take_text(reader, object, "set", &text);
    if (result == RESULT_OK)
        result = vector_read_set(reader, text, &header->spec.set);
    if (result == RESULT_OK)
        result = take_text(reader, object, "format", &text);
    if (result == RESULT_OK)
        result = vector_read_format(reader, text, &header->spec.format);
    if (result == RESULT_OK)
        result = take_text(reader, object, "equation", &text);
    if (result == RESULT_OK)
        result = vector_read_equation(reader, text, &header->equation);
    if (result == RESULT_OK)
        result = take_count(reader, object, "seed", &header->spec.seed);
    if (result == RESULT_OK)
        result = take_count(reader, object, "first", &header->first);
    if (result == RESULT_OK)
        result = take_count(reader, object, "count", &header->count);
    if (arithmetic)
        vector_read_note(arithmetic, header->arithmetic);
    return result;
}

static Result read_head(VectorReader *reader, VectorHeader *header)
{
    json_t *object;
    char version[32];
    Result result = next_object(reader, "the head with \"peel_blend_vectors\"", &object);
    if (result != RESULT_OK)
        return result;
    const json_t *value = json_object_get(object, "peel_blend_vectors");
    snprintf(version, sizeof version, "%" JSON_INTEGER_FORMAT, json_integer_value(value));
    result = value
                 ? vector_read_version(reader, version)
                 : vector_read_fail(reader, "expected \"peel_blend_vectors\": %d", VECTORS_VERSION);
    if (result == RESULT_OK)
        result = take_head(reader, object, header);
    json_decref(object);
    return result;
}

/* An array of so many values. */
static Result check_array(const VectorReader *reader, const json_t *array, const char *name,
                          size_t count)
{
    if (json_is_array(array) && json_array_size(array) == count)
        return RESULT_OK;
    return vector_read_fail(reader, "expected \"%s\", an array of %zu", name, count);
}

/* A hexadecimal float as text, or a number that is a float. */
static Result take_float(const VectorReader *reader, const json_t *value, const char *name,
                         float *out)
{
    const char *text = json_string_value(value);
    if (text)
        return vector_read_source(reader, name, text, out);
    double number = json_number_value(value);
    *out = fabs(number) <= (double)FLT_MAX ? (float)number : 0.0f;
    if (!json_is_number(value) || (double)*out != number)
        return vector_read_fail(
            reader, "%s is no float: expected a text with a hexadecimal one, as \"0x1.8p-1\"",
            name);
    return RESULT_OK;
}

static Result take_source(const VectorReader *reader, const json_t *array, float source[4])
{
    Result result = check_array(reader, array, "source", 4);
    for (size_t c = 0; c < 4 && result == RESULT_OK; c++) {
        char name[] = "source_r";
        name[7] = "rgba"[c];
        result = take_float(reader, json_array_get(array, c), name, &source[c]);
    }
    return result;
}

static Result take_channel(const VectorReader *reader, const json_t *value, const char *name,
                           uint32_t *bits)
{
    const FormatInfo *info = format_info(reader->header.spec.format);
    const char *text = json_string_value(value);
    float number;
    if (info->kind == KIND_UNORM) {
        json_int_t code = json_integer_value(value);
        if (!json_is_integer(value) || code < 0 || code > (json_int_t)info->unorm_max)
            return vector_read_fail(reader, "%s: expected a code from 0 to %u", name,
                                    info->unorm_max);
        *bits = (uint32_t)code;
        return RESULT_OK;
    }
    if (text)
        return vector_read_channel(reader, name, text, bits);
    Result result = take_float(reader, value, name, &number);
    if (result == RESULT_OK && !vector_read_bits(reader->header.spec.format, number, bits))
        return vector_read_fail(reader, "%s is a number that no half is", name);
    return result;
}

static Result take_pixel(const VectorReader *reader, const json_t *array, const char *what,
                         uint32_t bits[4])
{
    size_t stored = (size_t)format_info(reader->header.spec.format)->channels;
    Result result = check_array(reader, array, what, stored);
    for (size_t c = 0; c < stored && result == RESULT_OK; c++) {
        char name[24];
        snprintf(name, sizeof name, "%s_%c", what, "rgba"[c]);
        result = take_channel(reader, json_array_get(array, c), name, &bits[c]);
    }
    return result;
}

static Result next_row(VectorReader *reader, const char *what, json_t **out)
{
    char expected[80];
    snprintf(expected, sizeof expected, "%s %" PRIu64, what,
             reader->header.first +
                 (reader->header.spec.set == VECTORS_SEQUENCES ? reader->next : reader->row));
    Result result = next_object(reader, expected, out);
    if (result == RESULT_OK && json_object_get(*out, "end")) {
        json_decref(*out);
        return vector_read_fail(reader, "the end, expected %s (of %" PRIu64 ")", expected,
                                reader->header.count);
    }
    return result;
}

static Result read_row(VectorReader *reader, VectorRow *out)
{
    json_t *object;
    Result result = next_row(reader, "vector", &object);
    if (result != RESULT_OK)
        return result;
    result = take_count(reader, object, "index", &out->index);
    if (result == RESULT_OK)
        result = take_source(reader, json_object_get(object, "source"), out->source);
    if (result == RESULT_OK)
        result = take_pixel(reader, json_object_get(object, "destination"), "destination",
                            out->destination);
    if (result == RESULT_OK)
        result = take_pixel(reader, json_object_get(object, "result"), "result", out->result);
    json_decref(object);
    return result;
}

static Result put_result(const VectorReader *reader, const json_t *array, int layer,
                         VectorSequence *out)
{
    PixelFormat format = reader->header.spec.format;
    uint32_t bits[4] = {0};
    Result result = take_pixel(reader, array, "result", bits);
    for (int c = 0; c < 4 && result == RESULT_OK; c++)
        format_set_bits(format, out->results + (size_t)layer * format_pixel_bytes(format), c,
                        bits[c]);
    out->given[layer] = true;
    return result;
}

/* "results" of all layers, null where there is none, or "result" of the last. */
static Result take_results(const VectorReader *reader, const json_t *object, int layers,
                           VectorSequence *out)
{
    const json_t *results = json_object_get(object, "results");
    memset(out->given, 0, (size_t)layers * sizeof *out->given);
    if (!results)
        return put_result(reader, json_object_get(object, "result"), layers - 1, out);
    Result result = check_array(reader, results, "results", (size_t)layers);
    for (int i = 0; i < layers && result == RESULT_OK; i++) {
        const json_t *one = json_array_get(results, (size_t)i);
        if (!json_is_null(one) || i == layers - 1)
            result = put_result(reader, one, i, out);
    }
    return result;
}

static Result read_sequence(VectorReader *reader, int layers, VectorSequence *out)
{
    json_t *object;
    uint64_t count = 0;
    Result result = next_row(reader, "sequence", &object);
    if (result != RESULT_OK)
        return result;
    const json_t *sources = json_object_get(object, "source");
    result = take_count(reader, object, "sequence", &out->index);
    if (result == RESULT_OK)
        result = take_count(reader, object, "layers", &count);
    if (result == RESULT_OK && count != (uint64_t)layers)
        result = vector_read_fail(reader, "layers %" PRIu64 ", expected %d", count, layers);
    if (result == RESULT_OK)
        result = check_array(reader, sources, "source", (size_t)layers);
    for (int i = 0; i < layers && result == RESULT_OK; i++)
        result = take_source(reader, json_array_get(sources, (size_t)i), out->source[i]);
    if (result == RESULT_OK)
        result = take_results(reader, object, layers, out);
    json_decref(object);
    return result;
}

static Result read_end(VectorReader *reader, uint64_t *count, char checksum[VECTOR_DIGEST_TEXT])
{
    json_t *object;
    const char *text;
    Result result = next_object(reader, "the end with \"count\" and \"checksum\"", &object);
    if (result != RESULT_OK)
        return result;
    result = json_is_true(json_object_get(object, "end"))
                 ? take_count(reader, object, "count", count)
                 : vector_read_fail(
                       reader, "expected the end, {\"end\": true, ...}, after %" PRIu64 " vectors",
                       reader->header.count);
    if (result == RESULT_OK)
        result = take_text(reader, object, "checksum", &text);
    if (result == RESULT_OK)
        snprintf(checksum, VECTOR_DIGEST_TEXT, "%s", text);
    json_decref(object);
    return result;
}

const VectorFormReader vector_json_reader = {read_head, read_row, read_sequence, read_end};
