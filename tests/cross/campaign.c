/* The long run: random scenes of every kind under random settings of every method, unattended. Each
 * goes through the three checks of trial.h; one that fails is reduced to a few triangles and
 * written, and the next one begins. Exit code 0: no difference unexplained, memory flat; 2: not so;
 * 4: bad usage or environment. */
#include "minimise.h"
#include "random_desc.h"
#include "resident.h"
#include "trial.h"

#include "base/clock.h"
#include "frame/method.h"
#include "gl/gl_renderer.h"
#include "report/document.h"

#include <argp.h>
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

enum {
    EXIT_DIFFER = 2,
    EXIT_BAD_INPUT = 4,
    REDUCED_MAX = 20, /* failures that are reduced and written; the others are counted */
    LINE_SECONDS = 60 /* between two lines where there is no terminal */
};

typedef struct Options {
    uint64_t count, seed;
    double minutes; /* 0: no limit */
    bool unfused;
    const char *json;
} Options;

typedef struct Campaign {
    const Options *options;
    uint64_t done, failed, reduced;
    TrialFigures sums[TRIAL_COUNT];
    uint64_t kinds[SOUP_KINDS], methods[METHOD_COUNT];
    Resident resident;
    Clock start;
    double printed; /* seconds, when the latest line was */
} Campaign;

static volatile sig_atomic_t interrupted;

static void on_interrupt(int number)
{
    (void)number;
    interrupted = 1;
}

/* ---- one scene ------------------------------------------------------------------------------ */

/* What is random for the tile path alone; small frames hardly gain from more threads. */
static RenderDesc with_paths(RenderDesc desc, uint64_t seed)
{
    Random random = random_seed(~seed);
    desc.threads = 1 + (int)(random_bits(&random) % 8);
    desc.tile = TILE_MIN << random_bits(&random) % 6;
    desc.simd = (SimdChoice)(random_bits(&random) % SIMD_COUNT);
    return desc;
}

static void add(TrialFigures *sum, const TrialFigures *figures)
{
    sum->pixels += figures->pixels;
    sum->values += figures->values;
    sum->fragments += figures->fragments;
    sum->bounded += figures->bounded;
    sum->unbounded += figures->unbounded;
    sum->max_ratio = fmax(sum->max_ratio, figures->max_ratio);
    sum->differences += figures->differences;
    for (int i = 0; i < CLASS_COUNT; i++)
        sum->classes[i] += figures->classes[i];
}

/* A check that cannot be made on a part of a scene does not show the failure; nor does any, once
 * the run is to end. */
static bool fails(TrialId trial, const Scene *scene, const RenderDesc *desc)
{
    TrialFigures figures;
    return !interrupted && trial_run(trial, scene, desc, &figures) == RESULT_OK &&
           figures.differences > 0;
}

static bool fails_gl(const Scene *scene, const RenderDesc *desc)
{
    return fails(TRIAL_GL, scene, desc);
}

static bool fails_paths(const Scene *scene, const RenderDesc *desc)
{
    return fails(TRIAL_PATHS, scene, desc);
}

static bool fails_truth(const Scene *scene, const RenderDesc *desc)
{
    return fails(TRIAL_TRUTH, scene, desc);
}

static void clear_line(void)
{
    if (isatty(STDERR_FILENO))
        fputs("\r\033[K", stderr);
}

static void reduce(Campaign *campaign, TrialId trial, uint64_t seed, const Scene *scene,
                   const RenderDesc *desc)
{
    static const MinimiseFails of[TRIAL_COUNT] = {fails_gl, fails_paths, fails_truth};
    static const char *const suffixes[TRIAL_COUNT] = {"gl", "paths", "truth"};
    char path[64];
    MinimisedFile file;
    RenderDesc shown = trial_desc(trial, desc);
    if (campaign->reduced++ >= REDUCED_MAX)
        return;
    if (!fails(trial, scene, &shown))
        shown = *desc;
    snprintf(path, sizeof path, "campaign-%llu-%s.gltf", (unsigned long long)seed, suffixes[trial]);
    if (minimise_to_file(scene, &shown, of[trial], path, &file) != RESULT_OK)
        printf("  could not be written: %s\n", result_message());
    else
        printf("  %u triangles, %zu lights left%s\n  %s\n", file.triangles, file.lights,
               file.shown ? "" : " (the file does not show it)", file.command);
}

