#include "blend/vector_results.h"

#include "base/memory.h"
#include "base/progress.h"
#include "blend/sequence.h"
#include "blend/vector_parts.h"

#include <stdlib.h>
#include <string.h>

/* A block of vectors, or one sequence, whose results come one arithmetic after the other. */
typedef struct Block {
    const VectorHeader *header;
    uint64_t next;  /* of header->count */
    size_t vectors; /* in it, or layers */
    bool sequences;
    float (*source)[4];
    char *destination, *results; /* pixels */
} Block;

static Result block_open(const VectorHeader *header, const char *what, Block *out)
{
    size_t size = format_pixel_bytes(header->spec.format);
    *out = (Block){.header = header, .sequences = header->spec.set == VECTORS_SEQUENCES};
    out->source = memory_array(VECTOR_BLOCK, sizeof *out->source);
    out->destination = memory_array(VECTOR_BLOCK, size);
    out->results = memory_array(VECTOR_BLOCK, size);
    progress_begin(what, header->count);
    return out->source && out->destination && out->results ? RESULT_OK : RESULT_NO_MEMORY;
}

static void block_close(Block *block)
{
    progress_end();
    free(block->source);
    free(block->destination);
    free(block->results);
}

/* False at the end. */
static bool block_next(Block *block)
{
    const VectorHeader *header = block->header;
    uint64_t left = header->count - block->next, first = header->first + block->next;
    progress_step(block->next);
    if (left == 0)
        return false;
    if (block->sequences) {
        block->vectors = (size_t)sequence_make(&header->spec, first, block->source);
        block->next++;
        return true;
    }
    block->vectors = left < VECTOR_BLOCK ? (size_t)left : VECTOR_BLOCK;
    vectors_make(&header->spec, first, block->vectors, block->source, block->destination);
    block->next += block->vectors;
    return true;
}

static void block_blend(Block *block, const Arithmetic *arithmetic)
{
    const VectorHeader *header = block->header;
    PixelFormat format = header->spec.format;
    const float(*source)[4] = (const float(*)[4])block->source;
    if (block->sequences) {
        sequence_blend(arithmetic, format, (int)block->vectors, source, block->results);
        return;
    }
    memcpy(block->results, block->destination, block->vectors * format_pixel_bytes(format));
    arithmetic_blend(arithmetic, &header->equation, format, block->vectors, source, block->results);
}

static Result write_all(VectorWriter *writer, Block *block, const Arithmetic *arithmetic)
{
    Result result = RESULT_OK;
    while (result == RESULT_OK && block_next(block)) {
        const float(*source)[4] = (const float(*)[4])block->source;
        block_blend(block, arithmetic);
        result = block->sequences ? vector_writer_put_sequence(writer, (int)block->vectors, source,
                                                               block->results)
                                  : vector_writer_put(writer, source, block->destination,
                                                      block->results, block->vectors);
    }
    return result;
}

Result vector_results_write(const char *path, VectorForm form, const VectorHeader *header,
                            const Arithmetic *arithmetic)
{
    VectorWriter *writer;
    Block block;
    Result result = vector_writer_open(path, form, header, &writer);
    if (result != RESULT_OK)
        return result;
    result = block_open(header, "vectors", &block);
    if (result == RESULT_OK)
        result = write_all(writer, &block, arithmetic);
    block_close(&block);
    Result closed = vector_writer_close(writer, result == RESULT_OK);
    return result != RESULT_OK ? result : closed;
}

static void digest_operands(VectorDigest *digest, const Block *block)
{
    PixelFormat format = block->header->spec.format;
    size_t size = format_pixel_bytes(format);
    for (size_t i = 0; i < block->vectors; i++) {
        unsigned char bytes[16 + VECTOR_PIXEL_MAX];
        size_t used = vector_file_source(block->source[i], bytes);
        if (!block->sequences)
            used += vector_file_pixel(format, block->destination + i * size, bytes + used);
        vector_digest_put(digest, bytes, used);
    }
}

static void digest_results(VectorDigest *digest, const Block *block)
{
    PixelFormat format = block->header->spec.format;
    size_t size = format_pixel_bytes(format);
    for (size_t i = block->sequences ? block->vectors - 1 : 0; i < block->vectors; i++) {
        unsigned char bytes[VECTOR_PIXEL_MAX];
        vector_digest_put(digest, bytes,
                          vector_file_pixel(format, block->results + i * size, bytes));
    }
}

static void digest_all(Block *block, size_t count, const Arithmetic *const arithmetics[],
                       VectorDigest *digests[])
{
    while (block_next(block)) {
        digest_operands(digests[count], block);
        for (size_t i = 0; i < count; i++) {
            block_blend(block, arithmetics[i]);
            digest_results(digests[i], block);
        }
    }
}

Result vector_results_checksums(const VectorHeader *header, size_t count,
                                const Arithmetic *const arithmetics[], char *operands,
                                char (*results)[VECTOR_DIGEST_TEXT])
{
    VectorDigest **digests = memory_array(count + 1, sizeof *digests);
    Block block;
    Result result = block_open(header, "checksums", &block);
    if (!digests)
        result = RESULT_NO_MEMORY;
    for (size_t i = 0; i <= count && result == RESULT_OK; i++) {
        digests[i] = vector_digest_create();
        result = digests[i] ? RESULT_OK : RESULT_NO_MEMORY;
    }
    if (result == RESULT_OK)
        digest_all(&block, count, arithmetics, digests);
    for (size_t i = 0; digests && i <= count && digests[i]; i++)
        vector_digest_finish(digests[i], i < count ? results[i] : operands);
    block_close(&block);
    free(digests);
    return result;
}
