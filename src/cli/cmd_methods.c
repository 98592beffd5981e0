/* peel methods: the table of methods. */
#include "cli/bind.h"
#include "cli/options.h"
#include "frame/method.h"

#include <stdio.h>

static error_t parse(int key, char *argument, struct argp_state *state)
{
    (void)state;
    return key == ARGP_KEY_ARG ? options_error("'%s': expected no argument", argument)
                               : ARGP_ERR_UNKNOWN;
}

static const struct argp methods_argp = {
    NULL,
    parse,
    "",
    "Lists the methods of --method: whether each converges to the sorted result, and how near to "
    "truth "
    "it is then (--tolerance of peel compare), what it does, and the paper that it is from.",
    NULL,
    NULL,
    NULL};

int cmd_methods(int argc, char **argv)
{
    int code = options_parse(&methods_argp, argc, argv, NULL);
    if (code)
        return code == OPTIONS_HELPED ? EXIT_AGREE : code;
    for (int i = 0; i < METHOD_COUNT; i++) {
        const MethodInfo *method = method_info((MethodId)i);
        char bound[32] = "approximate";
        if (method->exact)
            snprintf(bound, sizeof bound, "exact to %g", method->tolerance);
        printf("%-17s %-15s %s\n%18s%s\n", method->name, bound, method->summary, "", method->paper);
    }
    return EXIT_AGREE;
}
