/* Deep OpenEXR files: scanlines, one chunk each, through OpenEXRCore.
 *
 * Channels, as "Interpreting OpenEXR Deep Pixels" and "OpenEXR Deep IDs Specification"
 * (openexr.com) name them: A, B, G, R, Z (float; colours premultiplied; point samples, so there is
 * no ZBack), depth.window (float), materialid, primitiveid (uint). ZIPS compression, rows from top
 * to bottom. Attributes: maxSamplesPerPixel; worldToCamera and worldToNDC where the image has a
 * camera; deepImageState TIDY where no pixel has two samples of one Z, else none. The chunks are
 * packed and compressed here: OpenEXRCore 3.1 does not compress the tables of sample counts, and
 * believes those of a broken file. */
#ifndef PEEL_IMAGE_EXR_DEEP_H
#define PEEL_IMAGE_EXR_DEEP_H

#include "image/deep.h"

/* Written to a temporary name and renamed. UNSUPPORTED when a row has more samples than a chunk can
 * hold (2^31 bytes). */
Result exr_deep_write(const DeepImage *image, const char *path);

/* Reads the first part of deep scanlines of any file that has R, G, B, A and Z; other channels are
 * left out, depth.window is 0 and ids are DEEP_NO_ID where they are missing (*out says which). Samples come
 * front to back, by Z and then as they lie in the file. UNSUPPORTED for tiles, and where ZBack
 * makes samples of a pixel overlap; BAD_INPUT for broken files and Z that is no number; NO_MEMORY
 * beyond max_bytes. The data window is the image. The caller frees *out; after a failure it is
 * empty. */
Result exr_deep_read(const char *path, size_t max_bytes, DeepImage *out);

#endif
