#include "ref/truth/single_fan.h"

#define U BOUNDED_SINGLE

/* Window coordinates are relative to the pixel's centre. */
typedef struct Piece {
    SingleCorner corner[3];
    double area_least;  /* of the stored corners, doubled; 0: it may be none */
    double weight[3];   /* |barycentric weights| of the pixel, at most */
    double area_factor; /* relative error of the rounded area's inverse */
    /* |differences| of the stored corners, at most: 0 less 1, 2 less 0 */
    double dx01, dy01, dx20, dy20;
    double rounding_w, least_w; /* error of the plane of 1/w, and how little it may be */
} Piece;

/* What a plane's rounding depends on: a scalar's stored values at the corners. */
typedef struct PlaneInput {
    double value[3], all[3]; /* and their errors, spread included */
    double off_plane[3];     /* of the stored values from the exact plane at the stored corners */
    double slope_x, slope_y; /* |gradient| of the exact plane, at most */
    double at;               /* |value| of the exact plane at the pixel, at most */
} PlaneInput;

/* ---- a piece --------------------------------------------------------------------------------- */

/* |a − b| of the stored corners at most. */
static double apart(double a, double a_error, double b, double b_error)
{
    return (fabs(a - b) + a_error + b_error) * BOUNDED_SLACK +
           4.0 * BOUNDED_DOUBLE * (fabs(a) + fabs(b));
}

static void set_piece(Piece *piece)
{
    const SingleCorner *c = piece->corner;
    double error, whole = single_area(c, 0.0, &error);
    piece->area_least = fabs(whole) - error > 0.0 ? fabs(whole) - error : 0.0;
    for (int i = 0; i < 3; i++) {
        double value = single_edge(c, i, 0.0, &error);
        piece->weight[i] = (fabs(value) + error) / piece->area_least;
    }
    piece->dx01 = apart(c[0].x, c[0].all_x, c[1].x, c[1].all_x);
    piece->dy01 = apart(c[0].y, c[0].all_y, c[1].y, c[1].all_y);
    piece->dx20 = apart(c[2].x, c[2].all_x, c[0].x, c[0].all_x);
    piece->dy20 = apart(c[2].y, c[2].all_y, c[0].y, c[0].all_y);
    /* Two differences, a product and the subtraction; then the division. */
    double products = piece->dx01 * piece->dy20 + piece->dy01 * piece->dx20;
    double relative =
        U * (4.001 * products / piece->area_least) + 2.0 * BOUNDED_TINY / piece->area_least;
    relative += 1.001 * U;
    piece->area_factor = relative < 0.5 ? relative / (1.0 - relative) : (double)INFINITY;
}

/* ---- planes ---------------------------------------------------------------------------------- */

/* How far the evaluated plane may be from the one through the stored corners. The error of the
 * inverse area scales the whole rise from corner 0 to the pixel; all other errors of the gradients
 * count over the distance to it, because the origin is taken back through the same gradients. */
