// Weighted blended, its geometry pass (behind surface.glsl, peel_test.glsl and shade.glsl) and its
// full-screen pass. The formula and its order: ref/pipeline/methods/weighted_blended.c.
//
// COMBINE          the full-screen pass: sums to the source colour
// WEIGHT           the paper's equation: 7, 8, 9 or 10
// REVERSED         depth is 1 near and 0 far
// ACCUM_CLAMP(c)   clamps a colour where the accumulation has 8 bits a channel

#ifndef COMBINE

layout(location = 0) out vec4 out_sum;
layout(location = 1) out vec4 out_second;

#if WEIGHT == 10
float weight()
{
#ifdef REVERSED
    precise float near = gl_FragCoord.z;
#else
    precise float near = 1.0 - gl_FragCoord.z;
#endif
    precise float w = max(1e-2, 3e3 * (near * near * near));
    return w;
}
#else
float weight()
{
    precise float z = abs(v_position.z);
    precise float s = z / 200.0;
    precise float s2 = s * s;
    precise float s4 = s2 * s2;
#if WEIGHT == 7
    precise float q = z / 5.0;
    precise float ratio = 10.0 / (1e-5 + q * q + s4 * s2);
#elif WEIGHT == 8
    precise float q = z / 10.0;
    precise float ratio = 10.0 / (1e-5 + q * q * q + s4 * s2);
#else
    precise float ratio = 0.03 / (1e-5 + s4);
#endif
    precise float w = max(1e-2, min(3e3, ratio));
    return w;
}
#endif

void main()
{
    if (is_culled() || is_peeled_or_hidden())
        discard;
    Surface surface = surface_at();
    if (surface.base.a <= ALPHA_TEST)
        discard;
    vec4 shaded = shade(surface.normal, v_position, surface.base, surface.material);
    precise float w = shaded.a * weight();
    precise vec4 weighted = shaded * w;
    out_sum = weighted;
    out_second = vec4(shaded.a, 0.0, 0.0, 0.0);
}

#else

layout(binding = 0) uniform sampler2D sum_buffer;
layout(binding = 1) uniform sampler2D second_buffer;

layout(location = 0) out vec4 source;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 sum = texelFetch(sum_buffer, pixel, 0);
    float transmittance = texelFetch(second_buffer, pixel, 0).r;
    if (transmittance == 1.0)
        discard;
    precise float alpha = 1.0 - transmittance;
    precise float total = max(sum.a, 1e-5);
    precise vec3 color = sum.rgb / total;
    precise vec3 premultiplied = color * alpha;
    source = ACCUM_CLAMP(vec4(premultiplied, alpha));
}

#endif
