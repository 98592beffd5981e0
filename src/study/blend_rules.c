/* Sources. Where a specification was not to be had, what its words were read in is in brackets.
 * OpenGL 4.6 core: 2.3.4, results accurate to about 1 part in 10^5, infinities and NaN permitted
 * but not required [4.2 compatibility profile, 2.1.1]; 2.3.5.2, a float becomes one of the two
 * closest codes, the nearest preferred [OpenGL ES 3.0.3, 2.1.6]; 17.3.6, computed as if in floating
 * point, with precision and dynamic range no lower than that of the destination's components
 * [OpenGL ES 3.2, reference page of glBlendFunc]. Vulkan 1.3: chapter "The Framebuffer", Blending:
 * the same words as OpenGL's. To store is taken to be as in OpenGL. Direct3D 11: "Floating-point
 * rules": float addition, subtraction and multiplication within 0.5 ULP, denormals flushed, NaN and
 * anything is NaN (but for minimum and maximum). (It also allows to truncate, which it says is 0.5
 * ULP; it is 1, and the number is what counts here.) "Data conversion rules": toward zero from
 * float to half; D3D11_FLOAT32_TO_INTEGER_TOLERANCE_IN_ULP, 0.6, from float to UNORM;
 * D3D10_1_FLOAT16_FUSED_TOLERANCE_IN_ULP, 0.6. That blending keeps these rules, in at least the
 * target's precision, is section 17.5 of the 11.3 functional specification, whose text we have not;
 * its sections 3.1 and 3.2 are the two pages above. WebGPU conformance tests:
 * api/operation/rendering/color_target_state.spec.ts (rgba16float, an absolute 0.003). The WebGPU
 * specification has no number. dEQP, in VK-GL-CTS: vktPipelineBlendTests.cpp (4 codes, 0.005 for
 * halves, 1e-5 for floats); es3fBlendTests.cpp (4 codes of RGBA8: 1 · 5 / 2 + 2 in integers).
 * piglit: tests/general/blendminmax and gl-1.0-blend-func, piglit_set_tolerance_for_bits
 * (3 / 2^bits, bits at most 8). */
#include "study/blend_rules.h"

#include <float.h>
#include <math.h>
#include <string.h>

typedef enum StepUnit {
    UNIT_FORMAT,  /* ULP of the format (codes) */
    UNIT_FLOAT,   /* ULP of single precision */
    UNIT_RELATIVE /* of the value */
} StepUnit;

/* One way to compute that a rule allows: what each step may be off by. */
typedef struct Way {
    StepUnit unit;
    double source; /* the source stored before it is blended: ULP of the format */
    double step;   /* 1 − x, product, sum: units */
    double store;  /* the result stored: ULP of the format */
} Way;

typedef enum RuleId {
    RULE_GL_ABOUT,
    RULE_GL_DESTINATION,
    RULE_VULKAN,
    RULE_D3D11,
    RULE_D3D11_NAN,
    RULE_WEBGPU_TESTS,
    RULE_DEQP_VULKAN,
    RULE_DEQP_GLES,
    RULE_PIGLIT
} RuleId;

static const BlendRuleInfo infos[BLEND_RULES] = {
    [RULE_GL_ABOUT] = {"OpenGL", "4.6 core, 2.3.4", "1 part in 10^5 a step", API_GL},
    [RULE_GL_DESTINATION] = {"OpenGL", "4.6 core, 17.3.6 and 2.3.5.2",
                             "1 ULP (code) a step, 1 to store", API_GL},
    [RULE_VULKAN] = {"Vulkan", "1.3, Framebuffer: Blending", "1 ULP (code) a step, 1 to store",
                     API_VULKAN},
    [RULE_D3D11] = {"Direct3D", "11.3, 17.5, 3.1 and 3.2", "0.5 ULP a step (half, unorm 0.6)",
                    API_D3D11},
    [RULE_D3D11_NAN] = {"Direct3D", "11.3, 17.5: NaN propagates", "none lost", API_D3D11},
    [RULE_WEBGPU_TESTS] = {"WebGPU tests", "color_target_state.spec.ts", "0.003", API_SUITE},
    [RULE_DEQP_VULKAN] = {"dEQP, Vulkan", "vktPipelineBlendTests.cpp",
                          "4 codes; half 0.005; float 1e-5", API_SUITE},
    [RULE_DEQP_GLES] = {"dEQP, GLES 3", "es3fBlendTests.cpp", "4 codes", API_SUITE},
    [RULE_PIGLIT] = {"piglit", "gl-1.0-blend-func", "3 / 256", API_SUITE},
};

