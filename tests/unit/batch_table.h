/* What works on LANES values at once, as a table of functions, so that a test can hold all widths
 * side by side: each is compiled in a file of its own that defines LANES and BATCH_TABLE, the
 * table's name. The arrays have `lanes` entries. Callers are in flushing mode. */
#ifndef PEEL_TESTS_BATCH_TABLE_H
#define PEEL_TESTS_BATCH_TABLE_H

#include "frame/view.h"
#include "ref/pipeline/shade.h"

typedef struct BatchTable {
    int lanes;
    void (*fma)(const float *a, const float *b, const float *c, float *out);
    void (*exp2)(bool fused, const float *x, float *out);
    void (*log2)(bool fused, const float *x, float *out);
    void (*pow)(bool fused, const float *x, const float *y, float *out);
    /* skip: as shade_batch; else every light. */
    void (*shade)(const View *view, const ShadeForm *form, bool skip, const Texel *texels,
                  float (*source)[4]);
    /* Per lane a, or other where a is INT32_MAX. */
    void (*kept)(const int32_t *a, int32_t other, int32_t *out);
    /* How many of at most 128 lights are not skipped. */
    int (*select)(const View *view, const ShadeForm *form, const Texel *texels);
    void (*resolve)(const View *view, bool fused, const float (*accum)[4], const float *weight,
                    float (*final)[4], uint8_t (*display)[4]);
} BatchTable;

/* batch_avx2_for_512: AVX2's, compiled for a processor that has more, as with -march=native. */
extern const BatchTable batch_scalar, batch_sse2, batch_avx2, batch_avx2_for_512, batch_avx512;

#endif

#ifdef BATCH_TABLE

#include "ref/pipeline/resolve_body.h"
#include "ref/pipeline/shade_body.h"

static void table_fma(const float *a, const float *b, const float *c, float *out)
{
    lanes_store(out, lanes_fma(lanes_load(a), lanes_load(b), lanes_load(c)));
}
static void table_exp2(bool fused, const float *x, float *out)
{
    lanes_store(out, lanes_exp2(fused, lanes_load(x)));
}
static void table_log2(bool fused, const float *x, float *out)
{
    lanes_store(out, lanes_log2(fused, lanes_load(x)));
}
static void table_pow(bool fused, const float *x, const float *y, float *out)
{
    lanes_store(out, lanes_pow(fused, lanes_load(x), lanes_load(y)));
}

static void table_load(const Texel *texels, ShadeBatch *out)
{
    for (int lane = 0; lane < LANES; lane++)
        for (int i = 0; i < 4; i++) {
            out->diffuse[i][lane] = texels[lane].diffuse[i];
            if (i == 3)
                continue;
            out->normal[i][lane] = texels[lane].normal[i];
            out->position[i][lane] = texels[lane].position[i];
            out->material[i][lane] = texels[lane].material[i];
        }
}

static void table_shade(const View *view, const ShadeForm *form, bool skip, const Texel *texels,
                        float (*source)[4])
{
    ShadeBatch batch;
    table_load(texels, &batch);
    if (skip)
        shade_batch(view, form, &batch);
    else
        shade_batch_skipping(view, form, false, &batch);
    for (int lane = 0; lane < LANES; lane++)
        for (int i = 0; i < 4; i++)
            source[lane][i] = batch.source[i][lane];
}

static void table_kept(const int32_t *a, int32_t other, int32_t *out)
{
    LanesInt value = lanes_int_load(a);
    LanesMask less = lanes_int_less(value, lanes_int_all(INT32_MAX));
    lanes_int_store(out, lanes_int_select(less, value, lanes_int_all(other)));
}

static int table_select(const View *view, const ShadeForm *form, const Texel *texels)
{
    ShadeBatch batch;
    Surface surface;
    const ViewLight *lights[SHADE_LIST];
    table_load(texels, &batch);
    shade_surface(&batch, &surface);
    bool skip = shade_may_skip(view, form, &batch, &surface);
    return shade_select(view, &surface, skip, 0, lights);
}

static void table_resolve(const View *view, bool fused, const float (*accum)[4],
                          const float *weight, float (*final)[4], uint8_t (*display)[4])
{
    float in[4][LANES], out[4][LANES];
    for (int lane = 0; lane < LANES; lane++)
        for (int i = 0; i < 4; i++)
            in[i][lane] = accum[lane][i];
    resolve_batch(view, fused, (const float(*)[LANES])in, weight, out, display);
    for (int lane = 0; lane < LANES; lane++)
        for (int i = 0; i < 4; i++)
            final[lane][i] = out[i][lane];
}

const BatchTable BATCH_TABLE = {LANES,       table_fma,  table_exp2,   table_log2,   table_pow,
                                table_shade, table_kept, table_select, table_resolve};

#endif
