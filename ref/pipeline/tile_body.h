/* Deferred depth peeling, the tile-resident path: the bits of methods/peel.c, without a trace.
 * One body: a file defines LANES and TILE_RENDER and includes it, once per instruction set.
 *
 * A tile is rendered whole before the next: opaque, then peel by peel until one yields nothing,
 * then opaque lighting, background and display. The geometry passes rasterize depth and primitive
 * index only; attributes are computed for the fragments that survive, with the same operations,
 * so they have the same bits. Memory per worker does not grow with the number of peels. */
#include "base/memory.h"
#include "number/blend.h"
#include "number/op.h"
#include "ref/pipeline/fragment.h"
#include "ref/pipeline/pass.h"
#include "ref/pipeline/shade.h"
#include "ref/pipeline/shade_body.h"
#include "ref/pipeline/tile.h"

#include <stdlib.h>

/* Setups of a tile's transparent primitives, kept between its peels. */
enum {
    SETUPS_MAX = 16384
};

/* One worker's memory. */
typedef struct Scratch {
    uint32_t opaque_key[TILE_PIXELS], opaque_index[TILE_PIXELS];
    uint32_t key[2][TILE_PIXELS]; /* the two depth buffers */
    uint32_t index[TILE_PIXELS];  /* winner of the current pass, in its list */
    uint32_t fragments[TILE_PIXELS], remaining[TILE_PIXELS];
    unsigned char accum[TILE_PIXELS * 16];
    Setup *setups;
    size_t setup_capacity;
} Scratch;

typedef struct TileJob {
    const Pass *pass;
    Scratch *scratch; /* per worker */
    PassCounts *counts;
    int *peels; /* per tile: blended */
    int limit;
    bool dry; /* count peels only */
    Frame *frame;
} TileJob;

/* A pass over the tile's primitives. */
typedef struct TilePass {
    const Pass *pass;
    Scratch *scratch;
    PixelRect rect;
    uint32_t *key;            /* depth buffer being written */
    const uint32_t *previous; /* the previous peel's; NULL in the first peel */
    uint32_t *index;
    uint32_t primitive; /* index in its list */
} TilePass;

static int local_index(const TilePass *tile, int x, int y)
{
    return (y - tile->rect.y0) * TILE + (x - tile->rect.x0);
}

static inline void keep(TilePass *tile, int pixel, FragmentDepth depth)
{
    tile->key[pixel] = depth.key;
    tile->index[pixel] = tile->primitive;
}

