/* peel blend check. */
#include "cli/bind.h"
#include "cli/options.h"

int cmd_blend_check(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    return options_fail(result_fail(RESULT_UNSUPPORTED, "blend check: not built yet"));
}
