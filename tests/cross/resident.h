/* What a process has of memory while it works, and whether that stays flat. */
#ifndef PEEL_TESTS_RESIDENT_H
#define PEEL_TESTS_RESIDENT_H

#include "base/memory.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* MiB; 0 where that is not known. */
typedef struct ResidentSample {
    double resident; /* after unused memory was given back */
    double heap;     /* allocated and not freed */
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

/* MiB that the second half of the work may add. To the heap: the driver's table of known shaders,
 * and ours of nothing. To what is resident: about 5 KiB for each GL context that was made and
 * destroyed, of Mesa's code generator (measured over frames without anything else). */
#define RESIDENT_HEAP_MAX 1.0
#define RESIDENT_MAX      32.0

static inline ResidentSample resident_now(void)
{
    unsigned long long pages = 0;
    struct mallinfo2 heap = mallinfo2();
    ResidentSample sample = {.heap = (double)(heap.uordblks + heap.hblkhd) / (1 << 20)};
    malloc_trim(0);
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file)
        return sample;
    if (fscanf(file, "%*u %llu", &pages) != 1)
        pages = 0;
    fclose(file);
    sample.resident = (double)pages * (double)sysconf(_SC_PAGESIZE) / (1 << 20);
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

static inline bool resident_is_flat(const Resident *resident)
{
    ResidentSample half = resident_at(resident, 0.5), end = resident_at(resident, 1.0);
    return end.resident <= half.resident + RESIDENT_MAX &&
           end.heap <= half.heap + RESIDENT_HEAP_MAX;
}

#endif
