#include "web/engine.h"

#include "base/memory.h"
#include "base/text.h"
#include "frame/method.h"
#include "frame/setting.h"
#include "ref/pipeline/pipeline.h"
#include "ref/pipeline/retrace.h"
#include "scene/blob.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifdef __wasm__
#define EXPORT(name) __attribute__((export_name(#name)))
#else
#define EXPORT(name)
#endif

typedef struct Traced {
    char name[48];
    int step;
    Image image;
} Traced;

typedef struct Engine {
    TraceSink sink; /* first: a sink is an engine */
    Scene scene;
    RenderDesc desc;
    Frame frame;
    Traced *traced;
    size_t traced_count, traced_room;
    Retrace *retrace; /* of the scene and settings as they are; NULL: not yet */
    Text scene_text, settings_text, frame_text, history_text;
} Engine;

static Engine engine;

EXPORT(engine_room) void *engine_room(size_t bytes)
{
    return memory_array(bytes, 1);
}

EXPORT(engine_free) void engine_free(void *room)
{
    free(room);
}

EXPORT(engine_message) const char *engine_message(void)
{
    return result_message();
}

/* Empties text to be printed anew. */
static Text *begin(Text *text)
{
    text_free(text);
    return text;
}

static const char *finish(const Text *text)
{
    return text->result == RESULT_OK ? text->bytes : NULL;
}

static void print_numbers(Text *text, const char *name, const float *values, int count)
{
    text_print(text, "\"%s\":[", name);
    for (int i = 0; i < count; i++)
        text_print(text, "%s%.9g", i ? "," : "", (double)values[i]);
    text_print(text, "]");
}

/* Before anything changes that a pixel's history depends on. */
static void forget_retrace(void)
{
    retrace_close(engine.retrace);
    engine.retrace = NULL;
}

/* ---- the scene ---- */

EXPORT(engine_open) int engine_open(const unsigned char *bytes, size_t count)
{
    forget_retrace();
    scene_free(&engine.scene);
    engine.desc = (RenderDesc){.width = 1, .height = 1, .threads = 1};
    return blob_read(bytes, count, &engine.scene);
}

static void print_material(Text *text, const Material *material)
{
    static const char *const modes[] = {"opaque", "mask", "blend"};
    text_print(text, "{\"name\":");
    text_json_string(text, material->name);
    text_print(text, ",");
    print_numbers(text, "base_color", material->base_color, 4);
    text_print(text,
               ",\"roughness\":%.9g,\"metallic\":%.9g,\"occlusion\":%.9g,\"mode\":\"%s\","
               "\"double_sided\":%s,\"textured\":%s}",
               (double)material->roughness, (double)material->metallic, (double)material->occlusion,
               modes[material->alpha_mode], material->double_sided ? "true" : "false",
               material->base_color_texture || material->metallic_roughness_texture ? "true"
                                                                                    : "false");
}

static void print_camera(Text *text, const Camera *camera)
{
    text_print(text, "{\"name\":");
    text_json_string(text, camera->name);
    text_print(text, ",\"world\":[");
    for (int i = 0; i < 16; i++)
        text_print(text, "%s%.17g", i ? "," : "", camera->world.m[i]);
    text_print(text, "],\"yfov\":%.17g,\"near\":%.17g,\"far\":", camera->yfov, camera->near);
    if (isfinite(camera->far))
        text_print(text, "%.17g}", camera->far);
    else
        text_print(text, "null}");
}

static void print_bounds(Text *text, const Scene *scene)
{
    double bounds[2][3] = {{0.0}, {0.0}};
    scene_bounds(scene, bounds[0], bounds[1]);
    for (int i = 0; i < 2; i++)
        text_print(text, "%s[%.17g,%.17g,%.17g]", i ? "," : ",\"bounds\":[", bounds[i][0],
                   bounds[i][1], bounds[i][2]);
    text_print(text, "]");
}

EXPORT(engine_scene) const char *engine_scene(void)
{
    Text *text = begin(&engine.scene_text);
    const Scene *scene = &engine.scene;
    text_print(text, "{\"name\":");
    text_json_string(text, scene->name ? scene->name : "");
    text_print(text, ",\"triangles\":%llu,\"lights\":%zu,",
               (unsigned long long)scene_triangle_count(scene), scene->light_count);
    print_numbers(text, "ambient", scene->ambient, 3);
    text_print(text, ",");
    print_numbers(text, "background", scene->background, 3);
    print_bounds(text, scene);
    text_print(text, ",\"light_degrees_per_second\":%.17g,\"materials\":[",
               scene->light_degrees_per_second);
    for (size_t i = 0; i < scene->material_count; i++) {
        text_print(text, i ? "," : "");
        print_material(text, &scene->materials[i]);
    }
    text_print(text, "],\"instances\":[");
    for (size_t i = 0; i < scene->instance_count; i++) {
        text_print(text, "%s{\"name\":", i ? "," : "");
        text_json_string(text, scene->instances[i].name);
        text_print(text, ",\"mesh\":%u,\"material\":%u}", scene->instances[i].mesh,
                   scene->instances[i].material);
    }
    text_print(text, "],\"cameras\":[");
    for (size_t i = 0; i < scene->camera_count; i++) {
        text_print(text, i ? "," : "");
        print_camera(text, &scene->cameras[i]);
    }
    text_print(text, "]}");
    return finish(text);
}

