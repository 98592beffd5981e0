/* An image that somebody gives us: what its file says, and what its values mean, which no file
 * says: how light is encoded, which row is first, what alpha is. That is found out by trying: each
 * meaning is compared with a reference of the same scene, and one that is not the usual is believed
 * only where it fits at least twice as well. */
#ifndef PEEL_COMPARE_GIVEN_H
#define PEEL_COMPARE_GIVEN_H

#include "image/image.h"

#include <stdbool.h>
#include <stdint.h>

typedef enum GivenEncoding {
    GIVEN_ENCODING_DETECT = 0,
    GIVEN_LINEAR,
    GIVEN_SRGB, /* IEC 61966-2-1 */
    GIVEN_SEED  /* the display transform of frame/shading.h */
} GivenEncoding;
typedef enum GivenRows {
    GIVEN_ROWS_DETECT = 0,
    GIVEN_TOP_DOWN,
    GIVEN_BOTTOM_UP
} GivenRows;
typedef enum GivenAlpha {
    GIVEN_ALPHA_DETECT = 0,
    GIVEN_ALPHA_NONE, /* there is none, or it means nothing */
    GIVEN_COVERAGE,
    GIVEN_TRANSMITTANCE
} GivenAlpha;

typedef struct GivenImage {
    Image stored;     /* four channels, rows as in the file */
    const char *kind; /* "PNG" or "EXR"; static */
    bool has_alpha;
    uint64_t nonfinite; /* pixels with a value that is NaN or infinite */
} GivenImage;

typedef struct GivenMeaning {
    GivenEncoding encoding;
    GivenRows rows;
    GivenAlpha alpha;
} GivenMeaning;

/* An image as it is to be understood. */
typedef struct GivenReading {
    GivenMeaning meaning; /* without DETECT */
    bool sure;            /* false: other encodings or rows fit about as well as what was found */
    /* Both FORMAT_RGBA32F, rows top first, A = coverage, or 1 where alpha means nothing. */
    Image encoded; /* colours as the file has them, unorm as integer / greatest */
    Image linear;  /* colours decoded; the greatest code of the seed's transform as infinity */
} GivenReading;

/* Names as on the command line; static. find: the value, or −1. */
const char *given_encoding_name(GivenEncoding encoding);
const char *given_alpha_name(GivenAlpha alpha);

/* Reads a PNG of 8 or 16 bits or a flat EXR with R, G and B in its first part, whatever else it
 * has. Of an image that has not this width and height (NULL: of none) only these are read: stored
 * has no pixels. BAD_INPUT, UNSUPPORTED or IO with a message naming path; the caller frees with
 * given_free. */
Result given_load(const char *path, const int size[2], GivenImage *out);
void given_free(GivenImage *given); /* leaves an empty one */

/* BAD_INPUT where options say what alpha means, and no image has any. */
Result given_check_alpha(const GivenMeaning *options, bool has_alpha);

/* Finds out what `options` leaves to be detected. reference: FORMAT_RGBA32F, linear over the
 * background, A = coverage, and of given's size (INTERNAL otherwise). Without a decision PNG is
 * taken for the seed's display form and EXR for linear, rows for top down. The caller frees with
 * given_reading_free. NO_MEMORY is possible. */
Result given_interpret(const GivenImage *given, const Image *reference, const GivenMeaning *options,
                       GivenReading *out);
void given_reading_free(GivenReading *reading); /* leaves an empty one */

/* "8-bit PNG, display-encoded (seed), rows from the top, no alpha"; the format is given's, the
 * meaning reading's. */
void given_describe(const GivenImage *given, const GivenReading *reading, char *text, size_t size);

/* Linear light to an encoding and back, in double. Encoded values of integer formats are in [0, 1]:
 * given_stored_value clamps for them. NaN stays NaN. */
double given_encode(GivenEncoding encoding, double linear);
double given_decode(GivenEncoding encoding, double value);
double given_stored_value(PixelFormat format, GivenEncoding encoding, double linear);

/* How far storing may move an encoded value: half a step of an integer format, one step of a half
 * at this value (which drivers round or truncate), 0 of a float. */
double given_quantum(PixelFormat format, double value);

#endif