const char *blend_api_name(BlendApi api)
{
    static const char *const names[] = {"gl", "vulkan", "d3d11", "suite"};
    return names[api];
}

static bool applies(RuleId id, PixelFormat format)
{
    FormatKind kind = format_info(format)->kind;
    switch (id) {
    case RULE_GL_ABOUT:
    case RULE_D3D11_NAN:
        return kind != KIND_UNORM;
    case RULE_WEBGPU_TESTS:
        return format == FORMAT_RGBA16F;
    case RULE_DEQP_GLES:
        return format == FORMAT_RGBA8;
    default:
        return true;
    }
}

void blend_rules_start(PixelFormat format, BlendRuleTally *out)
{
    for (int i = 0; i < BLEND_RULES; i++)
        out[i] = (BlendRuleTally){.info = &infos[i], .applies = applies((RuleId)i, format)};
}

/* ---- the exact result, and how far a way may be off ------------------------------------------ */

/* The unit in the last place of x, and that of the denormals at 0. */
static double exponent_unit(double x, int bits, int least)
{
    int exponent;
    frexp(x, &exponent); /* |x| in [2^(exponent − 1), 2^exponent) */
    if (x == 0.0)
        return ldexp(1.0, least);
    exponent -= bits;
    return ldexp(1.0, exponent > least ? exponent : least);
}

static double format_unit(PixelFormat format, double x)
{
    const FormatInfo *info = format_info(format);
    if (info->unorm_max)
        return 1.0 / info->unorm_max;
    return info->kind == KIND_HALF ? exponent_unit(x, 11, -24) : exponent_unit(x, 24, -149);
}

static double step_error(PixelFormat format, const Way *way, double x)
{
    if (way->unit == UNIT_RELATIVE)
        return way->step * x;
    return way->step *
           (way->unit == UNIT_FLOAT ? exponent_unit(x, 24, -149) : format_unit(format, x));
}

typedef struct Term {
    double value;  /* of the operand */
    double error;  /* what it may be off by */
    bool constant; /* a factor of 0 or 1: nothing is rounded */
} Term;

/* What a source, clamped to what the format holds, is as an operand. */
static Term source_term(const BlendCase *one, const Way *way, int channel)
{
    Term term = {one->source[channel], 0.0, false};
    const FormatInfo *info = format_info(one->format);
    if (info->unorm_max)
        term.value = fmin(fmax(term.value, 0.0), 1.0);
    double scaled = info->unorm_max ? term.value * info->unorm_max : 0.0;
    bool code = info->unorm_max && fabs(scaled - nearbyint(scaled)) < 1e-7 * info->unorm_max;
    if (code)
        term.value = nearbyint(scaled) / info->unorm_max;
    else if (way)
        term.error = way->source * format_unit(one->format, fabs(term.value));
    return term;
}

static Term inverted(const BlendCase *one, const Way *way, Term x)
{
    x.value = 1.0 - x.value;
    bool exact = !way || (way->unit == UNIT_FORMAT && format_info(one->format)->unorm_max);
    x.error += exact ? 0.0 : step_error(one->format, way, fabs(x.value) + x.error);
    return x;
}

