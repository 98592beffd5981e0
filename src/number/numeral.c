#include "number/numeral.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ---- writing ---- */

static const char *shortest(double value, bool single, char out[NUMERAL_MAX])
{
    if (isnan(value))
        return strcpy(out, "nan");
    double size = fabs(value);
    int digits = size >= 1.0 && size < 1e9 ? 1 + (int)log10(size) : 1;
    for (;; digits++) {
        snprintf(out, NUMERAL_MAX, "%.*g", digits, value);
        double back = strtod(out, NULL);
        if (digits >= 17 || back == value || (single && (float)back == (float)value))
            return out;
    }
}

const char *numeral_float(double value, char out[NUMERAL_MAX])
{
    return shortest(value, true, out);
}

const char *numeral_double(double value, char out[NUMERAL_MAX])
{
    return shortest(value, false, out);
}

const char *numeral_hex(double value, char out[NUMERAL_MAX])
{
    snprintf(out, NUMERAL_MAX, "%a", isnan(value) ? (double)NAN : value);
    return out;
}

const char *numeral_both(double value, char out[NUMERAL_BOTH])
{
    char decimal[NUMERAL_MAX], hex[NUMERAL_MAX];
    snprintf(out, NUMERAL_BOTH, "%s (%s)", numeral_float(value, decimal), numeral_hex(value, hex));
    return out;
}

enum {
    SMALL_POWER = 10 /* 1/1024 is as clear as 1/2^10 */
};

static char *whole_power(mpz_srcptr number, mp_bitcnt_t power)
{
    char *text = NULL;
    mpz_t odd;
    mpz_init(odd);
    mpz_tdiv_q_2exp(odd, number, power);
    if (mpz_cmpabs_ui(odd, 1) == 0)
        gmp_asprintf(&text, "%s2^%lu", mpz_sgn(odd) < 0 ? "-" : "", power);
    else
        gmp_asprintf(&text, "%Zd*2^%lu", odd, power);
    mpz_clear(odd);
    return text;
}

char *numeral_fraction(const Rational *a)
{
    char *text = NULL;
    if (a->kind != RATIONAL_FINITE) {
        gmp_asprintf(&text, "%s", a->kind == RATIONAL_NAN ? "nan" : (a->negative ? "-inf" : "inf"));
        return text;
    }
    mpz_srcptr numerator = mpq_numref(a->value), denominator = mpq_denref(a->value);
    bool zero = mpz_sgn(numerator) == 0, whole = mpz_cmp_ui(denominator, 1) == 0;
    mp_bitcnt_t below = mpz_scan1(denominator, 0), above = zero ? 0 : mpz_scan1(numerator, 0);
    bool power = mpz_sizeinbase(denominator, 2) == below + 1;
    if (whole && above > SMALL_POWER)
        text = whole_power(numerator, above);
    else if (whole)
        gmp_asprintf(&text, "%s%Zd", zero && a->negative ? "-" : "", numerator);
    else if (power && below > SMALL_POWER)
        gmp_asprintf(&text, "%Zd/2^%lu", numerator, below);
    else
        gmp_asprintf(&text, "%Zd/%Zd", numerator, denominator);
    return text;
}

/* ---- reading ---- */

enum {
    MOST_CHARACTERS = 1000,
    MOST_EXPONENT = 9999
};

/* What is left to read; ends with a 0. */
typedef struct Reader {
    const char *at;
    const char *problem; /* the first; NULL while there is none */
} Reader;

static bool fail(Reader *reader, const char *problem)
{
    if (!reader->problem)
        reader->problem = problem;
    return false;
}

static bool take(Reader *reader, char c)
{
    if (*reader->at != c)
        return false;
    reader->at++;
    return true;
}

/* Digits of the base to out, with what is there before; returns how many there were. */
static int take_digits(Reader *reader, int base, mpz_t out)
{
    int count = 0;
    for (; base == 16 ? isxdigit((unsigned char)*reader->at) : isdigit((unsigned char)*reader->at);
         count++) {
        int c = tolower((unsigned char)*reader->at++);
        mpz_mul_ui(out, out, (unsigned long)base);
        mpz_add_ui(out, out, (unsigned long)(isdigit(c) ? c - '0' : c - 'a' + 10));
    }
    return count;
}

