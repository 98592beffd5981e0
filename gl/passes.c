#include "passes.h"

#include "base/memory.h"
#include "program.h"
#include "readback.h"
#include "uniforms.h"

#include <stdio.h>
#include <stdlib.h>

/* ---- the frame ---- */

void passes_depth_test(const RenderDesc *desc, DepthFunc func)
{
    if (desc->depth_range == DEPTH_RANGE_REVERSED)
        gl.DepthFunc(func == DEPTH_LEQUAL ? GL_GEQUAL : GL_GREATER);
    else
        gl.DepthFunc(func == DEPTH_LEQUAL ? GL_LEQUAL : GL_LESS);
}

void passes_begin(const Passes *passes)
{
    const RenderDesc *desc = passes->desc;
    gl.ProgramUniform3fv(passes->resolve, UNIFORM_BACKGROUND, 1, passes->view->background);
    gl.Viewport(0, 0, desc->width, desc->height);
    passes_depth_test(desc, desc->depth_func);
    gl.ClipControl(GL_LOWER_LEFT,
                   desc->depth_range == DEPTH_RANGE_GL ? GL_NEGATIVE_ONE_TO_ONE : GL_ZERO_TO_ONE);
    gl.BindVertexArray(passes->meshes.vertex_array);
}

static Result upload_wanted_textures(Passes *passes)
{
    const Scene *scene = passes->scene;
    bool *wanted = memory_array(scene->texture_count, sizeof *wanted);
    if (!wanted)
        return RESULT_NO_MEMORY;
    needs_textures(&passes->needs, scene, passes->view, wanted);
    Result result = upload_textures(passes->context, scene, wanted, passes->desc,
                                    passes->targets.bytes, &passes->textures);
    free(wanted);
    return result;
}

static Result make(Passes *out)
{
    const RenderDesc *desc = out->desc;
    needs_derive(out->scene, out->view, desc, out->trace != NULL, &out->needs);
    Result result = targets_create(out->context, desc, &out->needs, &out->targets);
    if (result == RESULT_OK)
        result = upload_meshes(out->context, out->scene, &out->needs, &out->meshes);
    if (result == RESULT_OK)
        result = upload_lights(out->context, out->view, &out->lights);
    if (result == RESULT_OK)
        result = upload_wanted_textures(out);
    if (result == RESULT_OK)
        result = passes_build_programs(out);
    if (result == RESULT_OK && out->trace) {
        out->pixels = memory_array((size_t)desc->width * (size_t)desc->height, 4 * sizeof(float));
        result = out->pixels ? RESULT_OK : RESULT_NO_MEMORY;
    }
    if (result != RESULT_OK)
        return result;
    gl.CreateQueries(GL_SAMPLES_PASSED, 1, &out->samples);
    return context_check(out->context, "set-up");
}

Result passes_create(const Passes *in, Passes *out)
{
    *out = *in;
    Result result = make(out);
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
    gl.DeleteProgram(passes->opaque_geometry);
    gl.DeleteProgram(passes->opaque_lighting);
    gl.DeleteProgram(passes->peel_lighting);
    gl.DeleteProgram(passes->resolve);
    gl.DeleteQueries(1, &passes->samples);
    free(passes->pixels);
    *passes = (Passes){0};
}

/* ---- draws ---- */

/* Texture units of shaders/peel_test.glsl and surface.glsl. */
enum {
    UNIT_OPAQUE_DEPTH = 1,
    UNIT_BASE_COLOR,
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
    if (needs_has(&passes->needs, NEED_BASE_COLOR_TEXTURE))
        bind_texture(passes, program, material->base_color_texture, UNIT_BASE_COLOR,
                     UNIFORM_BASE_COLOR_SAMPLER);
    if (needs_has(&passes->needs, NEED_MATERIAL_TEXTURE))
        bind_texture(passes, program, material->metallic_roughness_texture, UNIT_METALLIC_ROUGHNESS,
                     UNIFORM_METALLIC_ROUGHNESS_SAMPLER);
    if (needs_has(&passes->needs, NEED_MASK))
        gl.ProgramUniform1f(program, UNIFORM_ALPHA_CUTOFF,
                            item->masked ? material->alpha_cutoff : 0.0f);
}

