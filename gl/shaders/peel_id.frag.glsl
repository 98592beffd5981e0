// Peeling by depth and primitive: the three geometry passes of a peel. Behind surface.glsl and
// peel_test.glsl; PASS_GBUFFER also behind octahedral.glsl and gbuffer.glsl.
//
// PASS_DEPTH      the depth of the first fragment after the previous layer
// PASS_SELECT     of the fragments at that depth, the first primitive
// PASS_GBUFFER    that fragment into the G-buffer
// AFTER_LAYER     there is a previous layer
// GREATER_FIRST   of equal depths, the greater id is in front
//
// A rank is 0 where there is no fragment, and greater in front.

layout(location = 10) uniform uint first_primitive; // of the draw

#if defined(DEPTH_24) && defined(REVERSED)
#define LAYER_CODE
layout(binding = 4) uniform usampler2D layer_depth; // of the previous peel
#else
layout(binding = 4) uniform sampler2D layer_depth;
#endif
layout(binding = 5) uniform usampler2D layer_rank; // previous peel's; PASS_GBUFFER: this peel's

uint rank()
{
    uint id = first_primitive + uint(gl_PrimitiveID);
#ifdef GREATER_FIRST
    return id + 1u;
#else
    return ~id;
#endif
}

#ifdef AFTER_LAYER
bool comes_after_previous()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint code;
    precise float z = stored_depth(gl_FragCoord.z, code);
#ifdef LAYER_CODE
    uint previous_code = texelFetch(layer_depth, pixel, 0).r;
    precise float previous = float(previous_code) * (1.0 / 16777215.0);
    bool same = code == previous_code;
    bool behind = code < previous_code;
#else
    precise float previous = texelFetch(layer_depth, pixel, 0).r;
    bool same = z == previous;
    bool behind = !same && AT_OR_BEHIND(z, previous);
#endif
    if (same)
        return rank() < texelFetch(layer_rank, pixel, 0).r;
#ifdef BIAS
#ifdef REVERSED
    previous = previous - BIAS;
#else
    previous = previous + BIAS;
#endif
    behind = behind && !AT_OR_BEHIND(previous, z);
#endif
    return behind;
}
#endif

#ifdef PASS_SELECT
layout(early_fragment_tests) in;
layout(binding = 0, r32ui) uniform uimage2D selected_rank;
#endif

void main()
{
    if (is_culled() || is_peeled_or_hidden())
        discard;
#ifdef AFTER_LAYER
    if (!comes_after_previous())
        discard;
#endif
#ifdef PASS_SELECT
    imageAtomicMax(selected_rank, ivec2(gl_FragCoord.xy), rank());
#endif
#ifdef PASS_GBUFFER
    if (rank() != texelFetch(layer_rank, ivec2(gl_FragCoord.xy), 0).r)
        discard;
    Surface surface = surface_at();
    write_surface(surface, surface.base.a);
#endif
}