/* [+-]digits, at most MOST_EXPONENT. */
static bool take_exponent(Reader *reader, long *out)
{
    bool negative = take(reader, '-');
    long value = 0;
    if (!negative)
        take(reader, '+');
    if (!isdigit((unsigned char)*reader->at))
        return fail(reader, "an exponent without digits");
    while (isdigit((unsigned char)*reader->at)) {
        value = 10 * value + (*reader->at++ - '0');
        if (value > MOST_EXPONENT)
            return fail(reader, "an exponent beyond 9999");
    }
    *out = negative ? -value : value;
    return true;
}

/* value · base^power */
static void scale(mpq_t value, unsigned long base, long power)
{
    mpq_t factor;
    mpq_init(factor);
    mpz_ui_pow_ui(mpq_numref(factor), base, (unsigned long)labs(power));
    (power < 0 ? mpq_div : mpq_mul)(value, value, factor);
    mpq_clear(factor);
}

/* Decimal or hexadecimal, without sign. */
static bool take_real(Reader *reader, mpq_t out)
{
    bool hex = reader->at[0] == '0' && tolower((unsigned char)reader->at[1]) == 'x';
    int base = hex ? 16 : 10;
    long power = 0;
    reader->at += hex ? 2 : 0;
    mpq_set_ui(out, 0, 1);
    int whole = take_digits(reader, base, mpq_numref(out));
    int behind = take(reader, '.') ? take_digits(reader, base, mpq_numref(out)) : 0;
    if (whole + behind == 0)
        return fail(reader, hex ? "'0x' without digits" : "no number");
    scale(out, (unsigned long)base, -behind);
    if (tolower((unsigned char)*reader->at) == (hex ? 'p' : 'e')) {
        reader->at++;
        if (!take_exponent(reader, &power))
            return false;
        scale(out, hex ? 2 : 10, power);
    }
    return true;
}

/* A real, or 2^N. */
static bool take_term(Reader *reader, mpq_t out)
{
    long power = 0;
    if (!take_real(reader, out))
        return false;
    if (!take(reader, '^'))
        return true;
    if (mpq_cmp_ui(out, 2, 1) != 0)
        return fail(reader, "a power of another number than 2");
    if (!take_exponent(reader, &power))
        return false;
    scale(out, 2, power - 1);
    return true;
}

/* term, term*term or term/term */
static bool take_number(Reader *reader, mpq_t out)
{
    if (!take_term(reader, out))
        return false;
    char operation = *reader->at;
    if (operation != '*' && operation != '/')
        return true;
    reader->at++;
    mpq_t right;
    mpq_init(right);
    bool taken = take_term(reader, right);
    if (taken && operation == '/' && mpq_sgn(right) == 0)
        taken = fail(reader, "a division by 0");
    if (taken)
        (operation == '/' ? mpq_div : mpq_mul)(out, out, right);
    mpq_clear(right);
    return taken;
}

/* text: without blanks around it. */
static bool read_all(Reader *reader, Rational *out)
{
    bool negative = take(reader, '-');
    if (!negative)
        take(reader, '+');
    if (strcasecmp(reader->at, "inf") == 0 || strcasecmp(reader->at, "infinity") == 0) {
        rational_set(negative ? -INFINITY : INFINITY, out);
        return true;
    }
    if (strcasecmp(reader->at, "nan") == 0) {
        rational_set(NAN, out);
        return true;
    }
    rational_set(0.0, out);
    if (!take_number(reader, out->value))
        return false;
    if (*reader->at)
        return fail(reader, "something behind the number");
    if (negative)
        mpq_neg(out->value, out->value);
    out->negative = negative && mpq_sgn(out->value) == 0;
    return true;
}

Result numeral_read(const char *text, size_t length, Rational *out)
{
    char copy[MOST_CHARACTERS + 1];
    while (length && isspace((unsigned char)*text)) {
        text++;
        length--;
    }
    while (length && isspace((unsigned char)text[length - 1]))
        length--;
    Reader reader = {copy, length > MOST_CHARACTERS  ? "a number of more than 1000 characters"
                           : memchr(text, 0, length) ? "a 0 byte"
                                                     : NULL};
    if (!reader.problem) {
        memcpy(copy, text, length);
        copy[length] = '\0';
        read_all(&reader, out);
    }
    if (!reader.problem)
        return RESULT_OK;
    return result_fail(RESULT_BAD_INPUT,
                       "'%.*s': %s; expected a number like 0.5, 0x1p-1, 1/3, nan or inf",
                       (int)(length < 40 ? length : 40), text, reader.problem);
}
