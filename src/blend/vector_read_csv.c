/* Reading CSV. */
#include "blend/sequence.h"
#include "blend/vector_parts.h"

#include <inttypes.h>
#include <string.h>

enum {
    FIELDS_MAX = 27 /* of a row of sequences, all columns */
};

static char *trim(char *text)
{
    text += strspn(text, " \t");
    size_t length = strlen(text);
    while (length && (text[length - 1] == ' ' || text[length - 1] == '\t'))
        text[--length] = 0;
    return text;
}

/* ---- the head ---- */

typedef enum Key {
    KEY_SET = 0,
    KEY_FORMAT,
    KEY_EQUATION,
    KEY_SEED,
    KEY_FIRST,
    KEY_COUNT,
    KEY_ARITHMETIC,
    KEYS
} Key;

static const char *const keys[KEYS] = {"set",   "format", "equation",  "seed",
                                       "first", "count",  "arithmetic"};

static Result take_count(const VectorReader *reader, const char *name, const char *text,
                         uint64_t *out)
{
    char quote[VECTOR_QUOTE];
    if (vector_read_count(text, out))
        return RESULT_OK;
    return vector_read_fail(reader, "%s '%s', expected an integer from 0 to 2^53 - 1", name,
                            vector_read_quote(text, quote));
}

static Result take_value(const VectorReader *reader, Key key, const char *value,
                         VectorHeader *header)
{
    switch (key) {
    case KEY_SET:
        return vector_read_set(reader, value, &header->spec.set);
    case KEY_FORMAT:
        return vector_read_format(reader, value, &header->spec.format);
    case KEY_EQUATION:
        return vector_read_equation(reader, value, &header->equation);
    case KEY_SEED:
        return take_count(reader, "seed", value, &header->spec.seed);
    case KEY_FIRST:
        return take_count(reader, "first", value, &header->first);
    case KEY_COUNT:
        return take_count(reader, "count", value, &header->count);
    default:
        vector_read_note(value, header->arithmetic);
        return RESULT_OK;
    }
}

/* A line "# key: value"; other comments are somebody's own. */
static Result take_comment(const VectorReader *reader, unsigned *seen, VectorHeader *header)
{
    char *key = trim(reader->line + 1), *colon = strchr(key, ':');
    if (!colon)
        return RESULT_OK;
    *colon = 0;
    for (int i = 0; i < KEYS; i++) {
        if (strcmp(trim(key), keys[i]) != 0)
            continue;
        if (*seen >> i & 1)
            return vector_read_fail(reader, "'%s' for the second time", keys[i]);
        *seen |= 1u << i;
        return take_value(reader, (Key)i, trim(colon + 1), header);
    }
    return RESULT_OK;
}

/* ---- columns ---- */

static char *add_columns(char *at, const char *name, int count)
{
    for (int c = 0; c < count; c++) {
        *at++ = ',';
        at = stpcpy(at, name);
        *at++ = '_';
        *at++ = "rgba"[c];
    }
    *at = 0;
    return at;
}

/* The line of columns; full: of sequences with what is known of them besides. */
static void columns(const VectorHeader *header, bool full, char *out)
{
    static const char *const facts[] = {"rounded", "low", "high", "exact"};
    int stored = format_info(header->spec.format)->channels;
    bool sequences = header->spec.set == VECTORS_SEQUENCES;
    out = stpcpy(out, sequences ? "sequence,layers,layer" : "index");
    out = add_columns(out, "source", 4);
    if (!sequences)
        out = add_columns(out, "destination", stored);
    out = add_columns(out, "result", stored);
    for (int i = 0; i < 4 && full; i++)
        out = add_columns(out, facts[i], 4);
}

/* Splits the line in place; more than FIELDS_MAX fields are counted only. */
static int split(char *line, char *fields[FIELDS_MAX])
{
    int count = 0;
    for (char *at = line, *comma; at; at = comma) {
        comma = strchr(at, ',');
        if (comma)
            *comma++ = 0;
        if (count < FIELDS_MAX)
            fields[count] = trim(at);
        count++;
    }
    return count;
}

static Result check_columns(const VectorReader *reader, const VectorHeader *header)
{
    char expected[512], text[512] = "", *fields[FIELDS_MAX];
    if (strlen(reader->line) < sizeof text) {
        int count = split(reader->line, fields);
        char *at = text;
        for (int i = 0; i < count && i < FIELDS_MAX; i++) {
            at = stpcpy(at, i ? "," : "");
            at = stpcpy(at, fields[i]);
        }
    }
    int forms = header->spec.set == VECTORS_SEQUENCES ? 2 : 1;
    for (int full = 0; full < forms; full++) {
        columns(header, full, expected);
        if (strcmp(text, expected) == 0)
            return RESULT_OK;
    }
    columns(header, false, expected);
    return vector_read_fail(reader, "expected the columns %s", expected);
}

