/* The tile path's geometry and lighting shaders: LANES fragments of one layer are shaded, lit and
 * blended together, those of a full block at once, those of others gathered until there are enough.
 * The operations are those of fragment.h, shade.h and blend.h. */
#ifndef PEEL_REF_TILE_LIGHT_BODY_H
#define PEEL_REF_TILE_LIGHT_BODY_H

#include "number/blend.h"
#include "number/blend_lanes.h"
#include "ref/pipeline/fragment.h"
#include "ref/pipeline/shade.h"
#include "ref/pipeline/shade_body.h"
#include "ref/pipeline/tile_raster_body.h"

enum {
    PLANES_CACHED = 1024
};

/* The planes of a triangle's varyings, over w, and of 1/w. */
typedef struct TrianglePlanes {
    float origin[VARYINGS], dx[VARYINGS], dy[VARYINGS];
    Plane inverse_w;
    int32_t surface; /* draw · 2 + whether the normal is turned */
} TrianglePlanes;

/* Planes of the triangles that were met last; a slot's tag says whose. */
typedef struct PlanesCache {
    uint64_t tag[PLANES_CACHED];
    TrianglePlanes planes[PLANES_CACHED];
} PlanesCache;

/* Fragments on their way to the lighting pass; varyings are over w. */
typedef struct Gathered {
    int count;
    float inverse_w[2 * LANES], varying[VARYINGS][2 * LANES];
    int32_t surface[2 * LANES], pixel[2 * LANES], key[2 * LANES];
} Gathered;

/* One list's lighting pass over a tile. */
typedef struct TileLight {
    const Pass *pass;
    const TileGrid *grid;
    const PrimitiveList *list;
    const TileTriangle *triangles; /* what an index of a layer names; NULL: items of the list */
    PlanesCache *cache;
    uint64_t tag; /* of this list in this tile, in the upper half */
    unsigned char *accum;
    PassCounts *counts;
    int first_varying, varyings; /* those between are needed: without lights, only uv */
    bool seed_blend;
    bool exact; /* the G-buffer keeps every bit and the position */
    ShadeForm form;
    Gathered whole, parts; /* a full block; fragments of others */
} TileLight;

/* ---- geometry pass: varyings ---- */

static __attribute__((noinline)) void make_planes(const TileLight *light, int32_t index,
                                                  TrianglePlanes *out)
{
    Setup made;
    const Setup *setup = &made;
    uint32_t item = light->triangles ? light->triangles[index].item : (uint32_t)index;
    if (light->triangles)
        setup = &light->triangles[index].setup;
    else
        pass_setup(light->pass, &light->list->items[item], &made);
    const Vertex *const *v = setup->corner;
    for (int i = 0; i < VARYINGS; i++) {
        float value[3];
        for (int k = 0; k < 3; k++)
            value[k] = op_mul(v[k]->varying[i], v[k]->window[3]);
        Plane plane = setup_plane(setup, value[0], value[1], value[2]);
        out->origin[i] = plane.origin;
        out->dx[i] = plane.dx;
        out->dy[i] = plane.dy;
    }
    out->inverse_w = setup_plane(setup, v[0]->window[3], v[1]->window[3], v[2]->window[3]);
    bool turned = light->pass->desc->normals == NORMALS_FACED && !setup->front;
    out->surface = (int32_t)(light->list->items[item].draw * 2 + turned);
}

static inline const TrianglePlanes *find_planes(TileLight *light, int32_t index)
{
    uint32_t slot = (uint32_t)index % PLANES_CACHED;
    uint64_t tag = light->tag | (uint32_t)index;
    TrianglePlanes *planes = &light->cache->planes[slot];
    if (light->cache->tag[slot] != tag) {
        make_planes(light, index, planes);
        light->cache->tag[slot] = tag;
    }
    return planes;
}

/* Varyings of a block's pixels, each of the triangle that its lane of index names. */
typedef struct BlockVaryings {
    Lanes inverse_w, varying[VARYINGS];
    LanesInt surface;
} BlockVaryings;

TILE_INLINE Lanes varying_plane(const TileGrid *grid, const TrianglePlanes *planes, int i, Lanes x,
                                Lanes y)
{
    Plane plane = {planes->origin[i], planes->dx[i], planes->dy[i]};
    return block_plane(grid, &plane, x, y);
}

