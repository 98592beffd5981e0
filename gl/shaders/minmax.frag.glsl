// The passes that the methods of dual depth peeling share. Behind minmax.glsl; FIRST_PASS also
// behind surface.glsl and peel_test.glsl.
//
// FIRST_PASS     geometry pass: nearest and farthest visible fragment, with MAX blending
// COUNT          full screen: a sample for every pixel that has a layer left
// TRANSMITTANCE  full screen: copies a colour whose alpha is transmittance, as one to be put under
// neither        full screen: copies a colour

#if defined(FIRST_PASS)

layout(location = 0) out vec2 limits;

void main()
{
    if (is_culled())
        discard;
    if (is_peeled_or_hidden())
        discard;
    surface_at(); // the alpha mask
    float distance = fragment_distance();
    limits = vec2(-distance, distance);
}

#elif defined(COUNT)

layout(binding = 0) uniform sampler2D limits_buffer;

layout(location = 0) out vec2 limits;

void main()
{
    if (texelFetch(limits_buffer, ivec2(gl_FragCoord.xy), 0).g == NO_LAYER.g)
        discard;
    limits = NO_LAYER;
}

#else

layout(binding = 0) uniform sampler2D color_buffer;

layout(location = 0) out vec4 source;

void main()
{
    precise vec4 color = texelFetch(color_buffer, ivec2(gl_FragCoord.xy), 0);
#ifdef TRANSMITTANCE
    color.a = 1.0 - color.a;
#endif
    source = color;
}

#endif
