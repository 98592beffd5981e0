/* The rendering options, which all commands that render share. */
#include "cli/options.h"

#include "frame/method.h"
#include "gl/context.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool options_pair(const char *text, char between, int low, int *first, int *second)
{
    char *end;
    const char digits[] = {'0', '1', '2', '3', '4', '5', '6', '7', '8', '9', between, '\0'};
    long a = strtol(text, &end, 10);
    bool whole = strspn(text, digits) == strlen(text) && end > text && *end == between;
    long b = whole ? strtol(end + 1, &end, 10) : low;
    if (!whole || end[-1] == between || *end || a < low || b < low || a > SIZE_MAX_PIXELS ||
        b > SIZE_MAX_PIXELS)
        return false;
    *first = (int)a;
    *second = (int)b;
    return true;
}

error_t options_size(const char *text, RenderDesc *desc)
{
    if (!options_pair(text, 'x', 1, &desc->width, &desc->height))
        return options_error("--size %s: expected WxH, each from 1 to %d", text, SIZE_MAX_PIXELS);
    return 0;
}

static error_t parse_background(const char *text, RenderOptions *options)
{
    const char *at = text;
    for (int i = 0; i < 3; i++) {
        char *end;
        double value = strtod(at, &end);
        if (isspace((unsigned char)*at) || end == at || *end != (i < 2 ? ',' : '\0') ||
            !(value >= 0.0 && value <= 1e6))
            return options_error("--background %s: expected R,G,B, linear, from 0 to 1e6", text);
        options->background[i] = value;
        at = end + 1;
    }
    options->has_background = true;
    return 0;
}

error_t options_memory(const char *text, size_t *out)
{
    char *end;
    errno = 0;
    unsigned long long bytes = strtoull(text, &end, 10);
    int shift = *end == 'K' ? 10 : *end == 'M' ? 20 : *end == 'G' ? 30 : 0;
    if (errno || !isdigit((unsigned char)*text) || bytes == 0 || end[shift != 0] ||
        bytes > (SIZE_MAX >> shift))
        return options_error("--max-memory %s: expected bytes, or a number with K, M or G", text);
    *out = (size_t)bytes << shift;
    return 0;
}

error_t options_count(const char *name, const char *text, int low, int high, int *out)
{
    long long value;
    if (!options_integer(text, low, high, &value))
        return options_error("%s %s: expected a whole number from %d to %d", name, text, low, high);
    *out = (int)value;
    return 0;
}

static error_t parse_real(const char *name, const char *text, double low, double high, double *out)
{
    if (!options_real(text, low, high, out))
        return options_error("%s %s: expected a number from %g to %g", name, text, low, high);
    return 0;
}

/* ---- the options ---- */

enum {
    KEY_SIZE = 0x100,
    KEY_CAMERA,
    KEY_LIGHTS,
    KEY_TIME,
    KEY_OPACITY,
    KEY_BACKGROUND,
    KEY_METHOD,
    KEY_PASSES,
    KEY_PROFILE,
    KEY_CULL,
    KEY_NORMALS,
    KEY_GGX,
    KEY_BACK_LIGHT,
    KEY_DEPTH_FUNC,
    KEY_DEPTH_RANGE,
    KEY_PEEL_TEST,
    KEY_DEPTH,
    KEY_ACCUM,
    KEY_GBUFFER,
    KEY_SHADING,
    KEY_BIAS,
    KEY_DRAW_ORDER,
    KEY_SORT,
    KEY_WEIGHT,
    KEY_NODES,
    KEY_POST,
    KEY_POSITION,
    KEY_FMA,
    KEY_GL,
    KEY_SIMD,
    KEY_TILE,
    KEY_MODEL,
    KEY_THREADS,
    KEY_MEMORY,
};

