// Forward dual depth peeling: one fragment of a peel, all targets blended with MAX. Behind
// surface.glsl, peel_test.glsl, shade.glsl and minmax.glsl.
//
// ACCUM_UNORM      colours are stored in fixed point
// ACCUM_CLAMP(c)   clamps a colour where the accumulation has 8 bits a channel

layout(binding = 4) uniform sampler2D previous_limits;
layout(binding = 5) uniform sampler2D previous_front;

layout(location = 0) out vec2 limits;
layout(location = 1) out vec4 front;
layout(location = 2) out vec4 back;

vec4 shade_surface(Surface surface)
{
    vec4 source = shade(surface.normal, v_position, surface.base, surface.material);
#ifdef ACCUM_UNORM
    source = clamp(source, 0.0, 1.0);
#endif
    return source;
}

// The front colour with one more layer under it; alpha is 1 - transmittance.
vec4 add_front(vec4 color, vec4 source)
{
    precise float transmittance = 1.0 - color.a;
    precise vec3 sum = color.rgb + source.rgb * transmittance;
    precise float alpha = 1.0 - transmittance * (1.0 - source.a);
    return vec4(sum, alpha);
}

void main()
{
    if (is_culled())
        discard;
    if (is_peeled_or_hidden())
        discard;
    Surface surface = surface_at();
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float distance = fragment_distance();
    vec2 previous = texelFetch(previous_limits, pixel, 0).rg;
    float nearest = -previous.r;
    float farthest = previous.g;
    limits = NO_LAYER;
    front = texelFetch(previous_front, pixel, 0); // MAX keeps it
    back = vec4(0.0);
    if (distance > nearest && distance < farthest)
        limits = vec2(-distance, distance);
    else if ((distance == nearest || distance == farthest) && surface.base.a > ALPHA_TEST) {
        vec4 source = shade_surface(surface);
        if (distance == nearest)
            front = add_front(front, source);
        else
            back = source;
    }
    front = ACCUM_CLAMP(front);
}
