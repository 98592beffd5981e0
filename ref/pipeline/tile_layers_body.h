/* The tile path's geometry passes: a tile's triangles, set up once, its opaque depths, and the
 * layers of its transparent fragments, sorted by insertion. */
#ifndef PEEL_REF_TILE_LAYERS_BODY_H
#define PEEL_REF_TILE_LAYERS_BODY_H

#include "ref/pipeline/fragment.h"
#include "ref/pipeline/tile_light_body.h"
#include "ref/pipeline/tile_raster_body.h"

enum {
    /* Of a round. With 1, peel after peel, a frame takes 1.6 times the instructions (teapot_hall)
     * and 2.4 times (teapot_hall_stress; 1920x1080, one light, AVX2, by callgrind). */
    LAYERS = 16,
    TRIANGLES = 1024 /* of a list that are set up at a time */
};
#define KEY_NONE    INT32_MAX /* of a layer without a fragment: behind every depth */
#define KEY_OUTSIDE INT32_MIN /* the opaque key of a pixel outside the image: hides everything */

/* One list's triangles in the tile. */
typedef struct TileList {
    const PrimitiveList *list;
    const uint32_t *items;
    size_t count;
    TileTriangle *triangles; /* TRIANGLES */
    uint32_t made;           /* of them, that cover something */
    bool resident;           /* all are in triangles: layers name them, not items of the list */
    bool ready;              /* made */
} TileList;

/* One worker's memory; arrays have an entry per pixel of a tile, block by block. */
typedef struct Scratch {
    void *memory;
    int32_t *opaque_key, *opaque_index;
    int32_t *previous;    /* key of the last layer of the round before */
    int32_t *fragments;   /* transparent, in front of the opaque one */
    int32_t *remaining;   /* behind the last layer */
    int32_t *layers;      /* per block, per layer: LANES keys, LANES indices */
    uint8_t *used;        /* layers of a block that have a fragment */
    unsigned char *accum; /* 16 bytes a pixel; RGBA32F: per block, LANES of each channel */
    TileTriangle *triangles[2];
    PlanesCache *cache;
    uint32_t lists_done; /* numbers the lists of all tiles, for tags */
} Scratch;

typedef struct Tile {
    const Pass *pass;
    Scratch *scratch;
    TileGrid grid;
    TileList opaque, transparent;
    PassCounts *counts;
    int32_t far;     /* the key that a depth buffer is cleared to */
    int32_t equal;   /* 1: of equal depths the last drawn stays */
    int capacity;    /* layers of a round */
    bool one_by_one; /* the peel test asks for the layer before */
    bool later;      /* not the first round */
    bool overflowed; /* a fragment found no layer */
} Tile;

/* ---- triangles ---- */

static inline void list_begin(const Pass *pass, bool transparent, uint32_t number,
                              TileTriangle *triangles, TileList *out)
{
    const Bins *bins = transparent ? &pass->transparent_bins : &pass->opaque_bins;
    *out = (TileList){
        .list = transparent ? &pass->geometry.transparent : &pass->geometry.opaque,
        .items = bins->item + bins->first[number],
        .count = bins->first[number + 1] - bins->first[number],
        .triangles = triangles,
    };
    out->resident = out->count <= TRIANGLES;
}

static __attribute__((noinline)) void set_up(const Tile *tile, TileList *list, size_t from)
{
    size_t end = list->count - from < TRIANGLES ? list->count : from + TRIANGLES;
    list->made = 0;
    for (size_t i = from; i < end; i++) {
        TileTriangle *triangle = &list->triangles[list->made];
        const Primitive *primitive = &list->list->items[list->items[i]];
        pass_setup(tile->pass, primitive, &triangle->setup);
        triangle->item = list->items[i];
        triangle->masked = tile->pass->view.draws[primitive->draw].masked;
        list->made += reduce_triangle(&tile->grid, triangle);
    }
    list->ready = list->resident;
}

/* Calls visit for every covered block of every triangle, in draw order. Inlined with visit. */
TILE_INLINE void draw(Tile *tile, TileList *list, BlockVisit visit)
{
    for (size_t from = 0; from < list->count; from += TRIANGLES) {
        if (!list->ready)
            set_up(tile, list, from);
        for (uint32_t i = 0; i < list->made; i++) {
            const TileTriangle *triangle = &list->triangles[i];
            int32_t index = list->resident ? (int32_t)i : (int32_t)triangle->item;
            raster_triangle(&tile->grid, triangle, index, visit, tile);
        }
    }
}