static const struct argp_option settings[] = {
    {0, 0, 0, 0, "Settings:", 1},
    {"camera", KEY_CAMERA, "NAME|INDEX", 0, "Camera of the scene (default the first)", 1},
    {"time", KEY_TIME, "SECONDS", 0, "Turns the lights (default 0)", 1},
    {"opacity", KEY_OPACITY, "A", 0, "Opacity 0 to 1 of every material; below 1 all are peeled", 1},
    {"background", KEY_BACKGROUND, "R,G,B", 0, "Linear background colour (default the scene's)", 1},
    {"profile", KEY_PROFILE, "default|seed", 0,
     "default, or seed: the number formats and choices of the original program", 1},
    {"cull", KEY_CULL, "MODE", 0,
     "Back faces left out: gltf (default: of single-sided materials), seed (of opaque ones), none",
     1},
    {"normals", KEY_NORMALS, "MODE", 0,
     "On back faces: faced (default: turned to the viewer) or kept", 1},
    {"shading", KEY_SHADING, "MODEL", 0,
     "ggx (default: the original's point lights) or phong (one directional light)", 1},
    {"ggx", KEY_GGX, "FORM", 0,
     "Highlights' distribution: source (default: as the original computes it) or stable (without "
     "its cancellation)",
     1},
    {"back-light", KEY_BACK_LIGHT, "on|off", 0,
     "Transparent surfaces also reflect lights behind them (default off)", 1},
    {"depth-func", KEY_DEPTH_FUNC, "FUNC", 0,
     "less (default: of equal depths the first drawn stays) or lequal (the last)", 1},
    {"depth-range", KEY_DEPTH_RANGE, "RANGE", 0,
     "gl (default: clip space -w to w), zero-one (0 to w), reversed (0 to w, depth 1 near and 0 "
     "far)",
     1},
    {"peel-test", KEY_PEEL_TEST, "TEST", 0,
     "stored (default: depths are compared as stored) or raw (gl_FragCoord.z with a stored depth)",
     1},
    {"bias", KEY_BIAS, "B", 0,
     "With peel, peel-id and forward: a peel takes fragments more than B of depth behind the "
     "previous "
     "one (default 0)",
     1},
    {"draw-order", KEY_DRAW_ORDER, "ORDER", 0,
     "Order of the instances: scene (default), reverse or shuffle=SEED", 1},
    {"sort", KEY_SORT, "UNIT", 0,
     "What the painter sorts by its centroid: objects (default) or triangles", 1},
    {"weight", KEY_WEIGHT, "N", 0,
     "Equation of weighted-blended's weights in its paper: 9 (default), 7, 8 or 10", 1},
    {"nodes-per-pixel", KEY_NODES, "N", 0,
     "Room of linked-list, on average (default: as many as are needed)", 1},
    {"post", KEY_POST, "EFFECT", 0,
     "With linked-list: none (default) or edges (outlines of every layer)", 1},
    {"depth", KEY_DEPTH, "FORMAT", 0, "d32f (default), d24 or d16", 1},
    {"accum", KEY_ACCUM, "FORMAT", 0, "rgba32f (default), rgba16f, rgba16 or rgba8", 1},
    {"gbuffer", KEY_GBUFFER, "SET", 0,
     "full (default: all 32-bit floats), seed (the original's formats) or compact (octahedral "
     "normals, 8-bit material, no position; linked-list always)",
     1},
    {"position", KEY_POSITION, "SOURCE", 0,
     "Positions for lighting: from the G-buffer's buffer (default) or reconstruct (from depth; "
     "with "
     "a compact G-buffer always)",
     1},
    {"fma", KEY_FMA, "on|off", 0,
     "Fused multiply-add in fixed-function arithmetic (default: as the GL driver does; without gl, "
     "on)",
     1},
    {"gl", KEY_GL, OPTIONS_GL_NAMES, 0, OPTIONS_GL_HELP, 1},
    {"simd", KEY_SIMD, "NAME", 0,
     "Instructions of ref's fast path: auto (default), scalar, sse2, avx2, avx512; same bits", 1},
    {"tile", KEY_TILE, "N", 0,
     "Pixels a side of ref's tiles: a power of two, 8 to 256 (default 64); same bits", 1},
    {"model", KEY_MODEL, "WHAT", 0,
     "needed (default): leave out what this scene does not need, see peel plan; or all; same bits",
     1},
    {"max-memory", KEY_MEMORY, "BYTES", 0,
     "Refuse to need more, per renderer and to load the scene (default 4G)", 1},
    {0},
};

static const struct argp_option render_options[] = {
    {0, 0, 0, 0, "Rendering:", 1},
    {"size", KEY_SIZE, "WxH", 0, "Image size in pixels (default 1280x720)", 1},
    {"lights", KEY_LIGHTS, "N", 0, "The scene's first N lights (default all)", 1},
    {"method", KEY_METHOD, "NAME", 0,
     "Transparency method (default peel; compare also takes all); see 'peel methods'", 1},
    {"passes", KEY_PASSES, "N|auto", 0,
     "At most N peels; auto (default) until a peel yields no fragment", 1},
    {"threads", KEY_THREADS, "N", 0, "Worker threads (default one per processor)", 1},
    {0},
};

static error_t parse_tile(const char *text, int *out)
{
    error_t error = options_count("--tile", text, TILE_MIN, TILE_MAX, out);
    if (!error && (*out & (*out - 1)) != 0)
        return options_error("--tile '%s': expected a power of two", text);
    return error;
}

