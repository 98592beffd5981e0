#include "ref/truth/single_fan.h"

#define U BOUNDED_SINGLE

/* ---- window coordinates ---------------------------------------------------------------------- */

/* scale·(c/w) + translate: errors of the stored one from that of the exact point (dev), and from
 * that at value. least: |w| is not less in any of them. */
static double window(const SingleViewport *viewport, const SingleVertex *v, int axis, double least,
                     double *dev, double *all)
{
    double scale = viewport->scale[axis], translate = viewport->translate[axis];
    double c = v->value[axis], value = scale * (c / v->value[3]) + translate;
    double ratio = (fabs(c) + v->dev[axis] + v->spread[axis]) / least;
    double error = (v->dev[axis] + ratio * v->dev[3]) / least + 2.001 * U * ratio + BOUNDED_TINY;
    double moved = (v->spread[axis] + ratio * v->spread[3]) / least;
    if (v->cut || !viewport->fused)
        error += 1.001 * U * ratio + BOUNDED_TINY;
    error *= scale;
    moved = moved * scale + 8.0 * BOUNDED_DOUBLE * (scale * ratio + translate);
    error += 1.001 * U * (fabs(value) + error + moved) + BOUNDED_TINY;
    *dev = error * BOUNDED_SLACK;
    *all = (error + moved) * BOUNDED_SLACK;
    return value;
}

static bool set_corner(const SingleViewport *viewport, const SingleVertex *v, SingleCorner *out)
{
    double w = v->value[3], least = w - v->dev[3] - v->spread[3];
    if (!(least > BOUNDED_TINY))
        return false;
    out->vertex = v;
    out->x = window(viewport, v, 0, least, &out->dev_x, &out->all_x);
    out->y = window(viewport, v, 1, least, &out->dev_y, &out->all_y);
    out->z = window(viewport, v, 2, least, &out->dev_z, &out->all_z);
    out->g = 1.0 / w;
    out->dev_g = (v->dev[3] / least + 1.001 * U) / least + BOUNDED_TINY;
    out->all_g = out->dev_g + (v->spread[3] / least + 4.0 * BOUNDED_DOUBLE) / least;
    out->g_most = out->g + out->all_g;
    return true;
}

/* ---- coverage of a piece --------------------------------------------------------------------- */

double single_edge(const SingleCorner c[3], int i, double moved, double *error)
{
    const SingleCorner *j = &c[(i + 1) % 3], *k = &c[(i + 2) % 3];
    *error = bounded_product_error(j->x, j->all_x + moved, k->y, k->all_y + moved) +
             bounded_product_error(k->x, k->all_x + moved, j->y, j->all_y + moved);
    *error += 4.0 * BOUNDED_DOUBLE * (fabs(j->x * k->y) + fabs(k->x * j->y));
    return j->x * k->y - k->x * j->y;
}

double single_area(const SingleCorner c[3], double moved, double *error)
{
    double x1 = c[1].x - c[0].x, y1 = c[1].y - c[0].y, x2 = c[2].x - c[0].x, y2 = c[2].y - c[0].y;
    double m2 = 2.0 * moved, tiny = 8.0 * BOUNDED_DOUBLE;
    double e_x1 = c[1].all_x + c[0].all_x + m2 + tiny * (fabs(c[1].x) + fabs(c[0].x));
    double e_y1 = c[1].all_y + c[0].all_y + m2 + tiny * (fabs(c[1].y) + fabs(c[0].y));
    double e_x2 = c[2].all_x + c[0].all_x + m2 + tiny * (fabs(c[2].x) + fabs(c[0].x));
    double e_y2 = c[2].all_y + c[0].all_y + m2 + tiny * (fabs(c[2].y) + fabs(c[0].y));
    *error = bounded_product_error(x1, e_x1, y2, e_y2) + bounded_product_error(x2, e_x2, y1, e_y1);
    return x1 * y2 - x2 * y1;
}

bool single_may_cover(const SingleCorner c[3])
{
    double area_error, whole = single_area(c, SINGLE_SNAP, &area_error);
    if (!(fabs(whole) > area_error))
        return true; /* either orientation */
    for (int i = 0; i < 3; i++) {
        double error, value = single_edge(c, i, SINGLE_SNAP, &error);
        if ((whole < 0.0 ? -value : value) < -error)
            return false;
    }
    return true;
}

/* ---- what clipping leaves -------------------------------------------------------------------- */

void single_set_corners(const SingleFan *fan, const SinglePixel *pixel,
                        SingleCorner corners[SINGLE_CORNERS_MAX])
{
    for (int i = 0; i < fan->polygon.count; i++) {
        corners[i] = fan->corner[i];
        corners[i].x -= pixel->x + 0.5;
        corners[i].y -= pixel->y + 0.5;
    }
}

