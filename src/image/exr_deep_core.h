/* What the writer and the reader of deep files share: the compression of chunks.
 * Private to src/image. */
#ifndef PEEL_IMAGE_EXR_DEEP_CORE_H
#define PEEL_IMAGE_EXR_DEEP_CORE_H

#include "image/deep.h"
#include "image/exr_core.h"

/* Bytes that exr_deep_zip may need for size bytes. */
size_t exr_deep_bound(size_t size);

/* Packs size bytes as ZIPS does, into out (exr_deep_bound(size) bytes); scratch: size bytes.
 * Returns how many bytes out has: size when they are stored as they were. */
size_t exr_deep_zip(const uint8_t *in, size_t size, uint8_t *scratch, uint8_t *out);

/* Undoes the compression: exactly size bytes into out, or false. scratch: size bytes. Equal sizes
 * mean that nothing was compressed. */
bool exr_deep_unpack(exr_compression_t compression, const uint8_t *packed, size_t packed_size,
                     uint8_t *scratch, uint8_t *out, size_t size);

#endif
