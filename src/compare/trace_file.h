/* Traces in files: the multi-part EXR of `peel render --trace`, and what peel_dump.h writes. */
#ifndef PEEL_COMPARE_TRACE_FILE_H
#define PEEL_COMPARE_TRACE_FILE_H

#include "compare/store.h"

/* Whether the file at path holds buffers under the names of frame/trace.h. A file that is neither
 * EXR nor a dump holds none; IO or BAD_INPUT when it cannot be read. */
Result trace_file_is(const char *path, bool *is);

/* Puts every buffer into store, which is empty, in the file's order. BAD_INPUT where one comes
 * twice. */
Result trace_file_read(const char *path, TraceStore *store);

/* The peel K of "peel.K.what", −1 of any other name. */
int trace_name_peel(const char *name);
/* 0 opaque.…, K + 1 peel.K.…, else INT_MAX: the order of the algorithm. */
int trace_name_step(const char *name);

#endif