void single_piece(const SinglePolygon *polygon, const SingleCorner *corners, int i,
                  SingleCorner out[3])
{
    out[0] = polygon->whole ? corners[0] : corners[i - 1];
    out[1] = polygon->whole ? corners[1] : corners[i];
    out[2] = polygon->whole ? corners[2] : corners[0];
}

/* The next combination of decisions: the last that was not yet taken the other way. False: there is
 * none. */
static bool next_choices(int decisions, unsigned *choices)
{
    while (decisions > 0 && *choices >> (decisions - 1) & 1)
        *choices &= ~(1u << --decisions);
    if (decisions > 0)
        *choices |= 1u << (decisions - 1);
    return decisions > 0;
}

static void make_fan(const SingleTriangle *triangle, unsigned choices, SingleFan *out)
{
    const SingleViewport *viewport = &triangle->viewport;
    SinglePolygon *polygon = &out->polygon;
    out->decisions = single_clip(viewport, triangle->vertex, choices, polygon);
    out->known = out->decisions <= SINGLE_DECISIONS_MAX;
    for (int i = 0; i < polygon->count && out->known; i++)
        out->known = set_corner(viewport, &polygon->corner[i], &out->corner[i]);
}

void single_clipped(SingleTriangle *triangle)
{
    unsigned choices = 0;
    int decisions;
    triangle->kept = 0;
    do {
        SingleFan *fan = &triangle->fan[triangle->kept++];
        make_fan(triangle, choices, fan);
        decisions = fan->decisions;
    } while (triangle->kept < SINGLE_KEPT && decisions <= SINGLE_DECISIONS_MAX &&
             next_choices(decisions, &choices));
}

/* Only this: `made` is large, and seldom used. */
void single_begin_walk(FanWalk *walk)
{
    walk->choices = 0;
    walk->count = 0;
}

const SingleFan *single_next_fan(const SingleTriangle *triangle, FanWalk *walk)
{
    if (walk->count > 0 &&
        (walk->decisions > SINGLE_DECISIONS_MAX || !next_choices(walk->decisions, &walk->choices)))
        return NULL;
    const SingleFan *fan = &walk->made;
    if (walk->count < triangle->kept)
        fan = &triangle->fan[walk->count];
    else
        make_fan(triangle, walk->choices, &walk->made);
    walk->count++;
    walk->decisions = fan->decisions;
    return fan;
}

/* ---- coverage of a triangle ------------------------------------------------------------------ */

/* Whether the centre lies within the convex polygon however its corners are snapped, and so in a
 * piece of its fan, whose inner edges two pieces share. */
static bool must_cover(const SingleCorner *corners, int count)
{
    int side = 0;
    for (int i = 0; i < count; i++) {
        const SingleCorner ends[3] = {corners[i], corners[i], corners[(i + 1) % count]};
        double error, value = single_edge(ends, 0, SINGLE_SNAP, &error);
        int here = value > error ? 1 : value < -error ? -1 : 0;
        if (here == 0 || (i > 0 && here != side))
            return false;
        side = here;
    }
    return count >= 3;
}

static bool piece_may_cover(const SinglePolygon *polygon, const SingleCorner *corners, int i)
{
    SingleCorner piece[3];
    single_piece(polygon, corners, i, piece);
    return single_may_cover(piece);
}

SingleCover single_cover(const SingleTriangle *triangle, const SinglePixel *pixel)
{
    SingleCover cover = {.possible = false, .certain = true};
    FanWalk walk;
    single_begin_walk(&walk);
    const SingleFan *fan;
    while ((!cover.possible || cover.certain) && (fan = single_next_fan(triangle, &walk))) {
        SingleCorner corners[SINGLE_CORNERS_MAX];
        const SinglePolygon *polygon = &fan->polygon;
        if (!fan->known)
            return (SingleCover){.possible = true};
        single_set_corners(fan, pixel, corners);
        for (int i = 2; i < polygon->count && !cover.possible; i++)
            cover.possible = piece_may_cover(polygon, corners, i);
        cover.certain = cover.certain && must_cover(corners, polygon->count);
    }
    return cover;
}

bool single_may_overlap(const SingleTriangle *triangle, const SinglePixel *pixel)
{
    FanWalk walk;
    single_begin_walk(&walk);
    for (const SingleFan *fan; (fan = single_next_fan(triangle, &walk));) {
        SingleCorner corners[SINGLE_CORNERS_MAX];
        int covering = 0;
        if (!fan->known)
            return true;
        single_set_corners(fan, pixel, corners);
        for (int i = 2; i < fan->polygon.count; i++)
            covering += piece_may_cover(&fan->polygon, corners, i);
        if (covering > 1)
            return true;
    }
    return false;
}
