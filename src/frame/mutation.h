/* Known mistakes of programs that peel: each one a named change of ref's definition path, with its
 * cause and its cure. diagnose renders them as hypotheses; teaching shows what they look like.
 *
 * RenderDesc.mutations holds them as bits, and several may be set: each changes its own step.
 * Only ref obeys, and only with METHOD_PEEL and METHOD_FORWARD. */
#ifndef PEEL_FRAME_MUTATION_H
#define PEEL_FRAME_MUTATION_H

#include "frame/render_desc.h"

/* At most 64: bits of a uint64_t. */
typedef enum MutationId {
    /* Blending. */
    MUTATION_NOT_PREMULTIPLIED = 0,
    MUTATION_PREMULTIPLIED_TWICE,
    MUTATION_BLEND_FACTORS_SWAPPED,
    MUTATION_OVER_FRONT_TO_BACK,
    MUTATION_DESTINATION_ALPHA_ZERO,
    MUTATION_ACCUMULATION_CLEARED,
    MUTATION_LAYERS_REVERSED,
    MUTATION_DUAL_MIDDLE_TWICE,
    /* The last composition. */
    MUTATION_TRANSMITTANCE_AS_COVERAGE,
    MUTATION_BACKGROUND_WEIGHTED_WRONGLY,
    MUTATION_BACKGROUND_FORGOTTEN,
    MUTATION_RESOLVED_AS_STRAIGHT,
    /* Opaque surfaces. */
    MUTATION_OPAQUE_BLENDED_FIRST,
    MUTATION_OPAQUE_DEPTH_IGNORED,
    MUTATION_OPAQUE_TEST_STRICT,
    /* Peeling. */
    MUTATION_PEEL_TEST_STRICT,
    MUTATION_PEEL_BIAS_1E_4,
    MUTATION_PEEL_BIAS_1E_3,
    MUTATION_PREVIOUS_DEPTH_STALE,
    MUTATION_DEPTH_NOT_SWAPPED,
    MUTATION_ONE_DEPTH_BUFFER,
    MUTATION_PEEL_DEPTH_NOT_CLEARED,
    MUTATION_PASSES_SHORT,
    MUTATION_PASSES_4,
    MUTATION_PASSES_6,
    MUTATION_PASSES_8,
    MUTATION_DEPTH_FETCH_HALF_PIXEL,
    MUTATION_DEPTH_FETCH_FLIPPED,
    MUTATION_DEPTH_16,
    MUTATION_DEPTH_24,
    MUTATION_RAW_PEEL_TEST,
    MUTATION_ALPHA_TEST_MISSING,
    MUTATION_ALPHA_TEST_HALF,
    MUTATION_GBUFFER_CLEAR_ALPHA_1,
    MUTATION_BACK_FACES_CULLED,
    /* Shading. */
    MUTATION_NORMALS_NOT_NORMALISED,
    MUTATION_NORMALS_NOT_FLIPPED,
    MUTATION_NORMALS_WRONG_SPACE,
    MUTATION_ROUGHNESS_SQUARED_TWICE,
    MUTATION_MISSING_1_OVER_PI,
    MUTATION_LIGHTS_OFF_BY_ONE,
    MUTATION_AMBIENT_PER_LAYER,
    /* Encodings and formats. */
    MUTATION_SRGB_ENCODED_TWICE,
    MUTATION_SRGB_BLENDED,
    MUTATION_ACCUMULATION_8_BIT,
    MUTATION_ACCUMULATION_16_BIT,
    MUTATION_ACCUMULATION_HALF,
    MUTATION_ACCUMULATION_HALF_ROUNDED,
    /* Another method. */
    MUTATION_OBJECTS_SORTED,
    MUTATION_WEIGHTED_SUM_TAKEN,
    MUTATION_WEIGHTED_AVERAGE_TAKEN,
    MUTATION_WEIGHTED_BLENDED_TAKEN,
    MUTATION_COUNT
} MutationId;

typedef struct MutationInfo {
    const char *name; /* as on the command line: lower case, digits and hyphens */
    const char *cause, *cure;
} MutationInfo;

const MutationInfo *mutation_info(MutationId id); /* static */
/* The mutation of that name, or MUTATION_COUNT when there is none. */
MutationId mutation_find(const char *name);

static inline uint64_t mutation_bit(MutationId id)
{
    return UINT64_C(1) << id;
}

/* Whether both change the same choice (a format, the method, the number of passes, ...), so that a
 * program cannot make both mistakes and setting both is setting one of them. */
bool mutation_excludes(MutationId a, MutationId b);

/* Settings that the mutations of desc stand for, as settings: out is desc with those changed and
 * their bits gone. What is left in out->mutations is obeyed inside ref. Of mutations that exclude
 * each other the later in the list counts. */
void mutation_apply(const RenderDesc *desc, RenderDesc *out);

#endif