void passes_use_draw(const Passes *passes, GLuint program, const Draw *draw)
{
    const Material *material = &passes->scene->materials[draw->material];
    const float surface[3] = {material->roughness, material->metallic, material->occlusion};
    gl.ProgramUniformMatrix4fv(program, UNIFORM_MODEL_VIEW, 1, GL_FALSE, draw->model_view);
    gl.ProgramUniformMatrix3fv(program, UNIFORM_NORMAL_MATRIX, 1, GL_FALSE, draw->normal_matrix);
    gl.ProgramUniform4fv(program, UNIFORM_BASE_COLOR, 1, material->base_color);
    gl.ProgramUniform3fv(program, UNIFORM_MATERIAL, 1, surface);
    if (needs_has(&passes->needs, NEED_CULLING))
        gl.ProgramUniform1i(program, UNIFORM_CULL_BACK, draw->cull_back);
    gl.ProgramUniform1i(program, UNIFORM_FLIPPED, draw->flipped);
    bind_textures(passes, program, draw);
}

void passes_draw_triangles(const Passes *passes, const Draw *draw, uint32_t first, uint32_t count)
{
    const MeshRange *range = &passes->meshes.ranges[draw->mesh];
    uint32_t triangles = range->index_count / 3;
    if (first >= triangles)
        return;
    count = count < triangles - first ? count : triangles - first;
    size_t at = range->first_index + 3 * (size_t)first;
    gl.DrawElementsBaseVertex(GL_TRIANGLES, (GLsizei)(3 * count), GL_UNSIGNED_INT,
                              (const void *)(at * sizeof(uint32_t)), range->base_vertex);
}

void passes_draw_range(const Passes *passes, GLuint program, const Draw *draw, uint32_t first,
                       uint32_t count)
{
    passes_use_draw(passes, program, draw);
    passes_draw_triangles(passes, draw, first, count);
}

void passes_draw_list(const Passes *passes, GLuint program, bool transparent)
{
    gl.UseProgram(program);
    for (size_t i = 0; i < passes->view->draw_count; i++)
        if (passes->view->draws[i].transparent == transparent)
            passes_draw_range(passes, program, &passes->view->draws[i], 0, UINT32_MAX);
}

void passes_begin_count(const Passes *passes, const uint64_t *samples)
{
    if (samples)
        gl.BeginQuery(GL_SAMPLES_PASSED, passes->samples);
}

Result passes_end_count(const Passes *passes, const char *what, uint64_t *samples)
{
    GLuint64 count = 0;
    if (!samples)
        return RESULT_OK;
    gl.EndQuery(GL_SAMPLES_PASSED);
    gl.GetQueryObjectui64v(passes->samples, GL_QUERY_RESULT, &count);
    *samples = count;
    return context_check(passes->context, what);
}

Result passes_draw_counted(const Passes *passes, GLuint program, bool transparent,
                           uint64_t *samples)
{
    passes_begin_count(passes, samples);
    gl.Enable(GL_DEPTH_TEST);
    passes_draw_list(passes, program, transparent);
    gl.Disable(GL_DEPTH_TEST);
    return passes_end_count(passes, "geometry pass", samples);
}

void passes_bind_opaque_depth(const Passes *passes)
{
    const Targets *targets = &passes->targets;
    gl.BindTextureUnit(UNIT_OPAQUE_DEPTH,
                       targets->opaque_code ? targets->opaque_code : targets->opaque.depth);
}

void passes_fullscreen(const Passes *passes, GLuint program, GLuint framebuffer)
{
    (void)passes;
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer);
    gl.UseProgram(program);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

