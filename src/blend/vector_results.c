#include "blend/vector_results.h"

#include "base/memory.h"
#include "base/pool.h"
#include "base/progress.h"
#include "blend/sequence.h"
#include "blend/vector_parts.h"

#include <stdlib.h>
#include <string.h>

/* A block of vectors, or one sequence, with its results. */
typedef struct Block {
    const VectorHeader *header;
    uint64_t next;  /* of header->count */
    size_t vectors; /* in it, or layers */
    bool sequences;
    float (*source)[4];
    char *destination, *results; /* pixels */
} Block;

static Result block_open(const VectorHeader *header, Block *out)
{
    size_t size = format_pixel_bytes(header->spec.format);
    *out = (Block){.header = header, .sequences = header->spec.set == VECTORS_SEQUENCES};
    out->source = memory_array(VECTOR_BLOCK, sizeof *out->source);
    out->destination = memory_array(VECTOR_BLOCK, size);
    out->results = memory_array(VECTOR_BLOCK, size);
    progress_begin("vectors", header->count);
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
    result = block_open(header, &block);
    if (result == RESULT_OK)
        result = write_all(writer, &block, arithmetic);
    block_close(&block);
    Result closed = vector_writer_close(writer, result == RESULT_OK);
    return result != RESULT_OK ? result : closed;
}

/* ---- checksums ------------------------------------------------------------------------------- */

enum {
    BATCH = 16 * VECTOR_BLOCK /* vectors that all arithmetics blend before the next ones are made */
};

/* Task 0 digests the operands, task i + 1 the results of arithmetic i. Each has a digest of its
 * own, which gets batch after batch in order, so that threads change nothing. */
typedef struct Checksums {
    const VectorHeader *header;
    const Arithmetic *const *arithmetics;
    size_t count; /* of arithmetics */
    VectorDigest **digests;
    bool sequences;
    /* The batch: */
    uint64_t next;  /* of header->count */
    size_t vectors; /* in it, or layers of its one sequence */
    float (*source)[4];
    char *destination, *results; /* pixels; results: VECTOR_BLOCK for each worker */
} Checksums;

static void digest_operands(const Checksums *sums)
{
    PixelFormat format = sums->header->spec.format;
    size_t size = format_pixel_bytes(format);
    for (size_t i = 0; i < sums->vectors; i++) {
        unsigned char bytes[16 + VECTOR_PIXEL_MAX];
        size_t used = vector_file_source(sums->source[i], bytes);
        if (!sums->sequences)
            used += vector_file_pixel(format, sums->destination + i * size, bytes + used);
        vector_digest_put(sums->digests[0], bytes, used);
    }
}

static void digest_pixels(VectorDigest *digest, PixelFormat format, const char *pixels,
                          size_t count)
{
    size_t size = format_pixel_bytes(format);
    for (size_t i = 0; i < count; i++) {
        unsigned char bytes[VECTOR_PIXEL_MAX];
        vector_digest_put(digest, bytes, vector_file_pixel(format, pixels + i * size, bytes));
    }
}

static void digest_results(const Checksums *sums, size_t arithmetic, char *pixels)
{
    const Arithmetic *by = sums->arithmetics[arithmetic];
    VectorDigest *digest = sums->digests[arithmetic + 1];
    PixelFormat format = sums->header->spec.format;
    size_t size = format_pixel_bytes(format);
    const float(*source)[4] = (const float(*)[4])sums->source;
    if (sums->sequences) {
        sequence_blend(by, format, (int)sums->vectors, source, pixels);
        digest_pixels(digest, format, pixels + (sums->vectors - 1) * size, 1);
        return;
    }
    for (size_t at = 0; at < sums->vectors; at += VECTOR_BLOCK) {
        size_t left = sums->vectors - at, count = left < VECTOR_BLOCK ? left : VECTOR_BLOCK;
        memcpy(pixels, sums->destination + at * size, count * size);
        arithmetic_blend(by, &sums->header->equation, format, count, source + at, pixels);
        digest_pixels(digest, format, pixels, count);
    }
}

static Result digest_task(void *context, uint32_t index, int worker)
{
    const Checksums *sums = context;
    size_t scratch = VECTOR_BLOCK * format_pixel_bytes(sums->header->spec.format);
    if (index == 0)
        digest_operands(sums);
    else
        digest_results(sums, index - 1, sums->results + (size_t)worker * scratch);
    return RESULT_OK;
}

/* False at the end. */
static bool next_batch(Checksums *sums)
{
    const VectorHeader *header = sums->header;
    uint64_t left = header->count - sums->next, first = header->first + sums->next;
    if (left == 0)
        return false;
    if (sums->sequences) {
        sums->vectors = (size_t)sequence_make(&header->spec, first, sums->source);
        sums->next++;
        return true;
    }
    sums->vectors = left < BATCH ? (size_t)left : BATCH;
    vectors_make(&header->spec, first, sums->vectors, sums->source, sums->destination);
    sums->next += sums->vectors;
    return true;
}

static Result checksums_open(Checksums *sums, const Pool *pool)
{
    size_t size = format_pixel_bytes(sums->header->spec.format);
    sums->digests = memory_array(sums->count + 1, sizeof *sums->digests);
    sums->source = memory_array(BATCH, sizeof *sums->source);
    sums->destination = memory_array(BATCH, size);
    sums->results = memory_array((size_t)pool_threads(pool) * VECTOR_BLOCK, size);
    if (!sums->digests || !sums->source || !sums->destination || !sums->results)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i <= sums->count; i++) {
        sums->digests[i] = vector_digest_create();
        if (!sums->digests[i])
            return RESULT_NO_MEMORY;
    }
    return RESULT_OK;
}

Result vector_results_checksums(const VectorHeader *header, size_t count,
                                const Arithmetic *const arithmetics[], int threads, char *operands,
                                char (*results)[VECTOR_DIGEST_TEXT])
{
    Checksums sums = {.header = header,
                      .arithmetics = arithmetics,
                      .count = count,
                      .sequences = header->spec.set == VECTORS_SEQUENCES};
    uint64_t batch = sums.sequences ? 1 : BATCH;
    Pool *pool = pool_create(threads);
    Result result = pool ? checksums_open(&sums, pool) : RESULT_NO_MEMORY;
    progress_begin("checksums", (header->count + batch - 1) / batch * (count + 1));
    while (result == RESULT_OK && next_batch(&sums))
        result = pool_run(pool, (uint32_t)count + 1, digest_task, &sums);
    progress_end();
    for (size_t i = 0; sums.digests && i <= count && sums.digests[i]; i++)
        vector_digest_finish(sums.digests[i], i > 0 ? results[i - 1] : operands);
    free(sums.digests);
    free(sums.source);
    free(sums.destination);
    free(sums.results);
    pool_destroy(pool);
    return result;
}