static Term factor_term(const BlendCase *one, const Way *way, BlendFactor factor)
{
    int c = one->channel;
    Term source_alpha = source_term(one, way, 3);
    Term destination_alpha = {blend_case_destination(one, 3), 0.0, false};
    switch (factor) {
    case FACTOR_ZERO:
        return (Term){0.0, 0.0, true};
    case FACTOR_ONE:
        return (Term){1.0, 0.0, true};
    case FACTOR_SRC_COLOR:
        return source_term(one, way, c);
    case FACTOR_ONE_MINUS_SRC_COLOR:
        return inverted(one, way, source_term(one, way, c));
    case FACTOR_DST_COLOR:
        return (Term){blend_case_destination(one, c), 0.0, false};
    case FACTOR_ONE_MINUS_DST_COLOR:
        return inverted(one, way, (Term){blend_case_destination(one, c), 0.0, false});
    case FACTOR_SRC_ALPHA:
        return source_alpha;
    case FACTOR_ONE_MINUS_SRC_ALPHA:
        return inverted(one, way, source_alpha);
    case FACTOR_DST_ALPHA:
        return destination_alpha;
    case FACTOR_ONE_MINUS_DST_ALPHA:
        return inverted(one, way, destination_alpha);
    default:
        break;
    }
    if (c == 3)
        return (Term){1.0, 0.0, true};
    Term room = inverted(one, way, destination_alpha);
    double error = fmax(source_alpha.error, room.error);
    return (Term){fmin(source_alpha.value, room.value), error, false};
}

static Term product_term(const BlendCase *one, const Way *way, Term x, Term factor)
{
    Term product = {x.value * factor.value, 0.0, factor.constant && factor.value == 0.0};
    product.error =
        fabs(x.value) * factor.error + fabs(factor.value) * x.error + x.error * factor.error;
    if (way && !factor.constant)
        product.error += step_error(one->format, way, fabs(product.value) + product.error);
    return product;
}

/* Magnitudes of operands, intermediates and the result that are not 0. */
typedef struct Extent {
    double smallest, largest;
} Extent;

static void extend(Extent *extent, double x)
{
    if (x != 0.0)
        extent->smallest = fmin(extent->smallest, fabs(x));
    extent->largest = fmax(extent->largest, fabs(x));
}

/* The exact value, clamped to what the format holds, and how far a computed one may be from it.
 * way NULL: the value alone. */
static Term result_term(const BlendCase *one, const Way *way, Extent *extent)
{
    const FormatInfo *info = format_info(one->format);
    BlendTerms terms = blend_case_terms(one);
    Term s = source_term(one, way, one->channel);
    Term d = {blend_case_destination(one, one->channel), 0.0, false}, result = s;
    *extent = (Extent){INFINITY, 0.0};
    if (terms.func == BLEND_FUNC_MIN || terms.func == BLEND_FUNC_MAX) {
        bool low = terms.func == BLEND_FUNC_MIN;
        result.value = low ? fmin(s.value, d.value) : fmax(s.value, d.value);
    } else {
        Term first = factor_term(one, way, terms.source);
        Term second = factor_term(one, way, terms.destination);
        Term left = product_term(one, way, s, first), right = product_term(one, way, d, second);
        const double parts[] = {s.value,      d.value,    first.value,
                                second.value, left.value, right.value};
        for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
            extend(extent, parts[i]);
        result.value = terms.func == BLEND_FUNC_SUBTRACT           ? left.value - right.value
                       : terms.func == BLEND_FUNC_REVERSE_SUBTRACT ? right.value - left.value
                                                                   : left.value + right.value;
        result.error = left.error + right.error;
        bool codes = way && way->unit == UNIT_FORMAT && info->unorm_max;
        if (way && !left.constant && !right.constant && !codes)
            result.error += step_error(one->format, way, fabs(result.value) + result.error);
    }
    if (info->unorm_max)
        result.value = fmin(fmax(result.value, 0.0), 1.0);
    extend(extent, result.value);
    if (way)
        result.error += way->store * format_unit(one->format, fabs(result.value) + result.error);
    return result;
}

