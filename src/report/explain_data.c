#include "report/explain_data.h"

#include "base/base64.h"
#include "base/memory.h"
#include "compare/metrics.h"
#include "frame/method.h"
#include "frame/setting.h"
#include "scene/blob.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

extern const char page_wasm[];
extern const unsigned long page_wasm_size;

/* ---- pieces of JSON ---- */

/* A string's '<' as \u003c: what has it is no markup then. */
static void put_string(Text *out, const char *string)
{
    Text plain = {0};
    text_json_string(&plain, string);
    if (plain.result != RESULT_OK)
        out->result = plain.result;
    for (const char *c = plain.bytes; c && *c;) {
        size_t run = strcspn(c, "<");
        text_print(out, "%.*s%s", (int)run, c, c[run] ? "\\u003c" : "");
        c += run + (c[run] != '\0');
    }
    text_free(&plain);
}

static void put_base64(Text *out, const unsigned char *bytes, size_t count)
{
    enum {
        BLOCK = 3072 /* bytes: whole groups of 3 */
    };
    char block[BLOCK / 3 * 4];
    for (size_t i = 0; i < count; i += BLOCK) {
        size_t part = count - i < BLOCK ? count - i : BLOCK;
        base64_put(bytes + i, part, block);
        text_print(out, "%.*s", (int)base64_length(part), block);
    }
}

/* As a JSON string; *room: its length is added. */
static Result put_packed(Text *out, const void *bytes, size_t count, size_t *room)
{
    uLongf packed_count = compressBound(count);
    unsigned char *packed = memory_array(packed_count, 1);
    if (!packed)
        return RESULT_NO_MEMORY;
    size_t before = out->count;
    bool failed = compress2(packed, &packed_count, bytes, count, Z_BEST_COMPRESSION) != Z_OK;
    text_print(out, "\"");
    put_base64(out, packed, packed_count);
    text_print(out, "\"");
    free(packed);
    *room += out->count - before;
    return failed ? result_fail(RESULT_NO_MEMORY, "out of memory for the page") : out->result;
}

/* ---- the program and the scene ---- */

static void put_settings(Text *out, const RenderDesc *desc)
{
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"method", desc->method},
                   {"passes", desc->passes},
                   {"lights", desc->lights},
                   {"camera", desc->camera},
                   {"time", desc->time},
                   {"bias", (double)desc->bias},
                   {"nodes-per-pixel", desc->nodes_per_pixel},
                   {"unfused", desc->unfused},
                   {"opaque-blend", desc->opaque_blend},
                   {"draw-order", desc->draw_order},
                   {"draw-seed", (double)desc->draw_seed}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        text_print(out, "%s[\"%s\",%.17g]", i ? "," : "", numbers[i].name, numbers[i].value);
    for (int i = 0; i < SETTING_COUNT; i++)
        text_print(out, ",[\"%s\",%d]", setting_info((SettingId)i)->name,
                   setting_get(desc, (SettingId)i));
}

static void put_methods(Text *out)
{
    for (int i = 0; i < METHOD_COUNT; i++) {
        const MethodInfo *method = method_info((MethodId)i);
        text_print(out, "%s{\"name\":\"%s\",\"summary\":", i ? "," : "", method->name);
        put_string(out, method->summary);
        text_print(out, ",\"paper\":");
        put_string(out, method->paper);
        text_print(out, ",\"exact\":%s}", method->exact ? "true" : "false");
    }
}

static void put_lesson(Text *out, const ExplainLesson *lesson)
{
    text_print(out, "\"lesson\":{\"number\":%d,\"titles\":[", lesson->number);
    for (int i = 0; i < lesson->count; i++) {
        text_print(out, i ? "," : "");
        put_string(out, lesson->titles[i]);
    }
    text_print(out, "]},\n");
}

