#include "frame/mutation.h"

#include <string.h>

static const MutationInfo mutations[MUTATION_COUNT] = {
    [MUTATION_NOT_PREMULTIPLIED] = {"not-premultiplied",
                                    "the source colour of a layer is not multiplied by its alpha, "
                                    "and blended by factors that "
                                    "take it for premultiplied",
                                    "write (colour·alpha, alpha) in the lighting shader"},
    [MUTATION_PREMULTIPLIED_TWICE] =
        {"premultiplied-twice",
         "the source colour is multiplied by alpha in the shader and once more, by a blend factor "
         "of SRC_ALPHA or by a second multiplication",
         "multiply once, in the shader, and blend colours by (DST_ALPHA, ONE)"},
    [MUTATION_BLEND_FACTORS_SWAPPED] =
        {"blend-factors-swapped",
         "source and destination factors have changed places: colours by (ONE, DST_ALPHA), alpha "
         "by (ONE_MINUS_SRC_ALPHA, ZERO)",
         "glBlendFuncSeparate(GL_DST_ALPHA, GL_ONE, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA)"},
    [MUTATION_OVER_FRONT_TO_BACK] =
        {"over-front-to-back",
         "layers come front to back and are blended by \"over\", (ONE, ONE_MINUS_SRC_ALPHA), so "
         "that each covers those in front of it, and the opaque surfaces cover all",
         "blend under: colours by (DST_ALPHA, ONE), alpha by (ZERO, ONE_MINUS_SRC_ALPHA)"},
    [MUTATION_DESTINATION_ALPHA_ZERO] =
        {"destination-alpha-zero",
         "the accumulation is cleared to alpha 0: no transmittance, so that nothing is added to "
         "it",
         "clear the accumulation to (0, 0, 0, 1) before the first peel"},
    [MUTATION_ACCUMULATION_CLEARED] =
        {"accumulation-cleared",
         "the accumulation is cleared at every peel's lighting pass: of the peels the last alone "
         "is left",
         "clear the accumulation once a frame; load it in every lighting pass after"},
    [MUTATION_LAYERS_REVERSED] =
        {"layers-reversed",
         "the layers are blended in reversed order, far to near, by factors for near to far; the "
         "opaque surfaces still come last",
         "peel from the near side, or blend over when layers come far to near"},
    [MUTATION_DUAL_MIDDLE_TWICE] =
        {"dual-middle-twice",
         "dual peeling of an odd number of layers takes the middle one, which is at both fronts, "
         "from both sides and blends it twice",
         "count a fragment at both fronts as the front's alone"},
    [MUTATION_TRANSMITTANCE_AS_COVERAGE] =
        {"transmittance-as-coverage",
         "the accumulation's alpha, a transmittance, is composited as coverage by (ONE, "
         "ONE_MINUS_SRC_ALPHA): the background has the weight 1 − T in place of T",
         "add background·T, or write 1 − T to alpha before compositing"},
    [MUTATION_BACKGROUND_WEIGHTED_WRONGLY] =
        {"background-weighted-wrongly",
         "the background is in the accumulation from the start, or added by (ONE, ONE): it counts "
         "in full under whatever covers it",
         "add the background last, times the transmittance"},
    [MUTATION_BACKGROUND_FORGOTTEN] =
        {"background-forgotten", "the background is not added: black shows through the layers",
         "add background·T to the accumulated colour at the end"},
    [MUTATION_RESOLVED_AS_STRAIGHT] =
        {"resolved-as-straight",
         "the accumulated colour, which is premultiplied, is composited by (SRC_ALPHA, "
         "ONE_MINUS_SRC_ALPHA) and so multiplied by its coverage again",
         "composite it by (ONE, ONE_MINUS_SRC_ALPHA), with alpha 1 − T"},
    [MUTATION_OPAQUE_BLENDED_FIRST] =
        {"opaque-blended-first",
         "the opaque surfaces are lit and blended under before the peels, which then find no "
         "transmittance left",
         "light and blend the opaque surfaces after the last peel"},
    [MUTATION_OPAQUE_DEPTH_IGNORED] =
        {"opaque-depth-ignored",
         "transparent fragments are not compared with the opaque depth: layers behind opaque "
         "surfaces are blended in front of them",
         "discard transparent fragments whose depth is at or behind the opaque depth"},
    [MUTATION_OPAQUE_TEST_STRICT] = {"opaque-test-strict",
                                     "transparent fragments are discarded where depth > opaque "
                                     "depth, not >=: those at exactly "
                                     "the opaque depth are blended",
                                     "discard where depth >= opaque depth"},
    [MUTATION_PEEL_TEST_STRICT] = {"peel-test-strict",
                                   "fragments are discarded where depth < previous depth, not <=: "
                                   "every peel takes the first "
                                   "layer again",
                                   "discard where depth <= previous depth"},
    [MUTATION_PEEL_BIAS_1E_4] =
        {"peel-bias-1e-4",
         "the previous depth has 1e-4 added before the comparison: layers closer than that are "
         "lost",
         "compare stored depths exactly; no bias is needed"},
    [MUTATION_PEEL_BIAS_1E_3] =
        {"peel-bias-1e-3",
         "the previous depth has 1e-3 added before the comparison: layers closer than that are "
         "lost",
         "compare stored depths exactly; no bias is needed"},
    [MUTATION_PREVIOUS_DEPTH_STALE] =
        {"previous-depth-stale",
         "the first peel is compared with the depth that the frame before left, that of its last "
         "layer: layers in front of it are lost",
         "skip the comparison in the first peel, or clear the previous depth to the near end"},
    [MUTATION_DEPTH_NOT_SWAPPED] =
        {"depth-not-swapped",
         "the two depth buffers do not change places after the second peel: all further ones are "
         "compared with the first layer and take the second again",
         "swap the depth attachment and the previous depth after every peel"},
    [MUTATION_ONE_DEPTH_BUFFER] =
        {"one-depth-buffer",
         "previous depth and depth attachment are one buffer: cleared for a peel it discards "
         "everything, and only the first layer is left",
         "use two depth buffers in turn"},
    [MUTATION_PEEL_DEPTH_NOT_CLEARED] =
        {"peel-depth-not-cleared",
         "a peel's depth buffer is not cleared and still holds the layer of two peels before, "
         "which hides all that is behind it: two layers are left",
         "clear the depth attachment to the far end before every peel"},
    [MUTATION_PASSES_SHORT] =
        {"passes-short", "one peel too few: the farthest layer of the deepest pixels is missing",
         "peel until a peel yields no fragment, or count the loop's passes again"},
    [MUTATION_PASSES_4] = {"passes-4", "always 4 peels: layers behind the fourth are missing",
                           "peel until a peel yields no fragment, or raise the limit"},
    [MUTATION_PASSES_6] = {"passes-6", "always 6 peels: layers behind the sixth are missing",
                           "peel until a peel yields no fragment, or raise the limit"},
    [MUTATION_PASSES_8] = {"passes-8", "always 8 peels: layers behind the eighth are missing",
                           "peel until a peel yields no fragment, or raise the limit"},
    [MUTATION_DEPTH_FETCH_HALF_PIXEL] = {"depth-fetch-half-pixel",
                                         "half a pixel is added to gl_FragCoord, which is a "
                                         "pixel's centre already, and depths are "
                                         "fetched from the next column and row",
                                         "texelFetch(depth, ivec2(gl_FragCoord.xy), 0)"},
    [MUTATION_DEPTH_FETCH_FLIPPED] =
        {"depth-fetch-flipped",
         "depths are fetched from the mirrored row: textures and the window disagree about y",
         "texelFetch(depth, ivec2(gl_FragCoord.xy), 0), without 1 − y"},
    [MUTATION_DEPTH_16] =
        {"depth-16",
         "depth buffers have 16 bits: layers that round to one depth are one layer, and layers at "
         "the opaque depth are lost",
         "use 32-bit float depth buffers"},
    [MUTATION_DEPTH_24] =
        {"depth-24", "depth buffers have 24 bits: layers that round to one depth are one layer",
         "use 32-bit float depth buffers"},
    [MUTATION_RAW_PEEL_TEST] =
        {"raw-peel-test",
         "gl_FragCoord.z as computed is compared with a depth as stored: a layer that was rounded "
         "down is peeled again",
         "round the fragment's depth to the stored format before comparing, or store 32-bit "
         "floats"},
    [MUTATION_ALPHA_TEST_MISSING] = {"alpha-test-missing",
                                     "the lighting pass does not discard by alpha: it also lights "
                                     "what is as good as invisible, "
                                     "and what was cleared",
                                     "discard in the lighting pass where alpha <= 1e-4"},
    [MUTATION_ALPHA_TEST_HALF] =
        {"alpha-test-half",
         "an alpha test for cutouts is left on: layers of alpha up to 0.5 are discarded",
         "discard in the lighting pass where alpha <= 1e-4 only"},
    [MUTATION_GBUFFER_CLEAR_ALPHA_1] =
        {"gbuffer-clear-alpha-1",
         "the G-buffer is cleared to alpha 1: pixels without a fragment are lit as opaque and "
         "black",
         "clear the G-buffer to (0, 0, 0, 0)"},
    [MUTATION_BACK_FACES_CULLED] = {"back-faces-culled",
                                    "back faces of all surfaces are culled: far sides are missing",
                                    "cull back faces of single-sided materials only"},
    [MUTATION_NORMALS_NOT_NORMALISED] =
        {"normals-not-normalised",
         "interpolated normals are used as they are, shorter than 1 between vertices",
         "normalise in the fragment shader"},
    [MUTATION_NORMALS_NOT_FLIPPED] =
        {"normals-not-flipped",
         "normals of back faces are not turned to the viewer: far sides are lit from inside",
         "negate the normal where gl_FrontFacing is false"},
    [MUTATION_NORMALS_WRONG_SPACE] =
        {"normals-wrong-space", "normals are in world space, lights and positions in view space",
         "transform normals by the inverse transpose of model-view, not of the model's matrix"},
    [MUTATION_ROUGHNESS_SQUARED_TWICE] =
        {"roughness-squared-twice",
         "roughness is squared before it is given to the shading, which squares it again",
         "give the material's roughness to the shading as it is; a = roughness²"},
    [MUTATION_MISSING_1_OVER_PI] =
        {"missing-1-over-pi", "the Lambert term is not divided by π: diffuse light is too bright",
         "lambert = diffuse·(1 − metallic)/π"},
    [MUTATION_LIGHTS_OFF_BY_ONE] =
        {"lights-off-by-one", "the loop over lights ends one early: the last light is missing",
         "run the loop over all lights: i < count"},
    [MUTATION_AMBIENT_PER_LAYER] =
        {"ambient-per-layer",
         "the ambient light is added after the multiplication by alpha: every layer adds it in "
         "full",
         "add the ambient light before the multiplication by alpha"},
    [MUTATION_SRGB_ENCODED_TWICE] =
        {"srgb-encoded-twice",
         "the colours are encoded for display twice, by the shader and by the framebuffer or the "
         "file's writer",
         "encode once: a plain framebuffer, or no pow(c, 1/2.2) in the shader"},
    [MUTATION_SRGB_BLENDED] = {"srgb-blended",
                               "layers are encoded for display before they are blended, and the "
                               "sum is taken for encoded",
                               "blend linear colours and encode the result"},
    [MUTATION_ACCUMULATION_8_BIT] =
        {"accumulation-8-bit",
         "the accumulation has 8 bits a channel: every blend rounds, and light above 1 is cut",
         "accumulate in 32-bit floats"},
    [MUTATION_ACCUMULATION_16_BIT] =
        {"accumulation-16-bit",
         "the accumulation has 16 bits a channel, 0 to 1: light above 1 is cut",
         "accumulate in floats"},
    [MUTATION_ACCUMULATION_HALF] =
        {"accumulation-half",
         "the accumulation is half floats, and every blend truncates to 11 bits",
         "accumulate in 32-bit floats"},
    [MUTATION_ACCUMULATION_HALF_ROUNDED] =
        {"accumulation-half-rounded",
         "the accumulation is half floats, and every blend rounds to the nearest of 11 bits",
         "accumulate in 32-bit floats"},
    [MUTATION_OBJECTS_SORTED] = {"objects-sorted",
                                 "objects are sorted by their distance and blended: surfaces "
                                 "within one object, and objects "
                                 "that reach through each other, are in the wrong order",
                                 "peel, or sort fragments"},
    [MUTATION_WEIGHTED_SUM_TAKEN] =
        {"weighted-sum-taken",
         "an image by weighted sum, which ignores order, is taken for the exact one",
         "peel, or compare with --method weighted-sum"},
    [MUTATION_WEIGHTED_AVERAGE_TAKEN] =
        {"weighted-average-taken",
         "an image by weighted average, which ignores order, is taken for the exact one",
         "peel, or compare with --method weighted-average"},
    [MUTATION_WEIGHTED_BLENDED_TAKEN] = {"weighted-blended-taken",
                                         "an image by weighted blending, which guesses order from "
                                         "depth, is taken for the exact one",
                                         "peel, or compare with --method weighted-blended"},
};

