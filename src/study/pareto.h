/* The Pareto front of measurements: those that nothing beats in both cost and error. */
#ifndef PEEL_STUDY_PARETO_H
#define PEEL_STUDY_PARETO_H

#include <stdbool.h>
#include <stddef.h>

/* cost and error: count values each, smaller is better, in any units. marks[i] (room for count)
 * becomes whether no other point is as good in both and better in one; of equal points all are
 * marked. A point with a NaN is never marked and beats none. */
void pareto_mark(const double *cost, const double *error, size_t count, bool *marks);

#endif