static Result put_program(const ExplainDesc *explain, Text *out, ExplainRoom *room)
{
    text_print(out, "{");
    if (explain->lesson)
        put_lesson(out, explain->lesson);
    text_print(out, "\"program\":{\"version\":");
    put_string(out, explain->ref.frame->version);
    text_print(out, ",\"command\":");
    put_string(out, explain->command);
    text_print(out, ",\"name\":");
    put_string(out, explain->name);
    text_print(out, ",\"size\":[%d,%d],\"settings\":[", explain->desc.width, explain->desc.height);
    put_settings(out, &explain->desc);
    text_print(out, "],\"methods\":[");
    put_methods(out);
    text_print(out, "]},\n\"wasm\":");
    return put_packed(out, page_wasm, page_wasm_size, &room->program);
}

static Result put_scene(const ExplainDesc *explain, Text *out, ExplainRoom *room)
{
    unsigned char *bytes;
    size_t count;
    Result result = blob_write(explain->scene, &bytes, &count);
    if (result != RESULT_OK)
        return result;
    text_print(out, ",\n\"scene\":");
    result = put_packed(out, bytes, count, &room->scene);
    free(bytes);
    return result;
}

/* ---- ref ---- */

/* FNV-1a, 32 bits. */
static uint32_t checksum(const void *bytes, size_t count)
{
    const unsigned char *at = bytes;
    uint32_t sum = 0x811c9dc5u;
    for (size_t i = 0; i < count; i++)
        sum = (sum ^ at[i]) * 0x01000193u;
    return sum;
}

static size_t image_size(const Image *image)
{
    return format_pixel_bytes(image->format) * (size_t)image->width * (size_t)image->height;
}

static void put_figures(Text *out, const Frame *frame)
{
    const LayerStats *layers = &frame->layers;
    text_print(out,
               "\"figures\":{\"peels\":%d,\"geometry_passes\":%d,\"max_layers\":%u,"
               "\"fragments\":%llu,\"lost_to_ties\":%llu,\"lost_to_pass_limit\":%llu,"
               "\"residual_max\":%.9g,\"ties\":%llu,\"coverage_differs\":%llu}",
               frame->peels, frame->geometry_passes, layers->max,
               (unsigned long long)layers->fragments, (unsigned long long)layers->lost_to_ties,
               (unsigned long long)layers->lost_to_pass_limit, frame->residual_max,
               (unsigned long long)layers->ties, (unsigned long long)layers->coverage_differs);
}

static Result put_ref(const ExplainDesc *explain, Text *out)
{
    const TraceStore *store = explain->ref.trace;
    text_print(out, ",\n\"ref\":{\"checksums\":[");
    for (int i = 0; i < store_count(store); i++) {
        Image image;
        Result result = store_image(store, i, &image);
        if (result != RESULT_OK)
            return result;
        text_print(out, "%s[\"%s\",\"%08x\"]", i ? "," : "", store_buffer(store, i)->name,
                   checksum(image.pixels, image_size(&image)));
        image_free(&image);
    }
    text_print(out, "],");
    put_figures(out, explain->ref.frame);
    text_print(out, "}");
    return out->result;
}

/* ---- gl and the truth, as they differ from ref ---- */

static void put_missing(Text *out, const ExplainSide *side)
{
    text_print(out, "{\"missing\":");
    put_string(out, side->missing ? side->missing : "not rendered");
    text_print(out, "}");
}

static size_t differing_bytes(unsigned char *bytes, const unsigned char *other, size_t count)
{
    size_t differing = 0;
    for (size_t i = 0; i < count; i++) {
        bytes[i] ^= other[i];
        differing += bytes[i] != 0;
    }
    return differing;
}

/* One of gl's buffers that ref has too. */
static Result put_difference(Text *out, const char *name, Image *theirs, const Image *ours,
                             ExplainRoom *room)
{
    size_t size = image_size(theirs);
    size_t differing = differing_bytes(theirs->pixels, ours->pixels, size);
    text_print(out, "{\"name\":\"%s\",\"differing\":%zu", name, differing);
    Result result = out->result;
    if (differing > 0) {
        text_print(out, ",\"difference\":");
        result = put_packed(out, theirs->pixels, size, &room->gl);
    }
    text_print(out, "}");
    return result;
}

