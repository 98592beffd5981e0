#include "ref/pipeline/wide.h"

#include "ref/pipeline/setup.h"

/* Source: Mesa 22.3, src/gallium/drivers/llvmpipe: lp_setup_tri.c, lp_rast_tri_tmp.h. Sums and
 * products wrap as the driver's do. */
enum {
    TILE = 64, /* pixels a side */
    BITS = 8,  /* behind the binary point of what is snapped */
    BLOCKS = 4 /* a side, of a tile and of a block of 16 pixels */
};

static int32_t wrap(uint64_t value)
{
    return (int32_t)(uint32_t)value;
}

static int32_t add(int32_t a, int32_t b)
{
    return wrap((uint64_t)(uint32_t)a + (uint32_t)b);
}

static int32_t negative(int32_t a)
{
    return wrap(0 - (uint64_t)(uint32_t)a);
}

static int32_t multiply(int32_t a, int b)
{
    return wrap((uint64_t)(uint32_t)a * (uint32_t)b);
}

/* The next number below. */
static int64_t below(int64_t a)
{
    return (int64_t)((uint64_t)a - 1);
}

static int32_t shifted(int64_t a)
{
    return wrap((uint64_t)(a >> BITS));
}

/* ---- setup ---------------------------------------------------------------------------------- */

PixelRect wide_bounds(PixelRect box, int width, int height)
{
    int x1 = box.x1 | (TILE - 1), y1 = box.y1 | (TILE - 1);
    return (PixelRect){(int16_t)(box.x0 & ~(TILE - 1)), (int16_t)(box.y0 & ~(TILE - 1)),
                       (int16_t)(x1 < width ? x1 : width - 1),
                       (int16_t)(y1 < height ? y1 : height - 1)};
}

static WidePlane make_plane(const Edge *edge)
{
    WidePlane plane = {
        .c = edge->c, .dx = wrap((uint64_t)edge->a << BITS), .dy = wrap((uint64_t)edge->b << BITS)};
    /* By the signs that there were before scaling. */
    plane.reach = (edge->b < 0 ? 0 : (uint32_t)plane.dy) - (edge->a < 0 ? (uint32_t)plane.dx : 0);
    return plane;
}

/* Whether the pixels from the least to the greatest coordinate, but the negative, are in a tile. */
static bool within_tile(int32_t a, int32_t b, int32_t c)
{
    int32_t low = a < b ? a : b, high = a < b ? b : a;
    low = (c < low ? c : low) >> BITS;
    high = setup_difference(c > high ? c : high, 1) >> BITS;
    return ((low > 0 ? low : 0) ^ high) < TILE;
}

void wide_make(const Setup *setup, Wide *out)
{
    const Vertex *const *v = setup->corner;
    PixelRect box = setup->box;
    for (int i = 0; i < 3; i++)
        out->planes[i] = make_plane(&setup->edge[i]);
    out->tiles = (PixelRect){(int16_t)(box.x0 / TILE), (int16_t)(box.y0 / TILE),
                             (int16_t)(box.x1 / TILE), (int16_t)(box.y1 / TILE)};
    out->alone = within_tile(v[0]->x_fixed8, v[1]->x_fixed8, v[2]->x_fixed8) &&
                 within_tile(v[0]->y_fixed8, v[1]->y_fixed8, v[2]->y_fixed8);
}

/* ---- tiles ---------------------------------------------------------------------------------- */

static int64_t plane_at_pixel(const WidePlane *plane, int x, int y)
{
    return (int64_t)((uint64_t)plane->c + (uint64_t)((int64_t)plane->dy * y) -
                     (uint64_t)((int64_t)plane->dx * x));
}

enum {
    ALL_PLANES = 7,
    TILE_OUTSIDE = -1 /* else a bit for each plane that may cut the tile */
};

static int judge_tile(const Wide *wide, int column, int row)
{
    int cut = 0;
    for (int i = 0; i < 3; i++) {
        const WidePlane *plane = &wide->planes[i];
        uint64_t at = (uint64_t)plane_at_pixel(plane, column * TILE, row * TILE);
        uint64_t inside = (uint64_t)add(plane->dy, negative(plane->dx)) - plane->reach;
        if ((int64_t)(at + TILE * (uint64_t)plane->reach) < 0)
            return TILE_OUTSIDE;
        cut |= (int64_t)(at + TILE * inside - 1) < 0 ? 1 << i : 0;
    }
    return cut;
}

