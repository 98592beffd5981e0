/* Renders a frame as the pages' settings and edits say, without any of the pages' code, and writes
 * what they are to show: a line of JSON, then the bytes of each buffer.
 *
 * web_frame ref|plain|truth SCENE WIDTH HEIGHT FILE [NAME=VALUE]...
 *
 * plain: ref without its trace.
 * NAME: a number of RenderDesc, the index of a setting's choice, or material.INDEX.FIELD with FIELD
 * red, green, blue, alpha, roughness, metallic or occlusion. SCENE: a built-in one. */
#include "base/text.h"
#include "compare/store.h"
#include "frame/setting.h"
#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"
#include "scene/generate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void stop(const char *what)
{
    fprintf(stderr, "web_frame: %s: %s\n", what, result_message());
    exit(1);
}

/* ---- what to render ---- */

static bool set_number(RenderDesc *desc, const char *name, double value)
{
    struct {
        const char *name;
        int *field;
    } counts[] = {{"passes", &desc->passes},
                  {"lights", &desc->lights},
                  {"nodes-per-pixel", &desc->nodes_per_pixel},
                  {"camera", &desc->camera}};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        if (strcmp(name, counts[i].name) == 0) {
            *counts[i].field = (int)value;
            return true;
        }
    if (strcmp(name, "method") == 0)
        desc->method = (MethodId)value;
    else if (strcmp(name, "time") == 0)
        desc->time = value;
    else if (strcmp(name, "bias") == 0)
        desc->bias = (float)value;
    else if (strcmp(name, "unfused") == 0)
        desc->unfused = value != 0.0;
    else if (strcmp(name, "opaque-blend") == 0)
        desc->opaque_blend = (OpaqueBlend)value;
    else if (strcmp(name, "draw-order") == 0)
        desc->draw_order = (DrawOrder)value;
    else if (strcmp(name, "draw-seed") == 0)
        desc->draw_seed = (uint64_t)value;
    else
        return false;
    return true;
}

static bool set_choice(RenderDesc *desc, const char *name, int choice)
{
    for (int i = 0; i < SETTING_COUNT; i++)
        if (strcmp(name, setting_info((SettingId)i)->name) == 0) {
            setting_put(desc, (SettingId)i, choice);
            return true;
        }
    return false;
}

/* As the page says it of a material: an alpha of 1 makes it opaque. */
static bool set_material(Scene *scene, const char *name, double value)
{
    static const char *const fields[] = {"red",       "green",    "blue",     "alpha",
                                         "roughness", "metallic", "occlusion"};
    unsigned index;
    char field[16];
    if (sscanf(name, "material.%u.%15s", &index, field) != 2 || index >= scene->material_count)
        return false;
    Material *material = &scene->materials[index];
    float *places[] = {&material->base_color[0], &material->base_color[1], &material->base_color[2],
                       &material->base_color[3], &material->roughness,     &material->metallic,
                       &material->occlusion};
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++)
        if (strcmp(field, fields[i]) == 0) {
            *places[i] = (float)value;
            if (i == 3)
                material->alpha_mode = value < 1.0 ? ALPHA_BLEND : ALPHA_OPAQUE;
            return true;
        }
    return false;
}

static void set(Scene *scene, RenderDesc *desc, const char *assignment)
{
    const char *equals = strchr(assignment, '=');
    char name[64];
    if (!equals || (size_t)(equals - assignment) >= sizeof name)
        stop(assignment);
    memcpy(name, assignment, (size_t)(equals - assignment));
    name[equals - assignment] = '\0';
    double value = strtod(equals + 1, NULL);
    if (!set_number(desc, name, value) && !set_choice(desc, name, (int)value) &&
        !set_material(scene, name, value))
        stop(assignment);
}

/* ---- what came of it ---- */

static size_t put_buffer(Text *head, const char *name, const Image *image, size_t at)
{
    size_t bytes = format_pixel_bytes(image->format) * (size_t)image->width * (size_t)image->height;
    text_print(head,
               "%s{\"name\":\"%s\",\"format\":\"%s\",\"width\":%d,\"height\":%d,"
               "\"at\":%zu,\"bytes\":%zu}",
               at ? "," : "", name, format_info(image->format)->name, image->width, image->height,
               at, bytes);
    return at + bytes;
}

