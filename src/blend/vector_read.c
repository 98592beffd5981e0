/* Reading: opening, the stream, and checks that all forms share. */
#include "base/memory.h"
#include "blend/sequence.h"
#include "blend/vector_parts.h"
#include "number/hexfloat.h"
#include "number/op.h"

#include <errno.h>
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* ---- messages -------------------------------------------------------------------------------- */

#undef vector_read_fail
Result vector_read_fail(const VectorReader *reader, const char *format, ...)
{
    char text[320];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (reader->form == &vector_binary_reader)
        return result_fail(RESULT_BAD_INPUT, "%s: byte %" PRIu64 ": %s", reader->path,
                           reader->position, text);
    return result_fail(RESULT_BAD_INPUT, "%s:%" PRIu64 ": %s", reader->path,
                       reader->line_number ? reader->line_number : 1, text);
}

const char *vector_read_quote(const char *text, char out[VECTOR_QUOTE])
{
    size_t length = strnlen(text, VECTOR_QUOTE);
    bool cut = length >= VECTOR_QUOTE - 1;
    length = cut ? VECTOR_QUOTE - 4 : length;
    memcpy(out, text, length);
    for (size_t i = 0; i < length; i++)
        if (out[i] < ' ' || out[i] > '~')
            out[i] = '?';
    memcpy(out + length, cut ? "..." : "", cut ? 4 : 1);
    return out;
}

void vector_read_note(const char *text, char out[VECTOR_NOTE])
{
    size_t length = 0;
    for (text += strspn(text, " \t"); *text && length < VECTOR_NOTE - 1; text++) {
        bool plain = *text >= ' ' && *text <= '~' && *text != '"' && *text != '\\';
        out[length++] = (char)(plain ? *text : '?');
    }
    while (length && out[length - 1] == ' ')
        length--;
    out[length] = 0;
}

/* ---- the stream ------------------------------------------------------------------------------ */

Result vector_read_more(VectorReader *reader, bool *any)
{
    if (reader->at == reader->filled) {
        reader->at = 0;
        errno = 0;
        reader->filled = fread(reader->buffer, 1, VECTOR_TEXT_BLOCK, reader->stream);
        if (reader->filled == 0 && ferror(reader->stream))
            return result_fail(RESULT_IO, "%s: cannot read: %s", reader->path,
                               strerror(errno ? errno : EIO));
    }
    *any = reader->at < reader->filled;
    return RESULT_OK;
}

static Result append(VectorReader *reader, const unsigned char *bytes, size_t size)
{
    if (reader->length + size > VECTOR_LINE_MAX)
        return vector_read_fail(reader, "a line of more than %d bytes", VECTOR_LINE_MAX);
    if (memchr(bytes, 0, size))
        return vector_read_fail(reader, "a zero byte, expected text");
    Result result =
        memory_grow((void **)&reader->line, &reader->room, reader->length + size + 1, 1);
    if (result != RESULT_OK)
        return result;
    memcpy(reader->line + reader->length, bytes, size);
    reader->length += size;
    reader->line[reader->length] = 0;
    return RESULT_OK;
}

/* *ended: there was no line any more. */
static Result next_line(VectorReader *reader, bool *ended)
{
    bool any, begun = false, whole = false;
    reader->length = 0;
    reader->line_number++;
    while (!whole) {
        Result result = vector_read_more(reader, &any);
        if (result != RESULT_OK)
            return result;
        if (!any)
            break;
        begun = true;
        unsigned char *first = reader->buffer + reader->at;
        unsigned char *end = memchr(first, '\n', reader->filled - reader->at);
        size_t size = end ? (size_t)(end - first) : reader->filled - reader->at;
        whole = end != NULL;
        reader->at += size + whole;
        reader->position += size + whole;
        result = append(reader, first, size);
        if (result != RESULT_OK)
            return result;
    }
    if (begun && reader->length && reader->line[reader->length - 1] == '\r')
        reader->line[--reader->length] = 0;
    *ended = !begun;
    return RESULT_OK;
}

Result vector_read_line(VectorReader *reader, const char *what)
{
    bool ended;
    Result result = next_line(reader, &ended);
    if (result == RESULT_OK && ended)
        return vector_read_fail(reader, "the file ends here, expected %s", what);
    return result;
}

