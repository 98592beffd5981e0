/* What peel-core makes of the built-in and the hard scenes, as one SHA-256 a row: the same on every
 * machine, with every compiler, however many threads, whatever the tiles and instructions.
 * tests/determinism runs it in every configuration and compares.
 *
 *   determinism [--only PATTERN]... [--threads N,...] [--tile N,...] [--simd NAME,...] [--list]
 *
 * A row is "SHA-256  SCENE/PATH/SETTING". Paths: scene (the scene's own numbers, by "arrays"), tile
 * (frames of ref's tile path), trace (of its definition path, with every buffer of every step) and
 * truth (frames and deep images; "bound" has its error bounds). Where lists are given, every row is
 * rendered with all combinations, and printed once, or where they differ once for each that is not
 * like the first, with that combination behind it; then the exit code is 1. Scenes and paths that a
 * combination does not concern are not rendered again for it. */
#include "determinism_settings.h"

#include "base/progress.h"
#include "frame/frame.h"
#include "image/deep.h"
#include "ref/pipeline/pipeline.h"
#include "ref/truth/truth.h"
#include "scene/generate.h"
#include "scene/hard_scenes.h"

#include <fnmatch.h>
#include <getopt.h>
#include <nettle/sha2.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    CHOICES_MAX = 8,
    PATTERNS_MAX = 32,
    LIGHTS = 4
};

typedef struct Choices {
    int count, value[CHOICES_MAX];
} Choices;

typedef struct Options {
    Choices threads, tile, simd;
    int pattern_count;
    const char *patterns[PATTERNS_MAX]; /* none: all rows */
    bool list;
} Options;

static int failures; /* rows that failed or differ between combinations */

/* ---- digests: numbers as 8 bytes, little-endian, pixels as they are stored --------------------
 */

typedef struct Digest {
    TraceSink sink; /* first */
    struct sha256_ctx state;
} Digest;

static void put_number(Digest *digest, uint64_t value)
{
    uint8_t bytes[8];
    for (int i = 0; i < 8; i++)
        bytes[i] = (uint8_t)(value >> 8 * i);
    sha256_update(&digest->state, sizeof bytes, bytes);
}

static void put_double(Digest *digest, double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_number(digest, bits);
}

static void put_bytes(Digest *digest, const void *bytes, size_t size)
{
    put_number(digest, size);
    if (size)
        sha256_update(&digest->state, size, bytes);
}

static void put_text(Digest *digest, const char *text)
{
    put_bytes(digest, text, strlen(text));
}

static void put_image(Digest *digest, const Image *image)
{
    put_number(digest, (uint64_t)image->width);
    put_number(digest, (uint64_t)image->height);
    put_number(digest, image->format);
    put_bytes(digest, image->pixels,
              (size_t)image->width * (size_t)image->height * format_pixel_bytes(image->format));
}

/* All but times, the room that was taken, and how often truth compared, which is the sorting
 * function's business. */
static void put_frame(Digest *digest, const Frame *frame)
{
    const LayerStats *layers = &frame->layers;
    put_image(digest, &frame->final);
    put_image(digest, &frame->display);
    put_image(digest, &frame->bound);
    put_image(digest, &frame->rounding);
    put_number(digest, (uint64_t)frame->peels);
    put_number(digest, (uint64_t)frame->geometry_passes);
    put_number(digest, frame->fragments_shaded);
    const uint64_t counts[] = {layers->max,
                               layers->fragments,
                               layers->lost_to_ties,
                               layers->lost_to_pass_limit,
                               layers->repeated,
                               layers->coverage_differs,
                               layers->lost_to_overflow,
                               layers->ties,
                               layers->undecided,
                               layers->exact_coverage,
                               layers->overflowed,
                               frame->residual_pixels,
                               frame->nodes,
                               frame->fused};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++)
        put_number(digest, counts[i]);
    put_double(digest, frame->residual_max);
}

