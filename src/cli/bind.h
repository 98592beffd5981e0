/* The one place that binds names to renderers and commands to functions. */
#ifndef PEEL_CLI_BIND_H
#define PEEL_CLI_BIND_H

#include "frame/frame.h"
#include "study/bench.h"
#include "study/threeway.h"

extern const Renderer bind_renderers[RENDERER_COUNT]; /* in the order of RENDERER_… */

extern const BenchRenderer bind_bench[BENCH_RENDERERS];

/* RENDERER_… by name, −1 when there is none. */
int bind_find_renderer(const char *name);

typedef struct Command {
    const char *name;
    const char *summary; /* a line */
    /* argv[0] is "peel <command>"; returns the exit code. */
    int (*run)(int argc, char **argv);
    const struct Command *subcommands; /* up to a row without a name; NULL: none */
} Command;

extern const Command commands[];          /* up to a row without a name */
extern const Command blend_subcommands[]; /* alike */

int cmd_bench(int argc, char **argv);
int cmd_blend(int argc, char **argv);
int cmd_blend_check(int argc, char **argv);
int cmd_blend_eval(int argc, char **argv);
int cmd_blend_vectors(int argc, char **argv);
int cmd_render(int argc, char **argv);
int cmd_check(int argc, char **argv);
int cmd_compare(int argc, char **argv);
int cmd_diagnose(int argc, char **argv);
int cmd_diff(int argc, char **argv);
int cmd_driver(int argc, char **argv);
int cmd_explain(int argc, char **argv);
int cmd_explain_course(int argc, char **argv);
int cmd_explain_pixel(int argc, char **argv);
int cmd_flatten(int argc, char **argv);
int cmd_hard(int argc, char **argv);
int cmd_methods(int argc, char **argv);
int cmd_plan(int argc, char **argv);
int cmd_scenes(int argc, char **argv);

#endif
