/* Between peel.h and what is behind it. Enumerations with one meaning have one numbering
 * (convert.c asserts it), but for formats and results. */
#ifndef PEEL_LIBRARY_CONVERT_H
#define PEEL_LIBRARY_CONVERT_H

#include "base/result.h"
#include "number/format.h"
#include "peel.h"

PeelResult convert_result(Result result);

/* FORMAT_NONE where peel.h has no such format. */
PixelFormat convert_format(PeelFormat format);
PeelFormat convert_from_format(PixelFormat format);

/* One of the formats that are blended; BAD_INPUT with a message otherwise. */
PeelResult convert_color_format(const char *function, PeelFormat format, PixelFormat *out);

/* Records the message "FUNCTION: ARGUMENT is NULL" and returns PEEL_BAD_INPUT. */
PeelResult convert_missing(const char *function, const char *argument);
#if defined __clang_analyzer__ || defined PEEL_ANALYZER /* see result_fail */
#define convert_missing(...)                                                                       \
    __extension__({                                                                                \
        (void)convert_missing(__VA_ARGS__);                                                        \
        PEEL_BAD_INPUT;                                                                            \
    })
#endif

#endif
