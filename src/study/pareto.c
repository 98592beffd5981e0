#include "study/pareto.h"

#include <math.h>

/* Comparisons with a NaN are false. */
static bool beats(const double *cost, const double *error, size_t a, size_t b)
{
    return cost[a] <= cost[b] && error[a] <= error[b] && (cost[a] < cost[b] || error[a] < error[b]);
}

void pareto_mark(const double *cost, const double *error, size_t count, bool *marks)
{
    for (size_t i = 0; i < count; i++) {
        marks[i] = !isnan(cost[i]) && !isnan(error[i]);
        for (size_t other = 0; other < count && marks[i]; other++)
            marks[i] = !beats(cost, error, other, i);
    }
}
