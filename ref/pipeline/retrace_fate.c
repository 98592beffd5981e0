/* The tests that each fragment met, pass by pass, repeated on the depths that were traced. */
#include "ref/pipeline/retrace_fragments.h"

#include "frame/method.h"
#include "ref/pipeline/methods/minmax.h"

/* No fate yet. */
#define UNDECIDED HISTORY_FATES

typedef struct Decide {
    const Pass *pass;
    const PixelTrace *trace;
    History *history;
    bool overflowed;
    bool ended;                     /* the last pass had no layer */
    uint32_t opaque, far;           /* depth codes */
    int number;                     /* of the pass */
    uint32_t previous, previous_id; /* of the layer in front, from the second pass on */
    size_t kept, kept_back;         /* by the pass so far: an index, or NOTHING */
} Decide;

#define NOTHING SIZE_MAX

static FragmentDepth depth_of(const HistoryFragment *fragment)
{
    return (FragmentDepth){(float)fragment->z, fragment->code};
}

static bool is_hidden(const Decide *decide, const HistoryFragment *fragment)
{
    return pass_hidden(decide->pass, depth_of(fragment), decide->opaque);
}

static bool takes_part(const HistoryFragment *fragment, bool transparent)
{
    return retrace_drawn(fragment) && fragment->transparent == transparent;
}

static bool is_peeled(const HistoryFragment *fragment)
{
    return fragment->fate == HISTORY_PEELED;
}

static void peel(HistoryFragment *fragment, int number, bool back)
{
    if (is_peeled(fragment))
        return;
    fragment->fate = HISTORY_PEELED;
    fragment->peel = number;
    fragment->back = back;
}

/* ---- passes with a depth test ---- */

/* Of two that a pass may keep: whether it keeps the new one. */
static bool replaces(const Decide *decide, const HistoryFragment *fragment)
{
    const Pass *pass = decide->pass;
    const HistoryFragment *kept =
        decide->kept == NOTHING ? NULL : &decide->history->fragments[decide->kept];
    bool by_id = fragment->transparent && pass->desc->method == METHOD_PEEL_ID;
    if (by_id && !kept)
        return true;
    if (by_id && fragment->code == kept->code)
        return !pass_id_before(pass, kept->primitive, fragment->primitive);
    return pass_depth_test(pass, fragment->code, kept ? kept->code : decide->far);
}

static HistoryTest test_of(const Decide *decide, const HistoryFragment *fragment)
{
    const Pass *pass = decide->pass;
    if (fragment->transparent && is_hidden(decide, fragment))
        return HISTORY_OPAQUE_DEPTH;
    if (fragment->transparent && decide->number > 0) {
        bool after = pass->desc->method == METHOD_PEEL_ID
                         ? pass_comes_after(pass, fragment->code, fragment->primitive,
                                            decide->previous, decide->previous_id)
                         : !pass_peeled(pass, depth_of(fragment), decide->previous);
        if (!after)
            return HISTORY_PREVIOUS_DEPTH;
    }
    if (!replaces(decide, fragment))
        return HISTORY_DEPTH_TEST;
    return fragment->masked ? HISTORY_ALPHA_TEST : HISTORY_KEPT;
}

static Result put(Decide *decide, size_t fragment, HistoryTest test)
{
    return history_put_test(decide->history, fragment, decide->number, test);
}

/* A new fragment takes the place of *kept, which fails the depth test after all. */
static Result keep(Decide *decide, size_t *kept, size_t fragment)
{
    Result result = *kept == NOTHING ? RESULT_OK : put(decide, *kept, HISTORY_DEPTH_TEST);
    *kept = fragment;
    return result == RESULT_OK ? put(decide, fragment, HISTORY_KEPT) : result;
}

/* Where another renderer's pass left another depth than this one would: its fragment. */
static Result find_traced(Decide *decide, bool transparent, uint32_t traced)
{
    const History *history = decide->history;
    if (decide->kept != NOTHING && history->fragments[decide->kept].code == traced)
        return RESULT_OK;
    size_t found = NOTHING;
    for (size_t i = history->fragment_count; i-- > 0 && traced != decide->far;)
        if (takes_part(&history->fragments[i], transparent) && history->fragments[i].code == traced)
            found = i;
    if (found != NOTHING)
        return keep(decide, &decide->kept, found);
    Result result =
        decide->kept == NOTHING ? RESULT_OK : put(decide, decide->kept, HISTORY_DEPTH_TEST);
    decide->kept = NOTHING;
    return result;
}

