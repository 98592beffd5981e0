/* A deep image in memory: any number of samples in each pixel, front to back.
 *
 * Samples are points on surfaces: colour and alpha at one distance, as in "Interpreting OpenEXR
 * Deep Pixels", openexr.com. They lie in blocks that whoever fills the image allocates as they
 * come (a tile, a row), so that nothing is ever copied or allocated twice. */
#ifndef PEEL_IMAGE_DEEP_H
#define PEEL_IMAGE_DEEP_H

#include "image/image.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define DEEP_NO_ID UINT32_MAX

typedef struct DeepSample {
    float rgba[4];      /* linear R, G, B, multiplied by alpha */
    float z;            /* distance along the view axis; never less than the previous sample's */
    float depth;        /* window depth, 0 near to 1 far */
    uint32_t primitive; /* the frame's primitive id, or DEEP_NO_ID */
    uint32_t material;  /* index into the scene's materials, or DEEP_NO_ID */
} DeepSample;

/* What a sample has, in the order of the names, which are OpenEXR's. */
enum {
    DEEP_A,
    DEEP_B,
    DEEP_G,
    DEEP_R,
    DEEP_Z,
    DEEP_DEPTH,
    DEEP_MATERIAL,
    DEEP_PRIMITIVE,
    DEEP_CHANNELS
};

typedef struct DeepChannel {
    const char *name;
    FormatKind kind; /* KIND_FLOAT or KIND_UINT */
    size_t offset;   /* of its 4 bytes in DeepSample */
} DeepChannel;

extern const DeepChannel deep_channels[DEEP_CHANNELS];

typedef struct DeepBlock DeepBlock;

typedef struct DeepImage {
    int width, height;
    uint32_t *counts;    /* samples of each pixel, rows from top to bottom; owned */
    DeepSample **pixels; /* the first of them, NULL where there is none; owned as they are */
    uint64_t sample_count;
    size_t bytes, max_bytes; /* allocated, and allowed */
    bool has_window;         /* else from 0, 0, and the image itself */
    ImageWindow window;
    bool has_camera;
    /* Column-major, for column vectors. Camera: looks down −z, y up. NDC: x and y from −1 to 1, z
     * as the depth range has it. */
    float world_to_camera[16], world_to_ndc[16];
    /* Of an image from a file: which part it is. Names with commas between, owned; NULL: none. */
    int part;
    bool half[DEEP_CHANNELS], missing[DEEP_CHANNELS]; /* stored as half; not there at all */
    char *left_out;                                   /* channels that a sample has no place for */
    DeepBlock *blocks;                                /* private */
} DeepImage;

/* An image without samples. Fails with NO_MEMORY, naming the need, when that takes more than
 * max_bytes. The caller frees with deep_free, after a failure too. */
Result deep_create(int width, int height, size_t max_bytes, DeepImage *out);
void deep_free(DeepImage *image); /* leaves an empty image; an empty one is fine */

/* Zeroed room for count samples, owned by the image and counted in sample_count; for deep_set. Not
 * for two threads at a time. NO_MEMORY when all blocks would take more than max_bytes. */
Result deep_block(DeepImage *image, size_t count, DeepSample **out);

/* NO_MEMORY, naming the need, where so many bytes beside the image are more than max_bytes. */
Result deep_room(const DeepImage *image, size_t bytes);

/* Gives pixel (x, y) count samples in a block of the image, front to back. */
void deep_set(DeepImage *image, int x, int y, DeepSample *samples, uint32_t count);

/* The samples of pixel (x, y), y from the top. */
static inline const DeepSample *deep_pixel(const DeepImage *image, int x, int y, uint32_t *count)
{
    size_t at = (size_t)y * (size_t)image->width + (size_t)x;
    *count = image->counts[at];
    return image->pixels[at];
}

/* The samples of the pixel that has most. */
uint32_t deep_most(const DeepImage *image);

/* Composites each pixel front to back over black, in double: FORMAT_RGBA32F, premultiplied R, G, B
 * and A = coverage. What lies behind a sample of alpha 1 or more does not count. The caller frees
 * *out. Source: Porter, Duff, "Compositing Digital Images", SIGGRAPH 1984: over. */
Result deep_flatten(const DeepImage *image, Image *out);

#endif