EXPORT(engine_set_material) int engine_set_material(int index, int field, double value)
{
    forget_retrace();
    Scene *scene = &engine.scene;
    if (index < 0 || (size_t)index >= scene->material_count || field < 0 || field > 7 ||
        !(value >= 0.0 && value <= 1.0))
        return result_fail(RESULT_BAD_INPUT,
                           "material %d, field %d: expected one of the scene's, "
                           "0 to 7, and a value from 0 to 1",
                           index, field);
    Material *material = &scene->materials[index];
    if (field == 7) {
        if (material->alpha_mode != ALPHA_MASK)
            material->alpha_mode = value != 0.0 ? ALPHA_BLEND : ALPHA_OPAQUE;
        return RESULT_OK;
    }
    float *fields[] = {&material->roughness, &material->metallic, &material->occlusion};
    *(field < 4 ? &material->base_color[field] : fields[field - 4]) = (float)value;
    if (field == 3 && material->alpha_mode != ALPHA_MASK)
        material->alpha_mode = value < 1.0 ? ALPHA_BLEND : ALPHA_OPAQUE;
    return RESULT_OK;
}

EXPORT(engine_set_ambient) int engine_set_ambient(double red, double green, double blue)
{
    forget_retrace();
    Scene *scene = &engine.scene;
    const double values[] = {red, green, blue};
    float before[3];
    memcpy(before, scene->ambient, sizeof before);
    for (int i = 0; i < 3; i++)
        scene->ambient[i] = (float)values[i];
    Result result = scene_validate_surroundings(scene);
    if (result != RESULT_OK)
        memcpy(scene->ambient, before, sizeof before);
    return result;
}

EXPORT(engine_set_camera)
int engine_set_camera(int index, const double world[16], double yfov, double near, double far)
{
    forget_retrace();
    Scene *scene = &engine.scene;
    if (index < 0 || (size_t)index >= scene->camera_count)
        return result_fail(RESULT_BAD_INPUT, "camera %d: expected one of the scene's %zu", index,
                           scene->camera_count);
    Camera *camera = &scene->cameras[index];
    Camera before = *camera;
    memcpy(camera->world.m, world, sizeof camera->world.m);
    camera->yfov = yfov;
    camera->near = near;
    camera->far = far;
    Result result = scene_validate_camera(&scene->cameras[index], (size_t)index);
    if (result != RESULT_OK)
        *camera = before;
    return result;
}

/* ---- settings ---- */

EXPORT(engine_settings) const char *engine_settings(void)
{
    Text *text = begin(&engine.settings_text);
    text_print(text, "[{\"name\":\"method\",\"choices\":[");
    for (int i = 0; i < METHOD_COUNT; i++)
        text_print(text, "%s\"%s\"", i ? "," : "", method_info((MethodId)i)->name);
    text_print(text, "],\"value\":%d}", (int)engine.desc.method);
    for (int i = 0; i < SETTING_COUNT; i++) {
        SettingId id = (SettingId)i;
        text_print(text, ",{\"name\":\"%s\",\"choices\":[", setting_info(id)->name);
        for (int k = 0; k < setting_choice_count(id); k++)
            text_print(text, "%s\"%s\"", k ? "," : "", setting_info(id)->choices[k]);
        text_print(text, "],\"value\":%d}", setting_get(&engine.desc, id));
    }
    text_print(text, "]");
    return finish(text);
}

static bool whole(double value, int low, int high)
{
    return value >= low && value <= high && value == floor(value);
}

/* The settings that are one of a few names; false where there is none of this name and value. */
static bool set_choice(RenderDesc *desc, const char *name, double value)
{
    if (strcmp(name, "method") == 0 && whole(value, 0, METHOD_COUNT - 1)) {
        desc->method = (MethodId)value;
        return true;
    }
    for (int i = 0; i < SETTING_COUNT; i++)
        if (strcmp(name, setting_info((SettingId)i)->name) == 0 &&
            whole(value, 0, setting_choice_count((SettingId)i) - 1)) {
            setting_put(desc, (SettingId)i, (int)value);
            return true;
        }
    return false;
}

