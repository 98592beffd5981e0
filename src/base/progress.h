/* A progress line on a terminal's stderr, and nothing in a pipe. One at a time. */
#ifndef PEEL_BASE_PROGRESS_H
#define PEEL_BASE_PROGRESS_H

#include <stdint.h>

/* Stands before what every later progress_begin says: what the work is part of. Copied, at most 63
 * bytes of it; NULL for nothing. */
void progress_context(const char *text);

/* what: a few words. total: steps expected; 0 when it is not known. */
void progress_begin(const char *what, uint64_t total);
void progress_step(uint64_t done); /* from any thread; redraws at most ten times a second */
void progress_clear(void);         /* before a line of stdout; the next step draws it again */
void progress_off(void);           /* stdout is rows on the terminal: no line any more */
void progress_add(void);           /* one step more; pool_run does so after every task */
void progress_end(void);           /* clears the line */

#endif
