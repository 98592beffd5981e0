/* What a process has of memory while it works, and whether that stays flat. */
#ifndef PEEL_TESTS_RESIDENT_H
#define PEEL_TESTS_RESIDENT_H

#include "base/memory.h"

#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

/* Samples, evenly spread over the work. */
typedef struct Resident {
    uint64_t every; /* steps between two samples */
    size_t count;
    double *mib;
} Resident;

enum {
    RESIDENT_SAMPLES = 1000
};

/* MiB, after unused memory was given back; 0 where that is not known. */
static inline double resident_now(void)
{
    unsigned long long pages = 0;
    malloc_trim(0);
    FILE *file = fopen("/proc/self/statm", "r");
    if (!file)
        return 0.0;
    if (fscanf(file, "%*u %llu", &pages) != 1)
        pages = 0;
    fclose(file);
    return (double)pages * (double)sysconf(_SC_PAGESIZE) / (1 << 20);
}

/* steps: how many there will be at most. The caller frees. */
static inline Result resident_begin(uint64_t steps, Resident *out)
{
    *out = (Resident){.every = (steps + RESIDENT_SAMPLES - 1) / RESIDENT_SAMPLES,
                      .mib = memory_array(RESIDENT_SAMPLES, sizeof *out->mib)};
    return out->mib ? RESULT_OK : RESULT_NO_MEMORY;
}

static inline void resident_free(Resident *resident)
{
    free(resident->mib);
}

/* After step 0, 1, … */
static inline void resident_add(Resident *resident, uint64_t step)
{
    if (step % resident->every == 0 && resident->count < RESIDENT_SAMPLES)
        resident->mib[resident->count++] = resident_now();
}

/* After this part of the work, 0 to 1. */
static inline double resident_at(const Resident *resident, double part)
{
    size_t last = resident->count ? resident->count - 1 : 0;
    return resident->count ? resident->mib[(size_t)(part * (double)last + 0.5)] : 0.0;
}

/* MiB that may be added after half of the work. */
static inline double resident_allowed(const Resident *resident)
{
    (void)resident;
    return 16.0;
}

static inline bool resident_is_flat(const Resident *resident)
{
    return resident_at(resident, 1.0) <= resident_at(resident, 0.5) + resident_allowed(resident);
}

#endif
