/* What the EXR writer and reader share: OpenEXRCore's messages and the layout of channels.
 * Private to src/image. */
#ifndef PEEL_IMAGE_EXR_CORE_H
#define PEEL_IMAGE_EXR_CORE_H

#include "image/image.h"

#include <openexr.h>
#include <stdbool.h>

/* Names the PixelFormat of a part, so that unorm formats come back as what they were. */
#define EXR_FORMAT_ATTRIBUTE "peel:format"

enum {
    EXR_SIZE_MAX = 16384
}; /* per side, as for rendering */

/* How a PixelFormat lies in a file: `channels` values of `bytes` each per pixel. */
typedef struct ExrLayout {
    int channels;
    exr_pixel_type_t type;
    int bytes;    /* of one value in the file: 2 for half, else 4 */
    bool widened; /* values in memory are narrower unsigned integers */
} ExrLayout;

ExrLayout exr_layout(PixelFormat format);

/* The channel's name in the file; index in memory order: R, G, B, A, or 0 alone. Static. */
const char *exr_channel_name(PixelFormat format, int index);
/* The inverse; −1 when the format has no such channel. */
int exr_channel_index(PixelFormat format, const char *name);

/* Keeps OpenEXRCore's first message since exr_message_clear, on the calling thread, instead of
 * letting it go to stderr. */
void exr_message_keep(exr_const_context_t context, exr_result_t code, const char *text);
void exr_message_clear(void);
/* That message, or the library's text for code. */
const char *exr_message(exr_result_t code);

#endif
