/* Deep deferred: one geometry pass into per-pixel lists of packed G-buffer nodes.
 *
 * This work is based on: A. Breust, "Deep Deferred Renderer"; J. Yang, J. Hensley, H. Grün,
 * N. Thibieroz, "Real-Time Concurrent Linked List Construction on the GPU", EGSR 2010.
 *
 * What a list and a layer are: ref/pipeline/methods/linked_list.c. One program draws opaque and
 * transparent instances in one pass; nodes lie in a storage buffer, numbered by an atomic counter,
 * and the lists' heads in another. Full-screen passes drop hidden nodes and sort every list by
 * relinking it; then each layer is a full-screen pass that takes the head of each list to an
 * ordinary compact G-buffer, which is lit and blended as a peel's.
 *
 * llvmpipe ends the loops of a shader after 65,535 turns in all, and sorting n nodes by insertion
 * takes up to n + n²/2. So longer lists than SORTED_MAX are not sorted: before each layer one more
 * pass puts the front node at the head. That is a pass of its own because llvmpipe 22.3.6 looks up
 * wrong materials in a loop behind one whose lanes leave at different turns.
 *
 * Without desc->nodes_per_pixel the buffer has room for NODES_GUESSED nodes a pixel, and when the
 * counter shows that there are more, for as many as there are: then geometry was drawn twice. The
 * buffer may be larger than the driver promises to reach in a block: llvmpipe says 2^27 bytes and
 * reaches all. So the last node is read back, and where it was not stored the frame is refused. */
#include "methods/methods.h"

#include "base/progress.h"
#include "frame/node.h"
#include "program.h"
#include "readback.h"

#include <stdio.h>
#include <stdlib.h>

enum {
    SORTED_MAX = 300,
    PIXEL_NODES_MAX = 65000
};
/* Uniform locations and storage blocks of shaders/linked_list.frag.glsl. */
enum {
    UNIFORM_FIRST_PRIMITIVE = 10,
    UNIFORM_TRANSPARENT,
    UNIFORM_WIDTH,
    UNIFORM_CAPACITY,
    UNIFORM_MATERIAL_COUNT,
    BLOCK_HEADS = 1,
    BLOCK_NODES,
    BLOCK_MATERIALS
};

/* The first words of the heads' buffer. */
typedef struct Header {
    uint32_t asked, visible, deepest, unused;
} Header;

typedef struct Lists {
    Passes *passes;
    Frame *frame;
    GLuint list, visible, extract, order; /* programs; order is built when lists are known */
    GLuint heads, nodes, materials;       /* buffers */
    size_t heads_bytes, nodes_bytes, materials_bytes;
    uint32_t words, capacity, material_count; /* of a node; nodes; entries */
    Layer layer;
    GLuint id, layer_buffer; /* primitive ids, and the layer's framebuffer with them */
    GLuint empty_buffer;     /* nothing to draw to but a depth that is not tested */
    Header header;
    uint64_t blended; /* nodes that became a fragment of a layer */
} Lists;

/* ---- set-up ---- */

static Result build_program(const Passes *passes, const char *name, const char *defines,
                            const PassesSource *source, GLuint *out)
{
    Result result = passes_program(passes, name, defines, source, out);
    if (result == RESULT_OK)
        gl.ProgramUniform1ui(*out, UNIFORM_WIDTH, (GLuint)passes->desc->width);
    return result;
}

/* Of a full-screen pass. */
static Result build_full(const Passes *passes, const char *name, const char *defines, GLuint *out)
{
    const PassesSource source = {
        .peel_test = true, .octahedral = true, .main = shader_linked_list_frag};
    return build_program(passes, name, defines, &source, out);
}

static Result build_programs(Lists *state)
{
    const Passes *passes = state->passes;
    const PassesSource list = {
        .surface = true, .octahedral = true, .gbuffer = true, .main = shader_linked_list_frag};
    char defines[64];
    snprintf(defines, sizeof defines, "#define PASS_EXTRACT\n#define OUT_ID %d\n",
             passes->targets.color_count);
    Result result = build_program(passes, "list", "#define PASS_LIST\n", &list, &state->list);
    if (result == RESULT_OK)
        result = build_full(passes, "list visible", "#define PASS_VISIBLE\n", &state->visible);
    if (result == RESULT_OK)
        result = build_full(passes, "list extract", defines, &state->extract);
    return result;
}