/* ---- geometry passes ---- */

/* Leaves out the lanes that the alpha mask discards. */
static __attribute__((noinline)) uint32_t
without_masked(const Tile *tile, const TileTriangle *triangle, int block, uint32_t bits)
{
    const Primitive *primitive = &tile->opaque.list->items[triangle->item];
    uint32_t kept = 0;
    for (; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits), pixel = block * LANES + lane;
        if (!fragment_masked(tile->pass, &triangle->setup, primitive,
                             grid_pixel_x(&tile->grid, pixel), grid_pixel_y(&tile->grid, pixel)))
            kept |= 1u << lane;
    }
    return kept;
}

/* Lanes whose key is nearer than the one they are tested against: a < b, or a ≤ b where the last
 * drawn of equal depths stays. */
TILE_INLINE LanesMask nearer(const Tile *tile, LanesInt a, LanesInt b)
{
    return lanes_int_less(lanes_int_sub(a, lanes_int_all(tile->equal)), b);
}

TILE_INLINE void visit_opaque(void *context, const TileTriangle *triangle, int32_t index, int block,
                              LanesMask covered, Lanes z)
{
    Tile *tile = context;
    int32_t *keys = tile->scratch->opaque_key + block * LANES;
    int32_t *indices = tile->scratch->opaque_index + block * LANES;
    LanesInt key = block_key(&tile->grid, z), stored = lanes_int_load(keys);
    LanesMask kept = lanes_mask_and(covered, nearer(tile, key, stored));
    if (triangle->masked)
        kept = lanes_mask_from_bits(without_masked(tile, triangle, block, lanes_mask_bits(kept)));
    lanes_int_store(keys, lanes_int_select(kept, key, stored));
    lanes_int_store(indices, lanes_int_select(kept, lanes_int_all(index), lanes_int_load(indices)));
}

/* Lanes that pass_hidden and, in later rounds, pass_peeled let pass, by the definition. */
static __attribute__((noinline)) uint32_t
visible_one_by_one(const Tile *tile, int block, uint32_t bits, LanesInt key, Lanes z, bool peeled)
{
    const Scratch *scratch = tile->scratch;
    int32_t keys[LANES];
    float depths[LANES];
    uint32_t visible = 0;
    lanes_int_store(keys, key);
    lanes_store(depths, z);
    for (; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits), pixel = block * LANES + lane;
        FragmentDepth depth = {depths[lane], grid_depth_key(&tile->grid, keys[lane])};
        int32_t opaque = scratch->opaque_key[pixel];
        bool hidden = opaque == KEY_OUTSIDE ||
                      pass_hidden(tile->pass, depth, grid_depth_key(&tile->grid, opaque));
        if (!hidden &&
            !(peeled && pass_peeled(tile->pass, depth,
                                    grid_depth_key(&tile->grid, scratch->previous[pixel]))))
            visible |= 1u << lane;
    }
    return visible;
}

/* Lanes in front of the opaque depth. */
TILE_INLINE LanesMask in_front(const Tile *tile, int block, LanesMask covered, LanesInt key,
                               Lanes z)
{
    if (tile->pass->desc->peel_test == PEEL_TEST_RAW)
        return lanes_mask_from_bits(
            visible_one_by_one(tile, block, lanes_mask_bits(covered), key, z, false));
    const int32_t *opaque = tile->scratch->opaque_key + block * LANES;
    return lanes_mask_and(covered, lanes_int_less(key, lanes_int_load(opaque)));
}

/* Lanes behind the layers of the rounds before. */
TILE_INLINE LanesMask behind(const Tile *tile, int block, LanesMask lanes, LanesInt key, Lanes z)
{
    if (tile->one_by_one)
        return lanes_mask_from_bits(
            visible_one_by_one(tile, block, lanes_mask_bits(lanes), key, z, true));
    const int32_t *previous = tile->scratch->previous + block * LANES;
    return lanes_mask_and(lanes, lanes_int_less(lanes_int_load(previous), key));
}