/* Of a row of tiles the driver looks at none behind those that it has left. */
static int tile_planes(const Wide *wide, int column, int row)
{
    if (column < wide->tiles.x0 || column > wide->tiles.x1 || row < wide->tiles.y0 ||
        row > wide->tiles.y1)
        return TILE_OUTSIDE;
    if (wide->alone)
        return ALL_PLANES;
    bool entered = false;
    for (int i = wide->tiles.x0; i < column; i++) {
        bool outside = judge_tile(wide, i, row) == TILE_OUTSIDE;
        if (entered && outside)
            return TILE_OUTSIDE;
        entered |= !outside;
    }
    return judge_tile(wide, column, row);
}

/* ---- blocks of a tile ----------------------------------------------------------------------- */

typedef enum Block {
    BLOCK_OUTSIDE,
    BLOCK_CUT,
    BLOCK_INSIDE
} Block;

/* Bit i of a mask: block or pixel i, row by row, of the 4x4 whose first has this value. */
static unsigned negative_values(int32_t first, int32_t dx, int32_t dy)
{
    unsigned mask = 0;
    for (int i = 0; i < BLOCKS * BLOCKS; i++)
        if (add(first, add(multiply(dx, i % BLOCKS), multiply(dy, i / BLOCKS))) < 0)
            mask |= 1u << i;
    return mask;
}

/* What block i is, of the 4x4 blocks of `size` pixels a side from pixel (x, y). */
static Block judge_block(const Wide *wide, int planes, int size, int x, int y, int i)
{
    unsigned outside = 0, cut = 0;
    for (int p = 0; p < 3; p++) {
        if (!(planes >> p & 1))
            continue;
        const WidePlane *plane = &wide->planes[p];
        int64_t at = plane_at_pixel(plane, x, y);
        int32_t dx = negative(plane->dx) >> BITS, dy = plane->dy >> BITS,
                reach = (int32_t)(plane->reach >> BITS);
        int32_t inside = multiply(add(add(dy, dx), -reach), size);
        int32_t value = shifted(at), less = shifted(below(at));
        reach = multiply(reach, size);
        int32_t most = add(value, reach),
                least = add(most, add(add(inside, negative(reach)), add(less, negative(value))));
        dx = multiply(dx, size);
        dy = multiply(dy, size);
        outside |= negative_values(most, dx, dy);
        cut |= negative_values(least, dx, dy);
    }
    if (outside == 0xffff)
        return BLOCK_OUTSIDE; /* whatever cut says */
    if (!(cut >> i & 1))
        return BLOCK_INSIDE;
    return outside >> i & 1 ? BLOCK_OUTSIDE : BLOCK_CUT;
}

static bool covers_pixel(const Wide *wide, int planes, int x, int y)
{
    int32_t i = y % BLOCKS * BLOCKS + x % BLOCKS;
    for (int p = 0; p < 3; p++) {
        if (!(planes >> p & 1))
            continue;
        const WidePlane *plane = &wide->planes[p];
        int64_t at = below(plane_at_pixel(plane, x - x % BLOCKS, y - y % BLOCKS));
        unsigned outside =
            negative_values(shifted(at), negative(plane->dx) >> BITS, plane->dy >> BITS);
        if (outside >> i & 1)
            return false;
    }
    return true;
}

bool wide_covers(const Wide *wide, int x, int y)
{
    int planes = tile_planes(wide, x / TILE, y / TILE);
    if (planes <= 0)
        return planes == 0;
    for (int size = TILE / BLOCKS; size > 1; size /= BLOCKS) {
        int side = BLOCKS * size, column = x % side / size, row = y % side / size;
        Block block =
            judge_block(wide, planes, size, x - x % side, y - y % side, row * BLOCKS + column);
        if (block != BLOCK_CUT)
            return block == BLOCK_INSIDE;
    }
    return covers_pixel(wide, planes, x, y);
}
