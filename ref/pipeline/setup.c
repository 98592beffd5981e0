#include "ref/pipeline/setup.h"

/* Snapped coordinates of clipped vertices lie within the viewport (below 2^23), so every product
 * here fits; a vertex with w = 0 snaps to INT32_MIN, where the driver wraps, and so do we. */
static int32_t subtract(int32_t a, int32_t b)
{
    return (int32_t)((uint32_t)a - (uint32_t)b);
}

static int64_t cross(int32_t ax, int32_t by, int32_t bx, int32_t ay)
{
    return (int64_t)((uint64_t)((int64_t)ax * by) - (uint64_t)((int64_t)bx * ay));
}

static int64_t snapped_area(const Vertex *const v[3])
{
    return cross(subtract(v[0]->x_fixed8, v[1]->x_fixed8), subtract(v[2]->y_fixed8, v[0]->y_fixed8),
                 subtract(v[2]->x_fixed8, v[0]->x_fixed8),
                 subtract(v[0]->y_fixed8, v[1]->y_fixed8));
}

Facing setup_facing(const Vertex *const corners[3], bool flipped)
{
    int64_t area = snapped_area(corners);
    if (area == 0)
        return FACING_NONE;
    return (area < 0) != flipped ? FACING_FRONT : FACING_BACK;
}

static int minimum(int a, int b)
{
    return a < b ? a : b;
}

static int maximum(int a, int b)
{
    return a > b ? a : b;
}

PixelRect setup_bounds(const Vertex *const v[3], int width, int height)
{
    int x_low = minimum(minimum(v[0]->x_fixed8, v[1]->x_fixed8), v[2]->x_fixed8);
    int y_low = minimum(minimum(v[0]->y_fixed8, v[1]->y_fixed8), v[2]->y_fixed8);
    int x_high = maximum(maximum(v[0]->x_fixed8, v[1]->x_fixed8), v[2]->x_fixed8);
    int y_high = maximum(maximum(v[0]->y_fixed8, v[1]->y_fixed8), v[2]->y_fixed8);
    /* The fill rule never gives a triangle the pixels on its greatest coordinate. */
    return (PixelRect){
        maximum(x_low >> 8, 0),
        maximum(y_low >> 8, 0),
        minimum(subtract(x_high, 1) >> 8, width - 1),
        minimum(subtract(y_high, 1) >> 8, height - 1),
    };
}

static Edge make_edge(const Vertex *from, const Vertex *to)
{
    int64_t a = subtract(from->y_fixed8, to->y_fixed8);
    int64_t b = subtract(from->x_fixed8, to->x_fixed8);
    int64_t c = (int64_t)((uint64_t)(a * from->x_fixed8) - (uint64_t)(b * from->y_fixed8));
    if (a < 0 || (a == 0 && b >= 0))
        c++;
    return (Edge){a, b, c};
}

void setup_triangle(const Vertex *const corners[3], bool flipped, int width, int height, Setup *out)
{
    bool swap = snapped_area(corners) < 0;
    const Vertex *v0 = corners[swap ? 1 : 0], *v1 = corners[swap ? 0 : 1], *v2 = corners[2];
    out->corner[0] = v0;
    out->corner[1] = v1;
    out->corner[2] = v2;
    out->front = swap != flipped;
    out->box = setup_bounds(corners, width, height);
    for (int i = 0; i < 3; i++)
        out->edge[i] = make_edge(out->corner[i], out->corner[(i + 1) % 3]);

    float dx01 = op_sub(v0->window[0], v1->window[0]), dy01 = op_sub(v0->window[1], v1->window[1]);
    float dx20 = op_sub(v2->window[0], v0->window[0]), dy20 = op_sub(v2->window[1], v0->window[1]);
    float inverse_area = op_div(1.0f, op_sub(op_mul(dx01, dy20), op_mul(dy01, dx20)));
    out->dx01 = op_mul(dx01, inverse_area);
    out->dy01 = op_mul(dy01, inverse_area);
    out->dx20 = op_mul(dx20, inverse_area);
    out->dy20 = op_mul(dy20, inverse_area);
    out->x_origin = op_sub(v0->window[0], 0.5f);
    out->y_origin = op_sub(v0->window[1], 0.5f);
    out->depth = setup_plane(out, v0->window[2], v1->window[2], v2->window[2]);
}
