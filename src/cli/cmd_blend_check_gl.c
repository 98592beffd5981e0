/* peel blend check --gl: the local driver's fixed-function blending. */
#include "cli/blend_check.h"

#include "base/memory.h"
#include "base/progress.h"
#include "gl/lab.h"
#include "report/blend_check.h"
#include "study/blend_driver.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct GlRun {
    const BlendCheckCommand *command;
    LabDriver driver;
    GlLab *lab;
    BlendReport reports[ARITHMETIC_FORMATS * EQUATION_COUNT];
    size_t count;
    uint64_t changed, unexplained, values;
    int code;
} GlRun;

static uint64_t progress_before;

static void show_progress(uint64_t vectors)
{
    progress_step(progress_before + vectors);
}

static BlendDriverDesc describe(const BlendCheckCommand *command, PixelFormat format,
                                const BlendEquation *equation)
{
    return (BlendDriverDesc){.format = format,
                             .equation = *equation,
                             .sets = command->sets ? command->sets : ~0u,
                             .limit = command->limit,
                             .seed = command->seed,
                             .threads = command->threads,
                             .worst = command->worst,
                             .progress = show_progress};
}

/* Equations that are run with format i. */
static int equation_count(const BlendCheckCommand *command, int i)
{
    if (command->formats && !(command->formats >> i & 1))
        return 0;
    return command->has_equation ? 1 : EQUATION_COUNT;
}

static const BlendEquation *equation_at(const BlendCheckCommand *command, int i)
{
    return command->has_equation ? &command->equation : &equation_info((EquationId)i)->equation;
}

static Result run_one(GlRun *run, PixelFormat format, const BlendEquation *equation)
{
    BlendReport *report = &run->reports[run->count];
    BlendDriverDesc desc = describe(run->command, format, equation);
    uint64_t changed;
    if (blend_driver_vectors(&desc) == 0) /* no such set of the format */
        return RESULT_OK;
    Result result = blend_driver_run(lab_experiments(run->lab), &desc, report, &changed);
    if (result != RESULT_OK)
        return result;
    run->count++;
    run->changed += changed;
    progress_before += report->vectors;
    run->unexplained += blend_unexplained(report);
    run->values += blend_values(report);
    int code = blend_check_code(run->command, report);
    run->code = code > run->code ? code : run->code;
    progress_clear();
    report_blend_row(report, stdout);
    fflush(stdout);
    return RESULT_OK;
}

static uint64_t count_vectors(const BlendCheckCommand *command)
{
    uint64_t all = 0;
    for (int i = 0; i < ARITHMETIC_FORMATS; i++)
        for (int k = 0; k < equation_count(command, i); k++) {
            BlendDriverDesc desc =
                describe(command, arithmetic_formats[i], equation_at(command, k));
            all += blend_driver_vectors(&desc);
        }
    return all;
}

static Result run_all(GlRun *run)
{
    Result result = RESULT_OK;
    progress_before = 0;
    progress_begin("vectors", count_vectors(run->command));
    progress_clear();
    report_blend_row_head(stdout);
    for (int i = 0; i < ARITHMETIC_FORMATS; i++)
        for (int k = 0; k < equation_count(run->command, i) && result == RESULT_OK; k++)
            result = run_one(run, arithmetic_formats[i], equation_at(run->command, k));
    progress_end();
    return result;
}

/* The whole of what is not explained, or of one combination alone. */
static Result say(GlRun *run)
{
    Result result = RESULT_OK;
    ReportBlend *blends = memory_array(run->count, sizeof *blends);
    if (!blends)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < run->count; i++)
        blends[i] = (ReportBlend){.report = &run->reports[i],
                                  .api = run->command->api,
                                  .note = "",
                                  .subject = run->driver.renderer,
                                  .vectors = "fixed-function blending",
                                  .verbose = run->command->verbose,
                                  .code = run->code};
    for (size_t i = 0; i < run->count && result == RESULT_OK; i++)
        if (run->count == 1 || run->command->verbose || blend_unexplained(&run->reports[i]) > 0) {
            fputc('\n', stdout);
            result = report_blend_print(&blends[i], stdout);
        }
    if (result == RESULT_OK) {
        if (run->changed)
            printf("\n%llu destinations were stored as other values; these were blended\n",
                   (unsigned long long)run->changed);
        printf("\n%llu unexplained of %llu values\n", (unsigned long long)run->unexplained,
               (unsigned long long)run->values);
        fflush(stdout);
        if (run->command->json)
            result = report_blend_json(blends, run->count, run->command->json);
    }
    free(blends);
    return result;
}

static Result check_fma(const BlendCheckCommand *command, FusesMode mode)
{
    bool wrong = (command->fma == FMA_ON && mode == FUSES_NOT) ||
                 (command->fma == FMA_OFF && mode == FUSES_YES);
    return wrong ? result_fail(RESULT_NO_GL, "--fma %s: the GL driver here %s multiply-adds",
                               command->fma == FMA_ON ? "on" : "off",
                               mode == FUSES_YES ? "fuses" : "does not fuse")
                 : RESULT_OK;
}

Result blend_check_gl(const BlendCheckCommand *command, int *code)
{
    if (count_vectors(command) == 0)
        return result_fail(RESULT_BAD_INPUT, "--set: expected a set that one of the formats has");
    GlRun *run = memory_array(1, sizeof *run);
    if (!run)
        return RESULT_NO_MEMORY;
    run->command = command;
    options_apply_fma(command->fma);
    Result result = lab_open(command->threads, &run->driver, &run->lab);
    if (result == RESULT_OK)
        result = check_fma(command, run->driver.mode);
    if (result == RESULT_OK) {
        printf("%s, %s\nmultiply-adds: %s\n\n", run->driver.renderer, run->driver.version,
               run->driver.mode == FUSES_YES   ? "fused"
               : run->driver.mode == FUSES_NOT ? "unfused"
                                               : "neither");
        result = run_all(run);
    }
    if (result == RESULT_OK)
        result = say(run);
    *code = run->code;
    for (size_t i = 0; i < run->count; i++)
        blend_report_free(&run->reports[i]);
    lab_close(run->lab);
    free(run);
    return result;
}
