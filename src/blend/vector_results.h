/* Whole sets of vectors with the results of an arithmetic: as a file, or as checksums. */
#ifndef PEEL_BLEND_VECTOR_RESULTS_H
#define PEEL_BLEND_VECTOR_RESULTS_H

#include "blend/arithmetic.h"
#include "blend/vector_file.h"

/* Writes the vectors that header names, in blocks and constant memory. The arithmetic must not be
 * refused for the equation and format. path "-": standard output. With progress. */
Result vector_results_write(const char *path, VectorForm form, const VectorHeader *header,
                            const Arithmetic *arithmetic);

/* SHA-256 of the operands (of each vector the source's four floats, then the destination's pixel;
 * of sequences the sources), and of the results of each of `count` arithmetics: raw pixels in the
 * vectors' order, of sequences the last one of each. All little-endian.
 * threads: as for pool_create; they change nothing but the time. operands: VECTOR_DIGEST_TEXT
 * bytes; results: count of them. With progress. */
Result vector_results_checksums(const VectorHeader *header, size_t count,
                                const Arithmetic *const arithmetics[], int threads, char *operands,
                                char (*results)[VECTOR_DIGEST_TEXT]);

#endif
