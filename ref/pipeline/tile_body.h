/* Deferred depth peeling, the tile-resident path: the bits of methods/peel.c, without a trace.
 * One body: a file defines LANES and TILE_RENDER and includes it, once per instruction set.
 *
 * A tile is rendered whole before the next. Its triangles are set up once. Geometry passes
 * rasterize depth and triangle only: first the opaque ones, then the transparent ones, each of
 * whose fragments is inserted into its pixel's layers, which are kept in order of depth. That keeps
 * what peel after peel would keep: a peel takes the nearest depth behind the last one, and of
 * equal depths the first drawn (DEPTH_LESS) or the last. Attributes are then computed for the
 * fragments that are layers, with the same operations and so the same bits, lit and blended, layer
 * by layer, the opaque one last. More layers than LAYERS, or than a raw or biased test, which
 * depends on the layer before it, can tell at once, are found in further rounds. Memory per worker
 * does not grow with the scene, the number of peels or of layers. */
#include "base/memory.h"
#include "ref/pipeline/pass.h"
#include "ref/pipeline/resolve_body.h"
#include "ref/pipeline/tile.h"
#include "ref/pipeline/tile_layers_body.h"
#include "ref/pipeline/tile_light_body.h"

#include <stdlib.h>

typedef struct TileJob {
    const Pass *pass;
    Scratch *scratch; /* per worker */
    PassCounts *counts;
    int *peels; /* per tile: blended */
    int limit;
    bool dry; /* count peels only */
    Frame *frame;
} TileJob;

/* ---- lighting passes ---- */

static void light_begin(Tile *tile, const TileList *list, TileLight *out)
{
    Scratch *scratch = tile->scratch;
    tile_light_begin(tile->pass, list == &tile->transparent, out);
    out->grid = &tile->grid;
    out->triangles = list->resident ? list->triangles : NULL;
    out->cache = scratch->cache;
    out->tag = (uint64_t)++scratch->lists_done << 32;
    out->accum = scratch->accum;
    out->counts = tile->counts;
}

static void light_opaque(Tile *tile)
{
    TileLight light;
    light_begin(tile, &tile->opaque, &light);
    LanesInt none = lanes_int_all(-1);
    for (int block = 0; block < grid_blocks(&tile->grid); block++) {
        LanesInt index = lanes_int_load(tile->scratch->opaque_index + block * LANES);
        uint32_t bits = ~lanes_mask_bits(lanes_int_equal(index, none)) & LANES_FULL;
        if (bits)
            tile_light_block(&light, block, bits, index,
                             lanes_int_load(tile->scratch->opaque_key + block * LANES));
    }
    tile_light_flush(&light);
}

static void light_layers(Tile *tile, int layers)
{
    TileLight light;
    light_begin(tile, &tile->transparent, &light);
    for (int layer = 0; layer < layers; layer++) {
        for (int block = 0; block < grid_blocks(&tile->grid); block++) {
            if (tile->scratch->used[block] <= layer)
                continue;
            const int32_t *at = layer_of(tile->scratch, block, layer);
            LanesInt key = lanes_int_load(at);
            tile_light_block(&light, block,
                             lanes_mask_bits(lanes_int_less(key, lanes_int_all(KEY_NONE))),
                             lanes_int_load(at + LANES), key);
        }
        tile_light_flush(&light);
    }
}

/* ---- peels ---- */

/* Fragments of the round's layers, and of those at the key of the layer before again, which only
 * the raw test lets pass. */
static void count_drawn(const Tile *tile, uint64_t *drawn, uint64_t *repeated)
{
    *drawn = *repeated = 0;
    for (int block = 0; block < grid_blocks(&tile->grid); block++)
        for (int layer = 0; layer < tile->scratch->used[block]; layer++) {
            LanesInt key = lanes_int_load(layer_of(tile->scratch, block, layer));
            LanesInt previous = lanes_int_load(tile->scratch->previous + block * LANES);
            LanesMask has = lanes_int_less(key, lanes_int_all(KEY_NONE));
            *drawn += (uint64_t)__builtin_popcount(lanes_mask_bits(has));
            if (tile->one_by_one && tile->later)
                *repeated += (uint64_t)__builtin_popcount(
                    lanes_mask_bits(lanes_mask_and(has, lanes_int_equal(key, previous))));
        }
}