static void visit_opaque(void *context, const Setup *setup, int x, int y)
{
    TilePass *tile = context;
    const Pass *pass = tile->pass;
    int pixel = local_index(tile, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    if (pass_depth_test(pass, depth.key, tile->key[pixel]) &&
        !fragment_masked(pass, setup, &pass->geometry.opaque.items[tile->primitive], x, y))
        keep(tile, pixel, depth);
}

static void visit_transparent(void *context, const Setup *setup, int x, int y)
{
    TilePass *tile = context;
    const Pass *pass = tile->pass;
    int pixel = local_index(tile, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    if (pass_hidden(pass, depth, tile->scratch->opaque_key[pixel]))
        return;
    if (!tile->previous)
        tile->scratch->fragments[pixel]++;
    else if (pass_peeled(pass, depth, tile->previous[pixel]))
        return;
    if (pass_depth_test(pass, depth.key, tile->key[pixel]))
        keep(tile, pixel, depth);
}

static void visit_remaining(void *context, const Setup *setup, int x, int y)
{
    TilePass *tile = context;
    const Pass *pass = tile->pass;
    int pixel = local_index(tile, x, y);
    FragmentDepth depth = pass_fragment_depth(pass, setup, x, y);
    if (!pass_hidden(pass, depth, tile->scratch->opaque_key[pixel]) &&
        pass_remains(pass, depth, tile->previous[pixel]))
        tile->scratch->remaining[pixel]++;
}

static void fill(uint32_t *values, uint32_t value)
{
    for (int i = 0; i < TILE_PIXELS; i++)
        values[i] = value;
}

static void draw_opaque(TilePass *tile, uint32_t number)
{
    const Pass *pass = tile->pass;
    const Bins *bins = &pass->opaque_bins;
    for (size_t i = bins->first[number]; i < bins->first[number + 1]; i++) {
        Setup setup;
        tile->primitive = bins->item[i];
        pass_setup(pass, &pass->geometry.opaque.items[tile->primitive], &setup);
        setup_visit(&setup, tile->rect, visit_opaque, tile);
    }
}

/* first: the setups are not made yet. */
static inline __attribute__((always_inline)) void draw_transparent(TilePass *tile, uint32_t number,
                                                                   bool first, SetupVisit visit)
{
    const Pass *pass = tile->pass;
    const Bins *bins = &pass->transparent_bins;
    const uint32_t *items = bins->item + bins->first[number];
    size_t count = bins->first[number + 1] - bins->first[number];
    for (size_t i = 0; i < count; i++) {
        Setup once, *setup = i < tile->scratch->setup_capacity ? &tile->scratch->setups[i] : &once;
        tile->primitive = items[i];
        if (first || setup == &once)
            pass_setup(pass, &pass->geometry.transparent.items[items[i]], setup);
        setup_visit(setup, tile->rect, visit, tile);
    }
}

/* Survivors gathered for the lighting pass; a batch is lit when it is full. */
typedef struct Gathered {
    const TilePass *tile;
    bool seed_blend;
    ShadeForm form;
    int count;
    int pixel[LANES];
    ShadeBatch batch;
} Gathered;

static void light_batch(Gathered *gathered)
{
    const Pass *pass = gathered->tile->pass;
    shade_batch(&pass->view, &gathered->form, &gathered->batch);
    for (int lane = 0; lane < gathered->count; lane++) {
        float color[4];
        for (int i = 0; i < 4; i++)
            color[i] = gathered->batch.source[i][lane];
        void *accum = gathered->tile->scratch->accum + 16 * (size_t)gathered->pixel[lane];
        if (gathered->seed_blend)
            blend_opaque_seed(pass->desc->accum, color, accum);
        else
            blend_under(pass->desc->accum, color, accum);
    }
    gathered->count = 0;
}

static inline void gather(Gathered *gathered, int pixel, const Texel *texel)
{
    ShadeBatch *batch = &gathered->batch;
    int lane = gathered->count++;
    gathered->pixel[lane] = pixel;
    for (int i = 0; i < 3; i++) {
        batch->normal[i][lane] = texel->normal[i];
        batch->position[i][lane] = texel->position[i];
        batch->material[i][lane] = texel->material[i];
    }
    for (int i = 0; i < 4; i++)
        batch->diffuse[i][lane] = texel->diffuse[i];
    if (gathered->count == LANES)
        light_batch(gathered);
}

/* Lights the winners in tile->index, at the depths in tile->key, which are of the transparent list
 * or of the opaque one, and blends them. */
static void light(const TilePass *tile, bool transparent)
{
    const Pass *pass = tile->pass;
    const PrimitiveList *list = transparent ? &pass->geometry.transparent : &pass->geometry.opaque;
    /* Lanes that the last batch leaves unused are lit too: zeros give finite values. */
    Gathered gathered = {
        .tile = tile,
        .seed_blend = !transparent && pass->desc->opaque_blend == OPAQUE_BLEND_SEED,
        .form = pass_shade_form(pass, transparent),
    };
    Setup setup;
    uint32_t last = PRIMITIVE_NONE;
    for (int y = tile->rect.y0; y <= tile->rect.y1; y++)
        for (int x = tile->rect.x0; x <= tile->rect.x1; x++) {
            int pixel = local_index(tile, x, y);
            uint32_t index = tile->index[pixel];
            if (index == PRIMITIVE_NONE)
                continue;
            if (index != last)
                pass_setup(pass, &list->items[index], &setup);
            last = index;
            Texel texel;
            fragment_shade(pass, &setup, &list->items[index], x, y, &texel);
            texel_quantise(&pass->layout, &texel);
            fragment_decode(pass, tile->key[pixel], x, y, &texel);
            if (texel.diffuse[3] > SHADING_ALPHA_TEST)
                gather(&gathered, pixel, &texel);
        }
    if (gathered.count > 0)
        light_batch(&gathered);
}

/* Pixels drawn, and of those at the previous peel's depth again. */
static void count_drawn(const TilePass *tile, uint64_t *drawn, uint64_t *repeated)
{
    *drawn = *repeated = 0;
    for (int i = 0; i < TILE_PIXELS; i++) {
        if (tile->index[i] == PRIMITIVE_NONE)
            continue;
        ++*drawn;
        *repeated += tile->previous && tile->key[i] == tile->previous[i];
    }
}

/* Returns the number of peels. With the raw test a tile that brings nothing new goes on being
 * blended until no tile does (auto) or the limit: job->limit is then that number. */
static int peel_tile(const TileJob *job, TilePass *tile, uint32_t number, PassCounts *counts)
{
    Scratch *scratch = tile->scratch;
    uint32_t far = depth_key_far(tile->pass->depth_format, tile->pass->desc->depth_range);
    int peel = 0;
    tile->previous = NULL;
    tile->index = scratch->index;
    for (; peel < job->limit; peel++) {
        uint64_t drawn, repeated;
        tile->key = scratch->key[peel % 2];
        fill(tile->key, far);
        fill(tile->index, PRIMITIVE_NONE);
        draw_transparent(tile, number, peel == 0, visit_transparent);
        count_drawn(tile, &drawn, &repeated);
        if (drawn == 0 || (job->dry && drawn == repeated))
            break;
        counts->peeled += drawn;
        counts->repeated += repeated;
        if (!job->dry)
            light(tile, true);
        tile->previous = tile->key;
    }
    return peel;
}

static void count_tile(const TileJob *job, TilePass *tile, uint32_t number, int peels,
                       PassCounts *counts)
{
    Scratch *scratch = tile->scratch;
    bool may_leave = pass_may_leave(job->pass, peels, job->limit);
    if (may_leave) {
        fill(scratch->remaining, 0);
        draw_transparent(tile, number, false, visit_remaining);
    }
    for (int y = tile->rect.y0; y <= tile->rect.y1; y++)
        for (int x = tile->rect.x0; x <= tile->rect.x1; x++) {
            int pixel = local_index(tile, x, y);
            pass_count_fragments(counts, scratch->fragments[pixel]);
            if (may_leave) {
                float accum[4];
                format_fetch(job->pass->desc->accum, scratch->accum + 16 * (size_t)pixel, accum);
                pass_count_remaining(counts, scratch->remaining[pixel], accum[3]);
            }
        }
}

static void resolve_tile(const TileJob *job, const TilePass *tile)
{
    const Pass *pass = tile->pass;
    for (int y = tile->rect.y0; y <= tile->rect.y1; y++)
        for (int x = tile->rect.x0; x <= tile->rect.x1; x++) {
            int pixel = local_index(tile, x, y), row = pass->view.height - 1 - y;
            float accum[4];
            format_fetch(pass->desc->accum, tile->scratch->accum + 16 * (size_t)pixel, accum);
            float opaque_alpha = tile->scratch->opaque_index[pixel] == PRIMITIVE_NONE ? 0.0f : 1.0f;
            float *final = image_pixel(&job->frame->final, x, row);
            shade_final(&pass->view, accum, pass_background_weight(pass, accum, opaque_alpha),
                        final);
            shade_display(pass->fused, final, image_pixel(&job->frame->display, x, row));
        }
}

static __attribute__((noinline)) void render_tile(const TileJob *job, uint32_t number,
                                                  Scratch *scratch)
{
    const Pass *pass = job->pass;
    PassCounts *counts = &job->counts[number];
    TilePass tile = {.pass = pass, .scratch = scratch, .rect = pass_tile_rect(pass, number)};
    *counts = (PassCounts){0};
    fill(scratch->fragments, 0);
    for (int i = 0; i < TILE_PIXELS; i++)
        blend_clear(pass->desc->accum, scratch->accum + 16 * (size_t)i);

    tile.key = scratch->opaque_key;
    tile.index = scratch->opaque_index;
    fill(tile.key, depth_key_far(pass->depth_format, pass->desc->depth_range));
    fill(tile.index, PRIMITIVE_NONE);
    draw_opaque(&tile, number);

    job->peels[number] = peel_tile(job, &tile, number, counts);
    if (job->dry)
        return;
    count_tile(job, &tile, number, job->peels[number], counts);
    tile.key = scratch->opaque_key;
    tile.index = scratch->opaque_index;
    light(&tile, false);
    resolve_tile(job, &tile);
}

/* That one tile keeps: at most SETUPS_MAX. */
static size_t tile_setups(const Pass *pass, uint32_t number)
{
    const size_t *first = pass->transparent_bins.first;
    size_t count = first[number + 1] - first[number];
    return count < SETUPS_MAX ? count : SETUPS_MAX;
}

static size_t most_setups(const Pass *pass)
{
    size_t most = 0;
    for (uint32_t tile = 0; tile < pass->tile_count; tile++)
        most = tile_setups(pass, tile) > most ? tile_setups(pass, tile) : most;
    return most;
}

static Result tile_task(void *context, uint32_t number, int worker)
{
    const TileJob *job = context;
    Scratch *scratch = &job->scratch[worker];
    Result result = memory_grow((void **)&scratch->setups, &scratch->setup_capacity,
                                tile_setups(job->pass, number), sizeof *scratch->setups);
    if (result != RESULT_OK)
        return result;
    uint32_t saved = op_enter();
    render_tile(job, number, scratch);
    op_leave(saved);
    return RESULT_OK;
}

static int most_peels(const TileJob *job)
{
    int most = 0;
    for (uint32_t tile = 0; tile < job->pass->tile_count; tile++)
        most = job->peels[tile] > most ? job->peels[tile] : most;
    return most;
}

static Result run(TileJob *job)
{
    const Pass *pass = job->pass;
    Result result = RESULT_OK;
    job->limit = pass->desc->passes ? pass->desc->passes : PASSES_MAX;
    if (pass->desc->peel_test == PEEL_TEST_RAW && pass->desc->passes == 0) {
        job->dry = true;
        result = pool_run(pass->pool, pass->tile_count, tile_task, job);
        job->dry = false;
        job->limit = most_peels(job);
    }
    if (result == RESULT_OK)
        result = pool_run(pass->pool, pass->tile_count, tile_task, job);
    return result;
}

Result TILE_RENDER(Pass *pass, Frame *frame)
{
    int workers = pool_threads(pass->pool);
    TileJob job = {.pass = pass, .frame = frame};
    Result result = pass_reserve(pass, (uint64_t)workers *
                                           (sizeof(Scratch) + most_setups(pass) * sizeof(Setup)));
    if (result != RESULT_OK)
        return result;
    job.scratch = memory_array((size_t)workers, sizeof *job.scratch);
    job.counts = memory_array(pass->tile_count, sizeof *job.counts);
    job.peels = memory_array(pass->tile_count, sizeof *job.peels);
    result = job.scratch && job.counts && job.peels ? run(&job) : RESULT_NO_MEMORY;
    if (result == RESULT_OK) {
        PassCounts sum = {0};
        for (uint32_t tile = 0; tile < pass->tile_count; tile++)
            pass_counts_add(&sum, &job.counts[tile]);
        pass_counts_report(&sum, frame);
        frame->peels = most_peels(&job);
    }
    for (int i = 0; job.scratch && i < workers; i++)
        free(job.scratch[i].setups);
    free(job.scratch);
    free(job.counts);
    free(job.peels);
    return result;
}
