#include "scene/teapot.h"

#include "scene/shapes.h"

#include <math.h>
#include <string.h>

/* The published data have z up, the axis of revolution at x = y = 0, the base at z = 0. */
#define SOURCE_HEIGHT 3.15
#define HEIGHT        1.2

/* One control point of a profile, revolved about the axis: radius and height; bulge is the
 * middle control points' offset of the quarter circle, 0.56 radii but for the knob. */
typedef struct Profile {
    double radius, bulge, height;
} Profile;

/* Cubic profiles from the inside of the lip down to the foot, and from the knob to the lid's edge;
 * each starts where the one before ends, except the lid. Outside is to the left of the path. */
static const Profile profiles[6][4] = {
    {{1.4, 0.784, 2.4}, {1.3375, 0.749, 2.53125}, {1.4375, 0.805, 2.53125}, {1.5, 0.84, 2.4}},
    {{1.5, 0.84, 2.4}, {1.75, 0.98, 1.875}, {2.0, 1.12, 1.35}, {2.0, 1.12, 0.9}},
    {{2.0, 1.12, 0.9}, {2.0, 1.12, 0.45}, {1.5, 0.84, 0.225}, {1.5, 0.84, 0.15}},
    {{1.5, 0.84, 0.15}, {1.5, 0.84, 0.075}, {1.425, 0.798, 0.0}, {0.0, 0.0, 0.0}},
    {{0.0, 0.0, 3.15}, {0.8, 0.45, 3.15}, {0.0, 0.0, 2.85}, {0.2, 0.112, 2.7}},
    {{0.2, 0.112, 2.7}, {0.4, 0.224, 2.55}, {1.3, 0.728, 2.55}, {1.3, 0.728, 2.4}},
};

/* One control section of a tube in the plane y = 0: from (x0, z0) through the side, `width` away,
 * to (x1, z1), and back on the other side. */
typedef struct Section {
    double x0, z0, x1, z1, width;
} Section;

/* Two cubic pieces each, sharing the middle section: handle from top to bottom, spout outward. */
static const Section tubes[2][7] = {
    {{-1.6, 2.025, -1.5, 2.25, 0.3},
     {-2.3, 2.025, -2.5, 2.25, 0.3},
     {-2.7, 2.025, -3.0, 2.25, 0.3},
     {-2.7, 1.8, -3.0, 1.8, 0.3},
     {-2.7, 1.575, -3.0, 1.35, 0.3},
     {-2.5, 1.125, -2.65, 0.9375, 0.3},
     {-2.0, 0.9, -1.9, 0.6, 0.3}},
    {{1.7, 1.425, 1.7, 0.6, 0.66},
     {2.6, 1.425, 3.1, 0.825, 0.66},
     {2.3, 2.1, 2.4, 2.025, 0.25},
     {2.7, 2.4, 3.3, 2.4, 0.25},
     {2.8, 2.475, 3.525, 2.49375, 0.25},
     {2.9, 2.475, 3.45, 2.5125, 0.15},
     {2.8, 2.4, 3.2, 2.4, 0.15}},
};

/* Control points by [along][around]; the normal is ∂around × ∂along. */
typedef struct Patch {
    double point[4][4][3];
    uint32_t around, along; /* subdivisions */
} Patch;

enum {
    PATCHES = 6 * 4 + 2 * 2 * 2
};
enum {
    AROUND = 12,
    ALONG = 12,
    ALONG_TUBE = 13
};

/* A quarter turn clockwise seen from above, `turns` times: exact. */
static void turn(double point[3], int turns)
{
    for (int i = 0; i < turns; i++) {
        double x = point[0];
        point[0] = point[1];
        point[1] = -x;
    }
}

static Patch revolved_patch(const Profile profile[4], int quadrant)
{
    Patch patch = {.around = AROUND, .along = ALONG};
    for (int j = 0; j < 4; j++) {
        double r = profile[j].radius, b = profile[j].bulge, z = profile[j].height;
        const double row[4][3] = {{r, 0.0, z}, {r, -b, z}, {b, -r, z}, {0.0, -r, z}};
        memcpy(patch.point[j], row, sizeof row);
        for (int k = 0; k < 4; k++)
            turn(patch.point[j][k], quadrant);
    }
    return patch;
}

/* mirrored: the half with y > 0, its section run through backwards to keep the orientation. */
static Patch tube_patch(const Section section[4], bool mirrored)
{
    Patch patch = {.around = AROUND, .along = ALONG_TUBE};
    for (int j = 0; j < 4; j++) {
        const Section *s = &section[j];
        double y = mirrored ? s->width : -s->width;
        const double row[4][3] = {
            {s->x0, 0.0, s->z0}, {s->x0, y, s->z0}, {s->x1, y, s->z1}, {s->x1, 0.0, s->z1}};
        for (int k = 0; k < 4; k++)
            memcpy(patch.point[j][k], row[mirrored ? 3 - k : k], sizeof row[0]);
    }
    return patch;
}

/* Bernstein polynomials of degree 3 and their first derivatives; exact at 0 and 1, so that
 * neighbouring patches meet in the same bits. */
