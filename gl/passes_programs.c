#include "passes.h"

#include "program.h"
#include "uniforms.h"

#include <stdio.h>

static bool has(const Passes *passes, NeedId id)
{
    return needs_has(&passes->needs, id);
}

static bool is_textured(const Passes *passes)
{
    return has(passes, NEED_BASE_COLOR_TEXTURE) || has(passes, NEED_MATERIAL_TEXTURE);
}

static bool stores_halves(const Passes *passes)
{
    bool stores = passes->desc->accum == FORMAT_RGBA16F;
    for (int i = 0; i < GBUFFER_TARGETS; i++)
        stores |= passes->targets.color_format[i] == FORMAT_RGBA16F;
    return stores;
}

static bool reconstructs(const Passes *passes)
{
    return render_desc_layout(passes->desc).position == FORMAT_NONE;
}

/* The switches that follow from desc, the formats and what is needed. */
static void write_defines(const Passes *passes, const char *defines, char *out, size_t size)
{
    static const char *const outputs[GBUFFER_TARGETS] = {"NORMAL", "POSITION", "DIFFUSE",
                                                         "MATERIAL"};
    const RenderDesc *desc = passes->desc;
    const Targets *targets = &passes->targets;
    char *at = out;
    for (int i = 0; i < GBUFFER_TARGETS; i++)
        if (targets->attachment[i] >= 0)
            at += sprintf(at, "#define OUT_%s %d\n", outputs[i], targets->attachment[i]);
    at += sprintf(at, "#define LIGHT_COUNT %zu\n", passes->view->light_count);
    const struct {
        bool on;
        const char *name;
    } switches[] = {
        {is_textured(passes), "TEXTURED"},
        {has(passes, NEED_BASE_COLOR_TEXTURE), "BASE_COLOR_TEXTURE"},
        {has(passes, NEED_MATERIAL_TEXTURE), "MATERIAL_TEXTURE"},
        {has(passes, NEED_MASK), "MASKED"},
        {has(passes, NEED_CULLING), "CULLED"},
        {stores_halves(passes), "HALF_TARGET"},
        {desc->normals == NORMALS_FACED && has(passes, NEED_FACING), "FACED"},
        {!has(passes, NEED_NORMAL), "NO_NORMAL"},
        {!needs_lit_position(&passes->needs), "NO_POSITION"},
        {!has(passes, NEED_MATERIAL), "CONSTANT_MATERIAL"},
        {targets->color_format[GBUFFER_NORMAL] == FORMAT_RG16, "OCTAHEDRAL"},
        {reconstructs(passes), "RECONSTRUCT"},
        {desc->depth_range == DEPTH_RANGE_REVERSED, "REVERSED"},
        {desc->peel_test == PEEL_TEST_RAW, "TEST_RAW"},
        {targets->depth_format == FORMAT_D24, "DEPTH_24"},
        {targets->depth_format == FORMAT_D16, "DEPTH_16"},
        {passes->lights.storage, "LIGHTS_STORAGE"},
        {passes->lights.ranges, "LIGHT_RANGES"},
        {desc->ggx == GGX_STABLE, "GGX_STABLE"},
        {desc->shading == SHADING_PHONG, "PHONG"},
        {targets->lit && targets->color_format[GBUFFER_DIFFUSE] == FORMAT_RGBA8, "CLAMP_COLOR"},
    };
    for (size_t i = 0; i < sizeof switches / sizeof *switches; i++)
        if (switches[i].on)
            at += sprintf(at, "#define %s\n", switches[i].name);
    /* What the store does anyway; without AVX, llvmpipe turns 2^31/255 and more into 0. */
    at += sprintf(at, "#define ACCUM_CLAMP(c) %s\n",
                  desc->accum == FORMAT_RGBA8 ? "clamp(c, 0.0, 1.0)" : "(c)");
    if (desc->bias > 0.0f)
        at += sprintf(at, "#define BIAS %.9g\n", (double)desc->bias);
    snprintf(at, size - (size_t)(at - out), "%s", defines);
}