/* Returns false where a renderer failed. */
static bool check(Campaign *campaign, TrialId trial, uint64_t seed, const Scene *scene,
                  const RenderDesc *desc)
{
    TrialFigures figures;
    Result result = trial_run(trial, scene, desc, &figures);
    add(&campaign->sums[trial], &figures);
    if (result == RESULT_OK && figures.differences == 0)
        return true;
    clear_line();
    printf("seed %llu (%s, %s): %s: %s\n", (unsigned long long)seed,
           soup_kind_name((SoupKind)(seed % SOUP_KINDS)), method_info(desc->method)->name,
           trial_name(trial), result == RESULT_OK ? figures.text : result_message());
    if (result == RESULT_OK)
        reduce(campaign, trial, seed, scene, desc);
    else
        campaign->sums[trial].differences++;
    fflush(stdout);
    return false;
}

static void run_scene(Campaign *campaign, uint64_t seed)
{
    static Soup soup;
    RenderDesc desc;
    SoupKind kind = random_case(seed, &desc, &soup);
    bool good = true;
    desc.unfused = campaign->options->unfused;
    campaign->kinds[kind]++;
    campaign->methods[desc.method]++;
    if (scene_validate(&soup.scene) != RESULT_OK) {
        printf("seed %llu: %s\n", (unsigned long long)seed, result_message());
        campaign->failed++;
        return;
    }
    RenderDesc paths = with_paths(desc, seed);
    for (int trial = 0; trial < TRIAL_COUNT; trial++)
        good &= check(campaign, (TrialId)trial, seed, &soup.scene,
                      trial == TRIAL_PATHS ? &paths : &desc);
    campaign->failed += !good;
}

/* ---- progress ------------------------------------------------------------------------------- */

static uint64_t differences(const Campaign *campaign)
{
    uint64_t sum = 0;
    for (int trial = 0; trial < TRIAL_COUNT; trial++)
        sum += campaign->sums[trial].differences;
    return sum;
}

static double seconds(const Campaign *campaign)
{
    double wall, cpu;
    clock_elapsed(&campaign->start, &wall, &cpu);
    return wall / 1e3;
}

static void print_progress(Campaign *campaign)
{
    bool terminal = isatty(STDERR_FILENO);
    double now = seconds(campaign);
    if (now - campaign->printed < (terminal ? 0.5 : LINE_SECONDS))
        return;
    campaign->printed = now;
    fprintf(stderr,
            "%s%llu of %llu scenes, %.2f a second, %.1f MiB resident (%.1f after the first), "
            "%llu differences%s",
            terminal ? "\r\033[K" : "", (unsigned long long)campaign->done,
            (unsigned long long)campaign->options->count, (double)campaign->done / now,
            resident_now().resident, resident_at(&campaign->resident, 0.0).resident,
            (unsigned long long)differences(campaign), terminal ? "" : "\n");
}

/* ---- the end -------------------------------------------------------------------------------- */

static void print_counts(const Campaign *campaign)
{
    const TrialFigures *gl = &campaign->sums[TRIAL_GL], *truth = &campaign->sums[TRIAL_TRUTH];
    for (int kind = 0; kind < SOUP_KINDS; kind++)
        printf("%s%s %llu", kind ? ", " : "kinds: ", soup_kind_name((SoupKind)kind),
               (unsigned long long)campaign->kinds[kind]);
    for (int method = 0; method < METHOD_COUNT; method++)
        printf("%s%s %llu", method ? ", " : "\nmethods: ", method_info((MethodId)method)->name,
               (unsigned long long)campaign->methods[method]);
    printf("\nref and gl: %llu pixels of buffers, %llu values, %llu transparent fragments: %llu "
           "differ\n",
           (unsigned long long)gl->pixels, (unsigned long long)gl->values,
           (unsigned long long)gl->fragments, (unsigned long long)gl->differences);
    printf("definition and tiles: %llu frames: %llu differ\n", (unsigned long long)campaign->done,
           (unsigned long long)campaign->sums[TRIAL_PATHS].differences);
    printf("ref and truth: %llu pixels with the same fragments, %llu without bound; greatest error "
           "%.3f of its bound: %llu unexplained\n",
           (unsigned long long)truth->bounded, (unsigned long long)truth->unbounded,
           truth->max_ratio, (unsigned long long)truth->differences);
    for (int i = 0; i < CLASS_COUNT; i++)
        if (truth->classes[i])
            printf("  %12llu pixels: %s\n", (unsigned long long)truth->classes[i],
                   class_text((PixelClass)i));
}