static Result put_buffer(TraceSink *sink, const TraceBuffer *buffer)
{
    Digest *digest = (Digest *)sink;
    put_text(digest, buffer->name);
    put_number(digest, (uint64_t)buffer->step);
    put_number(digest, buffer->format);
    const int numbers[] = {buffer->image_width, buffer->image_height, buffer->x,
                           buffer->y,           buffer->width,        buffer->height};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        put_number(digest, (uint64_t)numbers[i]);
    for (int y = 0; y < buffer->height; y++)
        put_bytes(digest, (const char *)buffer->pixels + (size_t)y * buffer->row_bytes,
                  (size_t)buffer->width * format_pixel_bytes(buffer->format));
    return RESULT_OK;
}

static void put_deep(Digest *digest, const DeepImage *deep)
{
    put_number(digest, deep->sample_count);
    for (int y = 0; y < deep->height; y++)
        for (int x = 0; x < deep->width; x++) {
            uint32_t count;
            const DeepSample *samples = deep_pixel(deep, x, y, &count);
            put_bytes(digest, samples, count * sizeof *samples);
        }
    put_bytes(digest, deep->world_to_camera, sizeof deep->world_to_camera);
    put_bytes(digest, deep->world_to_ndc, sizeof deep->world_to_ndc);
}

static void put_mesh(Digest *digest, const Mesh *mesh)
{
    put_bytes(digest, mesh->position, mesh->vertex_count * 3 * sizeof *mesh->position);
    put_bytes(digest, mesh->normal, mesh->vertex_count * 3 * sizeof *mesh->normal);
    put_bytes(digest, mesh->uv, mesh->uv ? mesh->vertex_count * 2 * sizeof *mesh->uv : 0);
    put_bytes(digest, mesh->index, mesh->triangle_count * 3 * sizeof *mesh->index);
}

static void put_scene(Digest *digest, const Scene *scene)
{
    for (size_t i = 0; i < scene->mesh_count; i++)
        put_mesh(digest, &scene->meshes[i]);
    for (size_t i = 0; i < scene->texture_count; i++)
        put_bytes(digest, scene->textures[i].texels,
                  (size_t)scene->textures[i].width * scene->textures[i].height * 4 * sizeof(float));
    for (size_t i = 0; i < scene->material_count; i++) {
        const Material *material = &scene->materials[i];
        put_bytes(digest, material->base_color, sizeof material->base_color);
        put_double(digest, (double)material->roughness);
        put_double(digest, (double)material->metallic);
        put_double(digest, (double)material->occlusion);
    }
    for (size_t i = 0; i < scene->instance_count; i++)
        put_bytes(digest, &scene->instances[i].world, sizeof scene->instances[i].world);
    for (size_t i = 0; i < scene->light_count; i++) {
        put_bytes(digest, scene->lights[i].position, sizeof scene->lights[i].position);
        put_bytes(digest, scene->lights[i].color, sizeof scene->lights[i].color);
    }
    for (size_t i = 0; i < scene->camera_count; i++)
        put_bytes(digest, &scene->cameras[i].world, sizeof scene->cameras[i].world);
}

/* ---- rows -------------------------------------------------------------------------------------
 */

typedef struct Hash {
    char text[2 * SHA256_DIGEST_SIZE + 1];
} Hash;

static Hash finish(Digest *digest)
{
    uint8_t bytes[SHA256_DIGEST_SIZE];
    Hash hash;
    sha256_digest(&digest->state, sizeof bytes, bytes);
    for (size_t i = 0; i < sizeof bytes; i++)
        snprintf(hash.text + 2 * i, 3, "%02x", bytes[i]);
    return hash;
}

typedef struct Row Row;
typedef Result (*RowFunction)(const Row *row, const RenderDesc *desc, Digest *digest);
struct Row {
    const char *scene_name, *path, *setting;
    const Scene *scene;
    RenderDesc desc;
    RowFunction function;
    bool threads, tile, simd; /* concern it */
};

static Result row_scene(const Row *row, const RenderDesc *desc, Digest *digest)
{
    (void)desc;
    put_scene(digest, row->scene);
    return RESULT_OK;
}

static Result row_frame(const Row *row, const RenderDesc *desc, Digest *digest)
{
    Frame frame;
    bool traced = desc->ref_path == REF_PATH_DEFINITION;
    Result result = pipeline_render(row->scene, desc, traced ? &digest->sink : NULL, &frame);
    if (result != RESULT_OK)
        return result;
    put_frame(digest, &frame);
    frame_free(&frame);
    return RESULT_OK;
}

