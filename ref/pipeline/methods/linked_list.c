/* Deep deferred: per-pixel lists of packed G-buffer nodes, the definition path.
 *
 * This work is based on: Alexis Breust, "Deep Deferred Renderer"; J. Yang, J. Hensley, H. Grün,
 * N. Thibieroz, "Real-Time Concurrent Linked List Construction on the GPU", EGSR 2010.
 *
 * One geometry pass: opaque fragments go to the opaque G-buffer, every transparent one becomes a
 * node (frame/node.h) of its pixel's list. Then each list is sorted, and nodes that turned out to
 * lie behind the opaque depth are dropped; layer after layer is written to a compact G-buffer, lit
 * and blended under, until no list has another node; then the opaque surfaces, and the background.
 *
 * Order: stored depth, then primitive id (of equal depths the smaller id is in front with
 * DEPTH_LESS, the greater with DEPTH_LEQUAL), then the other words of the node, greater last; so
 * that neither the draw order nor the order of insertion shows, and coplanar fragments are layers
 * of their own. A bias means nothing here.
 *
 * The G-buffer is compact, whatever desc asks for. Memory: desc->nodes_per_pixel times the pixels,
 * or as many nodes as there are. What finds no room is lost and counted; here that is the tail in
 * the order of tiles (of TILE_DEFAULT, whatever desc asks for) and primitives, in gl it depends on
 * threads.
 *
 * The trace has the buffers of peel, layer K under peel.K.*, and peel.K.id (FORMAT_R32UI). */
#include "ref/pipeline/methods/methods.h"

#include "base/memory.h"
#include "frame/node.h"
#include "ref/pipeline/stage.h"

#include <stdlib.h>

typedef struct Lists {
    uint32_t words; /* of a node */
    uint32_t *nodes;
    uint64_t capacity, total; /* nodes: there is room for, and there are */
    uint32_t *heads;          /* per pixel: its first node, or the next to extract */
    uint64_t *tile_first;     /* per tile: number of its first node; before that, how many it has */
    uint64_t *tile_next;      /* per tile: number of the next one */
    NodeMaterial *materials;
    uint32_t material_count;
    GBuffer layer;
    int peel;
} Lists;

static inline uint32_t *node_at(const Lists *lists, uint32_t index)
{
    return lists->nodes + (size_t)index * lists->words;
}

static inline uint32_t node_key(const Pass *pass, const uint32_t *node)
{
    return depth_key(pass->depth_format, op_from_bits(node[NODE_DEPTH]));
}

/* ---- how many nodes there are ---- */

static void visit_count(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    Stage *stage = visit->stage;
    const Pass *pass = stage->pass;
    const Lists *lists = stage->method;
    size_t pixel = stage_pixel(pass, x, y);
    uint32_t tile = pass_tile_at(pass, x, y);
    lists->tile_first[tile]++;
    if (!pass_hidden(pass, pass_fragment_depth(pass, setup, x, y),
                     stage_key(&stage->opaque.depth, pixel)))
        stage->fragments[pixel]++;
}

static void count_tile(Stage *stage, uint32_t tile)
{
    StageVisit visit = {.stage = stage, .list = &stage->pass->geometry.transparent};
    stage_draw(&stage->pass->transparent_bins, tile, visit_count, &visit);
}

/* From counts to numbers, so that the nodes do not depend on threads. */
static void number_tiles(const Pass *pass, Lists *lists)
{
    lists->total = 0;
    for (uint32_t tile = 0; tile < pass->tile_count; tile++) {
        uint64_t count = lists->tile_first[tile];
        lists->tile_first[tile] = lists->tile_next[tile] = lists->total;
        lists->total += count;
    }
}

static Result make_room(Pass *pass, Lists *lists)
{
    uint64_t pixels = (uint64_t)pass->view.width * (uint64_t)pass->view.height;
    lists->capacity =
        pass->desc->nodes_per_pixel ? (uint64_t)pass->desc->nodes_per_pixel * pixels : lists->total;
    if (lists->capacity > NODE_NONE)
        return result_fail(RESULT_UNSUPPORTED, "linked-list: %llu nodes, at most 2^32 - 1 expected",
                           (unsigned long long)lists->capacity);
    Result result = pass_reserve(pass, lists->capacity * lists->words * sizeof(uint32_t));
    if (result != RESULT_OK)
        return result;
    lists->nodes = memory_array((size_t)lists->capacity + 1, lists->words * sizeof(uint32_t));
    return lists->nodes ? RESULT_OK : RESULT_NO_MEMORY;
}

/* ---- the geometry pass ---- */

static void fill_node(const StageVisit *visit, const Setup *setup, int x, int y, uint32_t *node)
{
    const Pass *pass = visit->stage->pass;
    const Lists *lists = visit->stage->method;
    Texel texel;
    fragment_shade(pass, setup, visit->primitive, x, y, &texel);
    node[NODE_DEPTH] = op_bits(pass_fragment_depth(pass, setup, x, y).z);
    node[NODE_PRIMITIVE] = visit->primitive->id;
    format_store(pass->layout.normal, texel.normal, &node[NODE_NORMAL]);
    if (lists->words == NODE_WORDS)
        return;
    format_store(pass->layout.diffuse, texel.diffuse, &node[NODE_DIFFUSE]);
    format_store(pass->layout.material, texel.material, &node[NODE_MATERIAL]);
}

