#include "ref/pipeline/shade.h"

#define LANES 1
#include "ref/pipeline/shade_body.h"

static void shade(const View *view, const ShadeForm *form, bool skip, const Texel *texel,
                  float source[4])
{
    ShadeBatch batch;
    for (int i = 0; i < 3; i++) {
        batch.normal[i][0] = texel->normal[i];
        batch.position[i][0] = texel->position[i];
        batch.material[i][0] = texel->material[i];
    }
    for (int i = 0; i < 4; i++)
        batch.diffuse[i][0] = texel->diffuse[i];
    shade_batch_skipping(view, form, skip, &batch);
    for (int i = 0; i < 4; i++)
        source[i] = batch.source[i][0];
}

bool shade_pixel(const View *view, const ShadeForm *form, const Texel *texel, float source[4])
{
    if (texel->diffuse[3] <= SHADING_ALPHA_TEST)
        return false;
    shade(view, form, false, texel, source);
    return true;
}

void shade_skipping(const View *view, const ShadeForm *form, const Texel *texel, float source[4])
{
    shade(view, form, true, texel, source);
}
