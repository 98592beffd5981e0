/* The tile path's rasterizer: which blocks of a tile a triangle covers, and their depths.
 *
 * A tile is cut into blocks of LANES pixels, which lie together in every array of the tile: pixel
 * block · LANES + lane. Edge functions are those of setup.h, reduced without loss: with whole pixel
 * coordinates c + 256·(b·y − a·x) > 0 is ceil(c/256) − 1 + b·y − a·x ≥ 0, and an edge that does not
 * cross the tile needs no test, so that 32 bits hold the rest. */
#ifndef PEEL_REF_TILE_RASTER_BODY_H
#define PEEL_REF_TILE_RASTER_BODY_H

#include "number/lanes.h"
#include "number/op.h"
#include "ref/pipeline/pass.h"

#include <assert.h>
#include <stdlib.h>

enum {
#if LANES == 1
    BLOCK_WIDTH = 1,
#elif LANES == 4
    BLOCK_WIDTH = 2,
#else
    BLOCK_WIDTH = 4,
#endif
    BLOCK_HEIGHT = LANES / BLOCK_WIDTH
};

#define TILE_INLINE static inline __attribute__((always_inline))

/* A triangle in one tile; x and y in pixels from the tile's first. */
typedef struct TileTriangle {
    Setup setup;
    uint32_t item;   /* index in its list */
    int32_t edge[3]; /* at (0, 0); inside: edge + step_x·x + step_y·y ≥ 0 for all three */
    int32_t step_x[3], step_y[3];
    int16_t column0, row0, column1, row1; /* blocks, both ends included */
    bool masked;
} TileTriangle;

/* The pixels of a tile, and what a visit of a block needs. */
typedef struct TileGrid {
    PixelRect rect; /* window coordinates; may be cut by the image's edge */
    int size;       /* pixels per side, uncut */
    int columns;    /* of blocks; 1 << column_bits */
    int column_bits;
    bool fused, reversed;
    PixelFormat depth_format;
} TileGrid;

static inline LanesInt block_lane_x(void)
{
    int32_t x[LANES];
    for (int lane = 0; lane < LANES; lane++)
        x[lane] = lane % BLOCK_WIDTH;
    return lanes_int_load(x);
}

static inline LanesInt block_lane_y(void)
{
    int32_t y[LANES];
    for (int lane = 0; lane < LANES; lane++)
        y[lane] = lane / BLOCK_WIDTH;
    return lanes_int_load(y);
}

static inline int grid_blocks(const TileGrid *grid)
{
    return grid->columns * (grid->size / BLOCK_HEIGHT);
}

/* Window coordinates of a block's first pixel. */
static inline int grid_x(const TileGrid *grid, int block)
{
    return grid->rect.x0 + (block & (grid->columns - 1)) * BLOCK_WIDTH;
}

static inline int grid_y(const TileGrid *grid, int block)
{
    return grid->rect.y0 + (block >> grid->column_bits) * BLOCK_HEIGHT;
}

/* Of the tile's pixel with this index. */
static inline int grid_pixel_x(const TileGrid *grid, int pixel)
{
    return grid_x(grid, pixel / LANES) + pixel % LANES % BLOCK_WIDTH;
}

static inline int grid_pixel_y(const TileGrid *grid, int pixel)
{
    return grid_y(grid, pixel / LANES) + pixel % LANES / BLOCK_WIDTH;
}

static inline bool grid_inside(const TileGrid *grid, int x, int y)
{
    return x <= grid->rect.x1 && y <= grid->rect.y1;
}

/* Reduces an edge to the tile. Returns false where no pixel of it is inside. */
static inline bool reduce_edge(const TileGrid *grid, const Edge *edge, int i, TileTriangle *out)
{
    /* So that the steps of TILE_MAX pixels fit in 32 bits: see Geometry.wide. */
    assert(llabs(edge->a) <= SETUP_STEP_MAX && llabs(edge->b) <= SETUP_STEP_MAX);
    int64_t at_first =
        ((edge->c + 255) >> 8) - 1 + edge->b * grid->rect.y0 - edge->a * grid->rect.x0;
    int64_t reach = grid->size - 1, most = at_first, least = at_first;
    *(edge->a < 0 ? &most : &least) -= reach * edge->a;
    *(edge->b > 0 ? &most : &least) += reach * edge->b;
    bool crosses = least < 0;
    out->edge[i] = crosses ? (int32_t)at_first : 0;
    out->step_x[i] = crosses ? (int32_t)-edge->a : 0;
    out->step_y[i] = crosses ? (int32_t)edge->b : 0;
    return most >= 0;
}

