/* Writing CSV and JSON lines. */
#include "blend/vector_parts.h"
#include "number/hexfloat.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

static const char channels[] = "rgba";

static void flush(VectorWriter *writer)
{
    vector_write_bytes(writer, writer->text, writer->used);
    writer->used = 0;
}

static void put_text(VectorWriter *writer, const char *text)
{
    size_t size = strlen(text);
    if (writer->used + size > VECTOR_TEXT_BLOCK)
        flush(writer);
    if (size > VECTOR_TEXT_BLOCK) {
        vector_write_bytes(writer, text, size);
        return;
    }
    memcpy(writer->text + writer->used, text, size);
    writer->used += size;
}

static void __attribute__((format(printf, 2, 3)))
print(VectorWriter *writer, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    put_text(writer, text);
}

static bool is_json(const VectorWriter *writer)
{
    return writer->form == VECTOR_JSON_LINES;
}

/* ---- the head ---- */

static void put_columns(VectorWriter *writer, const char *name, int count)
{
    for (int c = 0; c < count; c++)
        print(writer, ",%s_%c", name, channels[c]);
}

static void csv_head(VectorWriter *writer, const char *equation)
{
    static const char *const facts[] = {"rounded", "low", "high", "exact"};
    const VectorHeader *header = &writer->header;
    int stored = format_info(header->spec.format)->channels;
    print(writer, VECTOR_CSV_START "%d\n", VECTORS_VERSION);
    print(writer, "# set: %s\n", vectors_set_name(header->spec.set));
    print(writer, "# format: %s\n", format_info(header->spec.format)->name);
    print(writer, "# equation: %s\n", equation);
    print(writer, "# seed: %" PRIu64 "\n", header->spec.seed);
    print(writer, "# first: %" PRIu64 "\n", header->first);
    print(writer, "# count: %" PRIu64 "\n", header->count);
    print(writer, "# arithmetic: %s\n", header->arithmetic);
    bool sequences = header->spec.set == VECTORS_SEQUENCES;
    put_text(writer, sequences ? "sequence,layers,layer" : "index");
    put_columns(writer, "source", 4);
    if (!sequences)
        put_columns(writer, "destination", stored);
    put_columns(writer, "result", stored);
    for (int i = 0; i < 4 && sequences; i++)
        put_columns(writer, facts[i], 4);
    put_text(writer, "\n");
}

void vector_write_text_head(VectorWriter *writer)
{
    const VectorHeader *header = &writer->header;
    char equation[EQUATION_TEXT];
    equation_print(&header->equation, equation);
    if (!is_json(writer)) {
        csv_head(writer, equation);
        return;
    }
    print(writer, "{\"peel_blend_vectors\":%d,\"set\":\"%s\",\"format\":\"%s\",", VECTORS_VERSION,
          vectors_set_name(header->spec.set), format_info(header->spec.format)->name);
    print(writer, "\"equation\":\"%s\",\"seed\":%" PRIu64 ",\"first\":%" PRIu64 ",", equation,
          header->spec.seed, header->first);
    print(writer, "\"count\":%" PRIu64 ",\"arithmetic\":\"%s\"}\n", header->count,
          header->arithmetic);
}

void vector_write_text_end(VectorWriter *writer, const char *checksum)
{
    if (is_json(writer))
        print(writer, "{\"end\":true,\"count\":%" PRIu64 ",\"checksum\":\"%s\"}\n",
              writer->header.count, checksum);
    else
        print(writer, "# end: %" PRIu64 " %s\n", writer->header.count, checksum);
    flush(writer);
}

/* ---- rows, of which there are millions: put into the block without a detour ---- */

static char *add_text(char *at, const char *text)
{
    return stpcpy(at, text);
}

static char *add_integer(char *at, uint64_t value)
{
    char digits[24], *first = digits + sizeof digits;
    do
        *--first = (char)('0' + value % 10);
    while (value /= 10);
    size_t size = (size_t)(digits + sizeof digits - first);
    memcpy(at, first, size);
    return at + size;
}

static char *add_float(char *at, float x, bool json)
{
    if (json)
        *at++ = '"';
    at = hexfloat_print(x, at);
    if (json)
        *at++ = '"';
    return at;
}

/* A stored channel: a code, or a hexadecimal float. */
static char *add_channel(char *at, PixelFormat format, const void *pixel, int c, bool json)
{
    if (format_info(format)->kind == KIND_UNORM)
        return add_integer(at, format_bits(format, pixel, c));
    return add_float(at, format_channel(format, pixel, c), json);
}

static char *add_pixel(char *at, PixelFormat format, const void *pixel, bool json)
{
    for (int c = 0; c < format_info(format)->channels; c++) {
        if (c || !json)
            *at++ = ',';
        at = add_channel(at, format, pixel, c, json);
    }
    return at;
}

