#include "report/gnuplot.h"

#include "base/file.h"
#include "base/memory.h"

#include <errno.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum {
    STREAMS = 3 /* the numbers of standard input, output and error */
};

static void close_all(FILE *const streams[STREAMS])
{
    for (int i = 0; i < STREAMS; i++)
        if (streams[i])
            (void)fclose(streams[i]);
}

/* Files without names, of the script, the drawing and complaints. */
static Result open_all(FILE *streams[STREAMS])
{
    for (int i = 0; i < STREAMS; i++)
        if (!(streams[i] = tmpfile()))
            return result_fail(RESULT_IO, "gnuplot: no temporary file: %s", strerror(errno));
    return RESULT_OK;
}

static Result run(FILE *const streams[STREAMS])
{
    char *const arguments[] = {"gnuplot", "-", NULL};
    posix_spawn_file_actions_t actions;
    pid_t child;
    int status = 0;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return result_fail(RESULT_NO_MEMORY, "gnuplot: out of memory");
    for (int i = 0; i < STREAMS; i++)
        posix_spawn_file_actions_adddup2(&actions, fileno(streams[i]), i);
    int error = posix_spawnp(&child, arguments[0], &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (error)
        return result_fail(RESULT_UNSUPPORTED,
                           "gnuplot: cannot start it: %s (Debian's gnuplot-nox)", strerror(error));
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        ;
    if (status == 0)
        return RESULT_OK;
    char line[256] = "no reason given";
    rewind(streams[STDERR_FILENO]);
    while (fgets(line, sizeof line, streams[STDERR_FILENO]) && line[0] == '\n')
        ;
    line[strcspn(line, "\n")] = '\0';
    return result_fail(RESULT_INTERNAL, "gnuplot: failed: %s", line);
}

/* gnuplot does not look whether its output was written. */
static bool is_whole(const char *svg, size_t size)
{
    static const char end[] = "</svg>";
    size_t length = sizeof end - 1;
    while (size > 0 && (svg[size - 1] == '\n' || svg[size - 1] == ' '))
        size--;
    return size >= length && memcmp(svg + size - length, end, length) == 0;
}

static Result copy(FILE *drawing, const char *path)
{
    long size = fseek(drawing, 0, SEEK_END) == 0 ? ftell(drawing) : 0;
    rewind(drawing);
    if (size <= 0)
        return result_fail(RESULT_INTERNAL, "gnuplot: drew nothing for %s", path);
    char *data = memory_array((size_t)size, 1);
    if (!data)
        return RESULT_NO_MEMORY;
    Result result = RESULT_OK;
    if (fread(data, 1, (size_t)size, drawing) != (size_t)size)
        result = result_fail(RESULT_IO, "gnuplot: cannot read its drawing back");
    else if (!is_whole(data, (size_t)size))
        result =
            result_fail(RESULT_IO, "gnuplot: %s is cut off: no room for a temporary file", path);
    else
        result = file_write(path, data, (size_t)size);
    free(data);
    return result;
}

Result gnuplot_draw(void (*write)(FILE *script, const void *what), const void *what,
                    const char *path)
{
    FILE *streams[STREAMS] = {NULL};
    Result result = open_all(streams);
    if (result == RESULT_OK) {
        write(streams[STDIN_FILENO], what);
        bool written = fflush(streams[STDIN_FILENO]) == 0 && !ferror(streams[STDIN_FILENO]);
        rewind(streams[STDIN_FILENO]);
        result =
            written ? run(streams) : result_fail(RESULT_IO, "gnuplot: cannot write its script");
    }
    if (result == RESULT_OK)
        result = copy(streams[STDOUT_FILENO], path);
    close_all(streams);
    return result;
}

void gnuplot_quote(FILE *script, const char *text)
{
    fputc('\'', script);
    for (const char *c = text; *c; c++) {
        if (*c == '\'')
            fputc('\'', script);
        fputc((unsigned char)*c < 32 ? ' ' : *c, script);
    }
    fputc('\'', script);
}