/* From out->setup. Returns false where the triangle covers no pixel of the tile. */
static inline bool reduce_triangle(const TileGrid *grid, TileTriangle *out)
{
    const Setup *setup = &out->setup;
    const PixelRect *box = &setup->box, *rect = &grid->rect;
    int x0 = box->x0 > rect->x0 ? box->x0 : rect->x0, y0 = box->y0 > rect->y0 ? box->y0 : rect->y0;
    int x1 = box->x1 < rect->x1 ? box->x1 : rect->x1, y1 = box->y1 < rect->y1 ? box->y1 : rect->y1;
    if (x0 > x1 || y0 > y1)
        return false;
    out->column0 = (int16_t)((x0 - rect->x0) / BLOCK_WIDTH);
    out->column1 = (int16_t)((x1 - rect->x0) / BLOCK_WIDTH);
    out->row0 = (int16_t)((y0 - rect->y0) / BLOCK_HEIGHT);
    out->row1 = (int16_t)((y1 - rect->y0) / BLOCK_HEIGHT);
    for (int i = 0; i < 3; i++)
        if (!reduce_edge(grid, &setup->edge[i], i, out))
            return false;
    return true;
}

/* Window coordinates of a block's pixels, from those of its first. */
TILE_INLINE Lanes block_x(int first)
{
    return lanes_from_int(lanes_int_add(lanes_int_all(first), block_lane_x()));
}

TILE_INLINE Lanes block_y(int first)
{
    return lanes_from_int(lanes_int_add(lanes_int_all(first), block_lane_y()));
}

/* plane_at. */
TILE_INLINE Lanes block_plane(const TileGrid *grid, const Plane *plane, Lanes x, Lanes y)
{
    return lanes_muladd(
        grid->fused, lanes_all(plane->dy), y,
        lanes_muladd(grid->fused, lanes_all(plane->dx), x, lanes_all(plane->origin)));
}

/* Stored depths as integers of which the nearer is less: depth_key, mirrored where depths are. */
TILE_INLINE LanesInt block_key(const TileGrid *grid, Lanes z)
{
    Lanes stored = lanes_max(lanes_min(z, lanes_all(1.0f)), lanes_all(0.0f));
    LanesInt key;
    if (grid->depth_format == FORMAT_D24)
        key = lanes_round_to_int(lanes_mul(stored, lanes_all(16777215.0f)));
    else if (grid->depth_format == FORMAT_D16)
        key = lanes_int_and(lanes_bits(lanes_add(lanes_mul(stored, lanes_all(65535.0f / 65536.0f)),
                                                 lanes_all(128.0f))),
                            lanes_int_all(0xffff));
    else
        key = lanes_bits(stored);
    return grid->reversed ? lanes_int_sub(lanes_int_all(0), key) : key;
}

/* depth_key of one such integer, and back. */
static inline int32_t grid_key(const TileGrid *grid, uint32_t depth_key)
{
    return grid->reversed ? -(int32_t)depth_key : (int32_t)depth_key;
}

static inline uint32_t grid_depth_key(const TileGrid *grid, int32_t key)
{
    return (uint32_t)(grid->reversed ? -key : key);
}

/* What is done with a block of which some lanes are covered. index: of the triangle, as the tile's
 * layers keep it; z: gl_FragCoord.z. */
typedef void (*BlockVisit)(void *context, const TileTriangle *triangle, int32_t index, int block,
                           LanesMask covered, Lanes z);

/* Calls visit for every block that the triangle covers, row by row. Inlined with visit. */
TILE_INLINE void raster_triangle(const TileGrid *grid, const TileTriangle *triangle, int32_t index,
                                 BlockVisit visit, void *context)
{
    LanesInt lane_x = block_lane_x(), lane_y = block_lane_y(), row[3], at[3], right[3], up[3];
    for (int i = 0; i < 3; i++) {
        int32_t x = triangle->step_x[i], y = triangle->step_y[i];
        uint32_t first = (uint32_t)triangle->edge[i] +
                         (uint32_t)x * (uint32_t)(triangle->column0 * BLOCK_WIDTH) +
                         (uint32_t)y * (uint32_t)(triangle->row0 * BLOCK_HEIGHT);
        row[i] = lanes_int_add(lanes_int_all((int32_t)first),
                               lanes_int_add(lanes_int_mul(lanes_int_all(x), lane_x),
                                             lanes_int_mul(lanes_int_all(y), lane_y)));
        right[i] = lanes_int_all(x * BLOCK_WIDTH);
        up[i] = lanes_int_all(y * BLOCK_HEIGHT);
    }
    for (int by = triangle->row0; by <= triangle->row1; by++) {
        Lanes y = block_y(grid->rect.y0 + by * BLOCK_HEIGHT);
        for (int i = 0; i < 3; i++)
            at[i] = row[i];
        for (int bx = triangle->column0; bx <= triangle->column1; bx++) {
            LanesInt sign = lanes_int_or(lanes_int_or(at[0], at[1]), at[2]);
            LanesMask covered = lanes_int_less(lanes_int_all(-1), sign);
            int block = by * grid->columns + bx;
            if (lanes_mask_bits(covered)) {
                Lanes x = block_x(grid->rect.x0 + bx * BLOCK_WIDTH);
                Lanes z = block_plane(grid, &triangle->setup.depth, x, y);
                visit(context, triangle, index, block, covered, lanes_add(z, lanes_all(0.0f)));
            }
            for (int i = 0; i < 3; i++)
                at[i] = lanes_int_add(at[i], right[i]);
        }
        for (int i = 0; i < 3; i++)
            row[i] = lanes_int_add(row[i], up[i]);
    }
}

#endif
