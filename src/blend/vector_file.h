/* Files of test vectors: what is blended, and what somebody's arithmetic made of it.
 *
 * Three forms hold the same: CSV with hexadecimal floats, JSON lines, and raw binary (layout in
 * vector_file.c). Each begins with its version and specification and ends with its count and a
 * checksum of the operands, so that files of another version, or with operands that were changed or
 * lost, are found out. */
#ifndef PEEL_BLEND_VECTOR_FILE_H
#define PEEL_BLEND_VECTOR_FILE_H

#include "base/result.h"
#include "blend/equation.h"
#include "blend/vectors.h"

typedef enum VectorForm {
    VECTOR_CSV = 0,
    VECTOR_JSON_LINES,
    VECTOR_BINARY
} VectorForm;

enum {
    VECTOR_BLOCK = 4096 /* vectors that readers and writers take at a time */
};

typedef struct VectorHeader {
    VectorSpec spec;
    BlendEquation equation;
    uint64_t first, count; /* which vectors of the set the file has */
    char arithmetic[64];   /* that made the results; "" where somebody else's did */
} VectorHeader;

typedef struct VectorReader VectorReader;

/* Opens a file ("-": standard input) and reads its head; the form is found by its first bytes.
 * BAD_INPUT with path, line (or byte) and what was expected. The caller closes the reader. */
Result vector_reader_open(const char *path, VectorHeader *header, VectorReader **out);

/* The next vectors, at most VECTOR_BLOCK of them, whose operands were found to be the set's;
 * results are pixels of the format. *count is 0 at the end, where the file's end was checked too.
 */
Result vector_reader_next(VectorReader *reader, float (*source)[4], void *destination,
                          void *results, size_t *count);

void vector_reader_close(VectorReader *reader); /* NULL is fine */

#endif
