/* The rasterizer: a triangle soup made of the input, by ref's definition, by its tile path with two
 * choices of tile size, SIMD path and threads (the same bits and counts), and, where the input says
 * so, against truth: every difference within the bound of single precision, or explained, as in the
 * long run (tests/cross/trial.h). What is not finite must be a sum that left its format. */
#include "fuzz.h"

#include "raster_input.h"
#include "trial.h"

#include "compare/finite.h"
#include "ref/pipeline/pipeline.h"

static void check(TrialId trial, const Scene *scene, const RenderDesc *desc)
{
    TrialFigures figures;
    Result result = trial_run(trial, scene, desc, &figures);
    FUZZ_CHECK(result == RESULT_OK, "%s: %s", trial_name(trial), result_message());
    FUZZ_CHECK(figures.differences == 0, "%s: %s", trial_name(trial), figures.text);
}

/* Every stored value of every pass, and the image. */
static void check_finite(const Scene *scene, const RenderDesc *desc)
{
    Finite finite = finite_before(NULL);
    Frame frame;
    Result result = pipeline_render(scene, desc, &finite.sink, &frame);
    FUZZ_CHECK(result == RESULT_OK, "%s", result_message());
    const float *values = frame.final.pixels;
    uint64_t nonfinite = finite.nonfinite;
    for (size_t i = 0; i < 4 * (size_t)frame.final.width * (size_t)frame.final.height; i++)
        nonfinite += !isfinite(values[i]);
    FUZZ_CHECK(nonfinite == 0 || frame.layers.overflowed > 0, "%llu values",
               (unsigned long long)nonfinite);
    frame_free(&frame);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static RasterInput input;
    raster_decode(data, size, &input);
    if (scene_validate(&input.soup.scene) != RESULT_OK) {
        fuzz_check_message();
        return 0;
    }
    check(TRIAL_PATHS, &input.soup.scene, &input.desc);
    check(TRIAL_PATHS, &input.soup.scene, &input.other);
    check_finite(&input.soup.scene, &input.desc);
    if (input.against_truth)
        check(TRIAL_TRUTH, &input.soup.scene, &input.desc);
    return 0;
}
