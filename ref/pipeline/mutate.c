#include "ref/pipeline/mutate.h"

#include "number/blend.h"

#include <float.h>

/* Undoes SHADING_DISPLAY_POWER. */
#define MUTATE_DECODE_POWER 2.2f

/* ---- the view ---- */

void mutate_view(const Scene *scene, const RenderDesc *desc, View *view)
{
    if ((desc->mutations & mutation_bit(MUTATION_LIGHTS_OFF_BY_ONE)) && view->light_count > 0)
        view->light_count--;
    for (size_t i = 0; i < view->draw_count; i++) {
        Draw *draw = &view->draws[i];
        if (desc->mutations & mutation_bit(MUTATION_BACK_FACES_CULLED))
            draw->cull_back = true;
        if (desc->mutations & mutation_bit(MUTATION_NORMALS_WRONG_SPACE))
            view_normal_matrix(&scene->instances[draw->instance].world, draw->normal_matrix);
    }
}

/* ---- geometry pass ---- */

void mutate_clear(const Pass *pass, GBuffer *buffers)
{
    static const float opaque_black[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    Image *diffuse = &buffers->diffuse;
    if (!mutate_has(pass, MUTATION_GBUFFER_CLEAR_ALPHA_1))
        return;
    for (int y = 0; y < diffuse->height; y++)
        for (int x = 0; x < diffuse->width; x++)
            format_store(diffuse->format, opaque_black, image_pixel(diffuse, x, y));
}

size_t mutate_fetch(const Pass *pass, int x, int y)
{
    int width = pass->view.width, height = pass->view.height;
    if (mutate_has(pass, MUTATION_DEPTH_FETCH_HALF_PIXEL)) {
        x = x + 1 < width ? x + 1 : x;
        y = y + 1 < height ? y + 1 : y;
    }
    if (mutate_has(pass, MUTATION_DEPTH_FETCH_FLIPPED))
        y = height - 1 - y;
    return (size_t)(height - 1 - y) * (size_t)width + (size_t)x;
}

/* Whether the comparison with a fetched depth finds both equal. */
static bool same_depth(const Pass *pass, FragmentDepth depth, uint32_t key)
{
    if (pass->desc->peel_test == PEEL_TEST_RAW)
        return depth.z == depth_fetch(pass->depth_format, key);
    return depth.key == key;
}

bool mutate_hidden(const Pass *pass, FragmentDepth depth, uint32_t opaque)
{
    if (mutate_has(pass, MUTATION_OPAQUE_DEPTH_IGNORED))
        return false;
    if (mutate_has(pass, MUTATION_OPAQUE_TEST_STRICT) && same_depth(pass, depth, opaque))
        return false;
    return pass_hidden(pass, depth, opaque);
}

bool mutate_peeled(const Pass *pass, FragmentDepth depth, uint32_t previous)
{
    /* With a bias no depth is at the edge of the comparison but by chance. */
    if (mutate_has(pass, MUTATION_PEEL_TEST_STRICT) && !(pass->desc->bias > 0.0f) &&
        same_depth(pass, depth, previous))
        return false;
    return pass_peeled(pass, depth, previous);
}

bool mutate_repeats(const Pass *pass)
{
    return mutate_has(pass, MUTATION_PEEL_TEST_STRICT) ||
           mutate_has(pass, MUTATION_DEPTH_NOT_SWAPPED) ||
           mutate_has(pass, MUTATION_DEPTH_FETCH_HALF_PIXEL) ||
           mutate_has(pass, MUTATION_DEPTH_FETCH_FLIPPED);
}

/* ---- lighting pass ---- */

float mutate_alpha_test(const Pass *pass)
{
    if (mutate_has(pass, MUTATION_ALPHA_TEST_MISSING))
        return -1.0f;
    return mutate_has(pass, MUTATION_ALPHA_TEST_HALF) ? 0.5f : SHADING_ALPHA_TEST;
}

/* The ambient light's part of a colour that is not multiplied by alpha. */
static float ambient_part(const Pass *pass, const ShadeForm *form, const Texel *texel, int channel)
{
    if (form->model == SHADING_PHONG)
        return channel == 0 ? SHADING_PHONG_AMBIENT_R : SHADING_PHONG_AMBIENT_GB;
    return op_mul(op_mul(pass->view.ambient[channel], texel->diffuse[channel]), texel->material[2]);
}

static float encode(const Pass *pass, float c)
{
    return op_pow(pass->fused, op_max(c, 0.0f), SHADING_DISPLAY_POWER);
}

static float decode(const Pass *pass, float c)
{
    return op_min(op_pow(pass->fused, op_max(c, 0.0f), MUTATE_DECODE_POWER), FLT_MAX);
}

/* Whether nothing was drawn there, and lighting it adds nothing: colours times an alpha of 0. */
static bool adds_nothing(const Pass *pass, const Texel *texel)
{
    return texel->diffuse[3] == 0.0f && texel->material[3] == 0.0f &&
           !mutate_has(pass, MUTATION_NOT_PREMULTIPLIED) &&
           !mutate_has(pass, MUTATION_BLEND_FACTORS_SWAPPED);
}

bool mutate_source(const Pass *pass, const ShadeForm *form, const Texel *texel, float source[4])
{
    Texel lit = *texel;
    ShadeForm mistaken = *form;
    float alpha = texel->diffuse[3], color[4];
    if (alpha <= mutate_alpha_test(pass) || adds_nothing(pass, texel))
        return false;
    mistaken.lambert_whole = mutate_has(pass, MUTATION_MISSING_1_OVER_PI);
    if (mutate_has(pass, MUTATION_ROUGHNESS_SQUARED_TWICE))
        lit.material[0] = op_mul(lit.material[0], lit.material[0]);
    /* With alpha 1 the colour is that before the multiplication by alpha, to the bit. */
    lit.diffuse[3] = 1.0f;
    shade_skipping(&pass->view, &mistaken, &lit, color);
    for (int i = 0; i < 3; i++) {
        float c = mutate_has(pass, MUTATION_SRGB_BLENDED) ? encode(pass, color[i]) : color[i];
        source[i] = mutate_has(pass, MUTATION_NOT_PREMULTIPLIED) ? c : op_mul(c, alpha);
        if (mutate_has(pass, MUTATION_PREMULTIPLIED_TWICE))
            source[i] = op_mul(source[i], alpha);
        if (mutate_has(pass, MUTATION_AMBIENT_PER_LAYER))
            source[i] =
                op_add(source[i], op_mul(ambient_part(pass, form, texel, i), op_sub(1.0f, alpha)));
    }
    source[3] = alpha;
    return true;
}

/* Colours by (ONE, DST_ALPHA), alpha by (ONE_MINUS_SRC_ALPHA, ZERO). */
static void blend_swapped(PixelFormat format, const float source[4], void *pixel)
{
    float dst[4];
    format_fetch(format, pixel, dst);
    for (int i = 0; i < 3; i++)
        dst[i] = op_add(source[i], op_mul(dst[i], dst[3]));
    dst[3] = op_mul(source[3], op_sub(1.0f, source[3]));
    format_store(format, dst, pixel);
}

/* The nearest half, ties to even, and no infinity. */
static float nearest_half(float x)
{
    uint16_t truncated = half_from_float(x);
    float low = half_to_float(truncated);
    if ((truncated & 0x7fffu) >= 0x7bffu)
        return low;
    float high = half_to_float((uint16_t)(truncated + 1u));
    float below = op_abs(op_sub(x, low)), above = op_abs(op_sub(high, x));
    return above < below || (above == below && (truncated & 1u)) ? high : low;
}

void mutate_blend(const Pass *pass, bool transparent, const float source[4], void *pixel)
{
    PixelFormat format = pass->desc->accum;
    /* Over, near to far, is under, far to near, but for rounding. */
    bool over = mutate_has(pass, MUTATION_OVER_FRONT_TO_BACK) ||
                (transparent && mutate_has(pass, MUTATION_LAYERS_REVERSED));
    if (mutate_has(pass, MUTATION_BLEND_FACTORS_SWAPPED))
        blend_swapped(format, source, pixel);
    else if (over)
        blend_over(format, source, pixel);
    else if (!transparent && pass->desc->opaque_blend == OPAQUE_BLEND_SEED)
        blend_opaque_seed(format, source, pixel);
    else
        blend_under(format, source, pixel);
    if (mutate_has(pass, MUTATION_ACCUMULATION_HALF_ROUNDED))
        for (int i = 0; i < 4; i++)
            ((float *)pixel)[i] = nearest_half(((float *)pixel)[i]);
}

/* ---- resolve ---- */

static float background_weight(const Pass *pass, float transmittance)
{
    if (mutate_has(pass, MUTATION_BACKGROUND_FORGOTTEN))
        return 0.0f;
    if (mutate_has(pass, MUTATION_BACKGROUND_WEIGHTED_WRONGLY))
        return 1.0f;
    return mutate_has(pass, MUTATION_TRANSMITTANCE_AS_COVERAGE) ? op_sub(1.0f, transmittance)
                                                                : transmittance;
}

/* The tone-mapped colour, encoded twice. */
static void display_twice(const Pass *pass, const float final[4], uint8_t display[4])
{
    for (int i = 0; i < 3; i++) {
        float c = op_max(final[i], 0.0f);
        display[i] = unorm8_from_float(encode(pass, encode(pass, op_div(c, op_add(c, 1.0f)))));
    }
    display[3] = 255;
}

void mutate_resolve(const Pass *pass, const float accum[4], float transmittance, float final[4],
                    uint8_t display[4])
{
    float weight = background_weight(pass, transmittance), coverage = op_sub(1.0f, transmittance);
    bool blended = mutate_has(pass, MUTATION_SRGB_BLENDED);
    for (int i = 0; i < 3; i++) {
        float background = pass->view.background[i], c = accum[i];
        if (mutate_has(pass, MUTATION_RESOLVED_AS_STRAIGHT))
            c = op_mul(c, coverage);
        c = op_add(c, op_mul(blended ? encode(pass, background) : background, weight));
        final[i] = op_canonical(blended ? decode(pass, c) : c);
    }
    final[3] = op_canonical(mutate_has(pass, MUTATION_TRANSMITTANCE_AS_COVERAGE) ? transmittance
                                                                                 : coverage);
    if (!mutate_has(pass, MUTATION_SRGB_ENCODED_TWICE)) {
        shade_display(pass->fused, final, display);
        return;
    }
    display_twice(pass, final, display);
    for (int i = 0; i < 3; i++)
        final[i] = encode(pass, final[i]);
}
