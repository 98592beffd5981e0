/* The inputs of fuzz_raster.c by OpenGL: every buffer of every pass has ref's bits, and the counts
 * are equal, as in the long run (tests/cross/trial.h). In the driver's mode of multiply-adds. */
#include "fuzz.h"

#include "raster_input.h"
#include "trial.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static RasterInput input;
    TrialFigures figures;
    raster_decode(data, size, &input);
    if (scene_validate(&input.soup.scene) != RESULT_OK)
        return 0;
    FUZZ_CHECK(trial_run(TRIAL_GL, &input.soup.scene, &input.desc, &figures) == RESULT_OK, "%s",
               result_message());
    FUZZ_CHECK(figures.differences == 0, "ref and gl: %s", figures.text);
    return 0;
}
