/* Arithmetics that have no name: every combination of the fields of ARITHMETIC_STEPS that is
 * defined for a format, and every mistake on top of every right named arithmetic. */
#ifndef PEEL_STUDY_BLEND_FIT_H
#define PEEL_STUDY_BLEND_FIT_H

#include "base/result.h"
#include "blend/arithmetic.h"

/* The catalogue's row of an arithmetic; NULL where it has no name. */
const ArithmeticInfo *blend_fit_name(const Arithmetic *arithmetic);

/* The combinations, those with the fewest fields away from the default first; named ones are left
 * out. The caller frees *out. */
Result blend_fit_list(const BlendEquation *equation, PixelFormat format, Arithmetic **out,
                      size_t *count);

#endif
