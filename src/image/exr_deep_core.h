/* What the writer and the reader of deep files share: channels and the compression of chunks.
 * Private to src/image. */
#ifndef PEEL_IMAGE_EXR_DEEP_CORE_H
#define PEEL_IMAGE_EXR_DEEP_CORE_H

#include "image/deep.h"
#include "image/exr_core.h"

/* In the order that a file has them: by name. */
enum {
    EXR_DEEP_A,
    EXR_DEEP_B,
    EXR_DEEP_G,
    EXR_DEEP_R,
    EXR_DEEP_Z,
    EXR_DEEP_DEPTH,
    EXR_DEEP_MATERIAL,
    EXR_DEEP_PRIMITIVE,
    EXR_DEEP_CHANNELS
};

typedef struct ExrDeepChannel {
    const char *name;
    exr_pixel_type_t type;
    size_t offset; /* of its 4 bytes in DeepSample */
} ExrDeepChannel;

extern const ExrDeepChannel exr_deep_channels[EXR_DEEP_CHANNELS];

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