static Result read_head(VectorReader *reader, VectorHeader *header)
{
    Result result = vector_read_line(reader, VECTOR_CSV_START);
    size_t start = strlen(VECTOR_CSV_START);
    unsigned seen = 0;
    if (result == RESULT_OK && strncmp(reader->line, VECTOR_CSV_START, start) != 0)
        return vector_read_fail(reader, "expected '%s%d'", VECTOR_CSV_START, VECTORS_VERSION);
    if (result == RESULT_OK)
        result = vector_read_version(reader, trim(reader->line + start));
    while (result == RESULT_OK) {
        result = vector_read_line(reader, "the columns and the vectors");
        if (result == RESULT_OK && reader->line[0] != '#')
            break;
        if (result == RESULT_OK)
            result = take_comment(reader, &seen, header);
    }
    for (int i = 0; i < KEY_ARITHMETIC && result == RESULT_OK; i++)
        if (!(seen >> i & 1))
            return vector_read_fail(reader, "expected a line '# %s: ...' before this one", keys[i]);
    if (result == RESULT_OK)
        result = vectors_check(&header->spec) == RESULT_OK
                     ? check_columns(reader, header)
                     : vector_read_fail(reader, "no %s vectors of %s",
                                        vectors_set_name(header->spec.set),
                                        format_info(header->spec.format)->name);
    return result;
}

/* ---- rows ---- */

static Result next_fields(VectorReader *reader, const char *what, uint64_t index, int least,
                          int most, char *fields[FIELDS_MAX])
{
    char expected[96];
    snprintf(expected, sizeof expected, "%s %" PRIu64 " of the %" PRIu64 " from %" PRIu64, what,
             index, reader->header.count, reader->header.first);
    Result result = vector_read_line(reader, expected);
    if (result != RESULT_OK)
        return result;
    if (reader->line[0] == '#')
        return vector_read_fail(reader, "a comment, expected %s", expected);
    int count = split(reader->line, fields);
    if (count == least || count == most)
        return RESULT_OK;
    return vector_read_fail(reader, "%d fields, expected the %d of the columns", count, least);
}

static Result take_source(const VectorReader *reader, char *const fields[4], float source[4])
{
    char name[] = "source_r";
    Result result = RESULT_OK;
    for (int c = 0; c < 4 && result == RESULT_OK; c++) {
        name[7] = "rgba"[c];
        result = vector_read_source(reader, name, fields[c], &source[c]);
    }
    return result;
}

static Result take_pixel(const VectorReader *reader, const char *what, char *const fields[],
                         uint32_t bits[4])
{
    char name[24];
    Result result = RESULT_OK;
    for (int c = 0; c < format_info(reader->header.spec.format)->channels && !result; c++) {
        snprintf(name, sizeof name, "%s_%c", what, "rgba"[c]);
        result = vector_read_channel(reader, name, fields[c], &bits[c]);
    }
    return result;
}

static Result read_row(VectorReader *reader, VectorRow *out)
{
    char *fields[FIELDS_MAX];
    int stored = format_info(reader->header.spec.format)->channels, count = 5 + 2 * stored;
    Result result =
        next_fields(reader, "vector", reader->header.first + reader->row, count, count, fields);
    if (result == RESULT_OK)
        result = take_count(reader, "index", fields[0], &out->index);
    if (result == RESULT_OK)
        result = take_source(reader, fields + 1, out->source);
    if (result == RESULT_OK)
        result = take_pixel(reader, "destination", fields + 5, out->destination);
    if (result == RESULT_OK)
        result = take_pixel(reader, "result", fields + 5 + stored, out->result);
    return result;
}

static Result take_layer(VectorReader *reader, char *const fields[], int layer, int layers,
                         VectorSequence *out)
{
    static const char *const names[] = {"sequence", "layers", "layer"};
    PixelFormat format = reader->header.spec.format;
    uint64_t index = reader->header.first + reader->next;
    uint64_t expected[3] = {index, (uint64_t)layers, (uint64_t)layer}, found;
    for (int i = 0; i < 3; i++) {
        Result result = take_count(reader, names[i], fields[i], &found);
        if (result != RESULT_OK)
            return result;
        if (found != expected[i])
            return vector_read_fail(reader, "%s %" PRIu64 ", expected %" PRIu64, names[i], found,
                                    expected[i]);
    }
    Result result = take_source(reader, fields + 3, out->source[layer]);
    bool empty = !*fields[7] && !*fields[8] && !*fields[9] && !*fields[10];
    out->given[layer] = !empty;
    if (result != RESULT_OK || (empty && layer + 1 < layers))
        return result;
    uint32_t bits[4] = {0};
    result = take_pixel(reader, "result", fields + 7, bits);
    for (int c = 0; c < 4 && result == RESULT_OK; c++)
        format_set_bits(format, out->results + (size_t)layer * format_pixel_bytes(format), c,
                        bits[c]);
    return result;
}

static Result read_sequence(VectorReader *reader, int layers, VectorSequence *out)
{
    char *fields[FIELDS_MAX];
    out->index = reader->header.first + reader->next;
    Result result = RESULT_OK;
    for (int i = 0; i < layers && result == RESULT_OK; i++) {
        result = next_fields(reader, "a layer of sequence", out->index, 11, FIELDS_MAX, fields);
        if (result == RESULT_OK)
            result = take_layer(reader, fields, i, layers, out);
    }
    return result;
}

static Result read_end(VectorReader *reader, uint64_t *count, char checksum[VECTOR_DIGEST_TEXT])
{
    char number[20];
    int length = 0;
    Result result = vector_read_line(reader, "'# end: COUNT CHECKSUM'");
    if (result != RESULT_OK)
        return result;
    int found = sscanf(reader->line, "# end: %16s %64s%n", number, checksum, &length);
    if (found != 2 || !length || *trim(reader->line + length) || !vector_read_count(number, count))
        return vector_read_fail(reader, "expected '# end: %" PRIu64 " CHECKSUM'",
                                reader->header.count);
    return RESULT_OK;
}

const VectorFormReader vector_csv_reader = {read_head, read_row, read_sequence, read_end};
