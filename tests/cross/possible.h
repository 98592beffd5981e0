/* Whether ref, and truth, can have seen a pixel as they did, where they see it otherwise: by what
 * exact arithmetic, and single precision and the format of depth, may make of each triangle there
 * (ref/truth/bound.h), which is derived, not measured. Link possible.c. */
#ifndef PEEL_TESTS_POSSIBLE_H
#define PEEL_TESTS_POSSIBLE_H

#include "compare/structure.h"
#include "frame/render_desc.h"
#include "scene/scene.h"

typedef struct Possible Possible;

/* scene and desc must outlive it. Fails as truth does; the caller destroys what it was given, or
 * NULL. */
Result possible_create(const Scene *scene, const RenderDesc *desc, Possible **out);
void possible_destroy(Possible *possible);

/* NULL, or what cannot be of a pixel's fragments and its opaque triangle: that it has one of them,
 * or has them in that order. pixel: row · width + column; desc: whose format of depth they are
 * stored in, NULL for truth. Static. */
const char *possible_fragments(const Possible *possible, const RenderDesc *desc, size_t pixel,
                               const StructurePixel *side);

/* The same: that it has a fragment twice, which two pieces of one triangle may be where rounding
 * folds what clipping leaves. */
const char *possible_repetitions(const Possible *possible, const RenderDesc *desc, size_t pixel,
                                 const StructurePixel *side);

/* Both of a side that loses nothing, and that it has not what another has there. */
const char *possible_all(const Possible *possible, const RenderDesc *desc, size_t pixel,
                         const StructurePixel *side, const StructurePixel *other);

/* Whether a peel can have passed over fragment `id` for another of side's, by desc's bias, too. */
bool possible_tie(const Possible *possible, const RenderDesc *desc, size_t pixel,
                  const StructurePixel *side, uint32_t id);

#endif
