/* Bytes as text. Source: RFC 4648, section 4. */
#ifndef PEEL_BASE_BASE64_H
#define PEEL_BASE_BASE64_H

#include <stddef.h>

/* Characters that count bytes take, padding included. */
static inline size_t base64_length(size_t count)
{
    return (count + 2) / 3 * 4;
}

/* out: room for base64_length(count) characters; no 0 is put behind them. */
void base64_put(const unsigned char *bytes, size_t count, char *out);

#endif
