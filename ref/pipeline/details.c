#include "ref/pipeline/details.h"

#include "ref/pipeline/stage.h"

static const char *const test_names[DETAILS_TESTS] = {"hidden", "peeled", "farther"};

Result details_create(const RenderDesc *desc, Details *out)
{
    Result result = image_create(desc->width, desc->height, FORMAT_RGBA32F, &out->source);
    for (int i = 0; i < DETAILS_TESTS && result == RESULT_OK; i++)
        result = image_create(desc->width, desc->height, FORMAT_R32UI, &out->rejected[i]);
    return result;
}

void details_free(Details *details)
{
    image_free(&details->source);
    for (int i = 0; i < DETAILS_TESTS; i++)
        image_free(&details->rejected[i]);
}

uint64_t details_pixel_bytes(void)
{
    return format_pixel_bytes(FORMAT_RGBA32F) + DETAILS_TESTS * format_pixel_bytes(FORMAT_R32UI);
}

static void clear(Image *image)
{
    if (image->pixels)
        memset(image->pixels, 0,
               (size_t)image->width * (size_t)image->height * format_pixel_bytes(image->format));
}

void details_clear_source(Details *details)
{
    clear(&details->source);
}

/* ---- what the tests threw away ---- */

static void visit_fragment(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    Stage *stage = visit->stage;
    const Pass *pass = stage->pass;
    const Details *details = &stage->details;
    size_t pixel = stage_pixel(pass, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    DetailsTest test = DETAILS_FARTHER;
    if (pass_hidden(pass, depth, stage_key(&stage->opaque.depth, pixel)))
        test = DETAILS_HIDDEN;
    else if (details->peeled(stage, visit->primitive, depth, pixel))
        test = DETAILS_PEELED;
    else if (((const uint32_t *)details->kept->pixels)[pixel] == visit->primitive->id ||
             fragment_masked(pass, setup, visit->primitive, x, y))
        return;
    ((uint32_t *)details->rejected[test].pixels)[pixel]++;
}

static void count_tile(Stage *stage, uint32_t tile)
{
    StageVisit visit = {.stage = stage, .list = &stage->pass->geometry.transparent};
    stage_draw(&stage->pass->transparent_bins, tile, visit_fragment, &visit);
}

Result details_put_rejected(Stage *stage, int peel, const Image *kept, DetailsPeeled peeled)
{
    Details *details = &stage->details;
    if (!details->source.pixels)
        return RESULT_OK;
    for (int i = 0; i < DETAILS_TESTS; i++)
        clear(&details->rejected[i]);
    details->kept = kept;
    details->peeled = peeled;
    Result result = stage_run(stage, count_tile);
    for (int i = 0; i < DETAILS_TESTS && result == RESULT_OK; i++)
        result = stage_put(stage, peel, test_names[i], &details->rejected[i]);
    return result;
}
