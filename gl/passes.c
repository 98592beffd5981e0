#include "passes.h"

#include "program.h"

#include <stdio.h>

/* Uniform locations of shaders/geometry.*.glsl. */
enum {
    UNIFORM_MODEL_VIEW,
    UNIFORM_NORMAL_MATRIX,
    UNIFORM_PROJECTION,
    UNIFORM_BASE_COLOR,
    UNIFORM_MATERIAL,
    UNIFORM_CULL_BACK,
    UNIFORM_FLIPPED,
    UNIFORM_BASE_COLOR_SAMPLER,
    UNIFORM_METALLIC_ROUGHNESS_SAMPLER,
    UNIFORM_ALPHA_CUTOFF,
};

enum {
    UNIFORM_AMBIENT = 0,
    UNIFORM_DEPTH_TO_Z = 1,
    UNIFORM_RAY = 2,
    UNIFORM_BACKGROUND = 0
};

static Result build_geometry(const Passes *passes, GeometryPass pass, GLuint *out)
{
    const RenderDesc *desc = passes->desc;
    const int *attachment = passes->targets.attachment;
    static const char *const names[] = {"opaque geometry", "first peel", "next peel"};
    static const char *const stages[] = {"", "#define TRANSPARENT\n",
                                         "#define TRANSPARENT\n#define NEXT_PEEL\n"};
    static const char *const outputs[GBUFFER_TARGETS] = {"NORMAL", "POSITION", "DIFFUSE",
                                                         "MATERIAL"};
    PixelFormat depth = render_desc_depth(desc);
    char defines[512], *at = defines;
    for (int i = 0; i < GBUFFER_TARGETS; i++)
        if (attachment[i] >= 0)
            at += sprintf(at, "#define OUT_%s %d\n", outputs[i], attachment[i]);
    snprintf(at, sizeof defines - (size_t)(at - defines), "%s%s%s%s%s%s%s", stages[pass],
             passes->textures.count > 0 ? "#define TEXTURED\n" : "",
             passes->targets.color_format[GBUFFER_NORMAL] == FORMAT_RG16 ? "#define OCTAHEDRAL\n"
                                                                         : "",
             desc->depth_range == DEPTH_RANGE_REVERSED ? "#define REVERSED\n" : "",
             desc->normals == NORMALS_FACED ? "#define FACED\n" : "",
             desc->peel_test == PEEL_TEST_RAW ? "#define TEST_RAW\n" : "",
             depth == FORMAT_D24   ? "#define DEPTH_24\n"
             : depth == FORMAT_D16 ? "#define DEPTH_16\n"
                                   : "");
    return program_build(names[pass], defines, shader_geometry_vert, shader_geometry_frag, out);
}

static Result build_lighting(const Passes *passes, LightingPass pass, GLuint *out)
{
    static const char *const names[] = {"opaque lighting", "peel lighting"};
    const RenderDesc *desc = passes->desc;
    const PixelFormat *formats = passes->targets.color_format;
    char defines[256];
    snprintf(defines, sizeof defines, "#define LIGHT_COUNT %zu\n%s%s%s%s%s%s",
             passes->view->light_count,
             formats[GBUFFER_NORMAL] == FORMAT_RG16 ? "#define OCTAHEDRAL\n" : "",
             formats[GBUFFER_POSITION] == FORMAT_NONE ? "#define RECONSTRUCT\n" : "",
             passes->lights.storage ? "#define LIGHTS_STORAGE\n" : "",
             desc->accum == FORMAT_RGBA8 ? "#define ACCUM_8\n" : "",
             desc->ggx == GGX_STABLE ? "#define GGX_STABLE\n" : "",
             desc->back_light && pass == LIGHTING_PEEL ? "#define BACK_LIGHT\n" : "");
    return program_build(names[pass], defines, shader_fullscreen_vert, shader_lighting_frag, out);
}

static Result build_programs(Passes *passes)
{
    const RenderDesc *desc = passes->desc;
    Result result = RESULT_OK;
    for (int i = 0; i < GEOMETRY_PASSES && result == RESULT_OK; i++)
        result = build_geometry(passes, (GeometryPass)i, &passes->geometry[i]);
    for (int i = 0; i < LIGHTING_PASSES && result == RESULT_OK; i++)
        result = build_lighting(passes, (LightingPass)i, &passes->lighting[i]);
    if (result == RESULT_OK)
        result = program_build(
            "resolve", desc->opaque_blend == OPAQUE_BLEND_SEED ? "#define SEED_BLEND\n" : "",
            shader_fullscreen_vert, shader_resolve_frag, &passes->resolve);
    return result;
}