const MutationInfo *mutation_info(MutationId id)
{
    return &mutations[id];
}

MutationId mutation_find(const char *name)
{
    int id = 0;
    while (id < MUTATION_COUNT && strcmp(mutations[id].name, name) != 0)
        id++;
    return (MutationId)id;
}

/* What a mutation chooses, of those that cannot be chosen twice. */
typedef enum Choice {
    CHOICE_NONE = 0,
    CHOICE_PREMULTIPLIED,
    CHOICE_BLEND,
    CHOICE_BACKGROUND,
    CHOICE_BIAS,
    CHOICE_PREVIOUS,
    CHOICE_PASSES,
    CHOICE_FETCH,
    CHOICE_DEPTH,
    CHOICE_ALPHA_TEST,
    CHOICE_ACCUM,
    CHOICE_METHOD
} Choice;

static Choice choice_of(MutationId id)
{
    switch (id) {
    case MUTATION_NOT_PREMULTIPLIED:
    case MUTATION_PREMULTIPLIED_TWICE:
        return CHOICE_PREMULTIPLIED;
    case MUTATION_BLEND_FACTORS_SWAPPED:
    case MUTATION_OVER_FRONT_TO_BACK:
    case MUTATION_LAYERS_REVERSED:
        return CHOICE_BLEND;
    case MUTATION_TRANSMITTANCE_AS_COVERAGE:
    case MUTATION_BACKGROUND_WEIGHTED_WRONGLY:
    case MUTATION_BACKGROUND_FORGOTTEN:
        return CHOICE_BACKGROUND;
    case MUTATION_PEEL_BIAS_1E_4:
    case MUTATION_PEEL_BIAS_1E_3:
        return CHOICE_BIAS;
    case MUTATION_DEPTH_NOT_SWAPPED:
    case MUTATION_ONE_DEPTH_BUFFER:
        return CHOICE_PREVIOUS;
    case MUTATION_PASSES_SHORT:
    case MUTATION_PASSES_4:
    case MUTATION_PASSES_6:
    case MUTATION_PASSES_8:
        return CHOICE_PASSES;
    case MUTATION_DEPTH_FETCH_HALF_PIXEL:
    case MUTATION_DEPTH_FETCH_FLIPPED:
        return CHOICE_FETCH;
    case MUTATION_DEPTH_16:
    case MUTATION_DEPTH_24:
        return CHOICE_DEPTH;
    case MUTATION_ALPHA_TEST_MISSING:
    case MUTATION_ALPHA_TEST_HALF:
        return CHOICE_ALPHA_TEST;
    case MUTATION_ACCUMULATION_8_BIT:
    case MUTATION_ACCUMULATION_16_BIT:
    case MUTATION_ACCUMULATION_HALF:
    case MUTATION_ACCUMULATION_HALF_ROUNDED:
        return CHOICE_ACCUM;
    case MUTATION_OBJECTS_SORTED:
    case MUTATION_WEIGHTED_SUM_TAKEN:
    case MUTATION_WEIGHTED_AVERAGE_TAKEN:
    case MUTATION_WEIGHTED_BLENDED_TAKEN:
        return CHOICE_METHOD;
    default:
        return CHOICE_NONE;
    }
}

