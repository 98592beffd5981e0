#include "ref/truth/bound.h"

#include "base/memory.h"
#include "frame/shading.h"
#include "ref/truth/bound_store.h"
#include "ref/truth/bound_texture.h"
#include "ref/truth/radiance_bound.h"
#include "ref/truth/single.h"

#include <stdlib.h>
#include <string.h>

enum {
    KEPT = 128 /* triangles: those of some pixels of a row, layer by layer */
};

/* The exact triangle's corners, as the truth has them (soup.c). */
typedef struct BoundedCorner {
    Bounded position[3], normal[3], uv[2];
    Bounded x, y, z, w; /* homogeneous window coordinates; z/w is the pipeline's window depth */
} BoundedCorner;

typedef struct Triangle {
    const View *view;
    const SoupDraw *draw;
    BoundedCorner corner[3];
    SingleTriangle single;
} Triangle;

struct BoundTriangles {
    const Soup *soup;
    bool fused;
    uint32_t number[KEPT]; /* of the soup */
    bool used[KEPT];
    Triangle kept[KEPT];
};

/* Where a pixel meets it. */
typedef struct Point {
    Bounded attribute[SINGLE_COMPONENTS], depth;
    bool facing_certain;
} Point;

static double largest(double a, double b)
{
    return a > b ? a : b;
}

/* ---- the exact triangle ---------------------------------------------------------------------- */

/* In the order of soup.c: from the matrix's fourth column, where there is one, or from 0. */
static void transform(const float *m, int stride, const Bounded v[3], bool point, int rows,
                      Bounded *out)
{
    for (int row = 0; row < rows; row++) {
        out[row] = bounded_of(point ? (double)m[3 * stride + row] : 0.0);
        for (int column = 0; column < 3; column++)
            out[row] =
                bounded_add(out[row], bounded_mul(bounded_of(m[stride * column + row]), v[column]));
    }
}

static BoundedCorner make_corner(const View *view, const Draw *draw, const float *position,
                                 const float *normal, const float *uv)
{
    BoundedCorner corner;
    Bounded p[3], n[3], clip[4];
    for (int i = 0; i < 3; i++) {
        p[i] = bounded_of(position[i]);
        n[i] = bounded_of(normal[i]);
    }
    transform(draw->model_view, 4, p, true, 3, corner.position);
    transform(draw->normal_matrix, 3, n, false, 3, corner.normal);
    transform(view->projection, 4, corner.position, true, 4, clip);
    for (int i = 0; i < 2; i++)
        corner.uv[i] = bounded_of(uv ? (double)uv[i] : 0.0);
    corner.x = bounded_mul(bounded_add(clip[0], clip[3]), bounded_of(0.5 * view->width));
    corner.y = bounded_mul(bounded_add(clip[1], clip[3]), bounded_of(0.5 * view->height));
    corner.w = clip[3];
    corner.z = view->depth_range == DEPTH_RANGE_GL
                   ? bounded_mul(bounded_add(clip[2], clip[3]), bounded_of(0.5))
                   : clip[2];
    return corner;
}

static void make_triangle(const Soup *soup, bool fused, uint32_t number, Triangle *out)
{
    out->view = soup->view;
    out->draw = soup_draw(soup, number);
    out->single.viewport = single_viewport(soup->view, fused);
    const Mesh *mesh = out->draw->mesh;
    const uint32_t *index = &mesh->index[(size_t)(number - out->draw->first_triangle) * 3];
    for (int i = 0; i < 3; i++) {
        const float *position = &mesh->position[3 * (size_t)index[i]];
        const float *normal = &mesh->normal[3 * (size_t)index[i]];
        const float *uv = mesh->uv ? &mesh->uv[2 * (size_t)index[i]] : NULL;
        out->corner[i] = make_corner(soup->view, out->draw->draw, position, normal, uv);
        single_vertex(soup->view, out->draw->draw, position, normal, uv, &out->single.vertex[i]);
    }
    single_clipped(&out->single);
}

size_t bound_triangles_bytes(void)
{
    return sizeof(BoundTriangles);
}

BoundTriangles *bound_triangles_create(const Soup *soup, bool fused)
{
    BoundTriangles *triangles = memory_array(1, sizeof *triangles);
    if (triangles) {
        triangles->soup = soup;
        triangles->fused = fused;
    }
    return triangles;
}

