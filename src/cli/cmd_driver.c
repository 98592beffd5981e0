/* peel driver: what the local GL driver keeps of the number rules. */
#include "cli/bind.h"
#include "cli/options.h"
#include "gl/gl_renderer.h"
#include "gl/lab.h"
#include "ref/pipeline/experiment.h"
#include "report/driver.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct DriverCommand {
    const char *json;
    int threads;
    FmaChoice fma;
} DriverCommand;

enum {
    KEY_JSON = 0x200,
    KEY_GL,
    KEY_FMA,
    KEY_THREADS
};

static const struct argp_option command_options[] = {
    {"gl", KEY_GL, OPTIONS_GL_NAMES, 0, OPTIONS_GL_HELP, 0},
    {"fma", KEY_FMA, "on|off", 0,
     "Whether Mesa's software driver fuses multiply-adds (default: as the processor can)", 0},
    {"json", KEY_JSON, "FILE", 0, "Write the table as JSON", 0},
    {"threads", KEY_THREADS, "N", 0, "Rasterizer threads of Mesa's software driver", 0},
    {0},
};

static error_t parse(int key, char *argument, struct argp_state *state)
{
    DriverCommand *command = state->input;
    switch (key) {
    case KEY_JSON:
        command->json = argument;
        return 0;
    case KEY_GL:
        return options_gl(argument);
    case KEY_FMA:
        return options_fma(argument, &command->fma);
    case KEY_THREADS:
        return options_count("--threads", argument, 1, 256, &command->threads);
    case ARGP_KEY_ARG:
        return options_error("'%s': driver takes no argument", argument);
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp command_argp = {
    command_options,
    parse,
    "",
    "Takes the local GL driver through the rules of ref/pipeline/NUMBERS.md, one by one, and says "
    "which it keeps to the bit, how far off it is elsewhere, and the simplest example.\vExit code "
    "0 when all is exact or differs only in what peeling does not rely on, 2 when the driver "
    "breaks a rule that it relies on (marked *), 4 when there is no such driver.",
    NULL,
    NULL,
    NULL};

static const char *mode_name(FusesMode mode)
{
    return mode == FUSES_YES ? "fused" : mode == FUSES_NOT ? "unfused" : "neither";
}

static Result check_fma(FmaChoice fma, FusesMode mode)
{
    if ((fma == FMA_ON && mode == FUSES_NOT) || (fma == FMA_OFF && mode == FUSES_YES))
        return result_fail(RESULT_NO_GL, "--fma %s: the GL driver here is %s",
                           fma == FMA_ON ? "on" : "off", mode_name(mode));
    return RESULT_OK;
}

static Result run_rules(const DriverCommand *command, const LabDriver *driver, GlLab *lab,
                        DriverReport *report)
{
    Result result = check_fma(command->fma, driver->mode);
    if (result != RESULT_OK)
        return result;
    PipelineLab model = pipeline_lab(driver->mode != FUSES_NOT);
    result_warnings_enable(false); /* the table says more */
    result = driver_run(&model.lab, lab_experiments(lab), gl_render, report);
    result_warnings_enable(true);
    return result;
}

static Result examine(const DriverCommand *command, DriverReport *report)
{
    LabDriver driver;
    GlLab *lab;
    Result result = options_check_output(command->json);
    options_apply_fma(command->fma);
    if (result == RESULT_OK)
        result = lab_open(command->threads, &driver, &lab);
    if (result != RESULT_OK)
        return result;
    result = run_rules(command, &driver, lab, report);
    lab_close(lab);
    if (result != RESULT_OK)
        return result;
    DriverName name = {driver.vendor, driver.renderer, driver.version, driver.glsl,
                       mode_name(driver.mode)};
    report_driver_print(&name, report, stdout);
    fflush(stdout); /* before a --json /dev/stdout */
    if (command->json)
        result = report_driver_json(&name, report, command->json);
    if (result != RESULT_OK)
        driver_free(report);
    return result;
}

int cmd_driver(int argc, char **argv)
{
    DriverCommand command = {0};
    int code = options_parse(&command_argp, argc, argv, &command);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    DriverReport report;
    Result result = examine(&command, &report);
    if (result != RESULT_OK)
        return options_fail(result);
    code = report.broken ? EXIT_DIFFER : EXIT_AGREE;
    driver_free(&report);
    return code;
}
