/* Reading the binary form. */
#include "blend/sequence.h"
#include "blend/vector_parts.h"
#include "number/op.h"

#include <inttypes.h>
#include <string.h>

static Result read_bytes(VectorReader *reader, const char *what, void *out, size_t size)
{
    unsigned char *to = out;
    while (size) {
        bool any;
        Result result = vector_read_more(reader, &any);
        if (result != RESULT_OK)
            return result;
        if (!any)
            return vector_read_fail(reader, "the file ends here, expected %s", what);
        size_t part = reader->filled - reader->at;
        part = part < size ? part : size;
        memcpy(to, reader->buffer + reader->at, part);
        reader->at += part;
        reader->position += part;
        to += part;
        size -= part;
    }
    return RESULT_OK;
}

static uint64_t integer(const unsigned char *bytes, int size)
{
    uint64_t value = 0;
    for (int i = size; i-- > 0;)
        value = value << 8 | bytes[i];
    return value;
}

static Result check_texts(const VectorReader *reader, const char *texts)
{
    static const size_t sizes[] = {VECTOR_NAME, VECTOR_NAME, EQUATION_TEXT, 64};
    for (int i = 0; i < 4; i++) {
        if (!memchr(texts, 0, sizes[i]))
            return vector_read_fail(reader, "a text of the head without its final zero byte");
        texts += sizes[i];
    }
    return RESULT_OK;
}

static Result read_head(VectorReader *reader, VectorHeader *header)
{
    unsigned char head[VECTOR_BINARY_HEAD];
    const char *texts = (const char *)head + 40;
    char version[24];
    Result result = read_bytes(reader, "the head of 296 bytes", head, sizeof head);
    if (result != RESULT_OK)
        return result;
    if (memcmp(head, vector_binary_start, sizeof vector_binary_start) != 0)
        return vector_read_fail(reader, "no file of 'peel blend vectors': expected PEELVEC first");
    snprintf(version, sizeof version, "%" PRIu64, integer(head + 8, 4));
    uint64_t flags = integer(head + 12, 4);
    header->spec.seed = integer(head + 16, 8);
    header->first = integer(head + 24, 8);
    header->count = integer(head + 32, 8);
    result = vector_read_version(reader, version);
    if (result == RESULT_OK && flags & ~(uint64_t)VECTOR_LAST_ONLY)
        result = vector_read_fail(reader, "flags %" PRIu64 ", expected 0 or 1", flags);
    if (result == RESULT_OK && (header->spec.seed | header->first | header->count) >> 53)
        result = vector_read_fail(reader, "seed, first or count of 2^53 or more");
    reader->last_only = flags & VECTOR_LAST_ONLY;
    if (result == RESULT_OK)
        result = check_texts(reader, texts);
    if (result == RESULT_OK)
        result = vector_read_set(reader, texts, &header->spec.set);
    if (result == RESULT_OK)
        result = vector_read_format(reader, texts + VECTOR_NAME, &header->spec.format);
    if (result == RESULT_OK)
        result = vector_read_equation(reader, texts + 2 * VECTOR_NAME, &header->equation);
    if (result == RESULT_OK)
        vector_read_note(texts + 2 * VECTOR_NAME + EQUATION_TEXT, header->arithmetic);
    return result;
}

static void take_source(const unsigned char *bytes, float source[4])
{
    for (int c = 0; c < 4; c++)
        source[c] = op_from_bits((uint32_t)integer(bytes + 4 * c, 4));
}

static void take_pixel(PixelFormat format, const unsigned char *bytes, uint32_t bits[4])
{
    const FormatInfo *info = format_info(format);
    for (int c = 0; c < info->channels; c++)
        bits[c] = (uint32_t)integer(bytes + c * info->channel_bytes, info->channel_bytes);
}

static Result read_row(VectorReader *reader, VectorRow *out)
{
    PixelFormat format = reader->header.spec.format;
    size_t size = format_pixel_bytes(format);
    unsigned char bytes[16 + 2 * VECTOR_PIXEL_MAX];
    char expected[64];
    out->index = reader->header.first + reader->row;
    snprintf(expected, sizeof expected, "vector %" PRIu64 " of %zu bytes", out->index,
             16 + 2 * size);
    Result result = read_bytes(reader, expected, bytes, 16 + 2 * size);
    if (result != RESULT_OK)
        return result;
    take_source(bytes, out->source);
    take_pixel(format, bytes + 16, out->destination);
    take_pixel(format, bytes + 16 + size, out->result);
    return RESULT_OK;
}

static Result read_results(VectorReader *reader, int layers, const char *expected,
                           VectorSequence *out)
{
    PixelFormat format = reader->header.spec.format;
    size_t size = format_pixel_bytes(format);
    Result result = RESULT_OK;
    for (int i = 0; i < layers && result == RESULT_OK; i++) {
        unsigned char bytes[VECTOR_PIXEL_MAX];
        uint32_t bits[4] = {0};
        out->given[i] = !reader->last_only || i + 1 == layers;
        if (!out->given[i])
            continue;
        result = read_bytes(reader, expected, bytes, size);
        if (result != RESULT_OK)
            break;
        take_pixel(format, bytes, bits);
        for (int c = 0; c < 4; c++)
            format_set_bits(format, out->results + (size_t)i * size, c, bits[c]);
    }
    return result;
}

static Result read_sequence(VectorReader *reader, int layers, VectorSequence *out)
{
    unsigned char bytes[16];
    char expected[64];
    out->index = reader->header.first + reader->next;
    snprintf(expected, sizeof expected, "sequence %" PRIu64 " of %d layers", out->index, layers);
    Result result = read_bytes(reader, expected, bytes, 4);
    if (result == RESULT_OK && integer(bytes, 4) != (uint64_t)layers)
        return vector_read_fail(reader, "sequence %" PRIu64 ": %" PRIu64 " layers, expected %d",
                                out->index, integer(bytes, 4), layers);
    for (int i = 0; i < layers && result == RESULT_OK; i++) {
        result = read_bytes(reader, expected, bytes, sizeof bytes);
        if (result == RESULT_OK)
            take_source(bytes, out->source[i]);
    }
    return result == RESULT_OK ? read_results(reader, layers, expected, out) : result;
}

static Result read_end(VectorReader *reader, uint64_t *count, char checksum[VECTOR_DIGEST_TEXT])
{
    unsigned char end[VECTOR_BINARY_END];
    Result result = read_bytes(reader, "the end of 48 bytes", end, sizeof end);
    if (result != RESULT_OK)
        return result;
    if (memcmp(end, vector_binary_end, sizeof vector_binary_end) != 0)
        return vector_read_fail(reader, "expected PEELEND after %" PRIu64 " vectors",
                                reader->header.count);
    *count = integer(end + 8, 8);
    for (int i = 0; i < 32; i++)
        snprintf(checksum + 2 * i, 3, "%02x", end[16 + i]);
    return RESULT_OK;
}

const VectorFormReader vector_binary_reader = {read_head, read_row, read_sequence, read_end};