void bound_triangles_destroy(BoundTriangles *triangles)
{
    free(triangles);
}

static const Triangle *find_triangle(BoundTriangles *triangles, uint32_t number)
{
    uint32_t place = number % KEPT;
    Triangle *kept = &triangles->kept[place];
    if (!triangles->used[place] || triangles->number[place] != number) {
        make_triangle(triangles->soup, triangles->fused, number, kept);
        triangles->number[place] = number;
        triangles->used[place] = true;
    }
    return kept;
}

/* p0 + (w1·(p1 − p0) + w2·(p2 − p0)) */
static Bounded mix(const Bounded weight[3], Bounded p0, Bounded p1, Bounded p2)
{
    return bounded_add(p0, bounded_add(bounded_mul(weight[1], bounded_sub(p1, p0)),
                                       bounded_mul(weight[2], bounded_sub(p2, p0))));
}

static Bounded sum3(const Bounded weight[3], Bounded p0, Bounded p1, Bounded p2)
{
    return bounded_add(bounded_add(bounded_mul(weight[0], p0), bounded_mul(weight[1], p1)),
                       bounded_mul(weight[2], p2));
}

/* a·d − b·c */
static Bounded cross(Bounded a, Bounded d, Bounded b, Bounded c)
{
    return bounded_sub(bounded_mul(a, d), bounded_mul(b, c));
}

/* Perspective-correct weights at the pixel's centre, as exact.c has them, and gradients. */
static void set_pixel(const Triangle *triangle, int x, int y, Bounded weight[3], SinglePixel *out)
{
    const BoundedCorner *c = triangle->corner;
    Bounded dx[3], dy[3], edge[3];
    for (int i = 0; i < 3; i++) {
        dx[i] = bounded_sub(c[i].x, bounded_mul(bounded_of(x + 0.5), c[i].w));
        dy[i] = bounded_sub(c[i].y, bounded_mul(bounded_of(y + 0.5), c[i].w));
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        edge[i] = cross(dx[j], dy[k], dx[k], dy[j]);
        out->cofactor_x[i] = cross(dy[j], c[k].w, dy[k], c[j].w);
        out->cofactor_y[i] = cross(dx[k], c[j].w, dx[j], c[k].w);
    }
    Bounded sum = bounded_add(bounded_add(edge[0], edge[1]), edge[2]);
    for (int i = 0; i < 3; i++)
        weight[i] = bounded_div(edge[i], sum);
    out->x = x;
    out->y = y;
    out->determinant = sum3(edge, c[0].w, c[1].w, c[2].w);
    Bounded ones[2] = {bounded_of(0.0), bounded_of(0.0)};
    for (int i = 0; i < 3; i++) {
        ones[0] = bounded_add(ones[0], out->cofactor_x[i]);
        ones[1] = bounded_add(ones[1], out->cofactor_y[i]);
    }
    Bounded slope_x = bounded_div(ones[0], out->determinant);
    Bounded slope_y = bounded_div(ones[1], out->determinant);
    out->inverse_w_x = fabs(slope_x.value) + slope_x.exact;
    out->inverse_w_y = fabs(slope_y.value) + slope_y.exact;
    out->inverse_w = bounded_div(bounded_of(1.0), mix(weight, c[0].w, c[1].w, c[2].w));
}

static void unknown(Bounded *x)
{
    x->exact = x->single = (double)INFINITY;
}

/* used: SingleVertex's components whose errors are wanted end there. */
static Point find_point(const Triangle *triangle, int used, bool has_depth, int x, int y,
                        SinglePixel *pixel)
{
    const BoundedCorner *c = triangle->corner;
    Point point;
    Bounded weight[3], *at = point.attribute;
    set_pixel(triangle, x, y, weight, pixel);
    for (int i = 0; i < 3; i++) {
        at[SINGLE_POSITION + i] =
            sum3(weight, c[0].position[i], c[1].position[i], c[2].position[i]);
        at[SINGLE_NORMAL + i] = sum3(weight, c[0].normal[i], c[1].normal[i], c[2].normal[i]);
    }
    for (int i = 0; i < 2; i++)
        at[SINGLE_UV + i] = mix(weight, c[0].uv[i], c[1].uv[i], c[2].uv[i]);
    point.depth = bounded_mul(mix(weight, c[0].z, c[1].z, c[2].z), pixel->inverse_w);
    /* Where the plane has no depth the truth takes a nearby point (exact.h). */
    if (!(pixel->inverse_w.value > pixel->inverse_w.exact)) {
        for (int i = 0; i < SINGLE_COMPONENTS; i++)
            unknown(&at[i]);
        unknown(&point.depth);
        point.facing_certain = false;
        return point;
    }
    single_errors(&triangle->single, pixel, used, at, has_depth ? &point.depth : NULL,
                  &point.facing_certain);
    return point;
}