static double plane_rounding(const SingleViewport *viewport, const Piece *piece,
                             const SinglePixel *pixel, const PlaneInput *in)
{
    const SingleCorner *c = piece->corner;
    double d01 = apart(in->value[0], in->all[0], in->value[1], in->all[1]);
    double d20 = apart(in->value[2], in->all[2], in->value[0], in->all[0]);
    double inverse = (1.0 + piece->area_factor) / piece->area_least;
    double sum_x = inverse * (d01 * piece->dy20 + d20 * piece->dy01) + 2.0 * BOUNDED_TINY;
    double sum_y = inverse * (d20 * piece->dx01 + d01 * piece->dx20) + 2.0 * BOUNDED_TINY;
    /* d01, dy20 and its product with the inverse, the product of both, the subtraction. */
    double error_x = 5.001 * U * sum_x, error_y = 5.001 * U * sum_y;
    /* The gradients as they come out. */
    const double *off = in->off_plane;
    double slope_x = in->slope_x + error_x + piece->area_factor * sum_x +
                     inverse * ((off[0] + off[1]) * piece->dy20 + (off[2] + off[0]) * piece->dy01);
    double slope_y = in->slope_y + error_y + piece->area_factor * sum_y +
                     inverse * ((off[2] + off[0]) * piece->dx01 + (off[0] + off[1]) * piece->dx20);
    slope_x = slope_x < sum_x ? slope_x : sum_x * 1.001;
    slope_y = slope_y < sum_y ? slope_y : sum_y * 1.001;
    double to_x = fabs(c[0].x) + c[0].all_x, to_y = fabs(c[0].y) + c[0].all_y;
    double from_x = fabs(c[0].x + pixel->x) + c[0].all_x; /* x_origin: window less 0.5 */
    double from_y = fabs(c[0].y + pixel->y) + c[0].all_y;
    double start = fabs(in->value[0]) + in->all[0];
    double back_x = slope_x * from_x, back_y = slope_y * from_y;
    double forth_x = slope_x * pixel->x, forth_y = slope_y * pixel->y;
    double off_most = off[0] > off[1] ? off[0] : off[1];
    off_most = off_most > off[2] ? off_most : off[2];
    double at = in->at + off_most * (piece->weight[0] + piece->weight[1] + piece->weight[2]);
    double rise = piece->weight[1] * d01 + piece->weight[2] * d20;
    double error = piece->area_factor * rise + error_x * to_x + error_y * to_y;
    /* x_origin's rounding, the products, their sum; then the origin's own. */
    error += U * 3.001 * (back_x + back_y);
    error += U * 1.001 * (start + back_x + back_y);
    /* The two multiply-adds. */
    error += U * 1.001 * (at + forth_y) + U * 1.001 * at + U * error;
    if (!viewport->fused)
        error += U * 1.001 * (forth_x + forth_y);
    error += BOUNDED_TINY * (8.0 + to_x + to_y + from_x + from_y);
    double largest = start + d01 + d20 + sum_x + sum_y + back_x + back_y + forth_x + forth_y;
    if (!(largest <= 0.5 * (double)FLT_MAX))
        return (double)INFINITY;
    return error * (1.0 + 0x1p-20);
}

/* Sum over the corners of |weight|·error. */
static double mixed(const Piece *piece, const double error[3])
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++)
        sum += piece->weight[i] * error[i];
    return sum * BOUNDED_SLACK;
}

/* ---- gradients ------------------------------------------------------------------------------- */

static Bounded slope(const SinglePixel *pixel, const Bounded cofactor[3], const Bounded at[3])
{
    Bounded sum = bounded_of(0.0);
    for (int i = 0; i < 3; i++)
        sum = bounded_add(sum, bounded_mul(at[i], cofactor[i]));
    return bounded_div(sum, pixel->determinant);
}

static double most(Bounded b)
{
    return fabs(b.value) + b.exact;
}

/* A value computed in double from floats by a few operations. */
static Bounded exactly(double value, double error)
{
    return (Bounded){value, error, 0.0};
}

/* ---- the errors ------------------------------------------------------------------------------ */

/* The plane of 1/w: its error at the pixel, and how little it may be there. */
static double inverse_w_rounding(const SingleViewport *viewport, const Piece *piece,
                                 const SinglePixel *pixel, double *least)
{
    PlaneInput in = {
        .slope_x = pixel->inverse_w_x, .slope_y = pixel->inverse_w_y, .at = most(pixel->inverse_w)};
    for (int i = 0; i < 3; i++) {
        const SingleCorner *c = &piece->corner[i];
        in.value[i] = c->g;
        in.all[i] = c->all_g;
        in.off_plane[i] = c->dev_g + in.slope_x * c->dev_x + in.slope_y * c->dev_y;
    }
    double rounding = plane_rounding(viewport, piece, pixel, &in);
    *least =
        pixel->inverse_w.value - pixel->inverse_w.exact - mixed(piece, in.off_plane) - rounding;
    return rounding;
}