error_t options_passes(const char *text, RenderDesc *desc)
{
    desc->passes = 0;
    if (strcmp(text, "auto") == 0)
        return 0;
    long long passes;
    if (!options_integer(text, 1, PASSES_MAX, &passes))
        return options_error("--passes %s: expected auto or 1 to %d", text, PASSES_MAX);
    desc->passes = (int)passes;
    return 0;
}

/* "a", then "a, b", then "a, b or c": the i-th of count names. */
static void append_name(char *list, size_t size, int i, int count, const char *name)
{
    size_t length = strlen(list);
    const char *separator = i == 0 ? "" : i == count - 1 ? " or " : ", ";
    snprintf(list + length, size - length, "%s%s", separator, name);
}

/* The index of text among the names, which are listed in the message when it is none of them. */
static error_t parse_choice(const char *option, const char *text, const char *const names[],
                            int count, int *out)
{
    char expected[128] = "";
    for (int i = 0; i < count; i++) {
        if (strcmp(text, names[i]) == 0) {
            *out = i;
            return 0;
        }
        append_name(expected, sizeof expected, i, count, names[i]);
    }
    return options_error("%s %s: expected %s", option, text, expected);
}

error_t options_fma(const char *text, FmaChoice *out)
{
    static const char *const names[] = {"on", "off"};
    int choice = 0;
    error_t error = parse_choice("--fma", text, names, 2, &choice);
    *out = choice == 0 ? FMA_ON : FMA_OFF;
    return error;
}

error_t options_gl(const char *text)
{
    static const char *const names[] = {"osmesa", "egl"};
    int choice = 0;
    error_t error = parse_choice("--gl", text, names, 2, &choice);
    if (error == 0)
        context_choose(choice == 0 ? CONTEXT_OSMESA : CONTEXT_EGL);
    return error;
}

static error_t parse_method(const char *text, RenderOptions *options)
{
    options->all_methods = strcmp(text, "all") == 0;
    options->has_method = !options->all_methods;
    return options->all_methods ? 0 : options_method(text, &options->desc);
}

error_t options_method(const char *text, RenderDesc *desc)
{
    const MethodInfo *method = method_find(text);
    if (method) {
        desc->method = method->id;
        return 0;
    }
    char expected[256] = "";
    for (int i = 0; i < METHOD_COUNT; i++)
        append_name(expected, sizeof expected, i, METHOD_COUNT, method_info((MethodId)i)->name);
    return options_error("--method %s: expected %s", text, expected);
}

error_t options_lights(const char *text, RenderDesc *desc)
{
    error_t error = options_count("--lights", text, 0, 1 << 20, &desc->lights);
    if (desc->lights == 0)
        desc->lights = -1; /* none: 0 means all in a RenderDesc */
    return error;
}

/* Which setting an option is. */
static const struct {
    int key;
    SettingId setting;
} named_options[] = {
    {KEY_CULL, SETTING_CULL},
    {KEY_NORMALS, SETTING_NORMALS},
    {KEY_SHADING, SETTING_SHADING},
    {KEY_GGX, SETTING_GGX},
    {KEY_BACK_LIGHT, SETTING_BACK_LIGHT},
    {KEY_DEPTH_FUNC, SETTING_DEPTH_FUNC},
    {KEY_DEPTH_RANGE, SETTING_DEPTH_RANGE},
    {KEY_PEEL_TEST, SETTING_PEEL_TEST},
    {KEY_GBUFFER, SETTING_GBUFFER},
    {KEY_POSITION, SETTING_POSITION},
    {KEY_DEPTH, SETTING_DEPTH},
    {KEY_ACCUM, SETTING_ACCUM},
    {KEY_SORT, SETTING_SORT},
    {KEY_WEIGHT, SETTING_WEIGHT},
    {KEY_POST, SETTING_POST},
    {KEY_SIMD, SETTING_SIMD},
    {KEY_MODEL, SETTING_MODEL},
};

static error_t parse_profile(const char *text, RenderOptions *options)
{
    static const char *const names[] = {"default", "seed"};
    return parse_choice("--profile", text, names, 2, &options->profile);
}

static error_t parse_named(int key, const char *argument, RenderOptions *options)
{
    for (size_t i = 0; i < sizeof named_options / sizeof *named_options; i++) {
        SettingId id = named_options[i].setting;
        if (named_options[i].key != key)
            continue;
        char option[32];
        snprintf(option, sizeof option, "--%s", setting_info(id)->name);
        return parse_choice(option, argument, setting_info(id)->choices, setting_choice_count(id),
                            &options->settings[id]);
    }
    return ARGP_ERR_UNKNOWN;
}