static Result put_gl_buffers(const ExplainDesc *explain, Text *out, ExplainRoom *room)
{
    const TraceStore *ours = explain->ref.trace, *theirs = explain->gl.trace;
    Result result = RESULT_OK;
    const char *separator = "";
    for (int i = 0; i < store_count(theirs) && result == RESULT_OK; i++) {
        const StoredBuffer *buffer = store_buffer(theirs, i);
        int same = store_find(ours, buffer->name);
        if (same < 0 || store_buffer(ours, same)->format != buffer->format)
            continue;
        Image a = {0}, b = {0};
        result = store_image(theirs, i, &a);
        if (result == RESULT_OK)
            result = store_image(ours, same, &b);
        text_print(out, "%s", separator);
        separator = ",\n";
        if (result == RESULT_OK)
            result = put_difference(out, buffer->name, &a, &b, room);
        image_free(&a);
        image_free(&b);
    }
    return result;
}

static Result put_gl(const ExplainDesc *explain, Text *out, ExplainRoom *room)
{
    const Frame *frame = explain->gl.frame;
    text_print(out, ",\n\"gl\":");
    if (!frame) {
        put_missing(out, &explain->gl);
        return out->result;
    }
    text_print(out, "{\"renderer\":");
    put_string(out, frame->renderer);
    text_print(out, ",\"version\":");
    put_string(out, frame->version);
    text_print(out, ",");
    put_figures(out, frame);
    text_print(out, ",\"buffers\":[");
    Result result = put_gl_buffers(explain, out, room);
    text_print(out, "]}");
    return result;
}

/* Of each 32-bit word the first byte first, so that equal bytes stand together. */
static Result put_words(Text *out, const uint32_t *words, const uint32_t *other, size_t count,
                        size_t *room)
{
    unsigned char *planes = memory_array(count, sizeof *words);
    if (!planes)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 4; k++)
            planes[k * count + i] = (unsigned char)((words[i] ^ other[i]) >> 8 * k);
    Result result = put_packed(out, planes, count * sizeof *words, room);
    free(planes);
    return result;
}

static Result put_truth(const ExplainDesc *explain, Text *out, ExplainRoom *room)
{
    const Frame *frame = explain->truth.frame, *ours = explain->ref.frame;
    text_print(out, ",\n\"truth\":");
    if (!frame) {
        put_missing(out, &explain->truth);
        return out->result;
    }
    FinalMetrics metrics;
    metrics_final(&ours->final, &frame->final, &metrics);
    text_print(out, "{\"differing\":%llu,\"max_abs\":%.9g,\"rmse\":%.9g,\"nonfinite\":%llu,",
               (unsigned long long)metrics.differing, metrics.max_abs, metrics.rmse,
               (unsigned long long)metrics.nonfinite);
    put_figures(out, frame);
    text_print(out, ",\"final\":");
    Result result =
        put_words(out, frame->final.pixels, ours->final.pixels,
                  4 * (size_t)frame->final.width * (size_t)frame->final.height, &room->truth);
    text_print(out, "}");
    return result;
}

/* ---- the whole ---- */

Result explain_data(const ExplainDesc *explain, Text *out, ExplainRoom *room)
{
    Result result = put_program(explain, out, room);
    if (result == RESULT_OK)
        result = put_scene(explain, out, room);
    if (result == RESULT_OK)
        result = put_ref(explain, out);
    if (result == RESULT_OK)
        result = put_gl(explain, out, room);
    if (result == RESULT_OK)
        result = put_truth(explain, out, room);
    text_print(out, "}");
    return result == RESULT_OK ? out->result : result;
}
