#include "study/classes.h"

#include "frame/method.h"

#include <string.h>

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

/* -1: it has not. */
static int find(const StructurePixel *side, uint32_t id)
{
    for (int i = 0; i < side->count; i++)
        if (side->ids[i] == id)
            return i;
    return -1;
}

static bool has(const StructurePixel *side, uint32_t id)
{
    return find(side, id) >= 0;
}

/* Why `actual` has not truth's fragment number `index`; possible: what it can have. */
static PixelClass lost(const RenderDesc *desc, const StructurePixel *truth, int index,
                       const StructurePixel *actual, const StructurePixel *possible)
{
    int at = find(possible, truth->ids[index]);
    if (at < 0)
        return CLASS_COVERAGE;
    /* What is behind the last pass has nothing behind it, in the order that single precision sees,
     * or lies between both ends. */
    bool ends = desc->method == METHOD_DUAL || desc->method == METHOD_FORWARD_DUAL, last = true;
    for (int i = at + 1; i < possible->count; i++)
        last = last && !has(actual, possible->ids[i]);
    if (desc->passes && (last || ends))
        return CLASS_LOST_LIMIT;
    if (desc->method == METHOD_LINKED_LIST)
        return desc->nodes_per_pixel ? CLASS_LOST_OVERFLOW : CLASS_UNEXPLAINED;
    if (desc->bias > 0.0f)
        return CLASS_LOST_BIAS;
    return method_info(desc->method)->loses_ties ? CLASS_LOST_TIE : CLASS_UNEXPLAINED;
}

/* Why `actual` has not the same fragments as truth; CLASS_EQUAL: it has. */
static PixelClass class_of_set(const RenderDesc *desc, const StructurePixel *actual,
                               const StructurePixel *truth, const StructurePixel *possible)
{
    for (int i = 0; i < truth->count; i++)
        if (!has(actual, truth->ids[i]))
            return lost(desc, truth, i, actual, possible);
    for (int i = 0; i < actual->count; i++)
        if (!has(truth, actual->ids[i]))
            return CLASS_COVERAGE;
    return CLASS_EQUAL;
}

PixelClass class_of_fragments(const RenderDesc *desc, StructurePixel *actual,
                              const StructurePixel *truth, const StructurePixel *best,
                              const StructurePixel *stored)
{
    if (actual->opaque != truth->opaque)
        return CLASS_OPAQUE_FLIP;
    int count = structure_drop_repetitions(actual->ids, actual->count);
    bool repeated = count != actual->count;
    actual->count = count;
    PixelClass class = class_of_set(desc, actual, truth, stored);
    /* What desc's depth cannot have, as it is hidden by rounding, single precision may. */
    if (class == CLASS_COVERAGE && class_of_set(desc, actual, truth, best) != CLASS_COVERAGE)
        return CLASS_DEPTH;
    if (class != CLASS_EQUAL)
        return class;
    if (repeated)
        return CLASS_REPEATED;
    return actual->count == truth->count &&
                   memcmp(actual->ids, truth->ids, (size_t)count * sizeof *actual->ids) == 0
               ? CLASS_EQUAL
               : CLASS_INVERSION;
}
