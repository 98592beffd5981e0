/* A growing string. The first failure sticks; later calls do nothing, so that callers check once.
 */
#ifndef PEEL_BASE_TEXT_H
#define PEEL_BASE_TEXT_H

#include "base/result.h"

#include <stddef.h>

typedef struct Text {
    char *bytes; /* with a 0 behind its end; NULL while it is empty */
    size_t count, room;
    Result result;
} Text;

void text_print(Text *text, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Puts '?' for every byte that is not UTF-8. */
void text_make_utf8(char *string);

/* Leaves one line, and nothing that a terminal takes for a command: blanks for what breaks lines,
 * '?' for other control characters. */
void text_make_line(char *string);

/* A JSON string with its quotes. Bytes beyond ASCII that are not UTF-8 become '?'. */
void text_json_string(Text *text, const char *string);

void text_free(Text *text); /* leaves an empty one */

#endif
