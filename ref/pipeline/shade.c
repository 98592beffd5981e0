#include "ref/pipeline/shade.h"

#define LANES 1
#include "ref/pipeline/shade_body.h"

bool shade_pixel(const View *view, const ShadeForm *form, const Texel *texel, float source[4])
{
    if (texel->diffuse[3] <= SHADING_ALPHA_TEST)
        return false;
    ShadeBatch batch;
    for (int i = 0; i < 3; i++) {
        batch.normal[i][0] = texel->normal[i];
        batch.position[i][0] = texel->position[i];
        batch.material[i][0] = texel->material[i];
    }
    for (int i = 0; i < 4; i++)
        batch.diffuse[i][0] = texel->diffuse[i];
    shade_batch_skipping(view, form, false, &batch);
    for (int i = 0; i < 4; i++)
        source[i] = batch.source[i][0];
    return true;
}
