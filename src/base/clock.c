#include "base/clock.h"

#include <time.h>

static double milliseconds(clockid_t id)
{
    struct timespec time;
    clock_gettime(id, &time);
    return (double)time.tv_sec * 1e3 + (double)time.tv_nsec * 1e-6;
}

Clock clock_now(void)
{
    return (Clock){milliseconds(CLOCK_MONOTONIC), milliseconds(CLOCK_PROCESS_CPUTIME_ID)};
}

double clock_thread_ms(void)
{
    return milliseconds(CLOCK_THREAD_CPUTIME_ID);
}

void clock_elapsed(const Clock *start, double *wall_ms, double *cpu_ms)
{
    Clock now = clock_now();
    *wall_ms = now.wall_ms - start->wall_ms;
    *cpu_ms = now.cpu_ms - start->cpu_ms;
}
