/* Wall and processor time of a stretch of work. For reports only: nothing depends on it. */
#ifndef PEEL_BASE_CLOCK_H
#define PEEL_BASE_CLOCK_H

typedef struct Clock {
    double wall_ms, cpu_ms;
} Clock;

Clock clock_now(void);        /* cpu: user and system time of all threads of the process */
double clock_thread_ms(void); /* of the calling thread, from some start */
void clock_elapsed(const Clock *start, double *wall_ms, double *cpu_ms);

#endif
