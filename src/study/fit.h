/* How well a rendering predicts somebody's image, in the values that their file stores.
 *
 * A rendering is linear; their image may be display-encoded, bottom-up, its alpha the coverage or
 * the transmittance. The rendering is brought into each such form, and the one in which it fits
 * counts: their pixels are never changed, so that all forms and all renderings are measured alike.
 *
 * Two limits for every value. Quantisation: what storing may change, half a code of integers, a
 * step of half floats, a few roundings of floats. Tolerance: what another right renderer may change
 * besides, a code, or FIT_TOLERANCE. */
#ifndef PEEL_STUDY_FIT_H
#define PEEL_STUDY_FIT_H

#include "base/pool.h"
#include "compare/given.h"

#include <stdbool.h>
#include <stdint.h>

#define FIT_TOLERANCE 1e-4 /* of floats, relative to max(1, value) */
/* A right image may have one pixel of so many beyond the tolerance, in highlights and at depths
 * that single precision only just resolves, and one of so many far beyond it, on edges that another
 * rasterizer rounds to the other side. */
#define FIT_FEW     100
#define FIT_FEW_FAR 1000
#define FIT_FAR     1e-2 /* of values from 0 to 1; of greater ones, of them */

enum {
    FIT_FORMS = 12 /* encodings, orders of rows, meanings of alpha */
};

typedef struct Fit {
    const GivenImage *given;
    Pool *pool;
    GivenMeaning forms[FIT_FORMS]; /* to choose from, the usual one first */
    int form_count;
    Image theirs;          /* FORMAT_RGBA32F: the stored values as numbers, rows as in the file */
    Image encoded;         /* scratch: FORMAT_RGBA32F, a rendering in one encoding */
    uint8_t *encoded_rows; /* a GivenEncoding for each of its rows, DETECT before */
    float *residuals;      /* scratch: one per pixel */
    bool tolerant;         /* what is within the tolerance counts as 0 */
    double cap;            /* a pixel's residual counts up to this */
} Fit;

/* A rendering. encoded_twice: of MUTATION_SRGB_ENCODED_TWICE, which a linear image shows, and an
 * encoded one shows in another way: its colours are encoded once more than their form says. */
typedef struct FitRendering {
    const Image *final; /* of their size */
    bool encoded_twice;
} FitRendering;

/* One rendering against their image. */
typedef struct FitResult {
    GivenMeaning form; /* in which it fits best; not the usual one unless that is twice as bad */
    double squares;    /* over pixels, of residuals up to the cap */
    uint64_t beyond;   /* pixels with a value beyond quantisation */
    uint64_t over;     /* with one beyond the tolerance */
    uint64_t far;      /* with one far beyond it */
    uint64_t over_rgb, far_rgb; /* with such a colour, whatever alpha is */
    uint64_t broken; /* with one that is not finite, and should be: no rounding makes it */
} FitResult;

/* options: what is known of their image's meaning; the rest is fitted. given and pool must outlive
 * the fit. On failure there is nothing to free. */
Result fit_create(const GivenImage *given, const GivenMeaning *options, Pool *pool, Fit *out);
void fit_free(Fit *fit);

/* Measures the unmutated reference and decides what counts from now
 * on: residuals beyond the tolerance where the image is not right, else those beyond quantisation;
 * up to a cap of four times their median. */
Result fit_reference(Fit *fit, const FitRendering *rendering, FitResult *out);

/* Whether a right image may be as far from the reference; colors: but for its alpha. */
bool fit_tolerates(const Fit *fit, const FitResult *result, bool colors);

/* Measures another rendering. */
Result fit_measure(Fit *fit, const FitRendering *rendering, FitResult *out);

/* What their file would hold, but for the order of rows, which is from top to bottom, and before
 * integers are rounded: *out FORMAT_RGBA32F, the caller frees. */
Result fit_predict(Fit *fit, const FitRendering *rendering, const GivenMeaning *form, Image *out);

/* Their stored values at x, y from the top left. */
const float *fit_theirs(const Fit *fit, const GivenMeaning *form, int x, int y);

/* The residual of one pixel of a prediction, without a cap: as fit_measure counts. */
double fit_residual(const Fit *fit, const GivenMeaning *form, const Image *predicted, int x, int y);

/* 3, or 4 where alpha means something. */
int fit_channels(const GivenMeaning *form);

/* Whether two predictions in one form would be the same file, quantisation apart. */
bool fit_same(const Fit *fit, const GivenMeaning *form, const Image *a, const Image *b);

#endif
