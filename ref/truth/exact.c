#include "ref/truth/exact.h"

#include <math.h>

/* Whether the edge from corner j to corner k owns its pixels, in a triangle of the given
 * orientation (+1 or −1): its function grows to the right, or straight up. */
static bool edge_owns(const Corner *j, const Corner *k, double orientation)
{
    double per_x = orientation * (j->y * k->w - k->y * j->w);
    double per_y = orientation * (k->x * j->w - j->x * k->w);
    return per_x > 0.0 || (per_x == 0.0 && per_y >= 0.0);
}

static bool edges_contain(const Corner *const corners[3], const double edge[3], double orientation)
{
    for (int i = 0; i < 3; i++) {
        double e = orientation * edge[i];
        if (e < 0.0)
            return false;
        if (e == 0.0 && !edge_owns(corners[(i + 1) % 3], corners[(i + 2) % 3], orientation))
            return false;
    }
    return true;
}

/* Mixes relative to corner 0, so that equal values stay exactly equal: planes parallel to the
 * screen tie bit for bit. */
static double mix(const double weight[3], double p0, double p1, double p2)
{
    return p0 + (weight[1] * (p1 - p0) + weight[2] * (p2 - p0));
}

/* The weights of a point of the triangle near the one asked for. */
static void clamp_weights(double weight[3])
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        weight[i] = weight[i] > 0.0 ? weight[i] : 0.0; /* NaN becomes 0 */
        weight[i] = weight[i] < 1.0 ? weight[i] : 1.0;
        sum += weight[i];
    }
    for (int i = 0; i < 3; i++)
        weight[i] = sum > 0.0 ? weight[i] / sum : 1.0 / 3.0;
}

/* The three edge functions at the pixel's centre, and their sum. */
static double edges_at(const Corner *const corners[3], int x, int y, double edge[3])
{
    /* Corners relative to the pixel first: this keeps the edge functions of small triangles from
     * cancelling. */
    double dx[3], dy[3];
    for (int i = 0; i < 3; i++) {
        dx[i] = corners[i]->x - ((double)x + 0.5) * corners[i]->w;
        dy[i] = corners[i]->y - ((double)y + 0.5) * corners[i]->w;
    }
    edge[0] = dx[1] * dy[2] - dx[2] * dy[1];
    edge[1] = dx[2] * dy[0] - dx[0] * dy[2];
    edge[2] = dx[0] * dy[1] - dx[1] * dy[0];
    return edge[0] + edge[1] + edge[2];
}

static double clamp_depth(double depth)
{
    depth = depth < 1.0 ? depth : 1.0; /* NaN becomes 1, as in a depth buffer */
    return depth > 0.0 ? depth : 0.0;
}

/* Mixes a triangle's nearby point into weight and returns its depth. */
static double nearby(const Corner *const corners[3], double weight[3])
{
    clamp_weights(weight);
    double z = mix(weight, corners[0]->z, corners[1]->z, corners[2]->z);
    double w = mix(weight, corners[0]->w, corners[1]->w, corners[2]->w);
    return clamp_depth(z / w * 0.5 + 0.5);
}

double exact_nearby_depth(const Corner *const corners[3], int x, int y)
{
    double edge[3], weight[3];
    double sum = edges_at(corners, x, y, edge);
    for (int i = 0; i < 3; i++)
        weight[i] = sum != 0.0 ? edge[i] / sum : 0.0;
    return nearby(corners, weight);
}

void exact_at(const Corner *const corners[3], int x, int y, ExactPoint *out)
{
    double sum = edges_at(corners, x, y, out->edge);
    out->clockwise = sum < 0.0;
    for (int i = 0; i < 3; i++)
        out->weight[i] = sum != 0.0 ? out->edge[i] / sum : 0.0;

    double z = mix(out->weight, corners[0]->z, corners[1]->z, corners[2]->z);
    double w = mix(out->weight, corners[0]->w, corners[1]->w, corners[2]->w);
    bool usable = sum != 0.0 && w > 0.0 && w <= 1e300;
    out->inside = usable && -w <= z && z <= w &&
                  edges_contain(corners, out->edge, out->clockwise ? -1.0 : 1.0);
    out->plane = usable ? z / w * 0.5 + 0.5 : NAN;
    out->depth = usable ? clamp_depth(out->plane) : nearby(corners, out->weight);
}