static Result write_json(const Campaign *campaign, bool fused)
{
    Document json = {0};
    json_t *root = json_object(), *memory = json_array(), *classes = json_object();
    const TrialFigures *gl = &campaign->sums[TRIAL_GL], *truth = &campaign->sums[TRIAL_TRUTH];
    document_put(&json, root, "first_seed", document_count(campaign->options->seed));
    document_put(&json, root, "wanted", document_count(campaign->options->count));
    document_put(&json, root, "scenes", document_count(campaign->done));
    document_put(&json, root, "failed", document_count(campaign->failed));
    document_put(&json, root, "fused", json_boolean(fused));
    document_put(&json, root, "seconds", document_real(seconds(campaign)));
    document_put(&json, root, "values", document_count(gl->values));
    document_put(&json, root, "gl_differences", document_count(gl->differences));
    document_put(&json, root, "path_differences",
                 document_count(campaign->sums[TRIAL_PATHS].differences));
    document_put(&json, root, "unexplained", document_count(truth->differences));
    document_put(&json, root, "bounded", document_count(truth->bounded));
    document_put(&json, root, "unbounded", document_count(truth->unbounded));
    document_put(&json, root, "max_ratio", document_real(truth->max_ratio));
    for (int i = 0; i < CLASS_COUNT; i++)
        document_put(&json, classes, class_key((PixelClass)i), document_count(truth->classes[i]));
    document_put(&json, root, "classes", classes);
    for (int i = 0; i < 3; i++) {
        static const double parts[] = {0.1, 0.5, 1.0};
        ResidentSample sample = resident_at(&campaign->resident, parts[i]);
        json_t *object = json_object();
        document_put(&json, object, "part", document_real(parts[i]));
        document_put(&json, object, "resident_mib", document_real(sample.resident));
        document_put(&json, object, "heap_mib", document_real(sample.heap));
        document_append(&json, memory, object);
    }
    document_put(&json, root, "flat", json_boolean(resident_is_flat(&campaign->resident)));
    document_put(&json, root, "memory", memory);
    return document_write(&json, root, campaign->options->json);
}

static void print_memory(const Resident *resident, bool flat)
{
    static const double parts[] = {0.1, 0.5, 1.0};
    printf("memory:");
    for (int i = 0; i < 3; i++) {
        ResidentSample sample = resident_at(resident, parts[i]);
        printf(" %.1f MiB resident, %.2f of it allocated after %.0f %%%s", sample.resident,
               sample.heap, 100.0 * parts[i], i < 2 ? ";" : "");
    }
    ResidentSample allowed = resident_allowed(resident);
    printf(": %s (%.1f and %.2f may be added in the second half)\n", flat ? "flat" : "not flat",
           allowed.resident, allowed.heap);
}

static int conclude(Campaign *campaign, bool fused)
{
    const Resident *resident = &campaign->resident;
    bool flat = resident_is_flat(resident);
    clear_line();
    print_counts(campaign);
    print_memory(resident, flat);
    printf("%llu of %llu scenes%s in %.0f s, fma %s: %llu failed, %llu unexplained differences\n",
           (unsigned long long)campaign->done, (unsigned long long)campaign->options->count,
           interrupted ? " (interrupted)" : "", seconds(campaign), fused ? "on" : "off",
           (unsigned long long)campaign->failed, (unsigned long long)differences(campaign));
    int code = campaign->failed || !flat ? EXIT_DIFFER : EXIT_SUCCESS;
    if (campaign->options->json && write_json(campaign, fused) != RESULT_OK) {
        fprintf(stderr, "campaign: %s\n", result_message());
        code = EXIT_BAD_INPUT;
    }
    return code;
}