static Result row_truth(const Row *row, const RenderDesc *desc, Digest *digest)
{
    Frame frame;
    DeepImage deep = {0};
    Result result = desc->bound ? truth_render(row->scene, desc, NULL, &frame)
                                : truth_render_deep(row->scene, desc, &deep, &frame);
    if (result != RESULT_OK)
        return result;
    put_frame(digest, &frame);
    put_deep(digest, &deep);
    frame_free(&frame);
    deep_free(&deep);
    return RESULT_OK;
}

static bool wanted(const Options *options, const char *name)
{
    for (int i = 0; i < options->pattern_count; i++)
        if (fnmatch(options->patterns[i], name, 0) == 0)
            return true;
    return options->pattern_count == 0;
}

/* Renders a row with one combination, and prints it where it is the first or differs from it. */
static void run_one(const Row *row, const RenderDesc *desc, const char *name, Hash *first)
{
    Digest digest = {.sink = {.put = put_buffer, .details = true}};
    sha256_init(&digest.state);
    Result result = row->function(row, desc, &digest);
    bool is_first = !first->text[0];
    Hash hash = {"failed"};
    if (result == RESULT_OK)
        hash = finish(&digest);
    else
        fprintf(stderr, "determinism: %s: %s\n", name, result_message());
    if (is_first)
        *first = hash;
    bool differs = strcmp(hash.text, first->text) != 0;
    failures += differs || result != RESULT_OK;
    if (is_first)
        printf("%s  %s\n", hash.text, name);
    else if (differs)
        printf("%s  %s --threads %d --tile %d --simd %s\n", hash.text, name, desc->threads,
               desc->tile, simd_name(desc->simd));
}

static void run(const Options *options, const Row *row)
{
    char name[256];
    snprintf(name, sizeof name, "%s/%s/%s", row->scene_name, row->path, row->setting);
    if (!wanted(options, name))
        return;
    if (options->list) {
        puts(name);
        return;
    }
    Hash first = {""};
    for (int i = 0; i < (row->threads ? options->threads.count : 1); i++)
        for (int j = 0; j < (row->tile ? options->tile.count : 1); j++)
            for (int k = 0; k < (row->simd ? options->simd.count : 1); k++) {
                RenderDesc desc = row->desc;
                desc.threads = options->threads.value[i];
                desc.tile = options->tile.value[j];
                desc.simd = (SimdChoice)options->simd.value[k];
                run_one(row, &desc, name, &first);
            }
}

/* ---- scenes -----------------------------------------------------------------------------------
 */

/* A setting's own size, if it has one, but below the scene's. */
static int least(int own, int scene)
{
    return own == 0 ? scene : own < scene ? own : scene - 1;
}

static void run_settings(const Options *options, Row row, int width, int height)
{
    for (int i = 0; i < DETERMINISM_SETTINGS; i++) {
        const DeterminismSetting *setting = &determinism_settings[i];
        row.desc = setting->desc;
        row.desc.lights = LIGHTS;
        row.desc.width = least(setting->desc.width, width);
        row.desc.height = least(setting->desc.height, height);
        row.setting = setting->name;
        row.function = row_frame;
        row.desc.ref_path = REF_PATH_DEFINITION;
        row.path = "trace";
        row.simd = false;
        run(options, &row);
        if (setting->desc.method != METHOD_PEEL)
            continue;
        row.desc.ref_path = REF_PATH_TILE;
        row.path = "tile";
        row.simd = true;
        run(options, &row);
    }
}

static void run_truth(const Options *options, Row row, int width, int height)
{
    row.path = "truth";
    row.function = row_truth;
    row.threads = true;
    row.tile = row.simd = false;
    row.desc = (RenderDesc){.width = width, .height = height, .lights = LIGHTS};
    row.setting = "peel";
    run(options, &row);
    row.setting = "bound";
    row.desc.bound = true;
    run(options, &row);
}