static bool sorted_at_once(const Lists *state)
{
    return state->header.deepest <= SORTED_MAX;
}

/* The program that sorts lists, or the one that finds each layer's nodes. */
static Result build_order(Lists *state)
{
    bool sorts = sorted_at_once(state);
    char defines[64];
    snprintf(defines, sizeof defines, "#define PASS_%s\n%s", sorts ? "SORT" : "FIRST",
             state->passes->desc->depth_func == DEPTH_LEQUAL ? "#define GREATER_FIRST\n" : "");
    return build_full(state->passes, sorts ? "list sort" : "list first", defines, &state->order);
}

static Result make_layer(Lists *state)
{
    Targets *targets = &state->passes->targets;
    GLuint colors[GBUFFER_TARGETS + 1];
    Result result = targets_layer(targets, NULL, &state->layer);
    if (result == RESULT_OK)
        result = targets_texture(targets, FORMAT_R32UI, &state->id);
    if (result != RESULT_OK)
        return result;
    for (int i = 0; i < GBUFFER_TARGETS; i++)
        if (targets->attachment[i] >= 0)
            colors[targets->attachment[i]] = state->layer.color[i];
    colors[targets->color_count] = state->id;
    result = targets_framebuffer(targets->color_count + 1, colors, state->layer.depth,
                                 &state->layer_buffer);
    if (result == RESULT_OK)
        result = targets_framebuffer(0, NULL, state->layer.depth, &state->empty_buffer);
    return result;
}

static Result make_materials(Lists *state)
{
    const Passes *passes = state->passes;
    NodeMaterial *entries;
    if (state->words != NODE_WORDS)
        return RESULT_OK;
    Result result = node_materials(passes->scene, passes->view, &entries, &state->material_count);
    if (result != RESULT_OK)
        return result;
    state->materials_bytes = (state->material_count + (size_t)1) * sizeof *entries;
    result = targets_buffer(&state->passes->targets, state->materials_bytes, &state->materials);
    if (result == RESULT_OK) {
        gl.NamedBufferSubData(state->materials, 0, (GLsizeiptr)state->materials_bytes, entries);
        gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, BLOCK_MATERIALS, state->materials);
        gl.ProgramUniform1ui(state->extract, UNIFORM_MATERIAL_COUNT, state->material_count);
    }
    free(entries);
    return result;
}

static Result create(Passes *passes, void *into)
{
    Lists *state = into;
    state->passes = passes;
    size_t pixels = (size_t)passes->desc->width * (size_t)passes->desc->height;
    state->words = node_words(passes->scene);
    state->heads_bytes = (NODES_HEADER_WORDS + pixels) * sizeof(uint32_t);
    Result result = build_programs(state);
    if (result == RESULT_OK)
        result = make_layer(state);
    if (result == RESULT_OK)
        result = make_materials(state);
    if (result == RESULT_OK)
        result = targets_buffer(&state->passes->targets, state->heads_bytes, &state->heads);
    return result;
}

static void destroy(void *of)
{
    Lists *state = of;
    gl.DeleteProgram(state->list);
    gl.DeleteProgram(state->visible);
    gl.DeleteProgram(state->extract);
    gl.DeleteProgram(state->order);
    gl.DeleteBuffers(1, &state->heads);
    gl.DeleteBuffers(1, &state->nodes);
    gl.DeleteBuffers(1, &state->materials);
    gl.DeleteFramebuffers(1, &state->layer_buffer);
    gl.DeleteFramebuffers(1, &state->empty_buffer);
    gl.DeleteTextures(1, &state->id);
    targets_destroy_layer(&state->layer, false);
}

/* ---- the geometry pass ---- */

static size_t node_bytes(const Lists *state)
{
    return state->words * sizeof(uint32_t);
}

static Result too_many(const Lists *state, uint64_t nodes)
{
    return result_fail(RESULT_UNSUPPORTED,
                       "linked-list: %llu nodes of %zu bytes: more than the OpenGL driver reaches",
                       (unsigned long long)nodes, node_bytes(state));
}

static GLintptr last_primitive(const Lists *state)
{
    return (GLintptr)((state->capacity - (size_t)1) * node_bytes(state) +
                      NODE_PRIMITIVE * sizeof(uint32_t));
}

