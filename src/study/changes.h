/* Which pixels each mistake changes alone: so that, of all mistakes, those can be found that change
 * the pixels which another one leaves unexplained. */
#ifndef PEEL_STUDY_CHANGES_H
#define PEEL_STUDY_CHANGES_H

#include "frame/mutation.h"
#include "image/image.h"

typedef struct Changes {
    size_t pixels, bytes; /* bytes: of one mistake's pixels, a bit each */
    uint8_t *bits;        /* MUTATION_COUNT of them */
} Changes;

/* The caller frees with changes_free. NO_MEMORY. */
Result changes_create(size_t pixels, Changes *out);
void changes_free(Changes *changes);

/* Notes where the two final images differ by more than 1e-4 of max(1, value). */
void changes_mark(Changes *changes, MutationId id, const Image *reference, const Image *final);

/* How alike the pixels of a mistake and of `left` are, a byte for each, 0 or not: those in both,
 * over those in either. 0 when there are none. */
double changes_likeness(const Changes *changes, MutationId id, const uint8_t *left);

#endif