static int most_used(const Tile *tile)
{
    int most = 0;
    for (int block = 0; block < grid_blocks(&tile->grid); block++)
        most = tile->scratch->used[block] > most ? tile->scratch->used[block] : most;
    return most;
}

/* What the next round lies behind: the last layer where the round filled all, elsewhere the far
 * end, behind which there is nothing. */
static void keep_previous(const Tile *tile)
{
    const Scratch *scratch = tile->scratch;
    LanesInt far = lanes_int_all(tile->far), none = lanes_int_all(KEY_NONE);
    for (int block = 0; block < grid_blocks(&tile->grid); block++) {
        LanesInt key = far;
        if (scratch->used[block] == tile->capacity) {
            LanesInt last = lanes_int_load(layer_of(scratch, block, tile->capacity - 1));
            key = lanes_int_select(lanes_int_less(last, none), last, far);
        }
        lanes_int_store(scratch->previous + block * LANES, key);
    }
}

/* Returns the number of peels. With the raw test a tile that brings nothing new goes on being
 * blended until no tile does (auto) or the limit: job->limit is then that number. */
static int peel_tile(const TileJob *job, Tile *tile)
{
    int peels = 0, most = tile->one_by_one ? 1 : LAYERS;
    tile->later = false;
    while (peels < job->limit) {
        uint64_t drawn, repeated;
        tile->capacity = job->limit - peels < most ? job->limit - peels : most;
        tile->overflowed = false;
        memset(tile->scratch->used, 0, (size_t)grid_blocks(&tile->grid));
        draw_transparent(tile);
        count_drawn(tile, &drawn, &repeated);
        if (drawn == 0 || (job->dry && drawn == repeated))
            break;
        int layers = most_used(tile);
        tile->counts->peeled += drawn;
        tile->counts->repeated += repeated;
        if (!job->dry)
            light_layers(tile, layers);
        peels += layers;
        keep_previous(tile);
        tile->later = true;
        if (!tile->one_by_one && !tile->overflowed)
            break;
    }
    return peels;
}

/* Whether the last round may have left fragments behind the last of all peels. */
static bool may_leave(const TileJob *job, const Tile *tile, int peels)
{
    return pass_may_leave(job->pass, peels, job->limit) && (tile->one_by_one || tile->overflowed);
}

/* Transmittance at a pixel. */
static float stored_alpha(const Tile *tile, int pixel)
{
    float accum[4];
    if (tile->pass->desc->accum == FORMAT_RGBA32F)
        return accum_of(tile->scratch->accum, pixel)[3 * LANES];
    format_fetch(tile->pass->desc->accum, tile->scratch->accum + 16 * (size_t)pixel, accum);
    return accum[3];
}

static void count_tile(const TileJob *job, Tile *tile, int peels)
{
    Scratch *scratch = tile->scratch;
    int pixels = tile->grid.size * tile->grid.size;
    for (int pixel = 0; pixel < pixels; pixel++)
        pass_count_fragments(tile->counts, (uint32_t)scratch->fragments[pixel]);
    if (!may_leave(job, tile, peels))
        return;
    memset(scratch->remaining, 0, (size_t)pixels * sizeof *scratch->remaining);
    draw_remaining(tile);
    for (int pixel = 0; pixel < pixels; pixel++)
        if (scratch->remaining[pixel])
            pass_count_remaining(tile->counts, (uint32_t)scratch->remaining[pixel],
                                 stored_alpha(tile, pixel));
}

/* ---- the tile ---- */

