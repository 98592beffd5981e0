/* Stored number formats: conversions as llvmpipe makes them, and distances between stored values.
 *
 * Facts: measured, see ref/pipeline/NUMBERS.md; pinned by tests/unit/test_format.c and
 * tests/cross/test_arithmetic.c. Callers are in flushing mode (op_enter). */
#ifndef PEEL_NUMBER_FORMAT_H
#define PEEL_NUMBER_FORMAT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum PixelFormat {
    FORMAT_RGBA32F = 0,
    FORMAT_RGBA16F,
    FORMAT_RGBA16, /* unorm */
    FORMAT_RGBA8,  /* unorm */
    FORMAT_RG16,   /* unorm */
    FORMAT_RG32F,
    FORMAT_D32F,  /* window depth as a float */
    FORMAT_D24,   /* window depth as a 24-bit unorm in a uint32_t */
    FORMAT_D16,   /* as a 16-bit unorm, in a uint32_t too */
    FORMAT_R32UI, /* an index; UINT32_MAX is none */
    FORMAT_R32F,
    FORMAT_COUNT,
    FORMAT_NONE = FORMAT_COUNT /* of a buffer that is not stored: no bytes */
} PixelFormat;

typedef enum FormatKind {
    KIND_FLOAT,
    KIND_HALF,
    KIND_UNORM,
    KIND_UINT
} FormatKind;

typedef struct FormatInfo {
    const char *name; /* "rgba32f", as the command line and JSON spell it */
    FormatKind kind;
    int channels;
    int channel_bytes;
    uint32_t unorm_max; /* the integer that means 1; 0 unless KIND_UNORM */
} FormatInfo;

const FormatInfo *format_info(PixelFormat format); /* static */
size_t format_pixel_bytes(PixelFormat format);

/* The format of that name; false where there is none, and *out is left. */
bool format_find(const char *name, PixelFormat *out);

/* Channel `channel` of the pixel at `pixel`: its stored bits, in the low end of the result. */
uint32_t format_bits(PixelFormat format, const void *pixel, int channel);
void format_set_bits(PixelFormat format, void *pixel, int channel, uint32_t bits);

/* Channel `channel` of the pixel at `pixel`, as a number: floats as they are, halves exactly,
 * unorm as integer / unorm_max in double, rounded to float. */
float format_channel(PixelFormat format, const void *pixel, int channel);

/* Four channels to and from a stored colour format, as a render target and a texel fetch do: those
 * that are not stored are fetched as 0, alpha as 1. Flushing mode. */
void format_store(PixelFormat format, const float value[4], void *pixel);
void format_fetch(PixelFormat format, const void *pixel, float value[4]);

/* RGBA8: round to nearest even of clamp(x)·255; NaN gives 0. */
uint8_t unorm8_from_float(float x);
/* A texel fetch: (float)i · (float)(1/255), not a division. */
float unorm8_to_float(uint8_t i);

uint16_t unorm16_from_float(float x);
/* A cleared RGBA16 or RG16: ties of the product are rounded up, not to even. */
uint16_t unorm16_from_clear(float x);
float unorm16_to_float(uint16_t i);

/* Half: truncated toward zero, finite overflow to 65504 (0x7bff), infinity kept, denormals made;
 * the driver does not round to nearest. */
uint16_t half_from_float(float x);
float half_to_float(uint16_t half); /* exact */

/* gl_FragCoord.z to the stored depth: clamped to [0, 1], NaN to 1. */
float depth32f_from_float(float z);
uint32_t depth24_from_float(float z);
float depth24_to_float(uint32_t depth); /* a texel fetch: (float)u · (float)(1/(2^24 − 1)) */

/* 16 bits: the low mantissa bits of z·65535/65536 + 128, which rounds to nearest even. */
uint32_t depth16_from_float(float z);
float depth16_to_float(uint32_t depth); /* a texel fetch: (float)u · (float)(1/65535) */

/* The number of representable values between two stored values: 0 iff the bits are equal or both
 * are NaN; +0 and −0 are 1 apart; UINT32_MAX between a NaN and a number. */
uint32_t ulp_distance(float a, float b);
uint32_t ulp_distance_half(uint16_t a, uint16_t b);
uint32_t format_ulp(FormatKind kind, uint32_t a,
                    uint32_t b); /* of stored bits; integers by value */

/* Whether a float or half channel of the pixel is where sums end that overflow: not finite, or as a
 * half ±65504, which truncation does not go beyond. */
bool format_overflowed(PixelFormat format, const void *pixel);

#endif
