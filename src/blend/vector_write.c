/* Writing: opening, closing, and the binary form. */
#include "blend/sequence.h"
#include "blend/vector_parts.h"

#include <stdlib.h>
#include <string.h>

const char vector_binary_start[8] = "PEELVEC\n", vector_binary_end[8] = "PEELEND\n";

void vector_write_bytes(VectorWriter *writer, const void *bytes, size_t size)
{
    if (writer->failed == RESULT_OK)
        writer->failed = file_writer_put(&writer->file, bytes, size);
}

static unsigned char *put_integer(uint64_t value, int size, unsigned char *at)
{
    for (int i = 0; i < size; i++)
        *at++ = (unsigned char)(value >> 8 * i);
    return at;
}

static void write_binary_head(VectorWriter *writer)
{
    const VectorHeader *header = &writer->header;
    unsigned char head[VECTOR_BINARY_HEAD] = {0}, *at = head + 8;
    char equation[EQUATION_TEXT];
    memcpy(head, vector_binary_start, 8);
    at = put_integer(VECTORS_VERSION, 4, at);
    at = put_integer(0, 4, at);
    at = put_integer(header->spec.seed, 8, at);
    at = put_integer(header->first, 8, at);
    at = put_integer(header->count, 8, at);
    char *text = (char *)at;
    snprintf(text, VECTOR_NAME, "%s", vectors_set_name(header->spec.set));
    text += VECTOR_NAME;
    snprintf(text, VECTOR_NAME, "%s", format_info(header->spec.format)->name);
    equation_print(&header->equation, equation);
    text += VECTOR_NAME;
    snprintf(text, EQUATION_TEXT, "%s", equation);
    snprintf(text + EQUATION_TEXT, sizeof header->arithmetic, "%s", header->arithmetic);
    vector_write_bytes(writer, head, sizeof head);
}

static unsigned hex_digit(char c)
{
    return (unsigned)(c <= '9' ? c - '0' : c - 'a' + 10);
}

static void write_binary_end(VectorWriter *writer, const char *checksum)
{
    unsigned char end[VECTOR_BINARY_END], *at;
    memcpy(end, vector_binary_end, 8);
    at = put_integer(writer->header.count, 8, end + 8);
    for (int i = 0; i < 32; i++)
        *at++ = (unsigned char)(hex_digit(checksum[2 * i]) << 4 | hex_digit(checksum[2 * i + 1]));
    vector_write_bytes(writer, end, sizeof end);
}

static Result open_writer(const char *path, VectorWriter *writer)
{
    writer->text = malloc(VECTOR_TEXT_BLOCK + VECTOR_ROW_MAX);
    if (!writer->text)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", path);
    writer->digest = vector_digest_create();
    if (!writer->digest)
        return RESULT_NO_MEMORY;
    return strcmp(path, "-") == 0 ? file_writer_standard(&writer->file)
                                  : file_writer_open(path, &writer->file);
}

Result vector_writer_open(const char *path, VectorForm form, const VectorHeader *header,
                          VectorWriter **out)
{
    VectorWriter *writer = calloc(1, sizeof *writer);
    if (!writer)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", path);
    writer->form = form;
    writer->header = *header;
    Result result = open_writer(path, writer);
    if (result == RESULT_OK) {
        if (form == VECTOR_BINARY)
            write_binary_head(writer);
        else
            vector_write_text_head(writer);
        result = writer->failed;
    }
    if (result != RESULT_OK) {
        vector_writer_close(writer, false);
        return result;
    }
    *out = writer;
    return RESULT_OK;
}

/* As a little-endian machine has them; what is in a file is that on every machine. */
static void little_endian(void *bytes, size_t size, size_t unit)
{
    static const union {
        uint16_t value;
        unsigned char first;
    } one = {1};
    unsigned char *at = bytes;
    for (size_t i = 0; i < size && !one.first; i += unit)
        for (size_t k = 0; k < unit / 2; k++) {
            unsigned char swapped = at[i + k];
            at[i + k] = at[i + unit - 1 - k];
            at[i + unit - 1 - k] = swapped;
        }
}

