// Weighted sum, its geometry pass (behind surface.glsl, peel_test.glsl and shade.glsl) and its
// full-screen pass: ref/pipeline/methods/weighted_sum.c.
//
// COMBINE          the full-screen pass: the sum is the source colour
// ACCUM_CLAMP(c)   clamps a colour where the accumulation has 8 bits a channel

#ifndef COMBINE

layout(location = 0) out vec4 out_sum;

void main()
{
    if (is_culled() || is_peeled_or_hidden())
        discard;
    Surface surface = surface_at();
    if (surface.base.a <= ALPHA_TEST)
        discard;
    out_sum = shade(surface.normal, v_position, surface.base, surface.material);
}

#else

layout(binding = 0) uniform sampler2D sum_buffer;

layout(location = 0) out vec4 source;

void main()
{
    source = texelFetch(sum_buffer, ivec2(gl_FragCoord.xy), 0);
    if (source.a == 0.0)
        discard;
    source = ACCUM_CLAMP(source);
}

#endif
