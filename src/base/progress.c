#include "base/progress.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static const char *label;
static char context[64];
static uint64_t steps;
static double last_drawn;
static atomic_bool active, off;
static atomic_ullong count;

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static void draw(uint64_t done)
{
    fprintf(stderr, "\r\033[K%s%s%s", context, context[0] ? ": " : "", label);
    if (steps)
        fprintf(stderr, " %3.0f%%", 100.0 * (double)done / (double)steps);
    else if (done)
        fprintf(stderr, ", step %llu", (unsigned long long)done);
    fflush(stderr);
}

void progress_context(const char *text)
{
    pthread_mutex_lock(&mutex);
    snprintf(context, sizeof context, "%s", text ? text : "");
    pthread_mutex_unlock(&mutex);
}

void progress_begin(const char *what, uint64_t total)
{
    if (atomic_load(&off) || !isatty(STDERR_FILENO))
        return;
    pthread_mutex_lock(&mutex);
    label = what;
    atomic_store(&count, 0);
    atomic_store(&active, true);
    steps = total;
    last_drawn = seconds();
    draw(0);
    pthread_mutex_unlock(&mutex);
}

static void redraw(uint64_t done)
{
    pthread_mutex_lock(&mutex);
    if (label && seconds() - last_drawn > 0.1) {
        last_drawn = seconds();
        draw(done);
    }
    pthread_mutex_unlock(&mutex);
}

void progress_clear(void)
{
    pthread_mutex_lock(&mutex);
    if (label) {
        fprintf(stderr, "\r\033[K");
        fflush(stderr);
        last_drawn = 0.0;
    }
    pthread_mutex_unlock(&mutex);
}

void progress_off(void)
{
    atomic_store(&off, true);
}

void progress_add(void)
{
    if (atomic_load(&active))
        redraw(atomic_fetch_add(&count, 1) + 1);
}

void progress_step(uint64_t done)
{
    atomic_store(&count, done); /* for the tasks that a step may have */
    redraw(done);
}

void progress_end(void)
{
    atomic_store(&active, false);
    pthread_mutex_lock(&mutex);
    if (label) {
        fprintf(stderr, "\r\033[K");
        fflush(stderr);
        label = NULL;
    }
    pthread_mutex_unlock(&mutex);
}
