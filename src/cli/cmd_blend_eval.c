/* peel blend eval. */
#include "cli/bind.h"
#include "cli/options.h"

int cmd_blend_eval(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    return options_fail(result_fail(RESULT_UNSUPPORTED, "blend eval: not built yet"));
}
