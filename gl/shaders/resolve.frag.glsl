// Resolve pass: the accumulation over the background, and its display form.
//
// SEED_BLEND   the opaque pass left no transmittance in the accumulation's alpha

layout(binding = 0) uniform sampler2D accum_buffer;
layout(binding = 1) uniform sampler2D opaque_diffuse;

layout(location = 0) uniform vec3 background;

layout(location = 0) out vec4 out_final;
layout(location = 1) out vec4 out_display;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 accum = texelFetch(accum_buffer, pixel, 0);
    float transmittance = accum.a;
#ifdef SEED_BLEND
    if (texelFetch(opaque_diffuse, pixel, 0).a > ALPHA_TEST)
        transmittance = 0.0;
#endif
    precise vec3 color = accum.rgb + background * transmittance;
    precise float coverage = 1.0 - transmittance;
    precise vec3 positive = max(color, vec3(0.0));
    precise vec3 ratio = positive / (positive + 1.0);
    precise vec3 display = pow(ratio, vec3(DISPLAY_POWER));
    out_final = vec4(color, coverage);
    out_display = vec4(display, 1.0);
}
