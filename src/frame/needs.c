#include "frame/needs.h"

#include "frame/shading.h"

#include <string.h>

/* What the draws of one list have in common. */
typedef struct ListNeeds {
    const Material *first; /* NULL of an empty list */
    bool textured;         /* some roughness and metallic are fetched */
    bool surface_varies;   /* roughness or metallic differ */
    bool occlusion_varies;
    bool alpha_varies, alpha_vanishes; /* some stored alpha may be at most SHADING_ALPHA_TEST */
} ListNeeds;

/* What the draws of both lists have. */
typedef struct DrawNeeds {
    ListNeeds list[2]; /* opaque, transparent */
    bool culled, back_faces, masked, base_color_texture;
} DrawNeeds;

const char *needs_name(NeedId id)
{
    static const char *const names[NEED_COUNT] = {
        [NEED_OPAQUE] = "opaque passes",
        [NEED_TRANSPARENT] = "transparent passes",
        [NEED_CULLING] = "culling test",
        [NEED_FACING] = "facing of normals",
        [NEED_MASK] = "mask test",
        [NEED_BASE_COLOR_TEXTURE] = "base-colour textures",
        [NEED_MATERIAL_TEXTURE] = "material textures",
        [NEED_LIGHTS] = "lights",
        [NEED_NORMAL] = "normals",
        [NEED_POSITION] = "positions",
        [NEED_MATERIAL] = "material channel",
        [NEED_BACK_FACES] = "back faces",
        [NEED_ALPHA] = "alpha of each fragment",
        [NEED_ALPHA_TEST] = "alpha test",
        [NEED_DOUBLE] = "double precision",
    };
    return names[id];
}

/* ---- the draws ---- */

/* Eight bits store alpha below half a step as 0. */
static bool alpha_vanishes(const Material *material)
{
    return material->base_color_texture > 0 || material->base_color[3] < 0.5f / 255.0f;
}

static void add_material(const Material *material, ListNeeds *list)
{
    const Material *first = list->first ? list->first : material;
    list->first = first;
    list->textured |= material->metallic_roughness_texture > 0;
    list->surface_varies |=
        material->roughness != first->roughness || material->metallic != first->metallic;
    list->occlusion_varies |= material->occlusion != first->occlusion;
    list->alpha_varies |=
        material->base_color_texture > 0 || material->base_color[3] != first->base_color[3];
    list->alpha_vanishes |= alpha_vanishes(material);
}

static DrawNeeds look_at_draws(const Scene *scene, const View *view)
{
    DrawNeeds needs = {0};
    for (size_t i = 0; i < view->draw_count; i++) {
        const Draw *draw = &view->draws[i];
        const Material *material = &scene->materials[draw->material];
        needs.culled |= draw->cull_back;
        needs.back_faces |= !draw->cull_back;
        needs.masked |= draw->masked;
        needs.base_color_texture |= material->base_color_texture > 0;
        add_material(material, &needs.list[draw->transparent]);
    }
    return needs;
}

/* ---- the items ---- */

static Need choose(bool needed, const char *yes, const char *no)
{
    return (Need){needed, needed ? yes : no};
}

static void derive_lists(const DrawNeeds *draws, Need *items)
{
    items[NEED_OPAQUE] = choose(draws->list[0].first, "the scene has opaque instances",
                                "no instance is opaque or masked");
    items[NEED_TRANSPARENT] = choose(draws->list[1].first, "the scene has transparent instances",
                                     "no instance is transparent");
    items[NEED_CULLING] =
        choose(draws->culled, "back faces of some materials are culled", "no material is culled");
    items[NEED_MASK] = choose(draws->masked, "the alpha of a texture masks fragments",
                              "no material has a mask and a texture");
    items[NEED_BASE_COLOR_TEXTURE] =
        choose(draws->base_color_texture, "some materials have one", "no material has one");
    items[NEED_BACK_FACES] =
        choose(draws->back_faces, "some materials show them", "all are culled");
    items[NEED_ALPHA] =
        choose(draws->list[1].alpha_varies, "it differs between fragments",
               draws->list[1].first ? "all fragments have the same" : "no instance is transparent");
    items[NEED_ALPHA_TEST] =
        choose(draws->list[1].alpha_vanishes, "an alpha may be stored as 0",
               "every alpha is above it: only pixels without a fragment are discarded");
    items[NEED_DOUBLE] = (Need){false, "ref and gl compute in single precision; truth does not"};
}

static void derive_normal_and_position(const RenderDesc *desc, bool faces, Need *items)
{
    bool phong = desc->shading == SHADING_PHONG, lit = items[NEED_LIGHTS].needed;
    bool weighted = desc->method == METHOD_WEIGHTED_BLENDED && items[NEED_TRANSPARENT].needed;
    static const char ambient[] = "only ambient light is left";
    items[NEED_NORMAL] = choose(phong || lit, "lighting uses them", ambient);
    items[NEED_POSITION] =
        choose(lit || weighted, lit ? "lighting uses them" : "weights are of the distance",
               phong ? "Phong's light and eye are directions" : ambient);
    items[NEED_FACING] =
        choose(desc->normals == NORMALS_FACED && faces && items[NEED_NORMAL].needed,
               "back faces are drawn and lit",
               desc->normals == NORMALS_KEPT ? "normals are kept as they are"
               : faces                       ? "normals are not needed"
                                             : "back faces are culled");
}