/* What no draw changes. */
static void set_constants(Passes *passes)
{
    const RenderDesc *desc = passes->desc;
    for (int i = 0; i < GEOMETRY_PASSES; i++)
        gl.ProgramUniformMatrix4fv(passes->geometry[i], UNIFORM_PROJECTION, 1, GL_FALSE,
                                   passes->view->projection);
    const Unprojection *back = &passes->view->unprojection;
    const float depth_to_z[] = {back->depth_scale, back->depth_offset, back->inverse_far};
    const float ray[] = {back->ray_scale[0], back->ray_scale[1], back->ray_offset[0],
                         back->ray_offset[1]};
    for (int i = 0; i < LIGHTING_PASSES; i++) {
        gl.ProgramUniform3fv(passes->lighting[i], UNIFORM_AMBIENT, 1, passes->view->ambient);
        if (passes->targets.color_format[GBUFFER_POSITION] != FORMAT_NONE)
            continue;
        gl.ProgramUniform3fv(passes->lighting[i], UNIFORM_DEPTH_TO_Z, 1, depth_to_z);
        gl.ProgramUniform4fv(passes->lighting[i], UNIFORM_RAY, 1, ray);
    }
    gl.ProgramUniform3fv(passes->resolve, UNIFORM_BACKGROUND, 1, passes->view->background);
    gl.Viewport(0, 0, desc->width, desc->height);
    if (desc->depth_range == DEPTH_RANGE_REVERSED)
        gl.DepthFunc(desc->depth_func == DEPTH_LEQUAL ? GL_GEQUAL : GL_GREATER);
    else
        gl.DepthFunc(desc->depth_func == DEPTH_LEQUAL ? GL_LEQUAL : GL_LESS);
    gl.ClipControl(GL_LOWER_LEFT,
                   desc->depth_range == DEPTH_RANGE_GL ? GL_NEGATIVE_ONE_TO_ONE : GL_ZERO_TO_ONE);
    gl.BindVertexArray(passes->meshes.vertex_array);
}

Result passes_create(Context *context, const Scene *scene, const RenderDesc *desc, const View *view,
                     Passes *out)
{
    *out = (Passes){.context = context, .scene = scene, .desc = desc, .view = view};
    Result result = targets_create(context, desc, &out->targets);
    if (result == RESULT_OK)
        result = upload_meshes(context, scene, &out->meshes);
    if (result == RESULT_OK)
        result = upload_lights(context, view, &out->lights);
    if (result == RESULT_OK)
        result = upload_textures(context, scene, desc, out->targets.bytes, &out->textures);
    if (result == RESULT_OK)
        result = build_programs(out);
    if (result == RESULT_OK) {
        gl.CreateQueries(GL_SAMPLES_PASSED, 1, &out->samples);
        set_constants(out);
        result = context_check(context, "set-up");
    }
    if (result != RESULT_OK)
        passes_destroy(out);
    return result;
}

void passes_destroy(Passes *passes)
{
    targets_destroy(&passes->targets);
    upload_free_meshes(&passes->meshes);
    upload_free_lights(&passes->lights);
    upload_free_textures(&passes->textures);
    for (int i = 0; i < GEOMETRY_PASSES; i++)
        gl.DeleteProgram(passes->geometry[i]);
    for (int i = 0; i < LIGHTING_PASSES; i++)
        gl.DeleteProgram(passes->lighting[i]);
    gl.DeleteProgram(passes->resolve);
    gl.DeleteQueries(1, &passes->samples);
    *passes = (Passes){0};
}

static void clear_gbuffer(const Passes *passes, GLuint framebuffer)
{
    static const float zero[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    const float far = passes->desc->depth_range == DEPTH_RANGE_REVERSED ? 0.0f : 1.0f;
    for (int i = 0; i < passes->targets.color_count; i++)
        gl.ClearNamedFramebufferfv(framebuffer, GL_COLOR, i, zero);
    gl.ClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &far);
}

/* Texture units of shaders/geometry.frag.glsl. */
enum {
    UNIT_BASE_COLOR = 2,
    UNIT_METALLIC_ROUGHNESS
};

/* number: as in Material. */
static void bind_texture(const Passes *passes, GLuint program, uint32_t number, GLuint unit,
                         GLint uniform)
{
    GLint sampler[4] = {0};
    if (number > 0) {
        const Texture *texture = &passes->scene->textures[number - 1];
        sampler[0] = 1;
        sampler[1] = (GLint)texture->wrap_s;
        sampler[2] = (GLint)texture->wrap_t;
        sampler[3] = texture->nearest;
        gl.BindTextureUnit(unit, passes->textures.names[number - 1]);
    }
    gl.ProgramUniform4iv(program, uniform, 1, sampler);
}

static void bind_textures(const Passes *passes, GLuint program, const Draw *item)
{
    const Material *material = &passes->scene->materials[item->material];
    if (passes->textures.count == 0)
        return;
    bind_texture(passes, program, material->base_color_texture, UNIT_BASE_COLOR,
                 UNIFORM_BASE_COLOR_SAMPLER);
    bind_texture(passes, program, material->metallic_roughness_texture, UNIT_METALLIC_ROUGHNESS,
                 UNIFORM_METALLIC_ROUGHNESS_SAMPLER);
    gl.ProgramUniform1f(program, UNIFORM_ALPHA_CUTOFF,
                        item->masked ? material->alpha_cutoff : 0.0f);
}