Result vector_read_rest(VectorReader *reader)
{
    for (;;) {
        bool ended;
        Result result = next_line(reader, &ended);
        if (result != RESULT_OK || ended)
            return result;
        if (strspn(reader->line, " \t") != reader->length)
            return vector_read_fail(reader, "text behind the last line, expected the file's end");
    }
}

/* ---- values of texts ------------------------------------------------------------------------- */

bool vector_read_count(const char *text, uint64_t *out)
{
    uint64_t value = 0;
    size_t length = strlen(text);
    if (length == 0 || length > 16 || strspn(text, "0123456789") != length)
        return false;
    for (; *text; text++)
        value = 10 * value + (uint64_t)(*text - '0');
    *out = value;
    return value < (uint64_t)1 << 53;
}

Result vector_read_version(const VectorReader *reader, const char *text)
{
    char quote[VECTOR_QUOTE];
    uint64_t version;
    if (vector_read_count(text, &version) && version == VECTORS_VERSION)
        return RESULT_OK;
    return vector_read_fail(reader, "vectors of version '%s', expected %d",
                            vector_read_quote(text, quote), VECTORS_VERSION);
}

Result vector_read_set(const VectorReader *reader, const char *text, VectorSet *out)
{
    char quote[VECTOR_QUOTE];
    for (int i = 0; i < VECTORS_SET_COUNT; i++)
        if (strcmp(text, vectors_set_name((VectorSet)i)) == 0) {
            *out = (VectorSet)i;
            return RESULT_OK;
        }
    return vector_read_fail(reader, "set '%s', expected exhaustive, directed, random or sequences",
                            vector_read_quote(text, quote));
}

Result vector_read_format(const VectorReader *reader, const char *text, PixelFormat *out)
{
    char quote[VECTOR_QUOTE];
    if (format_find(text, out))
        return RESULT_OK;
    return vector_read_fail(reader,
                            "format '%s', expected rgba8, rgba16, rgba16f, rgba32f, rg32f or r32f",
                            vector_read_quote(text, quote));
}

Result vector_read_equation(const VectorReader *reader, const char *text, BlendEquation *out)
{
    char quote[VECTOR_QUOTE];
    if (equation_parse(text, out) == RESULT_OK)
        return RESULT_OK;
    return vector_read_fail(reader,
                            "equation '%s', expected a name or factors as under, over, "
                            "one,one:max",
                            vector_read_quote(text, quote));
}

bool vector_read_bits(PixelFormat format, float x, uint32_t *bits)
{
    if (format_info(format)->kind == KIND_HALF) {
        *bits = half_from_float(x);
        return x != x || half_to_float((uint16_t)*bits) == x;
    }
    *bits = op_bits(x);
    return true;
}

Result vector_read_source(const VectorReader *reader, const char *name, const char *text,
                          float *out)
{
    char quote[VECTOR_QUOTE];
    if (hexfloat_parse(text, out))
        return RESULT_OK;
    return vector_read_fail(reader,
                            "%s is '%s', expected a hexadecimal float as 0x1.8p-1 (\"%%a\")", name,
                            vector_read_quote(text, quote));
}

Result vector_read_channel(const VectorReader *reader, const char *name, const char *text,
                           uint32_t *bits)
{
    PixelFormat format = reader->header.spec.format;
    const FormatInfo *info = format_info(format);
    char quote[VECTOR_QUOTE];
    if (info->kind == KIND_UNORM) {
        uint64_t code;
        if (!vector_read_count(text, &code) || code > info->unorm_max)
            return vector_read_fail(reader, "%s is '%s', expected a code from 0 to %u", name,
                                    vector_read_quote(text, quote), info->unorm_max);
        *bits = (uint32_t)code;
        return RESULT_OK;
    }
    float value;
    Result result = vector_read_source(reader, name, text, &value);
    if (result == RESULT_OK && !vector_read_bits(format, value, bits))
        return vector_read_fail(reader, "%s is '%s', which no half is", name,
                                vector_read_quote(text, quote));
    return result;
}

/* ---- opening --------------------------------------------------------------------------------- */

static Result find_form(VectorReader *reader)
{
    bool any;
    Result result = vector_read_more(reader, &any);
    if (result != RESULT_OK)
        return result;
    int first = any ? reader->buffer[0] : 0;
    reader->form = first == '{'                      ? &vector_json_reader
                   : first == vector_binary_start[0] ? &vector_binary_reader
                                                     : &vector_csv_reader;
    if (!any || (first != '#' && first != '{' && first != vector_binary_start[0]))
        return vector_read_fail(reader,
                                "no file of 'peel blend vectors': expected '%s%d', a line of JSON "
                                "or the binary form",
                                VECTOR_CSV_START, VECTORS_VERSION);
    return RESULT_OK;
}