TILE_INLINE int32_t *layer_of(const Scratch *scratch, int block, int layer)
{
    return scratch->layers + ((size_t)block * LAYERS + (size_t)layer) * 2 * LANES;
}

/* Insertion sort of every lane at once. What a lane carries is its fragment until that has found
 * its place, then the layer that it pushed back. */
TILE_INLINE void insert(Tile *tile, int block, LanesMask lanes, LanesInt key, LanesInt index)
{
    Scratch *scratch = tile->scratch;
    LanesInt none = lanes_int_all(KEY_NONE);
    key = lanes_int_select(lanes, key, none);
    for (int layer = 0; layer < scratch->used[block]; layer++) {
        int32_t *at = layer_of(scratch, block, layer);
        LanesInt stored_key = lanes_int_load(at), stored_index = lanes_int_load(at + LANES);
        LanesMask equal = lanes_int_equal(key, stored_key);
        LanesMask less = lanes_int_less(key, stored_key);
        LanesInt new_index = lanes_int_select(less, index, stored_index);
        if (tile->equal)
            new_index = lanes_int_select(equal, index, new_index);
        lanes_int_store(at, lanes_int_select(less, key, stored_key));
        lanes_int_store(at + LANES, new_index);
        key = lanes_int_select(less, stored_key, lanes_int_select(equal, none, key));
        index = lanes_int_select(less, stored_index, index);
        if (lanes_mask_bits(lanes_int_less(key, none)) == 0)
            return;
    }
    if (scratch->used[block] == tile->capacity) {
        tile->overflowed = true;
        return;
    }
    int32_t *at = layer_of(scratch, block, scratch->used[block]++);
    lanes_int_store(at, key);
    lanes_int_store(at + LANES, index);
}

TILE_INLINE void visit_transparent(void *context, const TileTriangle *triangle, int32_t index,
                                   int block, LanesMask covered, Lanes z)
{
    (void)triangle;
    Tile *tile = context;
    LanesInt key = block_key(&tile->grid, z);
    LanesMask lanes = in_front(tile, block, covered, key, z);
    if (lanes_mask_bits(lanes) == 0)
        return;
    if (tile->later) {
        lanes = behind(tile, block, lanes, key, z);
        if (lanes_mask_bits(lanes) == 0)
            return;
    } else {
        int32_t *fragments = tile->scratch->fragments + block * LANES;
        LanesInt count = lanes_int_load(fragments);
        LanesInt more = lanes_int_add(count, lanes_int_all(1));
        lanes_int_store(fragments, lanes_int_select(lanes, more, count));
    }
    /* What the raw test finds in front of the opaque depth may still be stored at the far end. */
    if (tile->one_by_one)
        lanes = lanes_mask_and(lanes, nearer(tile, key, lanes_int_all(tile->far)));
    if (lanes_mask_bits(lanes))
        insert(tile, block, lanes, key, lanes_int_all(index));
}

TILE_INLINE void visit_remaining(void *context, const TileTriangle *triangle, int32_t index,
                                 int block, LanesMask covered, Lanes z)
{
    (void)triangle;
    (void)index;
    Tile *tile = context;
    LanesInt key = block_key(&tile->grid, z);
    const int32_t *previous = tile->scratch->previous + block * LANES;
    LanesMask lanes = lanes_mask_and(covered, lanes_int_less(lanes_int_load(previous), key));
    lanes = in_front(tile, block, lanes, key, z);
    if (tile->one_by_one)
        lanes = behind(tile, block, lanes, key, z);
    int32_t *remaining = tile->scratch->remaining + block * LANES;
    LanesInt count = lanes_int_load(remaining);
    LanesInt more = lanes_int_add(count, lanes_int_all(1));
    lanes_int_store(remaining, lanes_int_select(lanes, more, count));
}

static __attribute__((noinline)) void draw_opaque(Tile *tile)
{
    draw(tile, &tile->opaque, visit_opaque);
}

static __attribute__((noinline)) void draw_transparent(Tile *tile)
{
    draw(tile, &tile->transparent, visit_transparent);
}

static __attribute__((noinline)) void draw_remaining(Tile *tile)
{
    draw(tile, &tile->transparent, visit_remaining);
}

#endif
