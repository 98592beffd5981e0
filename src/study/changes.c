#include "study/changes.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

#define CHANGED 1e-4

Result changes_create(size_t pixels, Changes *out)
{
    *out = (Changes){.pixels = pixels, .bytes = (pixels + 7) / 8};
    out->bits = memory_array(MUTATION_COUNT, out->bytes);
    return out->bits ? RESULT_OK : RESULT_NO_MEMORY;
}

void changes_free(Changes *changes)
{
    free(changes->bits);
    *changes = (Changes){0};
}

static bool differs(const float a[4], const float b[4])
{
    for (int c = 0; c < 4; c++) {
        double difference = fabs((double)a[c] - (double)b[c]);
        if (!(difference <= CHANGED * fmax(1.0, fabs((double)a[c]))))
            return true;
    }
    return false;
}

void changes_mark(Changes *changes, MutationId id, const Image *reference, const Image *final)
{
    uint8_t *bits = changes->bits + (size_t)id * changes->bytes;
    const float *a = reference->pixels, *b = final->pixels;
    for (size_t i = 0; i < changes->pixels; i++, a += 4, b += 4)
        if (differs(a, b))
            bits[i / 8] = (uint8_t)(bits[i / 8] | 1u << i % 8);
}

double changes_likeness(const Changes *changes, MutationId id, const uint8_t *left)
{
    const uint8_t *bits = changes->bits + (size_t)id * changes->bytes;
    size_t both = 0, either = 0;
    for (size_t i = 0; i < changes->pixels; i++) {
        bool changed = bits[i / 8] >> i % 8 & 1;
        both += changed && left[i];
        either += changed || left[i];
    }
    return either ? (double)both / (double)either : 0.0;
}