bool mutation_excludes(MutationId a, MutationId b)
{
    return choice_of(a) != CHOICE_NONE && choice_of(a) == choice_of(b);
}

/* ---- mistakes that are settings ---- */

/* Of peels. Whether that is all of the mistake, as below. */
static bool set_peeling(MutationId id, RenderDesc *desc)
{
    switch (id) {
    case MUTATION_PEEL_BIAS_1E_4:
        desc->bias = 1e-4f;
        return true;
    case MUTATION_PEEL_BIAS_1E_3:
        desc->bias = 1e-3f;
        return true;
    case MUTATION_PASSES_4:
        desc->passes = 4;
        return true;
    case MUTATION_PASSES_6:
        desc->passes = 6;
        return true;
    case MUTATION_PASSES_8:
        desc->passes = 8;
        return true;
    case MUTATION_DEPTH_16:
        desc->depth = FORMAT_D16;
        return true;
    case MUTATION_DEPTH_24:
        desc->depth = FORMAT_D24;
        return true;
    case MUTATION_RAW_PEEL_TEST:
        desc->peel_test = PEEL_TEST_RAW;
        return true;
    case MUTATION_NORMALS_NOT_FLIPPED:
        desc->normals = NORMALS_KEPT;
        return true;
    default:
        return false;
    }
}