TILE_INLINE void block_varyings(TileLight *light, int first_varying, int varyings, LanesInt index,
                                uint32_t bits, Lanes x, Lanes y, BlockVaryings *out)
{
    int32_t name[LANES];
    lanes_int_store(name, index);
    bool first = true;
    do {
        int32_t triangle = name[__builtin_ctz(bits)];
        const TrianglePlanes *planes = find_planes(light, triangle);
        LanesMask its = lanes_int_equal(index, lanes_int_all(triangle));
        Lanes w = block_plane(light->grid, &planes->inverse_w, x, y);
        out->inverse_w = first ? w : lanes_select(its, w, out->inverse_w);
        LanesInt surface = lanes_int_all(planes->surface);
        out->surface = first ? surface : lanes_int_select(its, surface, out->surface);
        for (int i = first_varying; i < varyings; i++) {
            Lanes value = varying_plane(light->grid, planes, i, x, y);
            out->varying[i] = first ? value : lanes_select(its, value, out->varying[i]);
        }
        bits &= ~lanes_mask_bits(its);
        first = false;
    } while (bits);
}

/* ---- G-buffer: what the lighting pass fetches ---- */

/* Colour and material of one lane, which may be textured. */
static inline void lane_material(const Pass *pass, const Draw *draw, const float uv[2], int lane,
                                 ShadeBatch *batch)
{
    const Material *material = &pass->scene->materials[draw->material];
    float base[4], surface[2];
    fragment_material(pass, material, uv, base, surface);
    if (!draw->transparent)
        base[3] = 1.0f;
    for (int i = 0; i < 4; i++)
        batch->diffuse[i][lane] = base[i];
    batch->material[0][lane] = surface[0];
    batch->material[1][lane] = surface[1];
    batch->material[2][lane] = material->occlusion;
}

static inline bool has_texture(const Material *material)
{
    return material->base_color_texture || material->metallic_roughness_texture;
}

/* Fills the batch's diffuse and material from the draws of its lanes. */
static inline void batch_materials(const TileLight *light, const Lanes uv[2], LanesInt surface,
                                   ShadeBatch *batch)
{
    const Pass *pass = light->pass;
    int32_t name[LANES];
    lanes_int_store(name, surface);
    const Draw *first = &pass->view.draws[name[0] / 2];
    LanesInt even = lanes_int_all(-2);
    LanesMask same =
        lanes_int_equal(lanes_int_and(surface, even), lanes_int_and(lanes_int_all(name[0]), even));
    if (lanes_mask_bits(same) == LANES_FULL &&
        !has_texture(&pass->scene->materials[first->material])) {
        lane_material(pass, first, (const float[2]){0, 0}, 0, batch);
        for (int i = 0; i < 4; i++)
            lanes_store(batch->diffuse[i], lanes_all(batch->diffuse[i][0]));
        for (int i = 0; i < 3; i++)
            lanes_store(batch->material[i], lanes_all(batch->material[i][0]));
        return;
    }
    float u[LANES], v[LANES];
    lanes_store(u, uv[0]);
    lanes_store(v, uv[1]);
    for (int lane = 0; lane < LANES; lane++)
        lane_material(pass, &pass->view.draws[name[lane] / 2], (const float[2]){u[lane], v[lane]},
                      lane, batch);
}

/* What is left of one lane in the G-buffer's formats. */
static __attribute__((noinline)) void lane_fetch(const TileLight *light, const Gathered *gathered,
                                                 int lane, ShadeBatch *batch)
{
    const Pass *pass = light->pass;
    Texel texel = {0};
    for (int i = 0; i < 3; i++) {
        texel.normal[i] = batch->normal[i][lane];
        texel.position[i] = batch->position[i][lane];
        texel.material[i] = batch->material[i][lane];
    }
    for (int i = 0; i < 4; i++)
        texel.diffuse[i] = batch->diffuse[i][lane];
    fragment_encode(pass, &texel);
    texel_quantise(&pass->layout, &texel);
    int pixel = gathered->pixel[lane];
    fragment_decode(pass, grid_depth_key(light->grid, gathered->key[lane]),
                    grid_pixel_x(light->grid, pixel), grid_pixel_y(light->grid, pixel), &texel);
    for (int i = 0; i < 3; i++) {
        batch->normal[i][lane] = texel.normal[i];
        batch->position[i][lane] = texel.position[i];
        batch->material[i][lane] = texel.material[i];
    }
    for (int i = 0; i < 4; i++)
        batch->diffuse[i][lane] = texel.diffuse[i];
}

