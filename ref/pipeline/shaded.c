#include "ref/pipeline/shaded.h"

void shaded_count(Stage *stage)
{
    uint64_t shaded = 0;
    size_t pixels = (size_t)stage->pass->view.width * (size_t)stage->pass->view.height;
    for (uint32_t tile = 0; tile < stage->pass->tile_count; tile++)
        shaded += stage->tile_counts[tile].shaded;
    for (size_t i = 0; i < pixels; i++)
        stage->counts.peeled += stage->fragments[i];
    stage->frame->peels = shaded > 0;
    stage->frame->geometry_passes = 1;
}
