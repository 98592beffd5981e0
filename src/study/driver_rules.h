/* The table of rules. */
#ifndef PEEL_STUDY_DRIVER_RULES_H
#define PEEL_STUDY_DRIVER_RULES_H

#include "study/driver_test.h"

const Rule *driver_rules(size_t *count); /* static */

#endif