static void clear_tile(const Tile *tile)
{
    const Scratch *scratch = tile->scratch;
    PixelFormat format = tile->pass->desc->accum;
    const TileGrid *grid = &tile->grid;
    int pixels = grid->size * grid->size;
    bool cut = !grid_inside(grid, grid_pixel_x(grid, pixels - 1), grid_pixel_y(grid, pixels - 1));
    memset(scratch->fragments, 0, (size_t)pixels * sizeof *scratch->fragments);
    memset(scratch->opaque_index, 0xff, (size_t)pixels * sizeof *scratch->opaque_index);
    for (int pixel = 0; pixel < pixels; pixel++)
        scratch->opaque_key[pixel] =
            cut && !grid_inside(grid, grid_pixel_x(grid, pixel), grid_pixel_y(grid, pixel))
                ? KEY_OUTSIDE
                : tile->far;
    for (int pixel = 0; format != FORMAT_RGBA32F && pixel < pixels; pixel++)
        blend_clear(format, scratch->accum + 16 * (size_t)pixel);
    for (int block = 0; format == FORMAT_RGBA32F && block < grid_blocks(grid); block++)
        for (int i = 0; i < 4; i++)
            lanes_store(accum_of(scratch->accum, block * LANES) + i * LANES,
                        lanes_all(i == 3 ? 1.0f : 0.0f));
}

/* A block's accumulated channels, and its transmittances to the background. */
static inline void fetch_block(const Tile *tile, int block, float accum[4][LANES],
                               float weight[LANES])
{
    PixelFormat format = tile->pass->desc->accum;
    if (format == FORMAT_RGBA32F) {
        memcpy(accum, accum_of(tile->scratch->accum, block * LANES), sizeof(float[4][LANES]));
    } else {
        for (int lane = 0; lane < LANES; lane++) {
            float value[4];
            format_fetch(format, tile->scratch->accum + 16 * (size_t)(block * LANES + lane), value);
            for (int i = 0; i < 4; i++)
                accum[i][lane] = value[i];
        }
    }
    for (int lane = 0; lane < LANES; lane++) {
        bool opaque = tile->scratch->opaque_index[block * LANES + lane] >= 0;
        weight[lane] = pass_background_weight(tile->pass, accum[3][lane], opaque ? 1.0f : 0.0f);
    }
}

static inline void put_block(const Tile *tile, int block, const float final[4][LANES],
                             const uint8_t display[LANES][4], Frame *frame)
{
    int x = grid_x(&tile->grid, block), y = grid_y(&tile->grid, block);
    int right = tile->grid.rect.x1 + 1 - x, up = tile->grid.rect.y1 + 1 - y;
    int columns = right < BLOCK_WIDTH ? right : BLOCK_WIDTH;
    for (int row = 0; row < BLOCK_HEIGHT && row < up; row++) {
        int image_y = tile->pass->view.height - 1 - (y + row);
        float(*out)[4] = image_pixel(&frame->final, x, image_y);
        for (int column = 0; column < columns; column++)
            for (int i = 0; i < 4; i++)
                out[column][i] = final[i][row * BLOCK_WIDTH + column];
        memcpy(image_pixel(&frame->display, x, image_y), display[row * BLOCK_WIDTH],
               (size_t)columns * 4);
    }
}

static void resolve_tile(const TileJob *job, const Tile *tile)
{
    for (int block = 0; block < grid_blocks(&tile->grid); block++) {
        float accum[4][LANES], weight[LANES], final[4][LANES];
        uint8_t display[LANES][4];
        if (!grid_inside(&tile->grid, grid_x(&tile->grid, block), grid_y(&tile->grid, block)))
            continue;
        fetch_block(tile, block, accum, weight);
        resolve_batch(&tile->pass->view, tile->pass->fused, accum, weight, final, display);
        put_block(tile, block, final, display, job->frame);
    }
}

static TileGrid tile_grid(const Pass *pass, uint32_t number)
{
    int columns = pass->tile / BLOCK_WIDTH;
    return (TileGrid){
        .rect = pass_tile_rect(pass, number),
        .size = pass->tile,
        .columns = columns,
        .column_bits = __builtin_ctz((unsigned)columns),
        .fused = pass->fused,
        .reversed = pass->reversed,
        .depth_format = pass->depth_format,
    };
}

