/* What a diagnosis shows: their image, the renderings that it is about, the pixel that tells two of
 * them apart, and a class for every pixel. */
#ifndef PEEL_STUDY_EVIDENCE_H
#define PEEL_STUDY_EVIDENCE_H

#include "study/diagnose.h"
#include "study/fit.h"

/* Fills theirs, reference, best, classes, class_counts and pixel of *out, whose form and pixels are
 * known. The pixel is where best and second differ most in
 * how far they are from theirs, best nearer. NO_MEMORY leaves what diagnose_free frees. */
Result evidence_gather(Fit *fit, const FitRendering *reference, const FitRendering *best,
                       const FitRendering *second, Diagnosis *out);

#endif