/* What a pass over one list makes of each of its fragments. */
static Result run_pass(Decide *decide, bool transparent, uint32_t traced)
{
    History *history = decide->history;
    Result result = RESULT_OK;
    decide->kept = NOTHING;
    for (size_t i = 0; i < history->fragment_count && result == RESULT_OK; i++) {
        const HistoryFragment *fragment = &history->fragments[i];
        if (!takes_part(fragment, transparent))
            continue;
        HistoryTest test = test_of(decide, fragment);
        result = test == HISTORY_KEPT ? keep(decide, &decide->kept, i) : put(decide, i, test);
    }
    return result == RESULT_OK ? find_traced(decide, transparent, traced) : result;
}

static Result run_peels(Decide *decide)
{
    const Pass *pass = decide->pass;
    int limit = render_desc_pass_limit(pass->desc);
    for (decide->number = 0; decide->number < limit; decide->number++) {
        const PixelTrace *trace = decide->trace;
        const PixelValue *depth = pixel_trace_numbered(trace, "peel", decide->number, "depth");
        const PixelValue *id = pixel_trace_numbered(trace, "peel", decide->number, "id");
        Result result = run_pass(decide, true, pixel_trace_bits(depth, decide->far));
        decide->ended = !depth; /* the pass after the last layer finds nothing */
        if (result != RESULT_OK || decide->ended)
            return result;
        if (decide->kept != NOTHING)
            peel(&decide->history->fragments[decide->kept], decide->number, false);
        decide->previous = pixel_trace_bits(depth, 0);
        decide->previous_id = pixel_trace_bits(id, PRIMITIVE_NONE);
    }
    return RESULT_OK;
}

/* ---- dual peeling ---- */

static float distance_of(const Decide *decide, const HistoryFragment *fragment)
{
    return minmax_distance(decide->pass, (float)fragment->z);
}

static Result test_dual(Decide *decide, const float limits[2], size_t index)
{
    const HistoryFragment *fragment = &decide->history->fragments[index];
    bool last = decide->pass->desc->depth_func == DEPTH_LEQUAL;
    if (is_hidden(decide, fragment))
        return put(decide, index, HISTORY_OPAQUE_DEPTH);
    if (fragment->masked)
        return put(decide, index, HISTORY_ALPHA_TEST);
    MinMaxSide side = minmax_side(limits, distance_of(decide, fragment));
    if (side == MINMAX_PEELED || side == MINMAX_BETWEEN)
        return put(decide, index,
                   side == MINMAX_BETWEEN ? HISTORY_BETWEEN : HISTORY_PREVIOUS_DEPTH);
    size_t *kept = side == MINMAX_FRONT ? &decide->kept : &decide->kept_back;
    return *kept == NOTHING || last ? keep(decide, kept, index)
                                    : put(decide, index, HISTORY_DEPTH_TEST);
}

static const PixelValue *limits_of(const Decide *decide, int number)
{
    const char *name = method_info(decide->pass->desc->method)->name;
    return number < 0 ? pixel_trace_find(decide->trace, decide->pass->desc->method == METHOD_DUAL
                                                            ? "dual.first.depth"
                                                            : "forward-dual.first.depth")
                      : pixel_trace_numbered(decide->trace, name, number, "depth");
}

static Result run_dual(Decide *decide)
{
    History *history = decide->history;
    Result result = RESULT_OK;
    for (decide->number = 0; limits_of(decide, decide->number); decide->number++) {
        float limits[2];
        memcpy(limits, limits_of(decide, decide->number - 1)->bytes, sizeof limits);
        decide->kept = decide->kept_back = NOTHING;
        for (size_t i = 0; i < history->fragment_count && result == RESULT_OK; i++)
            if (takes_part(&history->fragments[i], true))
                result = test_dual(decide, limits, i);
        if (result != RESULT_OK)
            return result;
        if (decide->kept != NOTHING)
            peel(&history->fragments[decide->kept], decide->number, false);
        if (decide->kept_back != NOTHING)
            peel(&history->fragments[decide->kept_back], decide->number, true);
    }
    return RESULT_OK;
}

/* ---- methods without passes ---- */

/* Lists are sorted: layer K holds the fragment whose depth and primitive are in its buffers. */
static void find_layer(Decide *decide, HistoryFragment *fragment)
{
    const PixelValue *id;
    for (int k = 0; (id = pixel_trace_numbered(decide->trace, "peel", k, "id")) != NULL; k++) {
        const PixelValue *depth = pixel_trace_numbered(decide->trace, "peel", k, "depth");
        if (pixel_trace_bits(id, PRIMITIVE_NONE) == fragment->primitive &&
            pixel_trace_bits(depth, decide->far) == fragment->code)
            peel(fragment, k, false);
    }
}

