/* peel blend vectors. */
#include "cli/bind.h"
#include "cli/options.h"

int cmd_blend_vectors(int argc, char **argv)
{
    (void)argc;
    (void)argv;
    return options_fail(result_fail(RESULT_UNSUPPORTED, "blend vectors: not built yet"));
}
