/* Whether blended values are within what the graphics APIs state, and within what their test suites
 * tolerate. Each rule bounds |stored − exact|, the exact result being that of the operands in real
 * numbers; the bounds are derived in blend_rules.c and computed in double, where they are rounded
 * in the value's favour.
 *
 * Not judged: what a rule says nothing of (infinities, NaN, what may be flushed, results that may
 * overflow). Such values are counted as unstated. */
#ifndef PEEL_STUDY_BLEND_RULES_H
#define PEEL_STUDY_BLEND_RULES_H

#include "blend/vectors.h"
#include "study/blend_case.h"

typedef enum BlendApi {
    API_GL = 0,
    API_VULKAN,
    API_D3D11,
    API_SUITE, /* a conformance test's tolerance: of no API */
    API_COUNT
} BlendApi;

const char *blend_api_name(BlendApi api); /* "gl", "vulkan", "d3d11", "suite"; static */

typedef struct BlendRuleInfo {
    const char *name, *source; /* "OpenGL", "4.6 core, 17.3.6" */
    const char *allowed;       /* per operation and store, or in all */
    BlendApi api;
} BlendRuleInfo;

/* What was seen of one rule. */
typedef struct BlendRuleTally {
    const BlendRuleInfo *info;
    bool applies; /* to the format */
    uint64_t judged, unstated, outside;
    double largest;      /* of the judged: |stored − exact| in codes, or in ULP of the greatest of
                          * operands, products and result */
    double largest_real; /* the same as a number */
    bool has_example;    /* the value farthest outside, or else with the largest error */
    double example_error; /* its |stored − exact|, as `largest` */
    int channel;
    VectorSet set; /* of the vector */
    uint64_t index;
    double exact;
    float source[4];
    unsigned char pixel[16];
    uint32_t got;
} BlendRuleTally;

enum {
    BLEND_RULES = 9
};

/* out: BLEND_RULES tallies, empty. */
void blend_rules_start(PixelFormat format, BlendRuleTally *out);

/* Where a vector is from, for examples. */
typedef struct BlendPlace {
    VectorSet set;
    uint64_t index;
} BlendPlace;

/* Judges got, the stored bits of the case's channel, by all rules that apply. */
void blend_rules_add(const BlendCase *one, BlendPlace place, uint32_t got, BlendRuleTally *tallies);

/* Adds what another thread saw of later vectors. */
void blend_rules_merge(BlendRuleTally *tallies, const BlendRuleTally *later);

/* Whether values were seen that break a rule of the API (API_COUNT: of every API). */
bool blend_rules_broken(const BlendRuleTally *tallies, BlendApi api);

#endif