/* The ways of the rule; how many. */
static int rule_ways(RuleId id, const FormatInfo *info, Way out[2])
{
    bool whole = info->kind == KIND_FLOAT;
    switch (id) {
    case RULE_GL_ABOUT:
        out[0] = (Way){UNIT_RELATIVE, whole ? 0.0 : 1.0, 1e-5, whole ? 0.0 : 1.0};
        return 1;
    case RULE_GL_DESTINATION:
    case RULE_VULKAN:
        out[0] = (Way){UNIT_FORMAT, whole ? 0.0 : 1.0, 1.0, 0.0};
        out[1] = (Way){UNIT_FLOAT, 0.0, 1.0, whole ? 0.0 : 1.0};
        return 2;
    default:
        break;
    }
    if (whole) {
        out[0] = (Way){UNIT_FLOAT, 0.0, 0.5, 0.0};
        return 1;
    }
    bool half = info->kind == KIND_HALF;
    out[0] = (Way){UNIT_FORMAT, half ? 1.0 : 0.6, 0.6, 0.0};
    out[1] = (Way){UNIT_FLOAT, half ? 1.0 : 0.0, 0.5, half ? 1.0 : 0.6};
    return 2;
}

/* Double's own roundings, and the float that stands for a code, are on the value's side. */
static double with_slack(const BlendCase *one, double bound)
{
    double size = 0.0;
    for (int i = 0; i < 4; i++)
        size = fmax(size, fmax(fabs((double)one->source[i]), fabs(blend_case_destination(one, i))));
    return bound * (1.0 + 0x1p-40) + (size + size * size) * 0x1p-50;
}

static double allowed_error(RuleId id, const BlendCase *one)
{
    const FormatInfo *info = format_info(one->format);
    switch (id) {
    case RULE_WEBGPU_TESTS:
        return 0.003;
    case RULE_DEQP_VULKAN:
        return info->unorm_max ? 4.0 / info->unorm_max : info->kind == KIND_HALF ? 0.005 : 1e-5;
    case RULE_DEQP_GLES:
        return 4.0 / 255.0;
    case RULE_PIGLIT:
        return 3.0 / 256.0;
    default:
        break;
    }
    Way ways[2];
    Extent extent;
    double bound = 0.0;
    int count = rule_ways(id, info, ways);
    for (int i = 0; i < count; i++)
        bound = fmax(bound, result_term(one, &ways[i], &extent).error);
    return bound;
}

/* ---- judging --------------------------------------------------------------------------------- */

typedef struct Seen {
    double exact, value, error; /* error: INFINITY where value is not a finite number */
    double ulp;                 /* error in units of the format at the exact result */
    double scaled;              /* and at the greatest of operands, products and result */
    Extent extent;
    bool finite, in_unit; /* the operands */
} Seen;

static bool is_unit(double x)
{
    return x >= 0.0 && x <= 1.0;
}

static Seen look(const BlendCase *one, uint32_t got)
{
    BlendOperands used = blend_case_operands(one);
    double s = one->source[one->channel], d = blend_case_destination(one, one->channel);
    double sa = used.source_alpha ? one->source[3] : 0.0;
    double da = used.destination_alpha ? blend_case_destination(one, 3) : 0.0;
    Seen seen = {.value = blend_case_value(one->format, got),
                 .finite = isfinite(s) && isfinite(d) && isfinite(sa) && isfinite(da),
                 .in_unit = is_unit(s) && is_unit(d) && is_unit(sa) && is_unit(da)};
    if (!seen.finite)
        return seen;
    seen.exact = result_term(one, NULL, &seen.extent).value;
    seen.error = isfinite(seen.value) ? fabs(seen.value - seen.exact) : INFINITY;
    seen.ulp = seen.error / format_unit(one->format, fabs(seen.exact));
    seen.scaled = seen.error / format_unit(one->format, seen.extent.largest);
    return seen;
}

static bool has_nan(const BlendCase *one)
{
    BlendOperands used = blend_case_operands(one);
    double d = blend_case_destination(one, one->channel);
    return isnan(one->source[one->channel]) || isnan(d) ||
           (used.source_alpha && isnan(one->source[3])) ||
           (used.destination_alpha && isnan(blend_case_destination(one, 3)));
}