void passes_clear_layer(const Passes *passes, const Layer *layer)
{
    static const float zero[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    const float far = passes->desc->depth_range == DEPTH_RANGE_REVERSED ? 0.0f : 1.0f;
    for (int i = 0; i < passes->targets.color_count && layer->color[GBUFFER_DIFFUSE]; i++)
        gl.ClearNamedFramebufferfv(layer->buffer, GL_COLOR, i, zero);
    gl.ClearNamedFramebufferfv(layer->buffer, GL_DEPTH, 0, &far);
}

/* ---- the passes that methods share ---- */

void passes_begin_opaque(const Passes *passes)
{
    static const float no_color_all_transmitted[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    const Targets *targets = &passes->targets;
    gl.ClearNamedFramebufferfv(targets->plain_buffer, GL_COLOR, 0, no_color_all_transmitted);
    passes_clear_layer(passes, &targets->opaque);
    gl.BindFramebuffer(GL_DRAW_FRAMEBUFFER, targets->opaque.buffer);
}

Result passes_end_opaque(Passes *passes)
{
    const Targets *targets = &passes->targets;
    Result result = targets_copy_code(targets, targets->opaque.buffer, targets->opaque_code);
    if (result == RESULT_OK && passes->trace)
        result = readback_trace_gbuffer(targets, targets->opaque.buffer, -1, passes->trace,
                                        passes->pixels);
    return result;
}

Result passes_opaque(Passes *passes)
{
    Result result = RESULT_OK;
    passes_begin_opaque(passes);
    if (needs_has(&passes->needs, NEED_OPAQUE))
        result = passes_draw_counted(passes, passes->opaque_geometry, false, NULL);
    return result == RESULT_OK ? passes_end_opaque(passes) : result;
}

Result passes_peels(const Passes *passes, Result (*draw_peel)(void *state, int peel, bool *more),
                    void *state)
{
    int most = render_desc_pass_limit(passes->desc);
    bool more = true;
    Result result = RESULT_OK;
    for (int peel = 0; peel < most && more && result == RESULT_OK; peel++)
        result = draw_peel(state, peel, &more);
    return result;
}

void passes_blend_under(void)
{
    gl.BlendFuncSeparate(GL_DST_ALPHA, GL_ONE, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
}

void passes_blend_over(void)
{
    gl.BlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
}

/* Whether only pixels in front of the far end, where shaders/fullscreen.vert.glsl draws, pass. */
static void test_far(const Passes *passes, bool on)
{
    gl.DepthMask(!on);
    if (on) {
        gl.DepthFunc(passes->desc->depth_range == DEPTH_RANGE_REVERSED ? GL_LESS : GL_GREATER);
        gl.Enable(GL_DEPTH_TEST);
    } else {
        passes_depth_test(passes->desc, passes->desc->depth_func);
        gl.Disable(GL_DEPTH_TEST);
    }
}

/* Where no position is stored, the depth takes its texture unit. */
static void light(const Passes *passes, GLuint program, const Layer *layer)
{
    for (GLuint i = 0; i < GBUFFER_TARGETS; i++)
        gl.BindTextureUnit(i, layer->color[i] ? layer->color[i] : layer->depth);
    gl.Enable(GL_BLEND);
    if (passes->options.reject_early)
        test_far(passes, true);
    passes_fullscreen(passes, program,
                      passes->options.reject_early ? layer->light_buffer
                                                   : passes->targets.plain_buffer);
    if (passes->options.reject_early)
        test_far(passes, false);
    gl.Disable(GL_BLEND);
}

void passes_light_layer(const Passes *passes, const Layer *layer)
{
    passes_blend_under();
    light(passes, passes->peel_lighting, layer);
}

Result passes_finish(Passes *passes, int peels)
{
    if (passes->desc->opaque_blend == OPAQUE_BLEND_SEED)
        gl.BlendFunc(GL_DST_ALPHA, GL_ONE);
    else
        passes_blend_under();
    if (needs_has(&passes->needs, NEED_OPAQUE))
        light(passes, passes->opaque_lighting, &passes->targets.opaque);
    return passes_trace_accum(passes, "accum", peels + 1);
}

Result passes_opaque_only(Passes *passes, Frame *out)
{
    Result result = passes_opaque(passes);
    out->geometry_passes = 1; /* what a method would find out with */
    return result == RESULT_OK ? passes_finish(passes, 0) : result;
}

static void read_accum(const Passes *passes)
{
    const Targets *targets = &passes->targets;
    readback_color(targets, targets->plain_buffer, 0, targets->accum_format, READBACK_TOP_DOWN,
                   passes->pixels);
}

Result passes_trace_accum(const Passes *passes, const char *name, int step)
{
    const Targets *targets = &passes->targets;
    if (!passes->trace)
        return RESULT_OK;
    read_accum(passes);
    return trace_put(passes->trace, name, step, targets->accum_format, targets->width,
                     targets->height, passes->pixels);
}

Result passes_trace_peel_accum(const Passes *passes, int peel)
{
    const Targets *targets = &passes->targets;
    if (!passes->trace)
        return RESULT_OK;
    read_accum(passes);
    return trace_put_peel(passes->trace, peel, "accum", targets->accum_format, targets->width,
                          targets->height, passes->pixels);
}

void passes_resolve(Passes *passes)
{
    const Targets *targets = &passes->targets;
    gl.BindTextureUnit(0, targets->accum);
    gl.BindTextureUnit(1, targets->opaque.color[GBUFFER_DIFFUSE]);
    passes_fullscreen(passes, passes->resolve, targets->resolve_buffer);
}
