#include "base/base64.h"

#include <stdint.h>

enum {
    PADDING = 64 /* where the digits have '=' */
};

void base64_put(const unsigned char *bytes, size_t count, char *out)
{
    static const char digits[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=";
    for (size_t i = 0; i < count; i += 3) {
        uint32_t group = (uint32_t)bytes[i] << 16;
        group |= i + 1 < count ? (uint32_t)bytes[i + 1] << 8 : 0;
        group |= i + 2 < count ? bytes[i + 2] : 0;
        *out++ = digits[group >> 18];
        *out++ = digits[group >> 12 & 63];
        *out++ = digits[i + 1 < count ? group >> 6 & 63 : PADDING];
        *out++ = digits[i + 2 < count ? group & 63 : PADDING];
    }
}
