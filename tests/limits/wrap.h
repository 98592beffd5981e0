/* Allocations that fail: what the linker's --wrap puts between our objects and the C library, in
 * faulty, the program with one failure planted. The libraries' own allocations are not ours, but
 * for jansson's, which takes its functions from us. */
#ifndef PEEL_TESTS_LIMITS_WRAP_H
#define PEEL_TESTS_LIMITS_WRAP_H

#include <stdbool.h>

/* In memory that forked processes share, so that they count as one. */
typedef struct WrapPlan {
    _Atomic long counted;
    _Atomic long fails_at; /* counted from 1; 0: none */
    _Atomic bool for_good; /* ... and all that follow */
    _Atomic long failed;
} WrapPlan;

/* Before any allocation is counted. false: no memory for the plan. */
bool wrap_begin(void);
WrapPlan *wrap_plan(void);

#endif
