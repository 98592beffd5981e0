/* The kernels of frame/roofline.h for LANES; define ROOFLINE as the table's name and ROOFLINE_SIMD
 * as its SimdChoice. */
#include "base/memory.h"
#include "base/random.h"
#include "ref/pipeline/roofline.h"
#include "ref/pipeline/shade_body.h"

#include <stdlib.h>

enum {
    CHAINS = ROOFLINE_CHAINS,
    BATCHES = ROOFLINE_FRAGMENTS / LANES
};

static float sum_lanes(const Lanes values[], int count)
{
    float lanes[LANES], sum = 0.0f;
    for (int i = 0; i < count; i++) {
        lanes_store(lanes, values[i]);
        for (int k = 0; k < LANES; k++)
            sum += lanes[k];
    }
    return sum;
}

static void start_chains(Lanes chain[CHAINS])
{
    for (int i = 0; i < CHAINS; i++)
        chain[i] = lanes_all(1.0f + 0.01f * (float)i);
}

/* ---- arithmetic: values stay near 1 ---------------------------------------------------------- */

static float muladd(uint64_t rounds)
{
    Lanes chain[CHAINS], factor = lanes_all(0.875f), term = lanes_all(0.125f);
    start_chains(chain);
    for (uint64_t round = 0; round < rounds; round++)
        for (int i = 0; i < CHAINS; i++)
            chain[i] = lanes_add(lanes_mul(chain[i], factor), term);
    return sum_lanes(chain, CHAINS);
}

#ifdef LANES_FMA
static float fma_chains(uint64_t rounds)
{
    Lanes chain[CHAINS], factor = lanes_all(0.875f), term = lanes_all(0.125f);
    start_chains(chain);
    for (uint64_t round = 0; round < rounds; round++)
        for (int i = 0; i < CHAINS; i++)
            chain[i] = LANES_FMA(chain[i], factor, term);
    return sum_lanes(chain, CHAINS);
}
#endif

static float divide(uint64_t rounds)
{
    Lanes chain[CHAINS], dividend = lanes_all(1.37f);
    start_chains(chain);
    for (uint64_t round = 0; round < rounds; round++)
        for (int i = 0; i < CHAINS; i++)
            chain[i] = lanes_div(dividend, chain[i]);
    return sum_lanes(chain, CHAINS);
}

/* The sum before a root keeps it from 1, and costs nothing beside it. */
static float root(uint64_t rounds)
{
    Lanes chain[CHAINS], one = lanes_all(1.0f);
    start_chains(chain);
    for (uint64_t round = 0; round < rounds; round++)
        for (int i = 0; i < CHAINS; i++)
            chain[i] = lanes_sqrt(lanes_add(chain[i], one));
    return sum_lanes(chain, CHAINS);
}

/* ---- memory ---------------------------------------------------------------------------------- */

static float read_floats(const float *from, size_t count)
{
    Lanes sums[4];
    for (int i = 0; i < 4; i++)
        sums[i] = lanes_all(0.0f);
    for (size_t at = 0; at < count; at += 4 * LANES)
        for (int i = 0; i < 4; i++)
            sums[i] = lanes_add(sums[i], lanes_load(from + at + (size_t)(i * LANES)));
    return sum_lanes(sums, 4);
}

static void write_floats(float *to, size_t count)
{
    const Lanes value = lanes_all(1.5f);
    for (size_t at = 0; at < count; at += LANES)
        lanes_store(to + at, value);
}

static void copy_floats(float *to, const float *from, size_t count)
{
    for (size_t at = 0; at < count; at += LANES)
        lanes_store(to + at, lanes_load(from + at));
}

/* ---- the lighting loop ----------------------------------------------------------------------- */

struct RooflineLighting {
    View view;
    ViewLight lights[ROOFLINE_LIGHTS];
    ShadeBatch batches[BATCHES];
};

/* Surfaces some 5 before the eye that face it, lights between: no light is behind a surface. */
static void fill_batch(Random *random, ShadeBatch *batch)
{
    for (int k = 0; k < LANES; k++) {
        float x = (float)random_range(random, -0.05, 0.05);
        float y = (float)random_range(random, -0.05, 0.05);
        const float normal[3] = {x, y, op_sqrt(1.0f - x * x - y * y)};
        for (int i = 0; i < 3; i++) {
            batch->normal[i][k] = normal[i];
            batch->position[i][k] =
                (float)(i < 2 ? random_range(random, -1.0, 1.0) : random_range(random, -5.5, -4.5));
            batch->material[i][k] = (float)random_range(random, 0.2, 0.9);
        }
        for (int i = 0; i < 4; i++)
            batch->diffuse[i][k] = (float)random_range(random, 0.2, 0.9);
    }
}

static Result make_lighting(RooflineLighting **out)
{
    RooflineLighting *data = *out = memory_array(1, sizeof *data);
    Random random = random_seed(1);
    if (!data)
        return RESULT_NO_MEMORY;
    data->view = (View){.light_count = ROOFLINE_LIGHTS, .lights = data->lights};
    for (int i = 0; i < ROOFLINE_LIGHTS; i++) {
        ViewLight *light = &data->lights[i];
        *light = (ViewLight){.attenuation = {1.0f, 0.14f, 0.07f}};
        for (int k = 0; k < 3; k++) {
            light->position[k] = (float)(k < 2 ? random_range(&random, -1.0, 1.0)
                                               : random_range(&random, -2.0, 0.0));
            light->color[k] = (float)random_unit(&random);
        }
    }
    for (int i = 0; i < BATCHES; i++)
        fill_batch(&random, &data->batches[i]);
    return RESULT_OK;
}

/* Not inlined: see op_enter. */
static __attribute__((noinline)) float light_batches(RooflineLighting *data, uint64_t rounds)
{
    const ShadeForm form = {0};
    float sum = 0.0f;
    for (uint64_t round = 0; round < rounds; round++)
        for (int i = 0; i < BATCHES; i++)
            shade_batch(&data->view, &form, &data->batches[i]);
    for (int i = 0; i < BATCHES; i++)
        for (int k = 0; k < LANES; k++)
            sum += data->batches[i].source[0][k];
    return sum;
}

static float light_fragments(RooflineLighting *data, uint64_t rounds)
{
    uint32_t saved = op_enter();
    float sum = light_batches(data, rounds);
    op_leave(saved);
    return sum;
}

const RooflineKernels ROOFLINE = {
    .simd = ROOFLINE_SIMD,
    .lanes = LANES,
    .muladd = muladd,
#ifdef LANES_FMA
    .fma = fma_chains,
#endif
    .divide = divide,
    .root = root,
    .read = read_floats,
    .write = write_floats,
    .copy = copy_floats,
    .light = light_fragments,
    .lighting = make_lighting,
};