static __attribute__((noinline)) void render_tile(const TileJob *job, uint32_t number,
                                                  Scratch *scratch)
{
    const Pass *pass = job->pass;
    PassCounts *counts = &job->counts[number];
    *counts = (PassCounts){0};
    Tile tile = {
        .pass = pass,
        .scratch = scratch,
        .grid = tile_grid(pass, number),
        .counts = counts,
        .equal = pass->desc->depth_func == DEPTH_LEQUAL,
        .one_by_one = pass->desc->peel_test == PEEL_TEST_RAW || pass->desc->bias > 0.0f,
    };
    tile.far = grid_key(&tile.grid, depth_key_far(pass->depth_format, pass->desc->depth_range));
    list_begin(pass, false, number, scratch->triangles[0], &tile.opaque);
    list_begin(pass, true, number, scratch->triangles[1], &tile.transparent);
    clear_tile(&tile);
    draw_opaque(&tile);
    job->peels[number] = peel_tile(job, &tile);
    if (job->dry)
        return;
    count_tile(job, &tile, job->peels[number]);
    light_opaque(&tile);
    resolve_tile(job, &tile);
}

/* ---- the frame ---- */

/* The worker's arrays in one block of memory, each at a multiple of 64 bytes. Returns its size;
 * base NULL: only that. */
static size_t scratch_layout(int tile_size, unsigned char *base, Scratch *out)
{
    size_t pixels = (size_t)tile_size * (size_t)tile_size, at = 0;
    const struct {
        void **array;
        size_t bytes;
    } parts[] = {
        {(void **)&out->opaque_key, pixels * sizeof *out->opaque_key},
        {(void **)&out->opaque_index, pixels * sizeof *out->opaque_index},
        {(void **)&out->previous, pixels * sizeof *out->previous},
        {(void **)&out->fragments, pixels * sizeof *out->fragments},
        {(void **)&out->remaining, pixels * sizeof *out->remaining},
        {(void **)&out->layers, pixels * 2 * LAYERS * sizeof *out->layers},
        {(void **)&out->used, pixels / LANES},
        {(void **)&out->accum, pixels * 16},
        {(void **)&out->triangles[0], TRIANGLES * sizeof *out->triangles[0]},
        {(void **)&out->triangles[1], TRIANGLES * sizeof *out->triangles[1]},
        {(void **)&out->cache, sizeof *out->cache},
    };
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        if (base)
            *parts[i].array = base + at;
        at += (parts[i].bytes + 63) / 64 * 64;
    }
    return at + 64;
}

static Result scratch_create(int tile_size, Scratch *out)
{
    out->memory = memory_array(1, scratch_layout(tile_size, NULL, out));
    if (!out->memory)
        return RESULT_NO_MEMORY;
    scratch_layout(tile_size, (unsigned char *)out->memory + (64 - (uintptr_t)out->memory % 64),
                   out);
    return RESULT_OK;
}

static Result tile_task(void *context, uint32_t number, int worker)
{
    const TileJob *job = context;
    Scratch *scratch = &job->scratch[worker];
    Result result = scratch->memory ? RESULT_OK : scratch_create(job->pass->tile, scratch);
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
    job->limit = render_desc_pass_limit(pass->desc);
    if (pass->desc->peel_test == PEEL_TEST_RAW && pass->desc->passes == 0) {
        job->dry = true;
        result = pool_run(pass->pool, pass->tile_count, tile_task, job);
        job->dry = false;
        job->limit = most_peels(job) > 0 ? most_peels(job) : 1; /* fragments are counted anyway */
    }
    if (result == RESULT_OK)
        result = pool_run(pass->pool, pass->tile_count, tile_task, job);
    return result;
}

Result TILE_RENDER(Pass *pass, Frame *frame)
{
    int workers = pool_threads(pass->pool);
    TileJob job = {.pass = pass, .frame = frame};
    Scratch none;
    Result result = pass_reserve(pass, (uint64_t)workers * scratch_layout(pass->tile, NULL, &none));
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
        frame->geometry_passes = pass_geometry_passes(pass, frame->peels);
    }
    for (int i = 0; job.scratch && i < workers; i++)
        free(job.scratch[i].memory);
    free(job.scratch);
    free(job.counts);
    free(job.peels);
    return result;
}