/* ---- the command line ----------------------------------------------------------------------- */

enum {
    KEY_COUNT = 0x100,
    KEY_SEED,
    KEY_MINUTES,
    KEY_FMA,
    KEY_JSON
};

static const struct argp_option known_options[] = {
    {"count", KEY_COUNT, "N", 0, "Scenes (default 10000)", 0},
    {"seed", KEY_SEED, "N", 0, "The first one's (default 1)", 0},
    {"minutes", KEY_MINUTES, "M", 0, "Ends after that time, with a summary, as Ctrl-C does", 0},
    {"fma", KEY_FMA, "on|off", 0, "Fused multiply-add (default on)", 0},
    {"json", KEY_JSON, "FILE", 0, "Write the figures as JSON", 0},
    {0}};

static error_t parse_count(const char *text, uint64_t *out, struct argp_state *state)
{
    char *end;
    errno = 0;
    *out = strtoull(text, &end, 10);
    if (errno || end == text || *end || *text == '-' || *out == 0 || *out > 1000000000)
        argp_error(state, "'%s': expected a number from 1 to 1000000000", text);
    return 0;
}

static error_t parse(int key, char *argument, struct argp_state *state)
{
    Options *options = state->input;
    char *end;
    switch (key) {
    case KEY_COUNT:
        return parse_count(argument, &options->count, state);
    case KEY_SEED:
        return parse_count(argument, &options->seed, state);
    case KEY_MINUTES:
        options->minutes = strtod(argument, &end);
        if (end == argument || *end || !(options->minutes > 0.0))
            argp_error(state, "--minutes %s: expected a number above 0", argument);
        return 0;
    case KEY_FMA:
        options->unfused = strcmp(argument, "off") == 0;
        if (!options->unfused && strcmp(argument, "on") != 0)
            argp_error(state, "--fma %s: expected on or off", argument);
        return 0;
    case KEY_JSON:
        options->json = argument;
        return 0;
    case ARGP_KEY_ARG:
        argp_error(state, "'%s': expected no argument", argument);
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp campaign_argp = {
    known_options, parse, "", "Random scenes: ref against gl, itself and truth.", NULL, NULL, NULL};

int main(int argc, char **argv)
{
    Options options = {.count = 10000, .seed = 1};
    Campaign campaign = {.options = &options, .start = clock_now()};
    bool fused = false;
    argp_err_exit_status = EXIT_BAD_INPUT;
    argp_parse(&campaign_argp, argc, argv, 0, NULL, &options);
    if (options.unfused)
        setenv("GALLIUM_OVERRIDE_CPU_CAPS", "sse4.1", 1); /* read at Mesa's first call */
    Result result = resident_begin(options.count, &campaign.resident);
    if (result == RESULT_OK)
        result = gl_driver_fuses(0, &fused);
    if (result == RESULT_OK && fused == options.unfused)
        result = result_fail(RESULT_UNSUPPORTED, "--fma %s: the driver here %s multiply-adds",
                             options.unfused ? "off" : "on", fused ? "fuses" : "does not fuse");
    if (result != RESULT_OK) {
        fprintf(stderr, "campaign: %s\n", result_message());
        return EXIT_BAD_INPUT;
    }
    signal(SIGINT, on_interrupt);
    signal(SIGTERM, on_interrupt);
    while (campaign.done < options.count && !interrupted) {
        run_scene(&campaign, options.seed + campaign.done);
        resident_add(&campaign.resident, campaign.done++);
        print_progress(&campaign);
        if (options.minutes > 0.0 && seconds(&campaign) > 60.0 * options.minutes)
            break;
    }
    int code = conclude(&campaign, fused);
    resident_free(&campaign.resident);
    return code;
}