static void put_figures(Text *head, const Frame *frame)
{
    text_print(head,
               "\"peels\":%d,\"geometry_passes\":%d,\"max_layers\":%u,\"fragments\":%llu,"
               "\"lost_to_ties\":%llu,\"lost_to_pass_limit\":%llu,\"ties\":%llu,"
               "\"residual_max\":%.17g,",
               frame->peels, frame->geometry_passes, frame->layers.max,
               (unsigned long long)frame->layers.fragments,
               (unsigned long long)frame->layers.lost_to_ties,
               (unsigned long long)frame->layers.lost_to_pass_limit,
               (unsigned long long)frame->layers.ties, frame->residual_max);
}

/* What the scene says that pages show. */
static void put_scene(Text *head, const Scene *scene, const RenderDesc *desc)
{
    static const char *const modes[] = {"opaque", "mask", "blend"};
    const Camera *camera = &scene->cameras[desc->camera];
    text_print(head,
               "\"ambient\":[%.9g,%.9g,%.9g],\"background\":[%.9g,%.9g,%.9g],"
               "\"camera\":[%.17g,%.17g,%.17g],\"lights\":%zu,\"materials\":[",
               (double)scene->ambient[0], (double)scene->ambient[1], (double)scene->ambient[2],
               (double)scene->background[0], (double)scene->background[1],
               (double)scene->background[2], camera->yfov, camera->near,
               isfinite(camera->far) ? camera->far : -1.0, scene->light_count);
    for (size_t i = 0; i < scene->material_count; i++) {
        const Material *material = &scene->materials[i];
        text_print(head,
                   "%s{\"red\":%.9g,\"green\":%.9g,\"blue\":%.9g,\"alpha\":%.9g,"
                   "\"roughness\":%.9g,\"metallic\":%.9g,\"occlusion\":%.9g,\"mode\":\"%s\"}",
                   i ? "," : "", (double)material->base_color[0], (double)material->base_color[1],
                   (double)material->base_color[2], (double)material->base_color[3],
                   (double)material->roughness, (double)material->metallic,
                   (double)material->occlusion, modes[material->alpha_mode]);
    }
    text_print(head, "],");
}

static void write_image(FILE *file, const Image *image)
{
    fwrite(image->pixels,
           format_pixel_bytes(image->format) * (size_t)image->width * (size_t)image->height, 1,
           file);
}

static void write(const Frame *frame, const TraceStore *store, Text *head, const char *path)
{
    int count = store_count(store);
    Image *images = calloc((size_t)count + 1, sizeof *images);
    FILE *file = fopen(path, "wb");
    if (!file || !images)
        stop(path);
    put_figures(head, frame);
    text_print(head, "\"buffers\":[");
    size_t at = put_buffer(head, "final", &frame->final, 0);
    at = put_buffer(head, "display", &frame->display, at);
    for (int i = 0; i < count; i++) {
        if (store_image(store, i, &images[i]) != RESULT_OK)
            stop(store_buffer(store, i)->name);
        if (strcmp(store_buffer(store, i)->name, "display") != 0)
            at = put_buffer(head, store_buffer(store, i)->name, &images[i], at);
    }
    fprintf(file, "%s]}\n", head->bytes);
    write_image(file, &frame->final);
    write_image(file, &frame->display);
    for (int i = 0; i < count; i++) {
        if (strcmp(store_buffer(store, i)->name, "display") != 0)
            write_image(file, &images[i]);
        image_free(&images[i]);
    }
    if (ferror(file) || fclose(file) != 0)
        stop(path);
    free(images);
}

int main(int argc, char **argv)
{
    const BuiltinScene *built_in = argc > 5 ? generate_find(argv[2]) : NULL;
    Scene scene;
    RenderDesc desc = {.threads = 1};
    TraceStore *store;
    Frame frame;
    if (!built_in || built_in->generate(&scene) != RESULT_OK)
        stop("usage: web_frame ref|plain|truth SCENE WIDTH HEIGHT FILE [NAME=VALUE]...");
    desc.width = atoi(argv[3]);
    desc.height = atoi(argv[4]);
    for (int i = 6; i < argc; i++)
        set(&scene, &desc, argv[i]);
    if (store_create(0, &store) != RESULT_OK)
        stop("trace");
    store_sink(store)->details = true;
    TraceSink *sink = strcmp(argv[1], "ref") == 0 ? store_sink(store) : NULL;
    Result result = strcmp(argv[1], "truth") == 0 ? truth_render(&scene, &desc, NULL, &frame)
                                                  : pipeline_render(&scene, &desc, sink, &frame);
    if (result != RESULT_OK)
        stop(argv[2]);
    Text head = {0};
    text_print(&head, "{");
    put_scene(&head, &scene, &desc);
    write(&frame, store, &head, argv[5]);
    text_free(&head);
    frame_free(&frame);
    store_destroy(store);
    scene_free(&scene);
    return 0;
}