/* Room for `capacity` nodes. */
static Result make_nodes(Lists *state, uint64_t capacity)
{
    Targets *targets = &state->passes->targets;
    uint64_t bytes = capacity * node_bytes(state);
    if (bytes > UINT32_MAX)
        return too_many(state, capacity);
    targets_free_buffer(targets, state->nodes_bytes, &state->nodes);
    state->capacity = (uint32_t)capacity;
    state->nodes_bytes = (size_t)bytes;
    Result result = targets_buffer(targets, state->nodes_bytes, &state->nodes);
    if (result != RESULT_OK)
        return result;
    gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, BLOCK_NODES, state->nodes);
    gl.ProgramUniform1ui(state->list, UNIFORM_CAPACITY, state->capacity);
    return context_check(state->passes->context, "list nodes");
}

/* Where all nodes were asked for, the last must be there. */
static Result check_nodes(const Lists *state)
{
    uint32_t primitive;
    if (state->header.asked < state->capacity)
        return RESULT_OK;
    gl.GetNamedBufferSubData(state->nodes, last_primitive(state), sizeof primitive, &primitive);
    return primitive == NODE_NONE ? too_many(state, state->capacity) : RESULT_OK;
}

static void read_header(Lists *state)
{
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    gl.GetNamedBufferSubData(state->heads, 0, sizeof state->header, &state->header);
}

/* The last node is marked as not stored before: see check_nodes. */
static Result draw_lists(Lists *state)
{
    static const Header zero = {0};
    static const uint32_t none = NODE_NONE;
    const Passes *passes = state->passes;
    const View *view = passes->view;
    progress_add();
    state->frame->geometry_passes++;
    gl.NamedBufferSubData(state->nodes, last_primitive(state), sizeof none, &none);
    gl.ClearNamedBufferData(state->heads, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &none);
    gl.NamedBufferSubData(state->heads, 0, sizeof zero, &zero);
    gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, BLOCK_HEADS, state->heads);
    passes_begin_opaque(passes);
    gl.UseProgram(state->list);
    gl.Enable(GL_DEPTH_TEST);
    for (size_t i = 0; i < view->draw_count; i++) {
        const Draw *draw = &view->draws[i];
        gl.ProgramUniform1ui(state->list, UNIFORM_FIRST_PRIMITIVE, draw->first_primitive);
        gl.ProgramUniform1i(state->list, UNIFORM_TRANSPARENT, draw->transparent);
        passes_draw_range(passes, state->list, draw, 0, UINT32_MAX);
    }
    gl.Disable(GL_DEPTH_TEST);
    read_header(state);
    return context_check(passes->context, "list pass");
}

/* As many as fit the limits, up to NODES_GUESSED a pixel. */
static uint64_t guess(const Lists *state)
{
    const Targets *targets = &state->passes->targets;
    uint64_t node = node_bytes(state);
    uint64_t nodes = NODES_GUESSED * (uint64_t)targets->width * (uint64_t)targets->height;
    uint64_t left = (targets->limit - targets->bytes) / node;
    uint64_t block = (uint64_t)context_limits(state->passes->context)->storage_block / node;
    nodes = nodes < left ? nodes : left;
    nodes = nodes < block ? nodes : block;
    return nodes > 0 ? nodes : 1;
}

static Result build_lists(Lists *state)
{
    const RenderDesc *desc = state->passes->desc;
    uint64_t pixels = (uint64_t)desc->width * (uint64_t)desc->height;
    bool fixed = desc->nodes_per_pixel > 0;
    Result result = RESULT_OK;
    if (!state->nodes) /* the first frame: later ones need as much */
        result = make_nodes(state, fixed ? (uint64_t)desc->nodes_per_pixel * pixels : guess(state));
    if (result == RESULT_OK)
        result = draw_lists(state);
    if (result == RESULT_OK && !fixed && state->header.asked > state->capacity) {
        result = make_nodes(state, state->header.asked);
        if (result == RESULT_OK)
            result = draw_lists(state);
    }
    if (result == RESULT_OK)
        result = check_nodes(state);
    return result == RESULT_OK ? passes_end_opaque(state->passes) : result;
}

/* ---- layers ---- */

