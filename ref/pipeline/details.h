/* What a trace with details has beyond the stored buffers (frame/trace.h): the colours that a
 * lighting pass blends, and which fragments a peel's tests throw away. */
#ifndef PEEL_REF_DETAILS_H
#define PEEL_REF_DETAILS_H

#include "frame/render_desc.h"
#include "image/image.h"
#include "ref/pipeline/geometry.h"
#include "ref/pipeline/pass.h"

#include <string.h>

typedef enum DetailsTest {
    DETAILS_HIDDEN,  /* behind the opaque depth */
    DETAILS_PEELED,  /* at or before the previous layer */
    DETAILS_FARTHER, /* another one was kept: the depth test */
    DETAILS_TESTS
} DetailsTest;

typedef struct Stage Stage;

/* Whether the previous layer throws a fragment away that is not hidden. */
typedef bool (*DetailsPeeled)(const Stage *stage, const Primitive *primitive, FragmentDepth depth,
                              size_t pixel);

typedef struct Details {
    Image source;                  /* FORMAT_RGBA32F */
    Image rejected[DETAILS_TESTS]; /* FORMAT_R32UI; of a peel */
    const Image *kept;             /* of details_put_rejected, while it runs */
    DetailsPeeled peeled;
} Details;

Result details_create(const RenderDesc *desc, Details *out); /* the caller frees, on failure too */
void details_free(Details *details);
uint64_t details_pixel_bytes(void);

/* Nothing where there are none. */
void details_clear_source(Details *details);
static inline void details_put_color(Details *details, size_t pixel, const float color[4])
{
    if (details->source.pixels)
        memcpy((float *)details->source.pixels + 4 * pixel, color, 4 * sizeof *color);
}

/* Counts and traces what a peel's tests threw away; kept: the primitives of its layer. */
Result details_put_rejected(Stage *stage, int peel, const Image *kept, DetailsPeeled peeled);

#endif