EXPORT(engine_set) int engine_set(const char *name, double value)
{
    forget_retrace();
    RenderDesc *desc = &engine.desc;
    const struct {
        const char *name;
        int *field, low, high;
    } counts[] = {{"passes", &desc->passes, 0, PASSES_MAX},
                  {"lights", &desc->lights, -1, 1 << 20},
                  {"nodes-per-pixel", &desc->nodes_per_pixel, 0, 4096},
                  {"camera", &desc->camera, 0, (int)engine.scene.camera_count - 1}};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        if (strcmp(name, counts[i].name) == 0 && whole(value, counts[i].low, counts[i].high)) {
            *counts[i].field = (int)value;
            return RESULT_OK;
        }
    if (strcmp(name, "time") == 0 && fabs(value) <= 1e6)
        desc->time = value;
    else if (strcmp(name, "bias") == 0 && value >= 0.0 && value <= 1.0)
        desc->bias = (float)value;
    else if (strcmp(name, "unfused") == 0 && whole(value, 0, 1))
        desc->unfused = value != 0.0;
    else if (strcmp(name, "opaque-blend") == 0 && whole(value, 0, OPAQUE_BLEND_SEED))
        desc->opaque_blend = (OpaqueBlend)value;
    else if (strcmp(name, "draw-order") == 0 && whole(value, 0, DRAW_ORDER_SHUFFLE))
        desc->draw_order = (DrawOrder)value;
    else if (strcmp(name, "draw-seed") == 0 && value >= 0.0 && value < 0x1p53)
        desc->draw_seed = (uint64_t)value;
    else if (!set_choice(desc, name, value))
        return result_fail(RESULT_BAD_INPUT, "%s %g: no such setting or value", name, value);
    return RESULT_OK;
}

/* ---- frames ---- */

static Result keep(TraceSink *sink, const TraceBuffer *buffer)
{
    Engine *self = (Engine *)sink;
    void *array = self->traced;
    Result result =
        memory_grow(&array, &self->traced_room, self->traced_count + 1, sizeof *self->traced);
    if (result != RESULT_OK)
        return result;
    self->traced = array;
    Traced *traced = &self->traced[self->traced_count];
    result =
        image_create(buffer->image_width, buffer->image_height, buffer->format, &traced->image);
    if (result != RESULT_OK)
        return result;
    self->traced_count++;
    strncpy(traced->name, buffer->name, sizeof traced->name - 1);
    traced->name[sizeof traced->name - 1] = '\0';
    traced->step = buffer->step;
    memcpy(traced->image.pixels, buffer->pixels, buffer->row_bytes * (size_t)buffer->height);
    return RESULT_OK;
}

static void forget(void)
{
    for (size_t i = 0; i < engine.traced_count; i++)
        image_free(&engine.traced[i].image);
    engine.traced_count = 0;
    frame_free(&engine.frame);
}

EXPORT(engine_render) int engine_render(int width, int height, bool trace)
{
    forget_retrace();
    forget();
    engine.sink = (TraceSink){.put = keep, .details = true};
    engine.desc.width = width;
    engine.desc.height = height;
    Result result =
        pipeline_render(&engine.scene, &engine.desc, trace ? &engine.sink : NULL, &engine.frame);
    if (result != RESULT_OK)
        forget();
    return result;
}

static void print_buffer(Text *text, const char *name, int step, const Image *image)
{
    text_print(text,
               "{\"name\":\"%s\",\"step\":%d,\"format\":\"%s\",\"width\":%d,\"height\":%d,"
               "\"at\":%zu}",
               name, step, format_info(image->format)->name, image->width, image->height,
               (size_t)image->pixels);
}

EXPORT(engine_frame) const char *engine_frame(void)
{
    Text *text = begin(&engine.frame_text);
    const Frame *frame = &engine.frame;
    text_print(text,
               "{\"width\":%d,\"height\":%d,\"peels\":%d,\"geometry_passes\":%d,\"time_ms\":%.3f,"
               "\"fused\":%s,\"max_layers\":%u,\"fragments\":%llu,\"lost_to_ties\":%llu,"
               "\"lost_to_pass_limit\":%llu,\"residual_max\":%.9g,\"buffers\":[",
               frame->final.width, frame->final.height, frame->peels, frame->geometry_passes,
               frame->time_ms, frame->fused ? "true" : "false", frame->layers.max,
               (unsigned long long)frame->layers.fragments,
               (unsigned long long)frame->layers.lost_to_ties,
               (unsigned long long)frame->layers.lost_to_pass_limit, frame->residual_max);
    print_buffer(text, "final", frame->peels + 2, &frame->final);
    text_print(text, ",");
    print_buffer(text, "display", frame->peels + 2, &frame->display);
    for (size_t i = 0; i < engine.traced_count; i++) {
        text_print(text, ",");
        print_buffer(text, engine.traced[i].name, engine.traced[i].step, &engine.traced[i].image);
    }
    text_print(text, "]}");
    return finish(text);
}

EXPORT(engine_history) const char *engine_history(int x, int y)
{
    Text *text = begin(&engine.history_text);
    History history = {0};
    Result result = RESULT_OK;
    if (!engine.retrace)
        result = retrace_open(&engine.scene, &engine.desc, &engine.retrace);
    if (result == RESULT_OK)
        result = retrace_pixel(engine.retrace, x, y, &history);
    if (result == RESULT_OK)
        history_json(&history, &engine.scene, text);
    history_free(&history);
    return result == RESULT_OK ? finish(text) : NULL;
}
