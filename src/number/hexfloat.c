#include "number/hexfloat.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

static uint32_t bits_of(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static char *print_exponent(int exponent, char *at)
{
    *at++ = 'p';
    *at++ = exponent < 0 ? '-' : '+';
    int size = exponent < 0 ? -exponent : exponent;
    if (size >= 100)
        *at++ = (char)('0' + size / 100);
    if (size >= 10)
        *at++ = (char)('0' + size / 10 % 10);
    *at++ = (char)('0' + size % 10);
    *at = 0;
    return at;
}

char *hexfloat_print(float x, char out[HEXFLOAT_TEXT])
{
    uint32_t bits = bits_of(x), mantissa = bits & 0x7fffffu;
    int exponent = (int)(bits >> 23 & 255u) - 127;
    char *at = out;
    if (exponent == 128 && mantissa)
        return strcpy(out, "nan") + 3;
    if (bits >> 31)
        *at++ = '-';
    if (exponent == 128)
        return strcpy(at, "inf") + 3;
    if (!(bits << 1))
        return strcpy(at, "0x0p+0") + 6;
    if (exponent == -127) { /* as a double, which is normal */
        int shift = __builtin_clz(mantissa) - 8;
        mantissa = mantissa << shift & 0x7fffffu;
        exponent = -126 - shift;
    }
    memcpy(at, "0x1", 3);
    at += 3;
    if (mantissa)
        *at++ = '.';
    for (uint32_t digits = mantissa << 9; digits; digits <<= 4)
        *at++ = "0123456789abcdef"[digits >> 28];
    return print_exponent(exponent, at);
}

static int digit_of(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

/* Digits without leading zeros: at most 15 of them count, more must be zeros. */
typedef struct Digits {
    uint64_t value;
    int64_t exponent; /* of the last digit that counts, as a power of two */
    bool any, exact;
} Digits;

static const char *parse_digits(const char *at, Digits *out)
{
    bool point = false;
    *out = (Digits){.exact = true};
    for (;; at++) {
        int digit = digit_of(*at);
        if (*at == '.' && !point) {
            point = true;
            continue;
        }
        if (digit < 0)
            return at;
        out->any = true;
        if (out->value >> 56) {
            out->exact = out->exact && digit == 0;
            out->exponent += point ? 0 : 4;
        } else {
            out->value = out->value << 4 | (uint64_t)digit;
            out->exponent -= point ? 4 : 0;
        }
    }
}

/* Far exponents are all alike: what they make of any digits is no float. */
static const char *parse_exponent(const char *at, int64_t *out)
{
    bool negative = *at == '-';
    int64_t value = 0;
    if (*at == '+' || *at == '-')
        at++;
    if (!isdigit((unsigned char)*at))
        return NULL;
    for (; isdigit((unsigned char)*at); at++)
        value = value < 1000000 ? 10 * value + (*at - '0') : value;
    *out += negative ? -value : value;
    return at;
}

static bool parse_word(const char *text, float *out)
{
    if (strcasecmp(text, "inf") == 0 || strcasecmp(text, "infinity") == 0) {
        *out = INFINITY;
        return true;
    }
    if (strncasecmp(text, "nan", 3) != 0)
        return false;
    text += 3;
    size_t length = strlen(text);
    *out = NAN;
    return length == 0 || (text[0] == '(' && text[length - 1] == ')');
}

bool hexfloat_parse(const char *text, float *out)
{
    bool negative = *text == '-';
    if (*text == '+' || *text == '-')
        text++;
    if (text[0] != '0' || (text[1] != 'x' && text[1] != 'X')) {
        bool found = parse_word(text, out);
        *out = found && negative && *out == *out ? -*out : *out;
        return found;
    }
    Digits digits;
    text = parse_digits(text + 2, &digits);
    if (digits.any && (*text == 'p' || *text == 'P'))
        text = parse_exponent(text + 1, &digits.exponent);
    if (!digits.any || !text || *text || !digits.exact)
        return false;
    int zeros = digits.value ? __builtin_ctzll(digits.value) : 0;
    digits.value >>= zeros;
    digits.exponent += zeros;
    if (digits.value >> 24 || (digits.value && (digits.exponent < -149 || digits.exponent > 127)))
        return false;
    double value = ldexp((double)digits.value, digits.value ? (int)digits.exponent : 0);
    *out = (float)(negative ? -value : value);
    return value <= 0x1.fffffep127;
}
