/* Files of test vectors: what is blended, and what somebody's arithmetic made of it.
 *
 * Three forms hold the same: CSV with hexadecimal floats, JSON lines, and raw binary (layouts:
 * README, "Blend arithmetic"). Each begins with its version and specification and ends with its
 * count and a checksum of the operands, so that files of another version, or with operands that
 * were changed or lost, are found out. Files are read and written in one pass and constant memory.
 *
 * Results are stored pixels of the header's format. Files of VECTORS_SEQUENCES hold sequences
 * (blend/sequence.h) and have their own functions to put and to take. */
#ifndef PEEL_BLEND_VECTOR_FILE_H
#define PEEL_BLEND_VECTOR_FILE_H

#include "base/result.h"
#include "blend/equation.h"
#include "blend/vectors.h"

typedef enum VectorForm {
    VECTOR_CSV = 0,
    VECTOR_JSON_LINES,
    VECTOR_BINARY,
    VECTOR_FORM_COUNT
} VectorForm;

enum {
    VECTOR_BLOCK = 4096,  /* vectors that readers and writers take at a time */
    VECTOR_PIXEL_MAX = 16 /* bytes of a pixel of any format */
};

typedef struct VectorHeader {
    VectorSpec spec;
    BlendEquation equation; /* of sequences: under */
    uint64_t first, count;  /* which vectors of the set the file has */
    char arithmetic[64];    /* a note of what made the results; "" where none is given */
} VectorHeader;

const char *vector_form_name(VectorForm form); /* "csv", "jsonl", "binary"; static */

/* ---- writing ---------------------------------------------------------------------------------
 */

typedef struct VectorWriter VectorWriter;

/* Starts a file ("-": standard output) that appears whole or not at all. header is copied. */
Result vector_writer_open(const char *path, VectorForm form, const VectorHeader *header,
                          VectorWriter **out);

/* The next vectors, in their order; destination and results: count pixels. */
Result vector_writer_put(VectorWriter *writer, const float (*source)[4], const void *destination,
                         const void *results, size_t count);

/* The next sequence; results: the pixel after each of its layers. */
Result vector_writer_put_sequence(VectorWriter *writer, int layers, const float (*source)[4],
                                  const void *results);

/* Ends the file if commit is true and nothing failed, else removes it. Frees the writer. The
 * failure that decided is the result. */
Result vector_writer_close(VectorWriter *writer, bool commit);

/* ---- reading ---------------------------------------------------------------------------------
 */

typedef struct VectorReader VectorReader;

/* Opens a file ("-": standard input) and reads its head; the form is found by its first bytes.
 * BAD_INPUT with path, line (or byte) and what was expected. The caller closes the reader. */
Result vector_reader_open(const char *path, VectorHeader *header, VectorReader **out);

/* The next vectors, at most VECTOR_BLOCK of them, whose operands were found to be the set's;
 * results are pixels of the format. *count is 0 at the end, where the file's end was checked too.
 * Not of sequences. */
Result vector_reader_next(VectorReader *reader, float (*source)[4], void *destination,
                          void *results, size_t *count);

/* The next sequence. source, results: room for SEQUENCE_LAYERS_MAX; results are the pixels after
 * each layer, of which given[k] tells whether the file has it; it always has the last. *layers is
 * 0 at the end, where the file's end was checked too. */
Result vector_reader_next_sequence(VectorReader *reader, int *layers, float (*source)[4],
                                   void *results, bool *given);

void vector_reader_close(VectorReader *reader); /* NULL is fine */

/* ---- checksums -------------------------------------------------------------------------------
 */

enum {
    VECTOR_DIGEST_TEXT = 65 /* 64 digits and a 0 */
};

/* SHA-256 of what it is given, as lower-case hexadecimal. */
typedef struct VectorDigest VectorDigest;
VectorDigest *vector_digest_create(void); /* NULL and a message when memory is exhausted */
void vector_digest_put(VectorDigest *digest, const void *bytes, size_t size);
/* Frees the digest. */
void vector_digest_finish(VectorDigest *digest, char out[VECTOR_DIGEST_TEXT]);

#endif