static void draw(const Passes *passes, GLuint program, const Draw *item)
{
    const MeshRange *range = &passes->meshes.ranges[item->mesh];
    if (range->index_count == 0)
        return;
    const Material *material = &passes->scene->materials[item->material];
    const float surface[3] = {material->roughness, material->metallic, material->occlusion};
    gl.ProgramUniformMatrix4fv(program, UNIFORM_MODEL_VIEW, 1, GL_FALSE, item->model_view);
    gl.ProgramUniformMatrix3fv(program, UNIFORM_NORMAL_MATRIX, 1, GL_FALSE, item->normal_matrix);
    gl.ProgramUniform4fv(program, UNIFORM_BASE_COLOR, 1, material->base_color);
    gl.ProgramUniform3fv(program, UNIFORM_MATERIAL, 1, surface);
    gl.ProgramUniform1i(program, UNIFORM_CULL_BACK, item->cull_back);
    gl.ProgramUniform1i(program, UNIFORM_FLIPPED, item->flipped);
    bind_textures(passes, program, item);
    gl.DrawElementsBaseVertex(GL_TRIANGLES, (GLsizei)range->index_count, GL_UNSIGNED_INT,
                              (const void *)(range->first_index * sizeof(uint32_t)),
                              range->base_vertex);
}

static void draw_list(const Passes *passes, GLuint program, bool transparent)
{
    gl.UseProgram(program);
    gl.Enable(GL_DEPTH_TEST);
    for (size_t i = 0; i < passes->view->draw_count; i++)
        if (passes->view->draws[i].transparent == transparent)
            draw(passes, program, &passes->view->draws[i]);
    gl.Disable(GL_DEPTH_TEST);
}

Result passes_opaque_geometry(Passes *passes)
{
    static const float no_color_all_transmitted[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    Targets *targets = &passes->targets;
    gl.ClearNamedFramebufferfv(targets->plain_buffer, GL_COLOR, 0, no_color_all_transmitted);
    clear_gbuffer(passes, targets->opaque_buffer);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, targets->opaque_buffer);
    draw_list(passes, passes->geometry[GEOMETRY_OPAQUE], false);
    return targets_copy_code(targets, targets->opaque_buffer, targets->opaque_code);
}

Result passes_peel_geometry(Passes *passes, int peel, uint64_t *samples)
{
    Targets *targets = &passes->targets;
    int current = peel & 1;
    clear_gbuffer(passes, targets->peel_buffer[current]);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, targets->peel_buffer[current]);
    if (peel > 0) {
        Result result =
            targets_copy_code(targets, targets->peel_buffer[1 - current], targets->previous_code);
        if (result != RESULT_OK)
            return result;
        gl.BindTextureUnit(0, targets->previous_code ? targets->previous_code
                                                     : targets->peel_depth[1 - current]);
    }
    gl.BindTextureUnit(1, targets->opaque_code ? targets->opaque_code : targets->opaque_depth);
    gl.BeginQuery(GL_SAMPLES_PASSED, passes->samples);
    draw_list(passes, passes->geometry[peel > 0 ? GEOMETRY_NEXT_PEEL : GEOMETRY_FIRST_PEEL], true);
    gl.EndQuery(GL_SAMPLES_PASSED);
    GLuint64 count = 0;
    gl.GetQueryObjectui64v(passes->samples, GL_QUERY_RESULT, &count);
    *samples = count;
    return context_check(passes->context, "peel");
}

/* Where no position is stored, the depth takes its texture unit. */
static void light(const Passes *passes, LightingPass pass, const GLuint color[GBUFFER_TARGETS],
                  GLuint depth)
{
    for (GLuint i = 0; i < GBUFFER_TARGETS; i++)
        gl.BindTextureUnit(i, color[i] ? color[i] : depth);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, passes->targets.plain_buffer);
    gl.UseProgram(passes->lighting[pass]);
    gl.Enable(GL_BLEND);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.Disable(GL_BLEND);
}

void passes_peel_lighting(Passes *passes, int peel)
{
    gl.BlendFuncSeparate(GL_DST_ALPHA, GL_ONE, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
    light(passes, LIGHTING_PEEL, passes->targets.peel_color, passes->targets.peel_depth[peel & 1]);
}

void passes_opaque_lighting(Passes *passes)
{
    if (passes->desc->opaque_blend == OPAQUE_BLEND_SEED)
        gl.BlendFunc(GL_DST_ALPHA, GL_ONE);
    else
        gl.BlendFuncSeparate(GL_DST_ALPHA, GL_ONE, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
    light(passes, LIGHTING_OPAQUE, passes->targets.opaque_color, passes->targets.opaque_depth);
}

void passes_resolve(Passes *passes)
{
    const Targets *targets = &passes->targets;
    gl.BindTextureUnit(0, targets->accum);
    gl.BindTextureUnit(1, targets->opaque_color[GBUFFER_DIFFUSE]);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, targets->resolve_buffer);
    gl.UseProgram(passes->resolve);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}