static void run_scene(const Options *options, const char *name, Result (*generate)(Scene *out),
                      int width, int height)
{
    Scene scene;
    if (generate(&scene) != RESULT_OK) {
        fprintf(stderr, "determinism: %s: %s\n", name, result_message());
        failures++;
        return;
    }
    Row row = {.scene_name = name,
               .path = "scene",
               .setting = "arrays",
               .scene = &scene,
               .function = row_scene};
    run(options, &row);
    row.threads = row.tile = true;
    run_settings(options, row, width, height);
    run_truth(options, row, width, height);
    scene_free(&scene);
}

/* The hard scenes are made for 96 pixels, or for fewer where there are many layers; with a thousand
 * there is no time for more. */
static int hard_size(const char *name)
{
    static const struct {
        const char *name;
        int size;
    } smaller[] = {{"layers_64", 48}, {"layers_256", 24}, {"drift_8", 24}, {"layers_1000", 6}};
    for (size_t i = 0; i < sizeof smaller / sizeof *smaller; i++)
        if (strcmp(name, smaller[i].name) == 0)
            return smaller[i].size;
    return 96;
}

static void run_scenes(const Options *options)
{
    size_t builtin_count, hard_count;
    const BuiltinScene *builtin = generate_table(&builtin_count);
    const HardScene *hard = hard_scenes_table(&hard_count);
    progress_begin("scenes", builtin_count + hard_count);
    for (size_t i = 0; i < builtin_count; i++) {
        run_scene(options, builtin[i].name, builtin[i].generate, 128, 72);
        progress_step(i + 1);
    }
    for (size_t i = 0; i < hard_count; i++) {
        int size = hard_size(hard[i].name);
        run_scene(options, hard[i].name, hard[i].generate, size, size);
        progress_step(builtin_count + i + 1);
    }
    progress_end();
}

/* ---- the command line -------------------------------------------------------------------------
 */

static bool parse_simd(const char *text, int *out)
{
    for (*out = 0; *out < SIMD_COUNT; ++*out)
        if (strcmp(text, simd_name((SimdChoice)*out)) == 0)
            return true;
    return false;
}

static bool parse_number(const char *text, int *out)
{
    char *end;
    long value = strtol(text, &end, 10);
    *out = (int)value;
    return *text && !*end && value >= 0 && value <= THREADS_MAX;
}

/* "1,2,8" into choices; text is cut up. */
static bool parse_choices(char *text, bool (*parse)(const char *, int *), Choices *out)
{
    *out = (Choices){0};
    char *rest;
    for (char *word = strtok_r(text, ",", &rest); word; word = strtok_r(NULL, ",", &rest))
        if (out->count == CHOICES_MAX || !parse(word, &out->value[out->count++]))
            return false;
    return out->count > 0;
}

static bool parse_options(int count, char **arguments, Options *out)
{
    static const struct option table[] = {
        {"only", required_argument, NULL, 'o'}, {"threads", required_argument, NULL, 't'},
        {"tile", required_argument, NULL, 's'}, {"simd", required_argument, NULL, 'i'},
        {"list", no_argument, NULL, 'l'},       {NULL, 0, NULL, 0},
    };
    *out = (Options){.threads = {1, {1}}, .tile = {1, {0}}, .simd = {1, {SIMD_AUTO}}};
    for (int c; (c = getopt_long(count, arguments, "", table, NULL)) != -1;) {
        bool right = c == 'o'   ? out->pattern_count < PATTERNS_MAX
                     : c == 't' ? parse_choices(optarg, parse_number, &out->threads)
                     : c == 's' ? parse_choices(optarg, parse_number, &out->tile)
                     : c == 'i' ? parse_choices(optarg, parse_simd, &out->simd)
                                : c == 'l';
        if (!right)
            return false;
        if (c == 'o')
            out->patterns[out->pattern_count++] = optarg;
        out->list |= c == 'l';
    }
    return optind == count;
}

int main(int count, char **arguments)
{
    Options options;
    if (!parse_options(count, arguments, &options)) {
        fprintf(stderr, "usage: determinism [--only PATTERN]... [--threads N,...] [--tile N,...] "
                        "[--simd NAME,...] [--list]\n");
        return 4;
    }
    setvbuf(stdout, NULL, _IOLBF, BUFSIZ); /* what took long is not lost */
    run_scenes(&options);
    return fflush(stdout) != 0 ? 4 : failures > 0;
}
