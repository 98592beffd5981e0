#include "study/classes.h"

#include "frame/method.h"

static const struct {
    const char *key, *text;
} classes[CLASS_COUNT] = {
    [CLASS_EQUAL] = {"equal", "the same bits"},
    [CLASS_OPAQUE_FLIP] = {"opaque_flip", "another opaque triangle"},
    [CLASS_COVERAGE] = {"coverage", "a fragment that only one side has"},
    [CLASS_LOST_TIE] = {"lost_tie", "a layer lost to equal depths"},
    [CLASS_LOST_LIMIT] = {"lost_pass_limit", "a layer behind the last pass"},
    [CLASS_LOST_BIAS] = {"lost_bias", "a layer that the bias passed over"},
    [CLASS_LOST_OVERFLOW] = {"lost_overflow", "a layer for which a list had no room"},
    [CLASS_REPEATED] = {"repeated", "a layer peeled twice"},
    [CLASS_INVERSION] = {"inversion", "layers in another order"},
    [CLASS_METHOD] = {"method", "the method's approximation"},
    [CLASS_DEPTH] = {"depth", "quantisation of depth"},
    [CLASS_GBUFFER] = {"gbuffer", "quantisation of the G-buffer"},
    [CLASS_ACCUM] = {"accum", "quantisation of the accumulation, clamping"},
    [CLASS_ROUNDING] = {"rounding", "arithmetic rounding"},
    [CLASS_UNEXPLAINED] = {"unexplained", "none of these"},
};

const char *class_key(PixelClass class)
{
    return classes[class].key;
}

const char *class_text(PixelClass class)
{
    return classes[class].text;
}

static bool has(const StructurePixel *side, uint32_t id)
{
    return structure_find(side->ids, side->count, id) >= 0;
}

/* Whether another fragment has the same depth as fragment `at`: by the raw test also the next one,
 * which a fetch may round to the same float. */
static bool is_tied(const RenderDesc *desc, const StructurePixel *side, int at)
{
    uint32_t depth = side->depths[at], most = desc->peel_test == PEEL_TEST_RAW ? 1 : 0;
    for (int i = 0; i < side->count; i++) {
        uint32_t other = side->depths[i];
        if (i != at && (other > depth ? other - depth : depth - other) <= most)
            return true;
    }
    return false;
}

/* Why `actual` has not truth's fragment number `index`; possible: what it can have; repeated: it
 * had a layer twice. */
static PixelClass lost(const RenderDesc *desc, const StructurePixel *truth, int index,
                       const StructurePixel *actual, bool repeated, const StructurePixel *possible)
{
    int at = structure_find(possible->ids, possible->count, truth->ids[index]);
    if (at < 0)
        return CLASS_COVERAGE;
    /* What is behind the last pass has nothing behind it, in the order that single precision sees,
     * or lies between both ends. A triangle that is there twice may have been seen in front. */
    bool ends = desc->method == METHOD_DUAL || desc->method == METHOD_FORWARD_DUAL, last = true;
    for (int i = at + 1; i < possible->count; i++)
        last = last && (structure_find(possible->ids, at, possible->ids[i]) >= 0 ||
                        !has(actual, possible->ids[i]));
    if (repeated && last)
        return CLASS_REPEATED;
    if (desc->passes && (last || ends))
        return CLASS_LOST_LIMIT;
    if (desc->method == METHOD_LINKED_LIST)
        return desc->nodes_per_pixel ? CLASS_LOST_OVERFLOW : CLASS_UNEXPLAINED;
    if (desc->bias > 0.0f)
        return CLASS_LOST_BIAS;
    if (method_info(desc->method)->loses_ties && is_tied(desc, possible, at))
        return CLASS_LOST_TIE;
    /* Passes end with one that yields nothing new, which is no layer any more. */
    return desc->peel_test == PEEL_TEST_RAW && last ? CLASS_REPEATED : CLASS_UNEXPLAINED;
}

/* The first fragment of `whole` that `side` has not; −1: it has all. */
static int first_missing(const StructurePixel *side, const StructurePixel *whole)
{
    for (int i = 0; i < whole->count; i++)
        if (!has(side, whole->ids[i]))
            return i;
    return -1;
}

PixelClass class_of_fragments(const RenderDesc *desc, StructurePixel *actual,
                              const StructurePixel *truth, const StructurePixel *best,
                              const StructurePixel *stored)
{
    if (actual->opaque != truth->opaque)
        return CLASS_OPAQUE_FLIP;
    /* What the raw test takes again it takes for ever. */
    bool repeated = desc->peel_test == PEEL_TEST_RAW && actual->count > 1 &&
                    actual->ids[actual->count - 1] == actual->ids[actual->count - 2];
    int count = structure_drop_repetitions(actual->ids, actual->count);
    bool twice = count != actual->count;
    actual->count = count;
    int missing = first_missing(actual, truth);
    if (missing >= 0) {
        PixelClass class = lost(desc, truth, missing, actual, repeated, stored);
        /* What desc's depth cannot have, as it is hidden by rounding, single precision may. */
        return class == CLASS_COVERAGE && has(best, truth->ids[missing]) ? CLASS_DEPTH : class;
    }
    if (first_missing(truth, actual) >= 0)
        return CLASS_COVERAGE;
    /* By stored depths it is two pieces of a clipped triangle that rounding has folded. */
    if (twice)
        return repeated ? CLASS_REPEATED : CLASS_COVERAGE;
    return structure_same(actual, truth) ? CLASS_EQUAL : CLASS_INVERSION;
}
