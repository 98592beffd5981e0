/* Runs a command within limits and says what it took.
 *
 *   limited RECORD SECONDS MEBIBYTES COMMAND [ARGUMENT...]
 *
 * No process of it may map more than MEBIBYTES, or take more than SECONDS of processor time; after
 * ten times as many on the clock, of which a busy machine needs more, it is killed. 0: no limit.
 * RECORD, a file, gets one line: the exit code (128 and the signal where one ended it), which is
 * also limited's, milliseconds of processor time, of all its processes together, and on the clock,
 * and the most KiB that one of them had in memory. */
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static pid_t command;

static void on_alarm(int number)
{
    (void)number;
    kill(command, SIGKILL);
}

static int fail(const char *what)
{
    fprintf(stderr, "limited: %s: %s\n", what, strerror(errno));
    return EXIT_FAILURE;
}

static double now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

static double ms_of(const struct timeval *time)
{
    return (double)time->tv_sec * 1e3 + (double)time->tv_usec * 1e-3;
}

int main(int argc, char **argv)
{
    if (argc < 5) {
        fprintf(stderr, "limited: expected RECORD SECONDS MEBIBYTES COMMAND [ARGUMENT...]\n");
        return EXIT_FAILURE;
    }
    rlim_t bytes = (rlim_t)strtoull(argv[3], NULL, 10) << 20;
    rlim_t seconds = (rlim_t)strtoul(argv[2], NULL, 10);
    double start = now_ms();
    struct rusage used;
    int status = 0;
    command = fork();
    if (command < 0)
        return fail("fork");
    if (command == 0) {
        if (bytes)
            setrlimit(RLIMIT_AS, &(struct rlimit){bytes, bytes});
        if (seconds)
            setrlimit(RLIMIT_CPU, &(struct rlimit){seconds, seconds});
        execvp(argv[4], argv + 4);
        _exit(fail(argv[4]));
    }
    signal(SIGALRM, on_alarm);
    alarm(10 * (unsigned)seconds);
    while (wait4(command, &status, 0, &used) < 0 && errno == EINTR)
        ;
    FILE *record = fopen(argv[1], "w");
    if (!record)
        return fail(argv[1]);
    int code = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    fprintf(record, "%d %.0f %.0f %ld\n", code, ms_of(&used.ru_utime) + ms_of(&used.ru_stime),
            now_ms() - start, used.ru_maxrss);
    return fclose(record) == 0 ? code : fail(argv[1]);
}