/* Of component k, whose exact value at the pixel is r: M = attribute/w − r/w vanishes at the pixel,
 * so that only distances from its plane count. */
static double varying_error(const SingleTriangle *triangle, const Piece *piece,
                            const SinglePixel *pixel, int k, Bounded r)
{
    Bounded at[3];
    for (int i = 0; i < 3; i++) {
        const SingleVertex *v = &triangle->vertex[i];
        at[i] = exactly(v->value[k] - r.value,
                        v->spread[k] + 2.0 * BOUNDED_DOUBLE * (fabs(v->value[k]) + fabs(r.value)));
    }
    double m_x = most(slope(pixel, pixel->cofactor_x, at)) + r.exact * pixel->inverse_w_x;
    double m_y = most(slope(pixel, pixel->cofactor_y, at)) + r.exact * pixel->inverse_w_y;
    double size = most(r), least = piece->least_w, apart_from_m[3];
    PlaneInput in = {.slope_x = m_x + size * pixel->inverse_w_x,
                     .slope_y = m_y + size * pixel->inverse_w_y,
                     .at = size * most(pixel->inverse_w)};
    for (int i = 0; i < 3; i++) {
        const SingleCorner *c = &piece->corner[i];
        const SingleVertex *v = c->vertex;
        double a = fabs(v->value[k]), a_all = v->dev[k] + v->spread[k];
        double rounded = 1.001 * U * (a + a_all) * c->g_most + BOUNDED_TINY;
        double from_r = fabs(v->value[k] - r.value) + v->spread[k] + r.exact;
        double dev_m = v->dev[k] * c->g_most + from_r * c->dev_g + rounded;
        apart_from_m[i] = dev_m + m_x * c->dev_x + m_y * c->dev_y;
        in.value[i] = v->value[k] * c->g;
        in.all[i] = bounded_product_error(a, a_all, c->g, c->all_g) + rounded;
        in.off_plane[i] = v->dev[k] * c->g_most + (a + v->spread[k]) * c->dev_g + rounded +
                          in.slope_x * c->dev_x + in.slope_y * c->dev_y;
    }
    double error = mixed(piece, apart_from_m) +
                   plane_rounding(&triangle->viewport, piece, pixel, &in) +
                   size * piece->rounding_w;
    if (!(least > BOUNDED_TINY))
        return (double)INFINITY;
    error = error / least;
    error += 2.001 * U * (size + error) + BOUNDED_TINY * (1.0 + 1.0 / least);
    if (!(size + error <= 0.5 * (double)FLT_MAX))
        return (double)INFINITY;
    return bounded_limit((error + r.exact) * (1.0 + 0x1p-20));
}

static double depth_error(const SingleTriangle *triangle, const Piece *piece,
                          const SinglePixel *pixel, Bounded depth)
{
    const SingleViewport *viewport = &triangle->viewport;
    Bounded at[3];
    double scale = viewport->scale[2], translate = viewport->translate[2];
    for (int i = 0; i < 3; i++) {
        const SingleVertex *v = &triangle->vertex[i];
        double value = scale * v->value[2] + (translate - depth.value) * v->value[3];
        double size = fabs(v->value[2]) + 2.0 * fabs(v->value[3]);
        at[i] = exactly(value, v->spread[2] + 2.0 * v->spread[3] + depth.exact * size +
                                   8.0 * BOUNDED_DOUBLE * size);
    }
    PlaneInput in = {.slope_x = most(slope(pixel, pixel->cofactor_x, at)),
                     .slope_y = most(slope(pixel, pixel->cofactor_y, at)),
                     .at = most(depth)};
    for (int i = 0; i < 3; i++) {
        const SingleCorner *c = &piece->corner[i];
        in.value[i] = c->z;
        in.all[i] = c->all_z;
        in.off_plane[i] = c->dev_z + in.slope_x * c->dev_x + in.slope_y * c->dev_y;
    }
    double error = mixed(piece, in.off_plane) + plane_rounding(viewport, piece, pixel, &in);
    return bounded_limit((error + depth.exact) * (1.0 + 0x1p-20));
}