static void bernstein(double t, double value[4], double slope[4])
{
    double s = 1.0 - t;
    value[0] = s * s * s;
    value[1] = 3.0 * s * s * t;
    value[2] = 3.0 * s * t * t;
    value[3] = t * t * t;
    slope[0] = -3.0 * s * s;
    slope[1] = 3.0 * s * s - 6.0 * s * t;
    slope[2] = 6.0 * s * t - 3.0 * t * t;
    slope[3] = 3.0 * t * t;
}

static void combine(const Patch *patch, const double along[4], const double around[4],
                    double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = 0.0;
        for (int j = 0; j < 4; j++) {
            double row = 0.0;
            for (int k = 0; k < 4; k++)
                row += around[k] * patch->point[j][k][i];
            out[i] += along[j] * row;
        }
    }
}

static double cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
    return sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
}

/* Position and unit normal at (along, around) in [0, 1]². Where a whole row of control points
 * collapses, ∂around vanishes and the limit of the normal comes from the mixed derivative, with
 * the sign of the side that the surface lies on. */
static void evaluate(const Patch *patch, double along, double around, double position[3],
                     double normal[3])
{
    double va[4], sa[4], vr[4], sr[4], d_along[3], d_around[3];
    bernstein(along, va, sa);
    bernstein(around, vr, sr);
    combine(patch, va, vr, position);
    combine(patch, sa, vr, d_along);
    combine(patch, va, sr, d_around);
    double length = cross(d_around, d_along, normal);
    if (length < 1e-9) {
        double mixed[3];
        combine(patch, sa, sr, mixed);
        length = cross(mixed, d_along, normal);
        if (along > 0.5)
            length = -length;
    }
    for (int i = 0; i < 3; i++)
        normal[i] /= length;
}

/* The vertex equal to the one at (position, normal), or a new one. A crease keeps its vertices
 * apart: normals within about 2° are the same. */
static uint32_t share_vertex(Mesh *mesh, const float position[3], const float normal[3])
{
    for (uint32_t v = mesh->vertex_count; v-- > 0;) {
        const float *p = mesh->position + 3 * (size_t)v, *n = mesh->normal + 3 * (size_t)v;
        if (p[0] == position[0] && p[1] == position[1] && p[2] == position[2] &&
            n[0] * normal[0] + n[1] * normal[1] + n[2] * normal[2] > 0.9995f)
            return v;
    }
    memcpy(mesh->position + 3 * (size_t)mesh->vertex_count, position, 3 * sizeof(float));
    memcpy(mesh->normal + 3 * (size_t)mesh->vertex_count, normal, 3 * sizeof(float));
    return mesh->vertex_count++;
}

/* The patch's vertex at grid point (i along, k around), brought to y up and our size. */
static uint32_t grid_vertex(Mesh *mesh, const Patch *patch, uint32_t i, uint32_t k)
{
    double position[3], normal[3];
    const double scale = HEIGHT / SOURCE_HEIGHT;
    evaluate(patch, (double)i / patch->along, (double)k / patch->around, position, normal);
    /* Adding 0 turns −0 into +0: one spelling for what the seams share. */
    const float p[3] = {(float)(position[0] * scale + 0.0), (float)(position[2] * scale + 0.0),
                        (float)(0.0 - position[1] * scale)};
    const float n[3] = {(float)(normal[0] + 0.0), (float)(normal[2] + 0.0),
                        (float)(0.0 - normal[1])};
    return share_vertex(mesh, p, n);
}

static void add_triangle(Mesh *mesh, uint32_t a, uint32_t b, uint32_t c)
{
    if (a == b || b == c || c == a)
        return; /* collapsed at a pole */
    uint32_t *index = mesh->index + 3 * (size_t)mesh->triangle_count++;
    index[0] = a;
    index[1] = b;
    index[2] = c;
}

static void tessellate(Mesh *mesh, const Patch *patch)
{
    uint32_t grid[ALONG_TUBE + 1][AROUND + 1];
    for (uint32_t i = 0; i <= patch->along; i++)
        for (uint32_t k = 0; k <= patch->around; k++)
            grid[i][k] = grid_vertex(mesh, patch, i, k);
    for (uint32_t i = 0; i < patch->along; i++)
        for (uint32_t k = 0; k < patch->around; k++) {
            add_triangle(mesh, grid[i][k], grid[i][k + 1], grid[i + 1][k + 1]);
            add_triangle(mesh, grid[i][k], grid[i + 1][k + 1], grid[i + 1][k]);
        }
}

Result teapot_mesh(Mesh *out)
{
    Result result = shapes_allocate(PATCHES * (AROUND + 1) * (ALONG_TUBE + 1),
                                    PATCHES * 2 * AROUND * ALONG_TUBE, out);
    if (result)
        return result;
    out->vertex_count = out->triangle_count = 0;
    for (int p = 0; p < 6; p++)
        for (int quadrant = 0; quadrant < 4; quadrant++) {
            Patch patch = revolved_patch(profiles[p], quadrant);
            tessellate(out, &patch);
        }
    for (int t = 0; t < 2; t++)
        for (int piece = 0; piece < 2; piece++)
            for (int mirrored = 0; mirrored < 2; mirrored++) {
                Patch patch = tube_patch(tubes[t] + 3 * piece, mirrored);
                tessellate(out, &patch);
            }
    return RESULT_OK;
}