static void visit_fragment(void *context, const Setup *setup, int x, int y)
{
    const StageVisit *visit = context;
    const Pass *pass = visit->stage->pass;
    const Lists *lists = visit->stage->method;
    uint32_t tile = pass_tile_at(pass, x, y);
    uint64_t number = lists->tile_next[tile]++;
    if (number >= lists->capacity)
        return;
    uint32_t *head = &lists->heads[stage_pixel(pass, x, y)];
    uint32_t *node = node_at(lists, (uint32_t)number);
    fill_node(visit, setup, x, y, node);
    node[NODE_NEXT] = *head;
    *head = (uint32_t)number;
}

static void list_tile(Stage *stage, uint32_t tile)
{
    StageVisit visit = {.stage = stage, .list = &stage->pass->geometry.transparent};
    stage_draw(&stage->pass->transparent_bins, tile, visit_fragment, &visit);
}

/* ---- sorting ---- */

static bool comes_before(const Pass *pass, const Lists *lists, const uint32_t *a, const uint32_t *b)
{
    uint32_t key[2] = {node_key(pass, a), node_key(pass, b)};
    if (key[0] != key[1])
        return pass->reversed ? key[0] > key[1] : key[0] < key[1];
    uint32_t id[2] = {a[NODE_PRIMITIVE], b[NODE_PRIMITIVE]};
    if (id[0] != id[1])
        return pass->desc->depth_func == DEPTH_LEQUAL ? id[0] > id[1] : id[0] < id[1];
    if (a[NODE_NORMAL] != b[NODE_NORMAL] || lists->words == NODE_WORDS)
        return a[NODE_NORMAL] < b[NODE_NORMAL];
    if (a[NODE_DIFFUSE] != b[NODE_DIFFUSE])
        return a[NODE_DIFFUSE] < b[NODE_DIFFUSE];
    return a[NODE_MATERIAL] < b[NODE_MATERIAL];
}

/* Puts a node into a sorted list; returns the list's head. */
static uint32_t insert(const Pass *pass, const Lists *lists, uint32_t head, uint32_t index)
{
    uint32_t *node = node_at(lists, index), *link = &head;
    while (*link != NODE_NONE && comes_before(pass, lists, node_at(lists, *link), node))
        link = &node_at(lists, *link)[NODE_NEXT];
    node[NODE_NEXT] = *link;
    *link = index;
    return head;
}

static void sort_tile(Stage *stage, uint32_t tile)
{
    const Pass *pass = stage->pass;
    const Lists *lists = stage->method;
    PixelRect rect = pass_tile_rect(pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            size_t pixel = stage_pixel(pass, x, y);
            uint32_t opaque = stage_key(&stage->opaque.depth, pixel);
            uint32_t sorted = NODE_NONE, next;
            for (uint32_t at = lists->heads[pixel]; at != NODE_NONE; at = next) {
                const uint32_t *node = node_at(lists, at);
                FragmentDepth depth = {op_from_bits(node[NODE_DEPTH]), node_key(pass, node)};
                next = node[NODE_NEXT];
                if (!pass_hidden(pass, depth, opaque))
                    sorted = insert(pass, lists, sorted, at);
            }
            lists->heads[pixel] = sorted;
        }
}

/* ---- layers ---- */

/* The next node of each pixel to the layer's G-buffer. */
static void extract_tile(Stage *stage, uint32_t tile)
{
    const Pass *pass = stage->pass;
    Lists *lists = stage->method;
    PixelRect rect = pass_tile_rect(pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            size_t pixel = stage_pixel(pass, x, y);
            uint32_t at = lists->heads[pixel];
            if (at == NODE_NONE)
                continue;
            const uint32_t *node = node_at(lists, at);
            uint32_t diffuse, material;
            if (lists->words == NODE_WORDS) {
                const NodeMaterial *entry =
                    node_material(lists->materials, lists->material_count, node[NODE_PRIMITIVE]);
                diffuse = entry->diffuse;
                material = entry->material;
            } else {
                diffuse = node[NODE_DIFFUSE];
                material = node[NODE_MATERIAL];
            }
            ((uint32_t *)lists->layer.depth.pixels)[pixel] = node_key(pass, node);
            ((uint32_t *)lists->layer.normal.pixels)[pixel] = node[NODE_NORMAL];
            ((uint32_t *)lists->layer.diffuse.pixels)[pixel] = diffuse;
            ((uint32_t *)lists->layer.material.pixels)[pixel] = material;
            ((uint32_t *)lists->layer.primitive.pixels)[pixel] = node[NODE_PRIMITIVE];
            lists->heads[pixel] = node[NODE_NEXT];
        }
}

static Result draw_layer(Stage *stage, uint64_t *drawn)
{
    Lists *lists = stage->method;
    uint64_t repeated;
    gbuffer_clear(&lists->layer, stage->pass->desc->depth_range);
    Result result = stage_run(stage, extract_tile);
    stage_count_drawn(&lists->layer, NULL, drawn, &repeated);
    return result;
}