static void raise(double *greatest, double error)
{
    if (!(error <= *greatest))
        *greatest = bounded_limit(error);
}

typedef struct Errors {
    bool any;     /* a piece may cover the pixel */
    bool unknown; /* nothing can be said of one */
    double component[SINGLE_COMPONENTS], depth;
    bool facing_certain;
} Errors;

static void add_turned(const SingleTriangle *triangle, const SinglePixel *pixel, Piece *piece,
                       int used, const Bounded *attribute, const Bounded *depth, Errors *errors)
{
    set_piece(piece);
    if (!(piece->area_least > 0.0)) {
        errors->unknown = true;
        return;
    }
    piece->rounding_w = inverse_w_rounding(&triangle->viewport, piece, pixel, &piece->least_w);
    for (int k = SINGLE_POSITION; k < used; k++)
        raise(&errors->component[k], varying_error(triangle, piece, pixel, k, attribute[k]));
    if (depth)
        raise(&errors->depth, depth_error(triangle, piece, pixel, *depth));
}

static void swap_corners(Piece *piece)
{
    SingleCorner first = piece->corner[0];
    piece->corner[0] = piece->corner[1];
    piece->corner[1] = first;
}

/* The pipeline exchanges the first two corners of a counter-clockwise piece. Where snapping may
 * decide which way it is turned, both count. */
static void add_piece(const SingleTriangle *triangle, const SinglePixel *pixel, Piece *piece,
                      int used, const Bounded *attribute, const Bounded *depth, Errors *errors)
{
    double error, whole = single_area(piece->corner, SINGLE_SNAP, &error);
    bool certain = fabs(whole) > error;
    errors->facing_certain &= certain;
    if (!certain || whole < 0.0)
        add_turned(triangle, pixel, piece, used, attribute, depth, errors);
    if (!certain || whole > 0.0) {
        swap_corners(piece);
        add_turned(triangle, pixel, piece, used, attribute, depth, errors);
    }
}

/* Adds what may cover the pixel of one polygon. */
static void add_fan(const SingleTriangle *triangle, const SinglePixel *pixel, const SingleFan *fan,
                    int used, const Bounded *attribute, const Bounded *depth, Errors *errors)
{
    SingleCorner corners[SINGLE_CORNERS_MAX];
    if (!fan->known) {
        errors->unknown = true;
        return;
    }
    single_set_corners(fan, pixel, corners);
    for (int i = 2; i < fan->polygon.count; i++) {
        Piece piece;
        single_piece(&fan->polygon, corners, i, piece.corner);
        if (fan->polygon.count > 3 && !single_may_cover(piece.corner))
            continue;
        errors->any = true;
        add_piece(triangle, pixel, &piece, used, attribute, depth, errors);
    }
}

void single_errors(const SingleTriangle *triangle, const SinglePixel *pixel, int used,
                   Bounded attribute[SINGLE_COMPONENTS], Bounded *depth, bool *facing_certain)
{
    Errors errors = {.facing_certain = true};
    FanWalk walk;
    single_begin_walk(&walk);
    for (const SingleFan *fan; !errors.unknown && (fan = single_next_fan(triangle, &walk));)
        add_fan(triangle, pixel, fan, used, attribute, depth, &errors);
    bool known = errors.any && !errors.unknown;
    for (int k = SINGLE_POSITION; k < used; k++)
        attribute[k].single = known ? errors.component[k] : (double)INFINITY;
    if (depth)
        depth->single = known ? errors.depth : (double)INFINITY;
    *facing_certain = errors.facing_certain && !errors.unknown;
}