static Result check_header(VectorReader *reader)
{
    VectorHeader *header = &reader->header;
    header->spec.count = header->first + header->count;
    Result result = vectors_check(&header->spec);
    if (result != RESULT_OK) {
        char message[256];
        snprintf(message, sizeof message, "%s", result_message());
        return vector_read_fail(reader, "%s", message);
    }
    uint64_t all = vectors_count(&header->spec);
    if (header->first > all || header->count > all - header->first)
        return vector_read_fail(
            reader, "first %" PRIu64 ", count %" PRIu64 ": the set has %" PRIu64 " vectors",
            header->first, header->count, all);
    if (header->spec.set == VECTORS_SEQUENCES && equation_id(&header->equation) != EQUATION_UNDER)
        return vector_read_fail(reader, "sequences: expected the equation under");
    return RESULT_OK;
}

static Result open_reader(const char *path, VectorReader *reader)
{
    bool standard = strcmp(path, "-") == 0;
    reader->path = strdup(standard ? "standard input" : path);
    reader->buffer = malloc(VECTOR_TEXT_BLOCK);
    reader->expected = malloc(VECTOR_BLOCK * sizeof *reader->expected);
    reader->pixels = malloc(VECTOR_BLOCK * VECTOR_PIXEL_MAX);
    if (!reader->path || !reader->buffer || !reader->expected || !reader->pixels)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", path);
    reader->digest = vector_digest_create();
    if (!reader->digest)
        return RESULT_NO_MEMORY;
    reader->stream = standard ? stdin : fopen(path, "rb");
    if (!reader->stream)
        return result_fail(RESULT_IO, "%s: cannot read: %s", path, strerror(errno));
    Result result = find_form(reader);
    if (result == RESULT_OK)
        result = reader->form->head(reader, &reader->header);
    return result == RESULT_OK ? check_header(reader) : result;
}

Result vector_reader_open(const char *path, VectorHeader *header, VectorReader **out)
{
    VectorReader *reader = calloc(1, sizeof *reader);
    if (!reader)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", path);
    Result result = open_reader(path, reader);
    if (result != RESULT_OK) {
        vector_reader_close(reader);
        return result;
    }
    *header = reader->header;
    *out = reader;
    return RESULT_OK;
}

void vector_reader_close(VectorReader *reader)
{
    if (!reader)
        return;
    char checksum[VECTOR_DIGEST_TEXT];
    if (reader->digest)
        vector_digest_finish(reader->digest, checksum);
    if (reader->stream && reader->stream != stdin)
        (void)fclose(reader->stream);
    free(reader->path);
    free(reader->buffer);
    free(reader->line);
    free(reader->expected);
    free(reader->pixels);
    free(reader);
}

/* ---- vectors --------------------------------------------------------------------------------- */

static bool same(float a, float b)
{
    return op_bits(a) == op_bits(b) || (a != a && b != b);
}

static bool same_bits(PixelFormat format, uint32_t a, uint32_t b)
{
    return a == b || format_ulp(format_info(format)->kind, a, b) == 0;
}

static const char channels[] = "rgba";

static Result check_source(const VectorReader *reader, const float got[4], const float expected[4])
{
    for (int c = 0; c < 4; c++)
        if (!same(got[c], expected[c])) {
            char a[HEXFLOAT_TEXT], b[HEXFLOAT_TEXT];
            hexfloat_print(got[c], a);
            hexfloat_print(expected[c], b);
            return vector_read_fail(reader, "source_%c is %s, expected this vector's %s",
                                    channels[c], a, b);
        }
    return RESULT_OK;
}

static void print_bits(PixelFormat format, uint32_t bits, char out[HEXFLOAT_TEXT])
{
    unsigned char pixel[VECTOR_PIXEL_MAX];
    format_set_bits(format, pixel, 0, bits);
    if (format_info(format)->kind == KIND_UNORM)
        snprintf(out, HEXFLOAT_TEXT, "%u", bits);
    else
        hexfloat_print(format_channel(format, pixel, 0), out);
}