size_t vector_file_source(const float source[4], unsigned char out[16])
{
    memcpy(out, source, 16);
    little_endian(out, 16, 4);
    return 16;
}

size_t vector_file_pixel(PixelFormat format, const void *pixel, unsigned char *out)
{
    size_t size = format_pixel_bytes(format);
    memcpy(out, pixel, size);
    little_endian(out, size, (size_t)format_info(format)->channel_bytes);
    return size;
}

Result vector_writer_put(VectorWriter *writer, const float (*source)[4], const void *destination,
                         const void *results, size_t count)
{
    PixelFormat format = writer->header.spec.format;
    size_t size = format_pixel_bytes(format);
    for (size_t i = 0; i < count && writer->failed == RESULT_OK; i++) {
        unsigned char bytes[3 * VECTOR_PIXEL_MAX];
        const char *before = (const char *)destination + i * size;
        const char *after = (const char *)results + i * size;
        size_t used = vector_file_source(source[i], bytes);
        used += vector_file_pixel(format, before, bytes + used);
        vector_digest_put(writer->digest, bytes, used);
        if (writer->form == VECTOR_BINARY) {
            used += vector_file_pixel(format, after, bytes + used);
            vector_write_bytes(writer, bytes, used);
        } else {
            vector_write_text_row(writer, source[i], before, after);
        }
        writer->next++;
    }
    return writer->failed;
}

static void write_binary_sequence(VectorWriter *writer, int layers, const float (*source)[4],
                                  const char *results)
{
    PixelFormat format = writer->header.spec.format;
    unsigned char bytes[VECTOR_PIXEL_MAX];
    put_integer((uint64_t)layers, 4, bytes);
    vector_write_bytes(writer, bytes, 4);
    for (int i = 0; i < layers; i++)
        vector_write_bytes(writer, bytes, vector_file_source(source[i], bytes));
    for (int i = 0; i < layers; i++) {
        size_t size = vector_file_pixel(format, results, bytes);
        vector_write_bytes(writer, bytes, size);
        results += size;
    }
}

Result vector_writer_put_sequence(VectorWriter *writer, int layers, const float (*source)[4],
                                  const void *results)
{
    PixelFormat format = writer->header.spec.format;
    for (int i = 0; i < layers; i++) {
        unsigned char bytes[16];
        vector_digest_put(writer->digest, bytes, vector_file_source(source[i], bytes));
    }
    if (writer->form == VECTOR_BINARY) {
        write_binary_sequence(writer, layers, source, results);
    } else {
        SequenceFacts facts;
        for (int c = 0; c < 4; c++)
            rational_init(&facts.exact[c]);
        sequence_exact(format, layers, source, facts.exact);
        sequence_round(format, facts.exact, facts.rounded);
        sequence_bound(format, layers, source, facts.low, facts.high);
        vector_write_text_sequence(writer, layers, source, results, &facts);
        for (int c = 0; c < 4; c++)
            rational_clear(&facts.exact[c]);
    }
    writer->next++;
    return writer->failed;
}

static void write_end(VectorWriter *writer)
{
    char checksum[VECTOR_DIGEST_TEXT];
    vector_digest_finish(writer->digest, checksum);
    writer->digest = NULL;
    if (writer->form == VECTOR_BINARY)
        write_binary_end(writer, checksum);
    else
        vector_write_text_end(writer, checksum);
}

Result vector_writer_close(VectorWriter *writer, bool commit)
{
    if (!writer)
        return RESULT_OK;
    if (commit)
        write_end(writer);
    commit = commit && writer->failed == RESULT_OK;
    Result result = writer->failed, closed = file_writer_close(&writer->file, commit);
    char checksum[VECTOR_DIGEST_TEXT];
    if (writer->digest)
        vector_digest_finish(writer->digest, checksum);
    free(writer->text);
    free(writer);
    return result != RESULT_OK ? result : closed;
}
