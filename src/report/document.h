/* Building a JSON document and writing it: failures are kept until it is written. */
#ifndef PEEL_REPORT_DOCUMENT_H
#define PEEL_REPORT_DOCUMENT_H

#include "base/result.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct Document {
    bool failed; /* a jansson call failed: memory is exhausted */
} Document;

/* Both take over value; NULL counts as a failure. */
void document_put(Document *json, json_t *object, const char *key, json_t *value);
void document_append(Document *json, json_t *array, json_t *value);

/* Values; NULL when memory is exhausted, or had been for text. What is not a finite number is null.
 * JSON is UTF-8; a path need not be: where it is not, its bytes beyond ASCII become '?'. */
json_t *document_real(double value);
json_t *document_count(uint64_t value);
json_t *document_string(const char *text);
json_t *document_hex(double value); /* "0x1.8p-1", "inf", "nan" */

/* Takes over root. Written to a temporary name and renamed; NO_MEMORY after a failure. */
Result document_write(const Document *json, json_t *root, const char *path);

#endif