static Result check_row(const VectorReader *reader, const VectorRow *row, uint64_t index,
                        const float source[4], const void *destination)
{
    PixelFormat format = reader->header.spec.format;
    if (row->index != index)
        return vector_read_fail(reader, "vector %" PRIu64 ", expected %" PRIu64, row->index, index);
    Result result = check_source(reader, row->source, source);
    for (int c = 0; c < format_info(format)->channels && result == RESULT_OK; c++) {
        uint32_t expected = format_bits(format, destination, c);
        if (!same_bits(format, row->destination[c], expected)) {
            char a[HEXFLOAT_TEXT], b[HEXFLOAT_TEXT];
            print_bits(format, row->destination[c], a);
            print_bits(format, expected, b);
            result = vector_read_fail(reader, "destination_%c is %s, expected this vector's %s",
                                      channels[c], a, b);
        }
    }
    return result;
}

/* The file's end, once everything before it was read. */
static Result finish(VectorReader *reader)
{
    char checksum[VECTOR_DIGEST_TEXT], theirs[VECTOR_DIGEST_TEXT], quote[VECTOR_QUOTE];
    uint64_t count;
    if (reader->ended)
        return RESULT_OK;
    Result result = reader->form->end(reader, &count, theirs);
    if (result != RESULT_OK)
        return result;
    if (count != reader->header.count)
        return vector_read_fail(reader, "the end says %" PRIu64 " vectors, expected %" PRIu64,
                                count, reader->header.count);
    vector_digest_finish(reader->digest, checksum);
    reader->digest = NULL;
    reader->ended = true;
    if (strcmp(checksum, theirs) != 0)
        return vector_read_fail(reader, "checksum of the operands '%s', expected %.40s...",
                                vector_read_quote(theirs, quote), checksum);
    if (reader->form != &vector_binary_reader)
        return vector_read_rest(reader);
    bool any;
    result = vector_read_more(reader, &any);
    return result == RESULT_OK && any ? vector_read_fail(reader, "expected the file's end")
                                      : result;
}

static void digest_vector(VectorReader *reader, const float source[4], const void *destination)
{
    unsigned char bytes[16 + VECTOR_PIXEL_MAX];
    size_t size = vector_file_source(source, bytes);
    if (destination)
        size += vector_file_pixel(reader->header.spec.format, destination, bytes + size);
    vector_digest_put(reader->digest, bytes, size);
}

Result vector_reader_next(VectorReader *reader, float (*source)[4], void *destination,
                          void *results, size_t *count)
{
    const VectorHeader *header = &reader->header;
    PixelFormat format = header->spec.format;
    size_t size = format_pixel_bytes(format);
    uint64_t left = header->count - reader->next, first = header->first + reader->next;
    *count = 0;
    if (left == 0)
        return finish(reader);
    size_t wanted = left < VECTOR_BLOCK ? (size_t)left : VECTOR_BLOCK;
    vectors_make(&header->spec, first, wanted, source, destination);
    for (size_t i = 0; i < wanted; i++) {
        VectorRow row;
        const char *pixel = (const char *)destination + i * size;
        Result result = reader->form->row(reader, &row);
        if (result == RESULT_OK)
            result = check_row(reader, &row, first + i, source[i], pixel);
        if (result != RESULT_OK)
            return result;
        reader->row++;
        for (int c = 0; c < format_info(format)->channels; c++)
            format_set_bits(format, (char *)results + i * size, c, row.result[c]);
        digest_vector(reader, source[i], pixel);
    }
    reader->next += wanted;
    *count = wanted;
    return RESULT_OK;
}

Result vector_reader_next_sequence(VectorReader *reader, int *layers, float (*source)[4],
                                   void *results, bool *given)
{
    const VectorHeader *header = &reader->header;
    uint64_t index = header->first + reader->next;
    *layers = 0;
    if (reader->next == header->count)
        return finish(reader);
    int expected = sequence_make(&header->spec, index, reader->expected);
    VectorSequence sequence = {.source = source, .results = results, .given = given};
    Result result = reader->form->sequence(reader, expected, &sequence);
    if (result == RESULT_OK && sequence.index != index)
        result = vector_read_fail(reader, "sequence %" PRIu64 ", expected %" PRIu64, sequence.index,
                                  index);
    for (int i = 0; i < expected && result == RESULT_OK; i++) {
        result = check_source(reader, source[i], reader->expected[i]);
        digest_vector(reader, reader->expected[i], NULL);
    }
    if (result != RESULT_OK)
        return result;
    reader->next++;
    *layers = expected;
    return RESULT_OK;
}