static char *add_source(char *at, const float source[4], bool json)
{
    for (int c = 0; c < 4; c++) {
        if (c || !json)
            *at++ = ',';
        at = add_float(at, source[c], json);
    }
    return at;
}

void vector_write_text_row(VectorWriter *writer, const float source[4], const void *destination,
                           const void *result)
{
    PixelFormat format = writer->header.spec.format;
    bool json = is_json(writer);
    uint64_t index = writer->header.first + writer->next;
    char *at = writer->text + writer->used;
    at = add_integer(json ? add_text(at, "{\"index\":") : at, index);
    at = add_source(json ? add_text(at, ",\"source\":[") : at, source, json);
    at = add_pixel(json ? add_text(at, "],\"destination\":[") : at, format, destination, json);
    at = add_pixel(json ? add_text(at, "],\"result\":[") : at, format, result, json);
    at = add_text(at, json ? "]}\n" : "\n");
    writer->used = (size_t)(at - writer->text);
    if (writer->used > VECTOR_TEXT_BLOCK)
        flush(writer);
}

/* ---- sequences ---- */

static void put_exact(VectorWriter *writer, const Rational *exact)
{
    char *text = NULL;
    gmp_asprintf(&text, "%#Zx/%#Zx", mpq_numref(exact->value), mpq_denref(exact->value));
    put_text(writer, text);
    free(text);
}

static char *add_bound(char *at, PixelFormat format, const double bound[4], bool json)
{
    bool codes = format_info(format)->kind == KIND_UNORM;
    for (int c = 0; c < 4; c++) {
        if (c || !json)
            *at++ = ',';
        at = codes ? add_integer(at, (uint64_t)bound[c]) : add_float(at, (float)bound[c], json);
    }
    return at;
}

static void csv_sequence(VectorWriter *writer, int layers, const float (*source)[4],
                         const char *results, const SequenceFacts *facts)
{
    PixelFormat format = writer->header.spec.format;
    for (int i = 0; i < layers; i++) {
        char row[VECTOR_ROW_MAX], *at = row;
        at = add_integer(at, writer->header.first + writer->next);
        *at++ = ',';
        at = add_integer(at, (uint64_t)layers);
        *at++ = ',';
        at = add_integer(at, (uint64_t)i);
        at = add_source(at, source[i], false);
        at = add_pixel(at, format, results, false);
        results += format_pixel_bytes(format);
        if (i + 1 < layers) {
            add_text(at, ",,,,,,,,,,,,,,,,\n");
            put_text(writer, row);
            continue;
        }
        at = add_pixel(at, format, facts->rounded, false);
        at = add_bound(at, format, facts->low, false);
        at = add_bound(at, format, facts->high, false);
        *at = 0;
        put_text(writer, row);
        for (int c = 0; c < 4; c++) {
            put_text(writer, ",");
            put_exact(writer, &facts->exact[c]);
        }
        put_text(writer, "\n");
    }
}

static void json_layers(VectorWriter *writer, int layers, const float (*source)[4],
                        const char *results)
{
    PixelFormat format = writer->header.spec.format;
    for (int i = 0; i < layers; i++) {
        char row[VECTOR_ROW_MAX], *at = add_text(row, i ? ",[" : "[");
        if (source)
            at = add_source(at, source[i], true);
        else
            at = add_pixel(at, format, results + (size_t)i * format_pixel_bytes(format), true);
        add_text(at, "]");
        put_text(writer, row);
    }
}

static void json_sequence(VectorWriter *writer, int layers, const float (*source)[4],
                          const char *results, const SequenceFacts *facts)
{
    PixelFormat format = writer->header.spec.format;
    char row[VECTOR_ROW_MAX], *at;
    print(writer, "{\"sequence\":%" PRIu64 ",\"layers\":%d,\"source\":[",
          writer->header.first + writer->next, layers);
    json_layers(writer, layers, source, NULL);
    put_text(writer, "],\"results\":[");
    json_layers(writer, layers, NULL, results);
    at = add_pixel(add_text(row, "],\"rounded\":["), format, facts->rounded, true);
    at = add_bound(add_text(at, "],\"low\":["), format, facts->low, true);
    at = add_bound(add_text(at, "],\"high\":["), format, facts->high, true);
    add_text(at, "],\"exact\":[\"");
    put_text(writer, row);
    for (int c = 0; c < 4; c++) {
        put_text(writer, c ? "\",\"" : "");
        put_exact(writer, &facts->exact[c]);
    }
    put_text(writer, "\"]}\n");
}

void vector_write_text_sequence(VectorWriter *writer, int layers, const float (*source)[4],
                                const char *results, const SequenceFacts *facts)
{
    if (is_json(writer))
        json_sequence(writer, layers, source, results, facts);
    else
        csv_sequence(writer, layers, source, results, facts);
}