/* Whether the rule says nothing of it. */
static bool is_unstated(RuleId id, const BlendCase *one, const Seen *seen)
{
    FormatKind kind = format_info(one->format)->kind;
    if (!seen->finite)
        return true;
    if (infos[id].api == API_SUITE)
        return !seen->in_unit; /* as their operands are */
    if (kind == KIND_UNORM)
        return false;
    if (seen->extent.smallest < 0x1p-126 ||
        (kind == KIND_HALF && id != RULE_D3D11 && seen->extent.smallest < 0x1p-14))
        return true;
    /* An intermediate that the format cannot hold, or a result that rounding may take there. */
    return seen->extent.largest * (1.0 + 0x1p-9) >= (kind == KIND_HALF ? 65504.0 : (double)FLT_MAX);
}

static void keep_example(BlendRuleTally *tally, const BlendCase *one, BlendPlace place,
                         const Seen *seen, uint32_t got)
{
    tally->has_example = true;
    tally->example_error = seen->scaled;
    tally->channel = one->channel;
    tally->set = place.set;
    tally->index = place.index;
    tally->exact = seen->exact;
    memcpy(tally->source, one->source, sizeof tally->source);
    memcpy(tally->pixel, one->pixel, format_pixel_bytes(one->format));
    tally->got = got;
}

static void judge_nan(BlendRuleTally *tally, const BlendCase *one, BlendPlace place, uint32_t got)
{
    BlendFunc func = blend_case_terms(one).func;
    if (func == BLEND_FUNC_MIN || func == BLEND_FUNC_MAX || !has_nan(one)) {
        tally->unstated++;
        return;
    }
    tally->judged++;
    if (isnan(blend_case_value(one->format, got)))
        return;
    Seen seen = {.exact = NAN};
    if (tally->outside++ == 0)
        keep_example(tally, one, place, &seen, got);
}

static void judge(RuleId id, BlendRuleTally *tally, const BlendCase *one, BlendPlace place,
                  const Seen *seen, uint32_t got)
{
    if (is_unstated(id, one, seen)) {
        tally->unstated++;
        return;
    }
    tally->judged++;
    /* Half a unit is within every rule: where nothing is rounded, the error is 0 or a whole one. */
    bool suite = infos[id].api == API_SUITE;
    bool outside =
        (suite || seen->ulp > 0.5) && seen->error > with_slack(one, allowed_error(id, one));
    bool first = outside && tally->outside == 0;
    tally->outside += outside;
    if (first || (outside == (tally->outside > 0) && seen->scaled > tally->example_error))
        keep_example(tally, one, place, seen, got);
    tally->largest = fmax(tally->largest, seen->scaled);
    tally->largest_real = fmax(tally->largest_real, seen->error);
}

void blend_rules_add(const BlendCase *one, BlendPlace place, uint32_t got, BlendRuleTally *tallies)
{
    Seen seen = look(one, got);
    for (int i = 0; i < BLEND_RULES; i++) {
        if (!tallies[i].applies)
            continue;
        if (i == RULE_D3D11_NAN)
            judge_nan(&tallies[i], one, place, got);
        else
            judge((RuleId)i, &tallies[i], one, place, &seen, got);
    }
}

void blend_rules_merge(BlendRuleTally *tallies, const BlendRuleTally *later)
{
    for (int i = 0; i < BLEND_RULES; i++) {
        BlendRuleTally merged = tallies[i];
        bool farther = later[i].outside
                           ? !merged.outside || later[i].example_error > merged.example_error
                           : !merged.outside && later[i].example_error > merged.example_error;
        if (later[i].has_example && (!merged.has_example || farther))
            merged = later[i];
        merged.judged = tallies[i].judged + later[i].judged;
        merged.unstated = tallies[i].unstated + later[i].unstated;
        merged.outside = tallies[i].outside + later[i].outside;
        merged.largest = fmax(tallies[i].largest, later[i].largest);
        merged.largest_real = fmax(tallies[i].largest_real, later[i].largest_real);
        tallies[i] = merged;
    }
}

bool blend_rules_broken(const BlendRuleTally *tallies, BlendApi api)
{
    bool broken[API_COUNT] = {false};
    for (int i = 0; i < BLEND_RULES; i++)
        broken[tallies[i].info->api] |= tallies[i].applies && tallies[i].outside > 0;
    return api == API_COUNT ? broken[API_GL] && broken[API_VULKAN] && broken[API_D3D11]
                            : broken[api];
}
