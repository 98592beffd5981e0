#include "cli/terminal.h"

#include "cli/options.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum {
    COLUMNS_UNKNOWN = 100,
    COLUMNS_MOST = 1000
};

int terminal_columns(int least)
{
    struct winsize size;
    const char *text = getenv("COLUMNS");
    long long columns = COLUMNS_UNKNOWN;
    if ((!text || !options_integer(text, 1, COLUMNS_MOST, &columns)) &&
        ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
        columns = size.ws_col;
    return columns > least ? (int)columns : least;
}

bool terminal_has_colour(void)
{
    const char *terminal = getenv("TERM"), *none = getenv("NO_COLOR");
    return isatty(STDOUT_FILENO) && !(none && *none) && terminal && *terminal &&
           strcmp(terminal, "dumb") != 0;
}