/* Of the accumulation, and another method. */
static bool set_accumulation(MutationId id, RenderDesc *desc)
{
    switch (id) {
    case MUTATION_ACCUMULATION_8_BIT:
        desc->accum = FORMAT_RGBA8;
        return true;
    case MUTATION_ACCUMULATION_16_BIT:
        desc->accum = FORMAT_RGBA16;
        return true;
    case MUTATION_ACCUMULATION_HALF:
        desc->accum = FORMAT_RGBA16F;
        return true;
    case MUTATION_OBJECTS_SORTED:
        desc->method = METHOD_PAINTER;
        desc->sort = SORT_OBJECTS;
        return true;
    case MUTATION_WEIGHTED_SUM_TAKEN:
        desc->method = METHOD_WEIGHTED_SUM;
        return true;
    case MUTATION_WEIGHTED_AVERAGE_TAKEN:
        desc->method = METHOD_WEIGHTED_AVERAGE;
        return true;
    case MUTATION_WEIGHTED_BLENDED_TAKEN:
        desc->method = METHOD_WEIGHTED_BLENDED;
        return true;
    case MUTATION_ACCUMULATION_HALF_ROUNDED:
        desc->accum = FORMAT_RGBA32F; /* in which ref rounds */
        return false;
    default:
        return false;
    }
}

/* Without those that a later one excludes. */
static uint64_t compatible(uint64_t bits)
{
    for (int id = 0; id < MUTATION_COUNT; id++)
        for (int later = id + 1; later < MUTATION_COUNT; later++)
            if ((bits & mutation_bit((MutationId)later)) &&
                mutation_excludes((MutationId)id, (MutationId)later))
                bits &= ~mutation_bit((MutationId)id);
    return bits;
}

void mutation_apply(const RenderDesc *desc, RenderDesc *out)
{
    *out = *desc;
    out->mutations = compatible(desc->mutations);
    for (int i = 0; i < MUTATION_COUNT; i++) {
        MutationId id = (MutationId)i;
        if ((out->mutations & mutation_bit(id)) &&
            (set_peeling(id, out) || set_accumulation(id, out)))
            out->mutations &= ~mutation_bit(id);
    }
}
