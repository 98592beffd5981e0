/* One blended value in words: its operands, what each arithmetic makes of it, its steps. Private to
 * src/report. */
#ifndef PEEL_REPORT_BLEND_EXAMPLE_H
#define PEEL_REPORT_BLEND_EXAMPLE_H

#include "report/document.h"
#include "study/blend_check.h"

#include <stdio.h>

enum {
    BLEND_TEXT = 64
};

/* Stored bits: a code, or a number in both forms. */
const char *blend_text_bits(PixelFormat format, uint32_t bits, char out[BLEND_TEXT]);
/* A source: of unorm formats as a code where it is one. */
const char *blend_text_source(PixelFormat format, float x, char out[BLEND_TEXT]);
/* "1 code", "3 ULP", "NaN". */
const char *blend_text_ulp(PixelFormat format, uint32_t ulp, char out[BLEND_TEXT]);
const char *blend_channel_name(int channel); /* "red"; static */

/* "source 128, alpha 255, before 1": the operands that the channel has; whole: and both alphas.
 * Floats in decimal alone, which reads back as the same number. */
void blend_print_operands(const BlendEquation *equation, PixelFormat format,
                          const BlendExample *example, bool whole, FILE *out);

/* Where the vector is from, its operands and bits, and how the named arithmetic comes to what it
 * expects, step by step. */
void blend_print_example(const BlendReport *report, const char *name, const Arithmetic *arithmetic,
                         const BlendExample *example, FILE *out);

/* A vector's place in its set, and its operands: hexadecimal floats as strings, codes as integers.
 */
json_t *blend_json_operands(Document *json, PixelFormat format, VectorSet set, uint64_t index,
                            int channel, const float from[4], const void *pixel);
json_t *blend_json_bits(PixelFormat format, uint32_t bits); /* stored bits, likewise */
/* The operands, what is expected and found, and the steps of an arithmetic that is not NULL. */
json_t *blend_json_example(Document *json, const BlendEquation *equation, PixelFormat format,
                           const Arithmetic *arithmetic, const BlendExample *example);

#endif
