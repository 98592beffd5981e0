/* What a report of blend_check.h says. */
#include "study/blend_check.h"

const char *blend_verdict_name(BlendVerdict verdict)
{
    static const char *const names[] = {"named", "unnamed", "wrong", "outside"};
    return names[verdict];
}

bool blend_explains(const BlendReport *report, size_t candidate, BlendGroup group)
{
    const BlendCandidate *one = &report->candidates[candidate];
    const BlendTally *tally = &one->groups[group];
    return !one->refused && one->vectors == report->vectors && tally->values > 0 &&
           tally->differing == 0;
}

/* Values of the group, of all vectors. */
static uint64_t group_values(const BlendReport *report, BlendGroup group)
{
    int channels = format_info(report->format)->channels, alpha = channels == 4;
    return report->vectors * (uint64_t)(group == GROUP_ALPHA ? alpha : channels - alpha);
}

uint64_t blend_values(const BlendReport *report)
{
    return group_values(report, GROUP_COLOR) + group_values(report, GROUP_ALPHA);
}

/* Groups are bits 1 << group. */
static uint64_t differing(const BlendCandidate *one, unsigned groups)
{
    uint64_t sum = 0;
    for (int i = 0; i < GROUP_COUNT; i++)
        sum += groups >> i & 1 ? one->groups[i].differing : 0;
    return sum;
}

static uint64_t compared(const BlendCandidate *one, unsigned groups)
{
    uint64_t sum = 0;
    for (int i = 0; i < GROUP_COUNT; i++)
        sum += groups >> i & 1 ? one->groups[i].values : 0;
    return sum;
}

/* 0: a right arithmetic that gives all; 1: a wrong one; 2: one without a name; 3: none. */
static int rank(const BlendReport *report, const BlendCandidate *one, unsigned groups)
{
    if (one->vectors != report->vectors || differing(one, groups) > 0)
        return 3;
    return !one->info ? 2 : arithmetic_is_wrong(one->info, report->format);
}

static size_t best(const BlendReport *report, unsigned groups)
{
    size_t found = SIZE_MAX;
    int found_rank = 4;
    double found_share = 2.0;
    for (size_t i = 0; i < report->count; i++) {
        const BlendCandidate *one = &report->candidates[i];
        uint64_t values = compared(one, groups);
        if (one->refused || values == 0)
            continue;
        int its_rank = rank(report, one, groups);
        double share = (double)differing(one, groups) / (double)values;
        if (its_rank < found_rank || (its_rank == found_rank && share < found_share)) {
            found = i;
            found_rank = its_rank;
            found_share = share;
        }
    }
    return found;
}

size_t blend_best(const BlendReport *report, BlendGroup group)
{
    return best(report, 1u << group);
}

size_t blend_best_whole(const BlendReport *report)
{
    return best(report, 1u << GROUP_COLOR | 1u << GROUP_ALPHA);
}

uint64_t blend_unexplained(const BlendReport *report)
{
    uint64_t sum = 0;
    for (int i = 0; i < GROUP_COUNT; i++) {
        size_t candidate = blend_best(report, (BlendGroup)i);
        if (candidate != SIZE_MAX)
            sum += report->candidates[candidate].groups[i].differing;
    }
    return sum;
}

/* The worst rank of the groups that have values. */
static int worst_rank(const BlendReport *report)
{
    int worst = 0;
    for (int i = 0; i < GROUP_COUNT; i++) {
        size_t candidate = blend_best(report, (BlendGroup)i);
        if (candidate == SIZE_MAX)
            continue;
        int its_rank = rank(report, &report->candidates[candidate], 1u << i);
        worst = its_rank > worst ? its_rank : worst;
        if (its_rank == 1) /* a wrong one is worse than none */
            return 1;
    }
    return worst;
}

BlendVerdict blend_verdict(const BlendReport *report, BlendApi api)
{
    int explained = worst_rank(report);
    if (explained == 0)
        return BLEND_NAMED;
    if (explained == 1)
        return BLEND_WRONG;
    return blend_rules_broken(report->rules, api) ? BLEND_OUTSIDE : BLEND_UNNAMED;
}
