#include "study/blend_twins.h"

#include "base/memory.h"
#include "study/blend_probe.h"

#include <stdlib.h>

enum {
    PROBE = 16384
};

static bool gives_all(const BlendReport *report, size_t candidate)
{
    const BlendCandidate *one = &report->candidates[candidate];
    return !one->refused && one->vectors == report->vectors &&
           one->groups[GROUP_COLOR].differing + one->groups[GROUP_ALPHA].differing == 0;
}

static Result tell_apart(const BlendReport *report, const BlendProbe *probe, size_t best,
                         BlendTwin *twins, size_t count)
{
    unsigned char *pixels = blend_probe_blend(probe, &report->candidates[best].arithmetic);
    const unsigned char *const others[] = {pixels};
    bool failed = pixels == NULL;
    for (size_t i = 0; i < count && !failed; i++) {
        unsigned char *its =
            blend_probe_blend(probe, &report->candidates[twins[i].candidate].arithmetic);
        failed = its == NULL;
        if (its)
            twins[i].apart = blend_probe_apart(probe, its, 1, others, &twins[i].example);
        free(its);
    }
    free(pixels);
    return failed ? RESULT_NO_MEMORY : RESULT_OK;
}

Result blend_twins(const BlendReport *report, size_t best, BlendTwin **out, size_t *count)
{
    *out = NULL;
    *count = 0;
    if (!gives_all(report, best))
        return RESULT_OK;
    BlendTwin *twins = memory_array(report->count, sizeof *twins);
    if (!twins)
        return RESULT_NO_MEMORY;
    for (size_t i = 0; i < report->count; i++)
        if (i != best && report->candidates[i].info && gives_all(report, i) &&
            report->candidates[i].info != report->candidates[best].info)
            twins[(*count)++].candidate = i;
    BlendProbe probe = {0};
    Result result = RESULT_OK;
    if (*count > 0)
        result = blend_probe_make(&report->equation, report->format, PROBE, &probe);
    if (*count > 0 && result == RESULT_OK)
        result = tell_apart(report, &probe, best, twins, *count);
    blend_probe_free(&probe);
    if (result == RESULT_OK && *count > 0) {
        *out = twins;
        return RESULT_OK;
    }
    free(twins);
    *count = 0;
    return result;
}
