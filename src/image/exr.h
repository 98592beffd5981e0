/* OpenEXR files through OpenEXRCore: float, half and uint channels, one or many parts.
 *
 * Colour formats give channels A, B, G, R; depth and index formats one channel Z or ID. Float is
 * FLOAT, half is HALF, unorm is UINT holding the stored integer, with a string attribute
 * "peel:format" naming the PixelFormat. Scanlines, ZIP compression, rows from top to bottom.
 * Files are written to a temporary name and renamed. */
#ifndef PEEL_IMAGE_EXR_H
#define PEEL_IMAGE_EXR_H

#include "image/image.h"

#include <stdbool.h>

typedef struct ExrPart {
    const char *name; /* unique in the file; NULL for a single unnamed part */
    PixelFormat format;
    int width, height;
} ExrPart;

typedef struct ExrWriter ExrWriter;

/* Announces all parts; then give each part's image in order, then close. */
Result exr_writer_open(const char *path, const ExrPart *parts, int part_count, ExrWriter **out);
Result exr_writer_part(ExrWriter *writer, const Image *image);
/* Finishes the file and renames it into place if all went well so far (commit true and every part
 * given), else removes it. Frees the writer either way. */
Result exr_writer_close(ExrWriter *writer, bool commit);

/* One image, one part. */
Result exr_write(const Image *image, const char *path);
/* The same where it is said to lie; NULL: from 0, 0 on. */
Result exr_write_at(const Image *image, const ImageWindow *window, const char *path);

/* Reads what the writer above makes, and any scanline file with channels R, G, B (A) or one
 * channel. part: index. The caller frees *out; name receives the part's name ("" if none). */
Result exr_read(const char *path, int part, Image *out, char name[64]);
/* The same, but of an image that has not this width and height (NULL: of none) only these and the
 * format are read: *out has no pixels. */
Result exr_read_sized(const char *path, int part, const int size[2], Image *out, char name[64]);
Result exr_part_count(const char *path, int *count);
/* Whether the file begins as EXR files do; IO or BAD_INPUT when it cannot be read. */
Result exr_is(const char *path, bool *is);
/* Whether all channels of a part are HALF. */
Result exr_is_half(const char *path, int part, bool *half);
/* Whether a part has a channel of this name. */
Result exr_has_channel(const char *path, int part, const char *channel, bool *has);

#endif
