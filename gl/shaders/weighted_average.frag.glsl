// Weighted average, its geometry pass (behind surface.glsl, peel_test.glsl and shade.glsl) and its
// full-screen pass. The formula and its order: ref/pipeline/methods/weighted_average.c.
//
// COMBINE          the full-screen pass: sums to the source colour
// ACCUM_CLAMP(c)   clamps a colour where the accumulation has 8 bits a channel

#ifndef COMBINE

layout(location = 0) out vec4 out_sum;
layout(location = 1) out vec4 out_second;

void main()
{
    if (is_culled() || is_peeled_or_hidden())
        discard;
    Surface surface = surface_at();
    if (surface.base.a <= ALPHA_TEST)
        discard;
    out_sum = shade(surface.normal, v_position, surface.base, surface.material);
    out_second = vec4(1.0, 0.0, 0.0, 0.0);
}

#else

layout(binding = 0) uniform sampler2D sum_buffer;
layout(binding = 1) uniform sampler2D second_buffer;

layout(location = 0) out vec4 source;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 sum = texelFetch(sum_buffer, pixel, 0);
    float count = texelFetch(second_buffer, pixel, 0).r;
    if (count == 0.0 || sum.a == 0.0)
        discard;
    precise float average = sum.a / count;
    precise float keep = 1.0 - average;
    precise float transmittance = 1.0;
    for (int i = 0; i < int(count); i++)
        transmittance = transmittance * keep;
    precise float alpha = 1.0 - transmittance;
    precise vec3 color = sum.rgb / sum.a;
    precise vec3 premultiplied = color * alpha;
    source = ACCUM_CLAMP(vec4(premultiplied, alpha));
}

#endif
