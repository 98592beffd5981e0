/* The G-buffer: what the geometry pass stores and the lighting pass reads, in stored formats. */
#ifndef PEEL_REF_BUFFERS_H
#define PEEL_REF_BUFFERS_H

#include "frame/render_desc.h"
#include "image/image.h"
#include "number/format.h"

#include <string.h>

/* Values as a shader writes or fetches them. */
typedef struct Texel {
    float normal[4], position[4], diffuse[4], material[4];
} Texel;

/* A full-size G-buffer with its depth; primitive ids beside it are for statistics only. position
 * may have FORMAT_NONE and no pixels. */
typedef struct GBuffer {
    Image depth, normal, position, diffuse, material, primitive;
} GBuffer;

/* Cleared. The caller frees with gbuffer_free. */
Result gbuffer_create(const RenderDesc *desc, GBuffer *out);
void gbuffer_free(GBuffer *buffers);
/* Colours to 0, depth to the far end, primitive to UINT32_MAX. */
void gbuffer_clear(GBuffer *buffers, DepthRange range);
/* The same in two parts: depth alone, and the rest. */
void gbuffer_clear_depth(Image *depth, DepthRange range);
void gbuffer_clear_colors(GBuffer *buffers);

/* Pixel (x, y) from the top left. Flushing mode. */
void gbuffer_store(GBuffer *buffers, int x, int y, const Texel *texel);
void gbuffer_load(const GBuffer *buffers, int x, int y, Texel *out);

/* What load gives after store, without the memory. Flushing mode. */
void texel_quantise(const GBufferLayout *layout, Texel *texel);

/* A stored depth as an integer whose order is the depth's: the bits of a D32F (never negative,
 * so they sort as integers), the D24 or D16 itself. */
static inline uint32_t depth_key(PixelFormat format, float z)
{
    if (format == FORMAT_D24)
        return depth24_from_float(z);
    if (format == FORMAT_D16)
        return depth16_from_float(z);
    float stored = depth32f_from_float(z);
    uint32_t key;
    memcpy(&key, &stored, sizeof key);
    return key;
}

/* What the depth buffer is cleared to. */
static inline uint32_t depth_key_far(PixelFormat format, DepthRange range)
{
    if (range == DEPTH_RANGE_REVERSED)
        return 0;
    return format == FORMAT_D24 ? 0xffffffu : format == FORMAT_D16 ? 0xffffu : 0x3f800000u;
}

/* What a texel fetch makes of it. */
static inline float depth_fetch(PixelFormat format, uint32_t key)
{
    if (format == FORMAT_D24)
        return depth24_to_float(key);
    if (format == FORMAT_D16)
        return depth16_to_float(key);
    float stored;
    memcpy(&stored, &key, sizeof stored);
    return stored;
}

#endif
