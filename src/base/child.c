#include "base/child.h"

#include "base/memory.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

/* Before every record, and, with more false, the last thing that a child says. */
typedef struct Header {
    bool more;
    Result result;
    char message[512];
} Header;

static bool write_all(int pipe, const void *data, size_t size)
{
    const char *at = data;
    while (size > 0) {
        ssize_t written = write(pipe, at, size);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return false;
        at += written;
        size -= (size_t)written;
    }
    return true;
}

static bool read_all(int pipe, void *data, size_t size)
{
    char *at = data;
    while (size > 0) {
        ssize_t got = read(pipe, at, size);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        at += got;
        size -= (size_t)got;
    }
    return true;
}

Result child_put(int pipe, const ChildWork *work, const void *record)
{
    const Header header = {.more = true};
    if (write_all(pipe, &header, sizeof header) && write_all(pipe, record, work->record_size))
        return RESULT_OK;
    return result_fail(RESULT_IO, "child process: cannot write to its parent: %s", strerror(errno));
}

static _Noreturn void be_child(const ChildWork *work, int pipe, pid_t parent)
{
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent)
        _exit(EXIT_FAILURE);
    Header header = {.result = work->run(work->context, pipe)};
    if (header.result != RESULT_OK)
        snprintf(header.message, sizeof header.message, "%s", result_message());
    fflush(stdout);
    _exit(write_all(pipe, &header, sizeof header) ? EXIT_SUCCESS : EXIT_FAILURE);
}

/* Takes records until the child's last word. */
static Result listen_to(const ChildWork *work, int pipe, void *record, bool *ended)
{
    Header header;
    *ended = false;
    while (read_all(pipe, &header, sizeof header)) {
        if (!header.more) {
            *ended = true;
            return header.result == RESULT_OK ? RESULT_OK
                                              : result_fail(header.result, "%s", header.message);
        }
        if (!read_all(pipe, record, work->record_size))
            break;
        work->take(work->take_context, record);
    }
    return RESULT_INTERNAL;
}

static Result start(const ChildWork *work, int *pipe_end, pid_t *child)
{
    int ends[2];
    pid_t parent = getpid();
    fflush(stdout); /* or the child would print it again */
    if (pipe(ends) != 0)
        return result_fail(RESULT_IO, "child process: no pipe: %s", strerror(errno));
    *child = fork();
    if (*child == 0) {
        close(ends[0]);
        be_child(work, ends[1], parent);
    }
    close(ends[1]);
    *pipe_end = ends[0];
    if (*child > 0)
        return RESULT_OK;
    close(ends[0]);
    return result_fail(RESULT_IO, "child process: cannot start: %s", strerror(errno));
}

Result child_run(const ChildWork *work)
{
    void *record = memory_array(1, work->record_size);
    int pipe_end = -1, status = 0;
    pid_t child = -1;
    bool ended;
    if (!record)
        return RESULT_NO_MEMORY;
    Result result = start(work, &pipe_end, &child);
    if (result != RESULT_OK) {
        free(record);
        return result;
    }
    result = listen_to(work, pipe_end, record, &ended);
    close(pipe_end);
    free(record);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR)
        ;
    if (ended)
        return result;
    if (WIFSIGNALED(status))
        return result_fail(RESULT_INTERNAL, "child process: ended by signal %d (%s)",
                           WTERMSIG(status), strsignal(WTERMSIG(status)));
    return result_fail(RESULT_INTERNAL, "child process: ended without a result, exit code %d",
                       WEXITSTATUS(status));
}
