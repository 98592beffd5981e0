/* Floats as hexadecimal text, exactly and fast: files of many millions of them. */
#ifndef PEEL_NUMBER_HEXFLOAT_H
#define PEEL_NUMBER_HEXFLOAT_H

#include <stdbool.h>

enum {
    HEXFLOAT_TEXT = 20 /* room for any float and its final 0 */
};

/* What "%a" of the C library prints of (double)x: "0x1.8p-1", "-0x0p+0", "inf"; NaN is "nan"
 * whatever its bits. Returns the place of the final 0. */
char *hexfloat_print(float x, char out[HEXFLOAT_TEXT]);

/* The whole of text as a float: [+-] and hexadecimal digits with at most one point, after "0x",
 * with or without exponent "p[+-]N"; or "inf", "infinity", "nan", "nan(...)", in any case. False
 * where it is neither, or is no float exactly. */
bool hexfloat_parse(const char *text, float *out);

#endif
