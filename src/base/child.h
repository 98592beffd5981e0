/* Work in a process of its own, which hands back records: for what a process can do only once, such
 * as starting a GL driver with some number of threads, and for libraries that may crash, hang or
 * take all memory.
 *
 * The child ends when its parent does, whatever it is at. Its warnings (base/result.h) are the
 * parent's. */
#ifndef PEEL_BASE_CHILD_H
#define PEEL_BASE_CHILD_H

#include "base/result.h"

#include <stddef.h>

/* Builds with a sanitizer that maps terabytes and prints reports: CHILD_SANITIZED. */
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define CHILD_SANITIZED
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CHILD_SANITIZED
#endif

/* 0: no limit but what the caller's process has. */
typedef struct ChildLimits {
    /* Bytes that the child may allocate beyond what it begins with: heap and mappings, not the
     * stack. Not kept where CHILD_SANITIZED. */
    size_t memory;
    double seconds; /* of processor time, rounded up; on the clock CHILD_PATIENCE times as many */
} ChildLimits;

enum {
    CHILD_PATIENCE = 4 /* how much slower than alone a child may run, or wait */
};

typedef struct ChildWork {
    /* Runs in the child: calls child_put with records. Its result and message become child_run's.
     * What it leaves open ends with the process. */
    Result (*run)(void *context, int pipe);
    void *context;
    /* Runs in the caller's process, for each record in order, which is freed behind it. */
    void (*take)(void *context, const void *record, size_t size);
    void *take_context;
    const char *name; /* in messages on how it ended: "NAME ended by ..."; NULL: child process */
    /* What it and its libraries print is lost, but where CHILD_SANITIZED. */
    bool quiet;
    ChildLimits limits;
} ChildWork;

/* The caller must have no other thread. Besides run's result: INTERNAL when the child ends without
 * one, by a signal, say; BAD_INPUT when it takes more time than it may; NO_MEMORY when a record
 * does not fit in the caller's. */
Result child_run(const ChildWork *work);

/* In the child. IO when the parent no longer listens. */
Result child_put(int pipe, const void *record, size_t size);

/* In the child: it reads the file at path, which the caller's process keeps (base/file.h). */
Result child_reads(int pipe, const char *path);

/* In the child: other limits than it began with, counted from its beginning. */
Result child_limit(int pipe, const ChildLimits *limits);

#endif