/* From the first LANES gathered fragments: fragment_surface, stored and fetched. */
static inline void batch_surfaces(const TileLight *light, const Gathered *gathered,
                                  ShadeBatch *batch)
{
    Lanes w = lanes_div(lanes_all(1.0f), lanes_load(gathered->inverse_w)), normal[3], uv[2];
    LanesInt surface = lanes_int_load(gathered->surface);
    LanesMask turned = lanes_int_equal(lanes_int_and(surface, lanes_int_all(1)), lanes_int_all(1));
    for (int i = 0; i < 3; i++) {
        Lanes position = lanes_all(0.0f);
        normal[i] = position;
        if (light->first_varying == 0) {
            position = lanes_mul(lanes_load(gathered->varying[i]), w);
            normal[i] = lanes_mul(lanes_load(gathered->varying[3 + i]), w);
        }
        lanes_store(batch->position[i], position);
    }
    shade_normalize(normal, normal);
    for (int i = 0; i < 3; i++)
        lanes_store(batch->normal[i], lanes_select(turned, LANES_NEG(normal[i]), normal[i]));
    for (int i = 0; i < 2; i++)
        uv[i] = light->varyings == VARYINGS ? lanes_mul(lanes_load(gathered->varying[6 + i]), w)
                                            : lanes_all(0.0f);
    batch_materials(light, uv, surface, batch);
    if (!light->exact)
        for (int lane = 0; lane < LANES; lane++)
            lane_fetch(light, gathered, lane, batch);
}

/* ---- lighting pass ---- */

static inline float *accum_of(unsigned char *accum, int pixel)
{
    return (float *)(void *)accum + pixel / LANES * 4 * LANES + pixel % LANES;
}

TILE_INLINE void blend_float(const TileLight *light, const Lanes source[4], Lanes stored[4])
{
    if (light->seed_blend)
        blend_lanes_seed(source, stored);
    else
        blend_lanes_under(source, stored);
}

/* Of the lanes in bits, each at its own pixel. */
static inline void blend_parts(const TileLight *light, const int32_t *pixels,
                               const ShadeBatch *batch, uint32_t bits)
{
    PixelFormat format = light->pass->desc->accum;
    for (; bits; bits &= bits - 1) {
        int lane = __builtin_ctz(bits), pixel = pixels[lane];
        float source[4], value[4], *stored = accum_of(light->accum, pixel);
        void *accum = light->accum + 16 * (size_t)pixel;
        for (int i = 0; i < 4; i++)
            source[i] = batch->source[i][lane];
        if (format == FORMAT_RGBA32F) {
            for (int i = 0; i < 4; i++)
                value[i] = stored[i * LANES];
            accum = value;
        }
        if (light->seed_blend)
            blend_opaque_seed(format, source, accum);
        else
            blend_under(format, source, accum);
        for (int i = 0; i < 4 && format == FORMAT_RGBA32F; i++)
            stored[i * LANES] = value[i];
    }
}

/* Of a full block with 32-bit floats. */
static inline void blend_block(const TileLight *light, int pixel, const ShadeBatch *batch,
                               uint32_t bits)
{
    float *accum = accum_of(light->accum, pixel);
    LanesMask blended = lanes_mask_from_bits(bits);
    Lanes source[4], before[4], after[4];
    for (int i = 0; i < 4; i++) {
        source[i] = lanes_load(batch->source[i]);
        before[i] = after[i] = lanes_load(accum + i * LANES);
    }
    blend_float(light, source, after);
    for (int i = 0; i < 4; i++)
        lanes_store(accum + i * LANES, lanes_select(blended, after[i], before[i]));
}

/* Lights the first LANES gathered fragments, or all of fewer. block: they are those of one. */
static __attribute__((noinline)) void light_batch(TileLight *light, Gathered *gathered, bool block)
{
    ShadeBatch batch;
    for (int lane = gathered->count; lane < LANES; lane++) {
        /* Unused lanes are copies of the first, so that they are as harmless. */
        gathered->inverse_w[lane] = gathered->inverse_w[0];
        for (int i = light->first_varying; i < light->varyings; i++)
            gathered->varying[i][lane] = gathered->varying[i][0];
        gathered->surface[lane] = gathered->surface[0];
        gathered->pixel[lane] = gathered->pixel[0];
        gathered->key[lane] = gathered->key[0];
    }
    batch_surfaces(light, gathered, &batch);
    uint32_t used = gathered->count < LANES ? (1u << gathered->count) - 1 : LANES_FULL;
    uint32_t alive = used & lanes_mask_bits(lanes_less(lanes_all(SHADING_ALPHA_TEST),
                                                       lanes_load(batch.diffuse[3])));
    shade_batch(&light->pass->view, &light->form, &batch);
    if (block && light->pass->desc->accum == FORMAT_RGBA32F)
        blend_block(light, gathered->pixel[0], &batch, alive);
    else
        blend_parts(light, gathered->pixel, &batch, alive);
    light->counts->shaded += (uint64_t)__builtin_popcount(alive);
}