/* A pass that reads and writes the lists alone. */
static void relink(const Lists *state, GLuint program)
{
    passes_fullscreen(state->passes, program, state->empty_buffer);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
}

static Result sort_lists(Lists *state)
{
    passes_bind_opaque_depth(state->passes);
    relink(state, state->visible);
    read_header(state);
    if (state->header.deepest >= PIXEL_NODES_MAX)
        return result_fail(RESULT_UNSUPPORTED,
                           "linked-list: %u nodes in one pixel, expected fewer than %d",
                           state->header.deepest, PIXEL_NODES_MAX);
    /* Later frames have the same lists. */
    Result result = state->order ? RESULT_OK : build_order(state);
    if (result != RESULT_OK)
        return result;
    if (sorted_at_once(state))
        relink(state, state->order);
    return context_check(state->passes->context, "list sort");
}

/* *samples: the pixels that have a node left. */
static Result draw_layer(Lists *state, uint64_t *samples)
{
    static const GLuint none[4] = {NODE_NONE, NODE_NONE, NODE_NONE, NODE_NONE};
    const Passes *passes = state->passes;
    progress_add();
    if (!sorted_at_once(state))
        relink(state, state->order);
    passes_clear_layer(passes, &state->layer);
    gl.ClearNamedFramebufferuiv(state->layer_buffer, GL_COLOR, passes->targets.color_count, none);
    gl.DepthFunc(GL_ALWAYS);
    gl.Enable(GL_DEPTH_TEST);
    passes_begin_count(passes, samples);
    passes_fullscreen(passes, state->extract, state->layer_buffer);
    gl.Disable(GL_DEPTH_TEST);
    passes_depth_test(passes->desc, passes->desc->depth_func);
    gl.MemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
    return passes_end_count(passes, "list layer", samples);
}

static Result trace_layer(const Lists *state, int peel)
{
    const Passes *passes = state->passes;
    const Targets *targets = &passes->targets;
    Result result =
        readback_trace_gbuffer(targets, state->layer.buffer, peel, passes->trace, passes->pixels);
    if (result != RESULT_OK)
        return result;
    readback_color(targets, state->layer_buffer, targets->color_count, FORMAT_R32UI,
                   READBACK_TOP_DOWN, passes->pixels);
    result = trace_put_peel(passes->trace, peel, "id", FORMAT_R32UI, targets->width,
                            targets->height, passes->pixels);
    return result == RESULT_OK ? passes_trace_peel_accum(passes, peel) : result;
}

/* One layer. *more: false when there was none. */
static Result blend_layer(void *context, int peel, bool *more)
{
    Lists *state = context;
    uint64_t samples = 0;
    Result result = draw_layer(state, &samples);
    *more = result == RESULT_OK && samples > 0;
    if (!*more)
        return result;
    state->blended += samples;
    state->frame->peels = peel + 1;
    passes_light_layer(state->passes, &state->layer);
    return state->passes->trace ? trace_layer(state, peel) : RESULT_OK;
}

/* ---- the frame ---- */

static void report(const Lists *state)
{
    Frame *frame = state->frame;
    frame->nodes = state->header.asked;
    frame->node_bytes = state->words * (uint32_t)sizeof(uint32_t);
    frame->layers.max = state->header.deepest;
    frame->layers.fragments = state->header.visible;
    frame->layers.lost_to_pass_limit = state->header.visible - state->blended;
    if (state->header.asked <= state->capacity)
        return;
    frame->layers.lost_to_overflow = state->header.asked - state->capacity;
    result_warn("gl: linked-list: no room for %llu of %llu nodes (--nodes-per-pixel)",
                (unsigned long long)frame->layers.lost_to_overflow,
                (unsigned long long)frame->nodes);
}

static Result draw(void *of, Frame *out)
{
    Lists *state = of;
    state->blended = 0;
    state->frame = out;
    Result result = build_lists(state);
    if (result == RESULT_OK)
        result = sort_lists(state);
    if (result == RESULT_OK)
        result = passes_peels(state->passes, blend_layer, state);
    if (result == RESULT_OK)
        result = passes_finish(state->passes, state->frame->peels);
    if (result == RESULT_OK)
        report(state);
    return result;
}

const GlMethod gl_linked_list = {sizeof(Lists), create, draw, destroy};
