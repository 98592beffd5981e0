/* Whose arithmetic made these results: a stream of vectors with blended pixels is compared with
 * every named arithmetic that applies, with every combination of the fields of ARITHMETIC_STEPS,
 * and with what the graphics APIs allow, in one pass and constant memory.
 *
 * Colour and alpha are told apart: hardware may compute them differently. Values are the stored
 * channels; two NaN are equal, other values are when their bits are. */
#ifndef PEEL_STUDY_BLEND_CHECK_H
#define PEEL_STUDY_BLEND_CHECK_H

#include "base/result.h"
#include "blend/arithmetic.h"
#include "blend/equation.h"
#include "blend/vectors.h"
#include "study/blend_rules.h"

typedef enum BlendGroup {
    GROUP_COLOR = 0,
    GROUP_ALPHA, /* has no values in formats without alpha */
    GROUP_COUNT
} BlendGroup;

/* One value of the stream that an arithmetic does not give. */
typedef struct BlendExample {
    VectorSet set;
    uint64_t index; /* of the vector in its set */
    int channel;
    int complexity; /* blend_case_complexity */
    uint32_t ulp;   /* of the format (codes); UINT32_MAX between a NaN and a number */
    float source[4];
    unsigned char pixel[16]; /* before */
    uint32_t expected, got;  /* bits */
} BlendExample;

typedef struct BlendTally {
    uint64_t values, differing;
    uint32_t max_ulp;
} BlendTally;

typedef struct BlendCandidate {
    char name[ARITHMETIC_TEXT]; /* "separate", or its fields */
    const ArithmeticInfo *info; /* NULL of an arithmetic that has no name */
    Arithmetic arithmetic;
    const char *refused; /* why it is not compared, static; or NULL */
    BlendTally groups[GROUP_COUNT];
    uint64_t vectors;      /* that were compared: fewer than all of one that is far off */
    BlendExample simplest; /* where it differs: least complexity, then first */
    BlendExample *worst;   /* where it differs most; as many as were asked for */
    int worst_count;
    bool stopped; /* not compared any more */
} BlendCandidate;

typedef enum BlendVerdict {
    BLEND_NAMED = 0, /* a right arithmetic's, or of colour and alpha one each */
    BLEND_UNNAMED,   /* none's that has a name, or none's at all, but within an API's rules */
    BLEND_WRONG,     /* a wrong arithmetic's */
    BLEND_OUTSIDE    /* none's, and outside the rules */
} BlendVerdict;

const char *blend_verdict_name(BlendVerdict verdict); /* "named", "unnamed", …; static */

typedef struct BlendCheckDesc {
    PixelFormat format;
    BlendEquation equation;
    const Arithmetic *against; /* one more to compare with, at index 0 of the report; or NULL */
    int worst;                 /* examples kept of each arithmetic */
    int threads;               /* as for pool_create */
    bool every;                /* count differences of all to the end */
    bool quick; /* once a right named arithmetic gives all values of some thousand vectors, go on
                 * only with those that give all */
} BlendCheckDesc;

typedef struct BlendReport {
    PixelFormat format;
    BlendEquation equation;
    uint64_t vectors;
    BlendCandidate *candidates; /* that of `against` if there is one; the named ones in their
                                 * order; then those without a name that explain a group */
    size_t count;
    bool has_against;
    BlendRuleTally rules[BLEND_RULES];
} BlendReport;

typedef struct BlendCheck BlendCheck;

/* The caller closes it, also after a failure of the others. */
Result blend_check_open(const BlendCheckDesc *desc, BlendCheck **out);
/* The next vectors, of the set from number `index` on. destination and results: pixels of the
 * format. */
Result blend_check_add(BlendCheck *check, VectorSet set, uint64_t index, size_t count,
                       const float (*source)[4], const void *destination, const void *results);
/* Moves what was found to *out, which the caller frees with blend_report_free. */
void blend_check_finish(BlendCheck *check, BlendReport *out);
void blend_check_close(BlendCheck *check); /* NULL is fine */
void blend_report_free(BlendReport *report);

/* ---- what the report says -------------------------------------------------------------------- */

/* Whether the candidate gives all values of the group, which has some. */
bool blend_explains(const BlendReport *report, size_t candidate, BlendGroup group);

/* The arithmetic that explains the group best: a right one that gives all values, else a wrong one
 * that does, else one without a name, else the named one with the fewest differences. Those before
 * it in the catalogue win. SIZE_MAX where the group has no values. */
size_t blend_best(const BlendReport *report, BlendGroup group);
/* The same of both groups at once. */
size_t blend_best_whole(const BlendReport *report);

/* Values that no arithmetic of the report gives: of each group the differences of its best. */
uint64_t blend_unexplained(const BlendReport *report);
uint64_t blend_values(const BlendReport *report);

/* api: whose rules count as "the rules"; API_COUNT: those of any API. */
BlendVerdict blend_verdict(const BlendReport *report, BlendApi api);

#endif
