/* The plan of a frame as text and as JSON. */
#ifndef PEEL_REPORT_PLAN_H
#define PEEL_REPORT_PLAN_H

#include "study/plan.h"

#include <stdio.h>

/* Layers, passes, buffers, and what was left out. */
void report_plan_print(const Plan *plan, FILE *out);

/* The front of a search, and its answer. command: of the answer; NULL where there is none. */
void report_plan_choices(const PlanSearch *search, const char *command, FILE *out);

/* search and command: NULL where none was made. Written to a temporary name and renamed. */
Result report_plan_json(const Plan *plan, const PlanSearch *search, const char *command,
                        const char *path);

#endif
