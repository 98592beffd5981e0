/* What the two files of `peel blend check` share. */
#ifndef PEEL_CLI_BLEND_CHECK_H
#define PEEL_CLI_BLEND_CHECK_H

#include "cli/options.h"
#include "study/blend_check.h"
#include "study/blend_wrong.h"

typedef struct BlendCheckCommand {
    const char *path, *json;
    Arithmetic against;
    BlendEquation equation;
    BlendApi api;     /* API_COUNT: any */
    unsigned formats; /* bits 1 << place in arithmetic_formats; 0: all */
    unsigned sets;    /* bits 1 << VectorSet; 0: all */
    uint32_t fail, warn;
    uint64_t limit, seed;
    int worst, threads;
    FmaChoice fma;
    bool has_against, has_equation, gl, list, verbose;
} BlendCheckCommand;

/* The exit code that a report asks for. */
int blend_check_code(const BlendCheckCommand *command, const BlendReport *report);

/* --gl. */
Result blend_check_gl(const BlendCheckCommand *command, int *code);

#endif