/* What no draw changes. */
static void set_constants(const Passes *passes, const PassesSource *source, GLuint program)
{
    const View *view = passes->view;
    const Unprojection *back = &view->unprojection;
    const float depth_to_z[] = {back->depth_scale, back->depth_offset, back->inverse_far};
    const float ray[] = {back->ray_scale[0], back->ray_scale[1], back->ray_offset[0],
                         back->ray_offset[1]};
    if (source->surface)
        gl.ProgramUniformMatrix4fv(program, UNIFORM_PROJECTION, 1, GL_FALSE, view->projection);
    if (source->shade && passes->desc->shading != SHADING_PHONG)
        gl.ProgramUniform3fv(program, UNIFORM_AMBIENT, 1, view->ambient);
    if (!source->unproject)
        return;
    gl.ProgramUniform3fv(program, UNIFORM_DEPTH_TO_Z, 1, depth_to_z);
    gl.ProgramUniform4fv(program, UNIFORM_RAY, 1, ray);
}

Result passes_program(const Passes *passes, const char *name, const char *defines,
                      const PassesSource *source, GLuint *out)
{
    char text[1024];
    const char *parts[PROGRAM_PARTS];
    int count = 0;
    write_defines(passes, defines, text, sizeof text);
    if (source->surface)
        parts[count++] = shader_surface;
    if (source->peel_test)
        parts[count++] = shader_peel_test;
    if (source->octahedral)
        parts[count++] = shader_octahedral;
    if (source->gbuffer)
        parts[count++] = shader_gbuffer;
    if (source->shade)
        parts[count++] = shader_shade;
    if (source->unproject)
        parts[count++] = shader_unproject;
    if (source->minmax)
        parts[count++] = shader_minmax;
    parts[count++] = source->main;
    Result result =
        program_build(name, text, source->surface ? shader_geometry_vert : shader_fullscreen_vert,
                      parts, count, out);
    if (result == RESULT_OK)
        set_constants(passes, source, *out);
    return result;
}

Result passes_geometry_program(const Passes *passes, const char *name, const char *defines,
                               GLuint *out)
{
    bool transparent = *defines != '\0', forward = passes->desc->method == METHOD_FORWARD;
    const PassesSource source = {.surface = true,
                                 .peel_test = transparent,
                                 .octahedral = !forward,
                                 .gbuffer = !forward,
                                 .shade = forward,
                                 .main = forward ? shader_forward_frag : shader_geometry_frag};
    char text[256];
    snprintf(text, sizeof text, "%s%s", defines,
             forward && transparent && passes->desc->back_light ? "#define BACK_LIGHT\n" : "");
    return passes_program(passes, name, text, &source, out);
}

/* Of the lighting pass of one list; nothing where nothing is in it. */
static Result build_lighting(const Passes *passes, const char *name, bool transparent, GLuint *out)
{
    const RenderDesc *desc = passes->desc;
    const PassesSource deferred = {.octahedral = true,
                                   .shade = true,
                                   .unproject = reconstructs(passes),
                                   .main = shader_lighting_frag};
    const PassesSource composed = {.main = shader_compose_frag};
    const PassesSource lighting = desc->method == METHOD_FORWARD ? composed : deferred;
    char defines[48];
    snprintf(defines, sizeof defines, "%s%s", render_desc_edges(desc) ? "#define EDGES\n" : "",
             transparent && desc->back_light ? "#define BACK_LIGHT\n" : "");
    Result result = RESULT_OK;
    if (has(passes, transparent ? NEED_TRANSPARENT : NEED_OPAQUE))
        result = passes_program(passes, name, defines, &lighting, out);
    if (result != RESULT_OK || !*out || has(passes, NEED_MATERIAL) ||
        lighting.main != deferred.main)
        return result;
    float material[4];
    needs_material(&passes->needs, desc, transparent, material);
    gl.ProgramUniform3fv(*out, UNIFORM_CONSTANT_MATERIAL, 1, material);
    return RESULT_OK;
}

Result passes_build_programs(Passes *passes)
{
    const PassesSource resolve = {.main = shader_resolve_frag};
    bool opaque = has(passes, NEED_OPAQUE);
    bool seed = passes->desc->opaque_blend == OPAQUE_BLEND_SEED && opaque;
    Result result = RESULT_OK;
    if (opaque)
        result = passes_geometry_program(passes, "opaque geometry", "", &passes->opaque_geometry);
    if (result == RESULT_OK)
        result = build_lighting(passes, "opaque lighting", false, &passes->opaque_lighting);
    if (result == RESULT_OK)
        result = build_lighting(passes, "peel lighting", true, &passes->peel_lighting);
    if (result == RESULT_OK)
        result = passes_program(passes, "resolve", seed ? "#define SEED_BLEND\n" : "", &resolve,
                                &passes->resolve);
    return result;
}
