/* Source of the packing: "OpenEXR File Layout" and "Technical Introduction to OpenEXR",
 * openexr.com: even bytes, then odd ones, each as the difference to the one before, then deflate
 * or run lengths. */
#include "image/exr_deep_core.h"

#include <string.h>
#include <zlib.h>

size_t exr_deep_bound(size_t size)
{
    return compressBound(size);
}

size_t exr_deep_zip(const uint8_t *in, size_t size, uint8_t *scratch, uint8_t *out)
{
    size_t half = (size + 1) / 2;
    for (size_t i = 0; i < size; i++)
        scratch[i / 2 + (i % 2 ? half : 0)] = in[i];
    for (size_t i = size; i-- > 1;)
        scratch[i] = (uint8_t)(scratch[i] - scratch[i - 1] + 128);
    uLongf packed = compressBound(size);
    if (size && compress2(out, &packed, scratch, size, EXR_ZIP_LEVEL) == Z_OK && packed < size)
        return packed;
    memcpy(out, in, size);
    return size;
}

/* Run lengths: n ≥ 0 and a byte n + 1 times; n < 0 and −n bytes. Exactly size bytes, or false. */
static bool expand_runs(const uint8_t *in, size_t in_size, uint8_t *out, size_t size)
{
    size_t at = 0, done = 0;
    while (at < in_size) {
        int run = (int8_t)in[at++];
        size_t count = (size_t)(run < 0 ? -run : run + 1), given = run < 0 ? count : 1;
        if (given > in_size - at || count > size - done)
            return false;
        if (run < 0)
            memcpy(out + done, in + at, count);
        else
            memset(out + done, in[at], count);
        at += given;
        done += count;
    }
    return done == size;
}

static bool inflate_all(const uint8_t *in, size_t in_size, uint8_t *out, size_t size)
{
    uLongf got = size;
    return uncompress(out, &got, in, in_size) == Z_OK && got == size;
}

bool exr_deep_unpack(exr_compression_t compression, const uint8_t *packed, size_t packed_size,
                     uint8_t *scratch, uint8_t *out, size_t size)
{
    if (packed_size == size) {
        memcpy(out, packed, size);
        return true;
    }
    bool good = false;
    if (compression == EXR_COMPRESSION_ZIPS)
        good = inflate_all(packed, packed_size, scratch, size);
    else if (compression == EXR_COMPRESSION_RLE)
        good = expand_runs(packed, packed_size, scratch, size);
    if (!good)
        return false;
    for (size_t i = 1; i < size; i++)
        scratch[i] = (uint8_t)(scratch[i] + scratch[i - 1] - 128);
    size_t half = (size + 1) / 2;
    for (size_t i = 0; i < size; i++)
        out[i] = scratch[i / 2 + (i % 2 ? half : 0)];
    return true;
}