static Result run_once(Decide *decide)
{
    History *history = decide->history;
    bool lists = decide->pass->desc->method == METHOD_LINKED_LIST;
    Result result = RESULT_OK;
    decide->number = 0;
    for (size_t i = 0; i < history->fragment_count && result == RESULT_OK; i++) {
        HistoryFragment *fragment = &history->fragments[i];
        if (!takes_part(fragment, true))
            continue;
        bool hidden = is_hidden(decide, fragment);
        result = put(decide, i, hidden ? HISTORY_OPAQUE_DEPTH : HISTORY_KEPT);
        if (!hidden && lists)
            find_layer(decide, fragment);
        else if (!hidden)
            fragment->fate = fragment->surface.base[3] > (double)SHADING_ALPHA_TEST
                                 ? HISTORY_BLENDED
                                 : HISTORY_INVISIBLE;
    }
    return result;
}

/* ---- what was not kept ---- */

static bool at_a_layer(const Decide *decide, const HistoryFragment *fragment, bool dual)
{
    const History *history = decide->history;
    for (size_t i = 0; i < history->fragment_count; i++) {
        const HistoryFragment *other = &history->fragments[i];
        if (is_peeled(other) && (dual ? distance_of(decide, other) == distance_of(decide, fragment)
                                      : other->code == fragment->code))
            return true;
    }
    return false;
}

/* Whether further passes would have come to it. */
static bool remains(const Decide *decide, const HistoryFragment *fragment, bool dual)
{
    const Pass *pass = decide->pass;
    if (dual) {
        float limits[2];
        memcpy(limits, limits_of(decide, decide->number - 1)->bytes, sizeof limits);
        return minmax_side(limits, distance_of(decide, fragment)) != MINMAX_PEELED;
    }
    if (decide->ended)
        return false;
    if (pass->desc->method == METHOD_PEEL_ID)
        return pass_comes_after(pass, fragment->code, fragment->primitive, decide->previous,
                                decide->previous_id);
    return pass_remains(pass, depth_of(fragment), decide->previous);
}

static HistoryFate fate_of(const Decide *decide, const HistoryFragment *fragment)
{
    MethodId method = decide->pass->desc->method;
    bool dual = method == METHOD_DUAL || method == METHOD_FORWARD_DUAL;
    if (is_hidden(decide, fragment))
        return HISTORY_HIDDEN;
    if (fragment->masked)
        return HISTORY_MASKED;
    if (method == METHOD_LINKED_LIST)
        return decide->overflowed ? HISTORY_OVERFLOW : HISTORY_PASS_LIMIT;
    if (remains(decide, fragment, dual))
        return HISTORY_PASS_LIMIT;
    return at_a_layer(decide, fragment, dual) ? HISTORY_TIE : HISTORY_SKIPPED;
}

static void decide_rest(Decide *decide)
{
    for (size_t i = 0; i < decide->history->fragment_count; i++) {
        HistoryFragment *fragment = &decide->history->fragments[i];
        if (takes_part(fragment, true) && fragment->fate == UNDECIDED)
            fragment->fate = fate_of(decide, fragment);
    }
}

static Result decide_opaque(Decide *decide)
{
    History *history = decide->history;
    decide->number = 0;
    Result result = run_pass(decide, false, decide->opaque);
    for (size_t i = 0; i < history->fragment_count; i++) {
        HistoryFragment *fragment = &history->fragments[i];
        if (takes_part(fragment, false))
            fragment->fate = i == decide->kept                  ? HISTORY_SEEN
                             : fragment->masked                 ? HISTORY_MASKED
                             : fragment->code == decide->opaque ? HISTORY_TIE
                                                                : HISTORY_HIDDEN;
    }
    return result;
}

Result retrace_decide(const Pass *pass, const PixelTrace *trace, bool overflowed, History *out)
{
    Decide decide = {.pass = pass, .trace = trace, .history = out, .overflowed = overflowed};
    decide.far = depth_key_far(pass->depth_format, pass->desc->depth_range);
    decide.opaque = pixel_trace_bits(pixel_trace_find(trace, "opaque.depth"), decide.far);
    for (size_t i = 0; i < out->fragment_count; i++)
        if (takes_part(&out->fragments[i], true))
            out->fragments[i].fate = UNDECIDED;
    Result result = decide_opaque(&decide);
    if (result != RESULT_OK)
        return result;
    switch (pass->desc->method) {
    case METHOD_PEEL:
    case METHOD_FORWARD:
    case METHOD_PEEL_ID:
        result = run_peels(&decide);
        break;
    case METHOD_DUAL:
    case METHOD_FORWARD_DUAL:
        result = run_dual(&decide);
        break;
    default:
        result = run_once(&decide);
    }
    if (result == RESULT_OK)
        decide_rest(&decide);
    return result;
}
