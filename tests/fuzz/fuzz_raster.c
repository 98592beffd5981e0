/* The rasterizer: a triangle soup made of the input, by ref's definition, by its tile path with two
 * choices of tile size, SIMD path and threads (the same bits and counts), and, where the input says
 * so, against truth: every difference within the bound of single precision, or explained, as in the
 * long run (tests/cross/trial.h). What is not finite must be a sum that left its format, or of a
 * triangle whose 1/w may cancel. */
#include "fuzz.h"

#include "paths.h"
#include "raster_input.h"
#include "scene_geometry.h"
#include "trial.h"

#include "compare/finite.h"
#include "ref/pipeline/pipeline.h"

/* The digits of a float, less two for the sum and its roundings. */
#define W_RATIO_MAX 0x1p22f

/* Whether 1/w may be interpolated to 0, and what is divided by it be infinite or NaN: where the
 * nearest corner's is so much larger than the farthest one's that this is lost in its rounding. */
static bool w_cancels(const Geometry *geometry, const PrimitiveList *list)
{
    for (size_t i = 0; i < list->count; i++) {
        float least = INFINITY, most = 0.0f;
        for (int k = 0; k < 3; k++) {
            float inverse_w = geometry->vertices[list->items[i].vertex[k]].window[3];
            least = fminf(least, inverse_w);
            most = fmaxf(most, inverse_w);
        }
        if (!(most <= least * W_RATIO_MAX))
            return true;
    }
    return false;
}

static bool any_w_cancels(const Geometry *geometry)
{
    return w_cancels(geometry, &geometry->opaque) || w_cancels(geometry, &geometry->transparent);
}

/* Every stored value of every pass, and the image, unless a sum left its format. */
static void check_finite(const Finite *finite, const Scene *scene, const RenderDesc *desc,
                         const Frame *frame)
{
    const float *values = frame->final.pixels;
    uint64_t nonfinite = finite->nonfinite;
    for (size_t i = 0; i < 4 * (size_t)frame->final.width * (size_t)frame->final.height; i++)
        nonfinite += !isfinite(values[i]);
    bool explained = nonfinite == 0 || frame->layers.overflowed > 0;
    if (!explained)
        FUZZ_CHECK(scene_geometry_ask(scene, desc, any_w_cancels, &explained) == RESULT_OK, "%s",
                   result_message());
    FUZZ_CHECK(explained, "%llu values", (unsigned long long)nonfinite);
}

static void check_tiles(const Scene *scene, const RenderDesc *desc, const Frame *definition)
{
    Frame tile;
    char text[PATHS_TEXT];
    FUZZ_CHECK(paths_tile(scene, *desc, &tile) == RESULT_OK, "%s", result_message());
    FUZZ_CHECK(!paths_frames_differ(&tile, definition, text), "%s", text);
    frame_free(&tile);
}

static void check_truth(const Scene *scene, const RenderDesc *desc)
{
    TrialFigures figures;
    FUZZ_CHECK(trial_run(TRIAL_TRUTH, scene, desc, &figures) == RESULT_OK, "%s", result_message());
    FUZZ_CHECK(figures.differences == 0, "ref and truth: %s", figures.text);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static RasterInput input;
    raster_decode(data, size, &input);
    const Scene *scene = &input.soup.scene;
    if (scene_validate(scene) != RESULT_OK) {
        fuzz_check_message();
        return 0;
    }
    Finite finite = finite_before(NULL);
    Frame definition;
    FUZZ_CHECK(pipeline_render(scene, &input.desc, &finite.sink, &definition) == RESULT_OK, "%s",
               result_message());
    check_finite(&finite, scene, &input.desc, &definition);
    check_tiles(scene, &input.desc, &definition);
    check_tiles(scene, &input.other, &definition);
    frame_free(&definition);
    if (input.against_truth)
        check_truth(scene, &input.desc);
    return 0;
}