static void set_range(double value, double error, double range[2])
{
    bool known = isfinite(error);
    range[0] = known ? value - error : -(double)INFINITY;
    range[1] = known ? value + error : (double)INFINITY;
}

void bound_fragment(BoundTriangles *triangles, const RenderDesc *desc, uint32_t triangle, int x,
                    int y, BoundFragment *out)
{
    const Triangle *exact = find_triangle(triangles, triangle);
    SinglePixel pixel;
    Point point = find_point(exact, SINGLE_POSITION, true, x, y, &pixel);
    SingleCover cover = single_cover(&exact->single, &pixel);
    const Draw *draw = exact->draw->draw;
    bool kept = !draw->masked && (point.facing_certain || !draw->cull_back);
    out->possible = cover.possible;
    out->certain = cover.certain && kept;
    set_range(point.depth.value, point.depth.exact, out->exact);
    Bounded stored = bound_store_depth(render_desc_depth(desc), point.depth);
    set_range(stored.value, stored.single, out->stored);
}

bool bound_may_repeat(BoundTriangles *triangles, uint32_t triangle, int x, int y)
{
    const Triangle *exact = find_triangle(triangles, triangle);
    Bounded weight[3];
    SinglePixel pixel;
    set_pixel(exact, x, y, weight, &pixel);
    return single_may_overlap(&exact->single, &pixel);
}

/* ---- the surface ----------------------------------------------------------------------------- */

static void store_surface(const View *view, const RenderDesc *desc, Bounded depth, int x, int y,
                          BoundedSurface *surface)
{
    GBufferLayout layout = render_desc_layout(desc);
    for (int i = 0; i < 3; i++) {
        if (layout.position != FORMAT_NONE)
            surface->position[i] = bound_store(layout.position, surface->position[i]);
        if (layout.normal != FORMAT_RG16)
            surface->normal[i] = bound_store(layout.normal, surface->normal[i]);
    }
    if (layout.normal == FORMAT_RG16)
        bound_store_octahedral(surface->normal);
    if (layout.position == FORMAT_NONE)
        bound_unproject(&view->unprojection, bound_store_depth(render_desc_depth(desc), depth), x,
                        y, surface->position);
    for (int i = 0; i < 4; i++)
        surface->diffuse[i] = bound_store(layout.diffuse, surface->diffuse[i]);
    surface->roughness = bound_store(layout.material, surface->roughness);
    surface->metallic = bound_store(layout.material, surface->metallic);
    surface->occlusion = bound_store(layout.material, surface->occlusion);
}

/* Of what is not of length 1 the distribution's two forms are not the same, and the truth has the
 * other one. */
static bool may_be_short(const Bounded normal[3])
{
    Bounded length2 = bounded_dot(normal, normal);
    return length2.value - largest(length2.exact, length2.single) <= (double)SHADING_TINY;
}

void bound_surface(BoundTriangles *triangles, const RenderDesc *desc, const Fragment *fragment,
                   int x, int y, BoundedSurface *surface)
{
    const Soup *soup = triangles->soup;
    const Triangle *triangle = find_triangle(triangles, fragment->triangle);
    const Material *material = triangle->draw->material;
    bool textured = material->base_color_texture || material->metallic_roughness_texture;
    bool forward = desc->method == METHOD_FORWARD;
    bool from_depth = !forward && render_desc_layout(desc).position == FORMAT_NONE;
    SinglePixel pixel;
    Point point =
        find_point(triangle, textured ? SINGLE_COMPONENTS : SINGLE_UV, from_depth, x, y, &pixel);
    bool faced = desc->normals == NORMALS_FACED, turned = faced && fragment->back;
    Bounded normal[3];
    for (int i = 0; i < 3; i++) {
        surface->position[i] = point.attribute[SINGLE_POSITION + i];
        normal[i] = point.attribute[SINGLE_NORMAL + i];
        if (turned)
            normal[i] = bounded_neg(normal[i]);
        if (faced && !point.facing_certain)
            normal[i].single += 2.0 * fabs(normal[i].value);
    }
    radiance_normalize_bound(normal, surface->normal);
    for (int i = 0; i < 3 && desc->ggx == GGX_STABLE && may_be_short(normal); i++)
        unknown(&surface->normal[i]);
    bound_material(soup->textures, material, &point.attribute[SINGLE_UV], surface);
    if (!triangle->draw->draw->transparent)
        surface->diffuse[3] = bounded_of(1.0);
    if (!forward)
        store_surface(soup->view, desc, point.depth, x, y, surface);
}

