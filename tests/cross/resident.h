/* What a process has of memory while it works, and whether that stays flat. */
#ifndef PEEL_TESTS_RESIDENT_H
#define PEEL_TESTS_RESIDENT_H

#include "base/memory.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* MiB; 0 where that is not known. */
typedef struct ResidentSample {
    /* Of the process's own, without the pages of libraries, which come as they are first used;
     * after unused memory was given back. */
    double resident;
    double heap; /* allocated and not freed */
} ResidentSample;

/* Samples, evenly spread over the work. */
typedef struct Resident {
    uint64_t every; /* steps between two samples */
    size_t count;
    ResidentSample *samples;
} Resident;

enum {
    RESIDENT_SAMPLES = 1000
};

/* What each step of the second half may add, in KiB, beside a few MiB for the largest frames: Mesa
 * keeps about half a KiB allocated, and 6 KiB resident, for each context that was made and
 * destroyed (measured with gl alone; without gl nothing is added). */
#define RESIDENT_STEP_HEAP 1.0
#define RESIDENT_STEP      10.0
#define RESIDENT_SLACK     4.0

static inline ResidentSample resident_now(void)
{
    struct mallinfo2 heap = mallinfo2();
    ResidentSample sample = {.heap = (double)(heap.uordblks + heap.hblkhd) / (1 << 20)};
    char line[128];
    malloc_trim(0);
    FILE *file = fopen("/proc/self/status", "r");
    while (file && fgets(line, sizeof line, file))
        if (strncmp(line, "RssAnon:", 8) == 0)
            sample.resident = strtod(line + 8, NULL) / 1024.0;
    if (file)
        fclose(file);
    return sample;
}

/* steps: how many there will be at most. Before any thread: from here on all of them allocate in
 * one arena, since glibc keeps what it has for each thread, up to tens of MiB. The caller frees. */
static inline Result resident_begin(uint64_t steps, Resident *out)
{
    mallopt(M_ARENA_MAX, 1);
    *out = (Resident){.every = (steps + RESIDENT_SAMPLES - 1) / RESIDENT_SAMPLES,
                      .samples = memory_array(RESIDENT_SAMPLES, sizeof *out->samples)};
    return out->samples ? RESULT_OK : RESULT_NO_MEMORY;
}

static inline void resident_free(Resident *resident)
{
    free(resident->samples);
}

/* After step 0, 1, … */
static inline void resident_add(Resident *resident, uint64_t step)
{
    if (step % resident->every == 0 && resident->count < RESIDENT_SAMPLES)
        resident->samples[resident->count++] = resident_now();
}

/* After this part of the work, 0 to 1. */
static inline ResidentSample resident_at(const Resident *resident, double part)
{
    if (resident->count == 0)
        return (ResidentSample){0};
    return resident->samples[(size_t)(part * (double)(resident->count - 1) + 0.5)];
}

/* MiB that the second half of the work may add. */
static inline ResidentSample resident_allowed(const Resident *resident)
{
    double steps = (double)(resident->every * resident->count) / 2.0;
    return (ResidentSample){.resident = RESIDENT_SLACK + RESIDENT_STEP * steps / 1024.0,
                            .heap = RESIDENT_STEP_HEAP * (1.0 + steps / 1024.0)};
}

static inline bool resident_is_flat(const Resident *resident)
{
    ResidentSample half = resident_at(resident, 0.5), end = resident_at(resident, 1.0);
    ResidentSample allowed = resident_allowed(resident);
    return end.resident <= half.resident + allowed.resident && end.heap <= half.heap + allowed.heap;
}

#endif