/* Moves what is behind the first LANES fragments to the front. */
static inline void advance(Gathered *gathered, int first_varying, int varyings)
{
    gathered->count -= LANES;
    lanes_store(gathered->inverse_w, lanes_load(gathered->inverse_w + LANES));
    for (int i = first_varying; i < varyings; i++)
        lanes_store(gathered->varying[i], lanes_load(gathered->varying[i] + LANES));
    lanes_int_store(gathered->surface, lanes_int_load(gathered->surface + LANES));
    lanes_int_store(gathered->pixel, lanes_int_load(gathered->pixel + LANES));
    lanes_int_store(gathered->key, lanes_int_load(gathered->key + LANES));
}

/* bits: lanes that have a fragment, of the triangle in index, at the depth in key. */
TILE_INLINE void gather_block(TileLight *light, int first_varying, int varyings, int block,
                              uint32_t bits, LanesInt index, LanesInt key)
{
    BlockVaryings values;
    block_varyings(light, first_varying, varyings, index, bits, block_x(grid_x(light->grid, block)),
                   block_y(grid_y(light->grid, block)), &values);
    bool full = bits == LANES_FULL;
    Gathered *gathered = full ? &light->whole : &light->parts;
    int at = full ? 0 : gathered->count;
    lanes_pack(gathered->inverse_w + at, bits, values.inverse_w);
    for (int i = first_varying; i < varyings; i++)
        lanes_pack(gathered->varying[i] + at, bits, values.varying[i]);
    lanes_int_pack(gathered->surface + at, bits, values.surface);
    lanes_int_pack(gathered->pixel + at, bits,
                   lanes_int_add(lanes_int_all(block * LANES), lanes_int_counting()));
    lanes_int_pack(gathered->key + at, bits, key);
    gathered->count = at + __builtin_popcount(bits);
    if (gathered->count < LANES)
        return;
    light_batch(light, gathered, full);
    if (!full)
        advance(gathered, first_varying, varyings);
}

static void tile_light_block(TileLight *light, int block, uint32_t bits, LanesInt index,
                             LanesInt key)
{
    if (light->first_varying > 0)
        gather_block(light, VARYINGS - 2, VARYINGS, block, bits, index, key);
    else if (light->varyings == VARYINGS)
        gather_block(light, 0, VARYINGS, block, bits, index, key);
    else
        gather_block(light, 0, VARYINGS - 2, block, bits, index, key);
}

/* Lights what is left of a layer: the next one must find it blended. */
static void tile_light_flush(TileLight *light)
{
    if (light->parts.count > 0)
        light_batch(light, &light->parts, false);
    light->parts.count = 0;
}

/* grid, triangles, cache, tag and accum are the tile's. */
static inline void tile_light_begin(const Pass *pass, bool transparent, TileLight *out)
{
    const GBufferLayout *layout = &pass->layout;
    out->pass = pass;
    out->list = transparent ? &pass->geometry.transparent : &pass->geometry.opaque;
    out->seed_blend = !transparent && pass->desc->opaque_blend == OPAQUE_BLEND_SEED;
    out->exact = layout->normal == FORMAT_RGBA32F && layout->position == FORMAT_RGBA32F &&
                 layout->diffuse == FORMAT_RGBA32F && layout->material == FORMAT_RGBA32F;
    bool unlit = !needs_has(&pass->needs, NEED_NORMAL) && !needs_has(&pass->needs, NEED_POSITION);
    bool textured = needs_has(&pass->needs, NEED_BASE_COLOR_TEXTURE) ||
                    needs_has(&pass->needs, NEED_MATERIAL_TEXTURE);
    out->first_varying = unlit ? VARYINGS - 2 : 0;
    out->varyings = unlit || textured ? VARYINGS : VARYINGS - 2;
    out->form = pass_shade_form(pass, transparent);
    out->parts.count = 0;
}

#endif