static void derive_material(const DrawNeeds *draws, const RenderDesc *desc, Need *items)
{
    bool phong = desc->shading == SHADING_PHONG, lit = items[NEED_LIGHTS].needed;
    bool textured = draws->list[0].textured || draws->list[1].textured;
    bool surface = draws->list[0].surface_varies || draws->list[1].surface_varies || textured;
    bool occlusion = draws->list[0].occlusion_varies || draws->list[1].occlusion_varies;
    bool forward = desc->method == METHOD_FORWARD;
    bool varies = !phong && !forward && ((lit && surface) || occlusion);
    bool marks = (desc->method == METHOD_PEEL || forward) && desc->peel_test == PEEL_TEST_RAW;
    items[NEED_MATERIAL_TEXTURE] =
        choose(textured && lit, "some materials have one",
               textured ? "no light needs roughness or metallic" : "no material has one");
    items[NEED_MATERIAL] =
        choose(varies || marks,
               varies ? "it differs between fragments"
                      : "it marks the pixels that a peel drew, for the raw peel test",
               forward ? "the geometry pass shades"
               : phong ? "Phong does not use it"
                       : "what lighting uses of it is the same everywhere");
}

static void derive_constants(const DrawNeeds *draws, float material[2][4])
{
    for (int i = 0; i < 2; i++) {
        const Material *first = draws->list[i].first;
        if (first)
            memcpy(material[i],
                   (float[4]){first->roughness, first->metallic, first->occlusion, 1.0f},
                   sizeof material[i]);
    }
}

/* A list's nodes have a fixed form, and both lists go through the same shader. Which lights there
 * are is the view's choice. */
static void need_all(const Scene *scene, const RenderDesc *desc, bool traced, Need *items)
{
    const char *why = traced            ? "all buffers are traced"
                      : desc->model_all ? "all is asked for"
                                        : "nodes of linked lists hold it, and both lists";
    for (int i = 0; i < NEED_ACTED_ON; i++)
        if (!items[i].needed && i != NEED_LIGHTS)
            items[i] = (Need){true, why};
    bool textures = scene->texture_count > 0;
    if (!textures)
        items[NEED_BASE_COLOR_TEXTURE] = items[NEED_MATERIAL_TEXTURE] = items[NEED_MASK] =
            (Need){false, "the scene has no textures"};
}

void needs_derive(const Scene *scene, const View *view, const RenderDesc *desc, bool traced,
                  Needs *out)
{
    DrawNeeds draws = look_at_draws(scene, view);
    *out = (Needs){.lights = view->light_count, .dark_lights = view->dark_light_count};
    Need *items = out->items;
    derive_lists(&draws, items);
    items[NEED_LIGHTS] = choose(view->light_count > 0, "they light the scene",
                                desc->shading == SHADING_PHONG ? "Phong has a light of its own"
                                : view->dark_light_count > 0   ? "all are black"
                                                               : "there are none");
    derive_normal_and_position(desc, draws.back_faces, items);
    derive_material(&draws, desc, items);
    derive_constants(&draws, out->material);
    out->all = traced || desc->model_all || desc->method == METHOD_LINKED_LIST;
    if (out->all)
        need_all(scene, desc, traced, items);
}

void needs_textures(const Needs *needs, const Scene *scene, const View *view, bool *wanted)
{
    for (size_t i = 0; i < scene->texture_count; i++)
        wanted[i] = needs->all;
    for (size_t i = 0; i < view->draw_count; i++) {
        const Material *material = &scene->materials[view->draws[i].material];
        if (material->base_color_texture && needs_has(needs, NEED_BASE_COLOR_TEXTURE))
            wanted[material->base_color_texture - 1] = true;
        if (material->metallic_roughness_texture && needs_has(needs, NEED_MATERIAL_TEXTURE))
            wanted[material->metallic_roughness_texture - 1] = true;
    }
}

/* ---- formats ---- */

GBufferLayout needs_layout(const Needs *needs, const RenderDesc *desc, bool transparent)
{
    const GBufferLayout none = {FORMAT_NONE, FORMAT_NONE, FORMAT_NONE, FORMAT_NONE};
    GBufferLayout layout = render_desc_layout(desc);
    if (!needs_has(needs, transparent ? NEED_TRANSPARENT : NEED_OPAQUE))
        return none;
    if (!needs_has(needs, NEED_NORMAL))
        layout.normal = FORMAT_NONE;
    if (!needs_lit_position(needs))
        layout.position = FORMAT_NONE;
    if (!needs_has(needs, NEED_MATERIAL))
        layout.material = FORMAT_NONE;
    return layout;
}

void needs_material(const Needs *needs, const RenderDesc *desc, bool transparent, float out[4])
{
    PixelFormat format = render_desc_layout(desc).material;
    unsigned char pixel[16];
    memcpy(out, needs->material[transparent], sizeof needs->material[transparent]);
    if (format == FORMAT_NONE)
        return;
    format_store(format, out, pixel);
    format_fetch(format, pixel, out);
}