static Result blend_layer(Stage *stage)
{
    Lists *lists = stage->method;
    Result result = stage_put_gbuffer(stage, lists->peel, &lists->layer);
    if (result == RESULT_OK)
        result = stage_put(stage, lists->peel, "id", &lists->layer.primitive);
    if (result == RESULT_OK)
        result = stage_light(stage, &lists->layer, true);
    if (result == RESULT_OK)
        result = stage_put_source(stage, lists->peel);
    if (result == RESULT_OK)
        result = stage_put(stage, lists->peel, "accum", &stage->accum);
    return result;
}

static Result layers(Stage *stage)
{
    Lists *lists = stage->method;
    int limit = render_desc_pass_limit(stage->pass->desc);
    for (lists->peel = 0; lists->peel < limit; lists->peel++) {
        uint64_t drawn;
        Result result = draw_layer(stage, &drawn);
        if (result == RESULT_OK && drawn == 0)
            break;
        stage->counts.peeled += drawn;
        if (result == RESULT_OK)
            result = blend_layer(stage);
        if (result != RESULT_OK)
            return result;
        stage->frame->peels = lists->peel + 1;
    }
    return RESULT_OK;
}

static void remaining_tile(Stage *stage, uint32_t tile)
{
    const Pass *pass = stage->pass;
    const Lists *lists = stage->method;
    PixelRect rect = pass_tile_rect(pass, tile);
    for (int y = rect.y0; y <= rect.y1; y++)
        for (int x = rect.x0; x <= rect.x1; x++) {
            size_t pixel = stage_pixel(pass, x, y);
            for (uint32_t at = lists->heads[pixel]; at != NODE_NONE;
                 at = node_at(lists, at)[NODE_NEXT])
                stage->remaining[pixel]++;
        }
    stage_count_remaining(stage, tile);
}

/* ---- the frame ---- */

static Result build_lists(Stage *stage, Pass *pass)
{
    Lists *lists = stage->method;
    Result result = stage_run(stage, count_tile);
    if (result == RESULT_OK) {
        number_tiles(pass, lists);
        result = make_room(pass, lists);
    }
    if (result == RESULT_OK)
        result = stage_run(stage, list_tile);
    if (result == RESULT_OK)
        result = stage_run(stage, sort_tile);
    return result;
}

/* What has no room is in front of the opaque depth or behind it, but never tied. */
static void report(const Lists *lists, Frame *frame)
{
    frame->geometry_passes = 1;
    frame->nodes = lists->total;
    frame->node_bytes = lists->words * (uint32_t)sizeof(uint32_t);
    frame->layers.lost_to_ties = 0;
    if (lists->total <= lists->capacity)
        return;
    frame->layers.lost_to_overflow = lists->total - lists->capacity;
    result_warn("ref: linked-list: no room for %llu of %llu nodes (--nodes-per-pixel)",
                (unsigned long long)frame->layers.lost_to_overflow,
                (unsigned long long)lists->total);
}

static Result run(Stage *stage, Pass *pass)
{
    Result result = stage_opaque(stage);
    if (result == RESULT_OK)
        result = build_lists(stage, pass);
    if (result == RESULT_OK)
        result = layers(stage);
    if (result == RESULT_OK)
        result = stage_run(stage, remaining_tile);
    if (result == RESULT_OK)
        result = stage_finish(stage);
    if (result == RESULT_OK)
        report(stage->method, stage->frame);
    return result;
}

static Result make(const Pass *pass, Lists *out)
{
    size_t pixels = (size_t)pass->view.width * (size_t)pass->view.height;
    out->words = node_words(pass->scene);
    out->heads = memory_array(pixels, sizeof *out->heads);
    out->tile_first = memory_array(pass->tile_count, sizeof *out->tile_first);
    out->tile_next = memory_array(pass->tile_count, sizeof *out->tile_next);
    if (!out->heads || !out->tile_first || !out->tile_next)
        return RESULT_NO_MEMORY;
    memset(out->heads, 0xff, pixels * sizeof *out->heads);
    Result result = node_materials(pass->scene, &pass->view, &out->materials, &out->material_count);
    return result == RESULT_OK ? gbuffer_create(pass->desc, &pass->stored[1], &out->layer) : result;
}

Result linked_list_render(Pass *pass, TraceSink *trace, Frame *frame)
{
    Lists lists = {0};
    Stage stage;
    uint64_t heads_bytes =
        (uint64_t)pass->view.width * (uint64_t)pass->view.height * sizeof(uint32_t);
    Result result = stage_create(pass, trace, frame, &lists,
                                 stage_gbuffer_bytes(pass, true) + heads_bytes, &stage);
    if (result != RESULT_OK)
        return result;
    result = make(pass, &lists);
    if (result == RESULT_OK)
        result = run(&stage, pass);
    gbuffer_free(&lists.layer);
    free(lists.materials);
    free(lists.nodes);
    free(lists.heads);
    free(lists.tile_first);
    free(lists.tile_next);
    stage_free(&stage);
    return result;
}