bool options_depth_format(const char *text, RenderOptions *options)
{
    const SettingInfo *depth = setting_info(SETTING_DEPTH);
    for (int i = 0; i < setting_choice_count(SETTING_DEPTH); i++)
        if (strcmp(text, depth->choices[i]) == 0) {
            options->settings[SETTING_DEPTH] = i;
            return true;
        }
    return false;
}

static error_t parse_draw_order(const char *text, RenderDesc *desc)
{
    static const char shuffle[] = "shuffle=";
    long long seed = 0;
    if (strcmp(text, "scene") == 0)
        desc->draw_order = DRAW_ORDER_SCENE;
    else if (strcmp(text, "reverse") == 0)
        desc->draw_order = DRAW_ORDER_REVERSE;
    else if (strncmp(text, shuffle, sizeof shuffle - 1) == 0 &&
             options_integer(text + sizeof shuffle - 1, 0, LLONG_MAX, &seed))
        desc->draw_order = DRAW_ORDER_SHUFFLE;
    else
        return options_error("--draw-order %s: expected scene, reverse or shuffle=SEED", text);
    desc->draw_seed = (uint64_t)seed;
    return 0;
}

static error_t parse_bias(const char *text, RenderDesc *desc)
{
    double bias = 0.0;
    error_t error = parse_real("--bias", text, 0.0, 1.0, &bias);
    desc->bias = (float)bias;
    return error;
}

/* --max-memory is for what is read, too. */
static void note_given(const struct argp_option *table, int key, RenderOptions *options)
{
    for (const struct argp_option *o = table; (o->name || o->doc) && !options->given; o++)
        if (o->name && o->key == key && key != KEY_MEMORY)
            options->given = o->name;
}

static error_t parse_settings(int key, char *argument, struct argp_state *state)
{
    RenderOptions *options = state->input;
    RenderDesc *desc = &options->desc;
    note_given(settings, key, options);
    switch (key) {
    case KEY_CAMERA:
        options->camera = argument;
        return 0;
    case KEY_TIME:
        return parse_real("--time", argument, -1e6, 1e6, &desc->time);
    case KEY_OPACITY:
        options->has_opacity = true;
        return parse_real("--opacity", argument, 0.0, 1.0, &options->opacity);
    case KEY_BACKGROUND:
        return parse_background(argument, options);
    case KEY_BIAS:
        return parse_bias(argument, desc);
    case KEY_DRAW_ORDER:
        return parse_draw_order(argument, desc);
    case KEY_NODES:
        return options_count("--nodes-per-pixel", argument, 1, NODES_MAX, &desc->nodes_per_pixel);
    case KEY_FMA:
        return options_fma(argument, &options->fma);
    case KEY_GL:
        return options_gl(argument);
    case KEY_PROFILE:
        return parse_profile(argument, options);
    case KEY_TILE:
        return parse_tile(argument, &desc->tile);
    case KEY_MEMORY:
        return options_memory(argument, &desc->max_memory);
    default:
        return parse_named(key, argument, options);
    }
}

static error_t parse_render(int key, char *argument, struct argp_state *state)
{
    RenderOptions *options = state->input;
    RenderDesc *desc = &options->desc;
    note_given(render_options, key, options);
    switch (key) {
    case KEY_SIZE:
        return options_size(argument, desc);
    case KEY_LIGHTS:
        return options_lights(argument, desc);
    case KEY_METHOD:
        return parse_method(argument, options);
    case KEY_PASSES:
        options->has_passes = true;
        return options_passes(argument, desc);
    case KEY_THREADS:
        return options_count("--threads", argument, 1, THREADS_MAX, &desc->threads);
    case ARGP_KEY_ARG:
        if (options->scene_path)
            return options_error("'%s': expected one scene, already given as '%s'", argument,
                                 options->scene_path);
        options->scene_path = options_input(argument);
        return 0;
    case ARGP_KEY_SUCCESS:
        if (!options->scene_path && !options->scene_optional)
            return options_error("no scene given; expected a .gltf or .glb file or the name of a "
                                 "built-in scene");
        return 0;
    case ARGP_KEY_INIT:
        state->child_inputs[0] = options;
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

const struct argp options_settings_argp = {settings, parse_settings, NULL, NULL, NULL, NULL, NULL};

static const struct argp_child render_children[] = {{&options_settings_argp, 0, NULL, 1}, {0}};

const struct argp options_render_argp = {render_options,  parse_render, NULL, NULL,
                                         render_children, NULL,         NULL};
