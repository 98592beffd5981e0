/* Whether jansson ran out of memory: of its functions, few say so, and a text that it could not
 * parse for want of memory looks like a bad one. */
#ifndef PEEL_BASE_JSON_MEMORY_H
#define PEEL_BASE_JSON_MEMORY_H

#include "base/result.h"

/* Before calls of jansson on this thread: lets it allocate through here, and forgets what was. */
void json_memory_begin(void);

/* NO_MEMORY, with a message that names path, if any of its allocations on this thread has failed
 * since json_memory_begin; else result, as it was. */
Result json_memory_check(const char *path, Result result);

#endif
