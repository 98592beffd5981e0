#include "ref/pipeline/setup.h"

static int64_t cross(int32_t ax, int32_t by, int32_t bx, int32_t ay)
{
    return (int64_t)((uint64_t)((int64_t)ax * by) - (uint64_t)((int64_t)bx * ay));
}

static int64_t snapped_area(const Vertex *const v[3])
{
    return cross(setup_difference(v[0]->x_fixed8, v[1]->x_fixed8),
                 setup_difference(v[2]->y_fixed8, v[0]->y_fixed8),
                 setup_difference(v[2]->x_fixed8, v[0]->x_fixed8),
                 setup_difference(v[0]->y_fixed8, v[1]->y_fixed8));
}

Facing setup_facing(const Vertex *const corners[3], bool flipped)
{
    int64_t area = snapped_area(corners);
    if (area == 0)
        return FACING_NONE;
    return (area < 0) != flipped ? FACING_FRONT : FACING_BACK;
}

bool setup_is_wide(const Vertex *const corners[3])
{
    bool wide = false;
    for (int i = 0; i < 3; i++) {
        Edge edge = setup_edge(corners[i], corners[(i + 1) % 3]);
        wide |= setup_step_is_wide(edge.a) || setup_step_is_wide(edge.b);
    }
    return wide;
}

static int minimum(int a, int b)
{
    return a < b ? a : b;
}

static int maximum(int a, int b)
{
    return a > b ? a : b;
}

PixelRect setup_bounds(const Vertex *const corners[3], int width, int height)
{
    int x_low = minimum(minimum(corners[0]->x_fixed8, corners[1]->x_fixed8), corners[2]->x_fixed8);
    int y_low = minimum(minimum(corners[0]->y_fixed8, corners[1]->y_fixed8), corners[2]->y_fixed8);
    int x_high = maximum(maximum(corners[0]->x_fixed8, corners[1]->x_fixed8), corners[2]->x_fixed8);
    int y_high = maximum(maximum(corners[0]->y_fixed8, corners[1]->y_fixed8), corners[2]->y_fixed8);
    /* The fill rule never gives a triangle the pixels on its greatest coordinate. */
    return (PixelRect){
        (int16_t)minimum(maximum(x_low >> 8, 0), width),
        (int16_t)minimum(maximum(y_low >> 8, 0), height),
        (int16_t)maximum(minimum(setup_difference(x_high, 1) >> 8, width - 1), -1),
        (int16_t)maximum(minimum(setup_difference(y_high, 1) >> 8, height - 1), -1),
    };
}

void setup_triangle(const Vertex *const corners[3], bool flipped, int width, int height, Setup *out)
{
    PixelRect box = setup_bounds(corners, width, height);
    if (setup_is_wide(corners) && box.x0 <= box.x1 && box.y0 <= box.y1)
        box = wide_bounds(box, width, height);
    setup_make(corners, snapped_area(corners) < 0, flipped, box, out);
}

void setup_visit_wide(const Setup *setup, PixelRect rect, SetupVisit visit, void *context)
{
    Wide wide;
    wide_make(setup, &wide);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++)
            if (wide_covers(&wide, x, y))
                visit(context, setup, x, y);
}