/* ---- blending -------------------------------------------------------------------------------- */

/* What single precision has may be this, too. */
static void may_be(Bounded other, Bounded *x)
{
    x->single = largest(x->single, other.single + fabs(other.value - x->value));
}

/* A fragment that the alpha test may or may not discard: its whole contribution is in doubt. */
static void doubt(const Bounded before[4], Bounded rgba[4])
{
    for (int i = 0; i < 4; i++) {
        double change = fabs(rgba[i].value - before[i].value);
        rgba[i].exact = largest(rgba[i].exact, before[i].exact + change);
        may_be(before[i], &rgba[i]);
    }
}

/* A forward method does not shade what is not opaque enough, but stores its alpha, which may be
 * rounded to more and be blended. */
static void blend_unshaded(const RenderDesc *desc, Bounded alpha, Bounded rgba[4])
{
    Bounded source[4] = {bounded_of(0.0), bounded_of(0.0), bounded_of(0.0),
                         bound_store(render_desc_layout(desc).diffuse, alpha)};
    Bounded blended[4];
    if (source[3].value + source[3].single <= (double)SHADING_ALPHA_TEST)
        return;
    memcpy(blended, rgba, sizeof blended);
    bound_blend_under(desc->accum, source, blended);
    for (int i = 0; i < 4; i++)
        may_be(blended[i], &rgba[i]);
}

void bound_blend(BoundTriangles *triangles, const RenderDesc *desc, const Fragment *fragment, int x,
                 int y, Bounded rgba[4])
{
    const Soup *soup = triangles->soup;
    bool transparent = soup_draw(soup, fragment->triangle)->draw->transparent;
    BoundedForm form = {desc->shading, desc->ggx, desc->back_light && transparent};
    BoundedSurface surface;
    bound_surface(triangles, desc, fragment, x, y, &surface);
    const double test = (double)SHADING_ALPHA_TEST;
    Bounded alpha = surface.diffuse[3], source[4], before[4];
    double error = largest(alpha.exact, alpha.single);
    bool forward = desc->method == METHOD_FORWARD;
    if (alpha.value + error <= test) {
        if (forward)
            blend_unshaded(desc, alpha, rgba);
        return;
    }
    radiance_shade_bound(soup->view, &surface, form, source);
    GBufferLayout layout = render_desc_layout(desc);
    for (int i = 0; i < 4; i++) {
        source[i] = i < 3 ? bounded_mul(source[i], alpha) : alpha;
        if (forward)
            source[i] = bound_store(layout.diffuse, source[i]);
        before[i] = rgba[i];
    }
    bound_blend_under(desc->accum, source, rgba);
    if (!transparent && desc->opaque_blend == OPAQUE_BLEND_SEED)
        rgba[3] = bounded_of(0.0); /* whatever is there, the resolve takes it so */
    if (alpha.value - error <= test)
        doubt(before, rgba);
    /* A forward method tests again what it stored. */
    for (int i = 0; i < 4 && forward && source[3].value - source[3].single <= test; i++)
        may_be(before[i], &rgba[i]);
}

void bound_resolve(const View *view, PixelFormat accum, Bounded rgba[4])
{
    /* A fetch multiplies an integer by the rounded inverse of the greatest. */
    if (format_info(accum)->kind == KIND_UNORM)
        for (int i = 0; i < 4; i++)
            rgba[i].single += rgba[i].value || rgba[i].single ? 4.0 * BOUNDED_SINGLE : 0.0;
    for (int i = 0; i < 3; i++)
        rgba[i] = bounded_add(rgba[i], bounded_mul(bounded_of(view->background[i]), rgba[3]));
    rgba[3] = bounded_sub(bounded_of(1.0), rgba[3]);
}
