// Deferred dual depth peeling: the geometry pass of a peel, and the lighting pass of its front or
// back layer. Behind octahedral.glsl and minmax.glsl; the geometry pass also behind surface.glsl
// and peel_test.glsl, the lighting pass behind shade.glsl and unproject.glsl.
//
// LIGHT_FRONT, LIGHT_BACK   lighting pass
// ACCUM_CLAMP(c)            clamps a colour where the accumulation has 8 bits a channel

#if defined(LIGHT_FRONT) || defined(LIGHT_BACK)

layout(binding = 0) uniform sampler2D normal_buffer;
layout(binding = 1) uniform sampler2D diffuse_buffer;
layout(binding = 2) uniform sampler2D material_buffer;
layout(binding = 4) uniform sampler2D previous_limits;

layout(location = 0) out vec4 source;

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 normal_opacity = texelFetch(normal_buffer, pixel, 0).xyz;
    if (normal_opacity.z <= ALPHA_TEST)
        discard;
    vec2 limits = texelFetch(previous_limits, pixel, 0).rg;
#ifdef LIGHT_FRONT
    float distance = -limits.r;
#else
    float distance = limits.g;
#endif
    vec3 N = decode_octahedral(normal_opacity.xy);
    vec3 P = unproject(pixel, distance_depth(distance));
    vec4 diffuse_alpha = vec4(texelFetch(diffuse_buffer, pixel, 0).rgb, normal_opacity.z);
    vec3 material = texelFetch(material_buffer, pixel, 0).xyz;
    source = ACCUM_CLAMP(shade(N, P, diffuse_alpha, material));
}

#else

layout(binding = 4) uniform sampler2D previous_limits;

// Alpha is a mask: 1 where the fragment is that layer's.
layout(location = 0) out vec2 limits;
layout(location = 1) out vec4 front_normal; // octahedral normal, opacity
layout(location = 2) out vec4 front_diffuse;
layout(location = 3) out vec4 front_material;
layout(location = 4) out vec4 back_normal;
layout(location = 5) out vec4 back_diffuse;
layout(location = 6) out vec4 back_material;

void main()
{
    if (is_culled())
        discard;
    if (is_peeled_or_hidden())
        discard;
    float distance = fragment_distance();
    vec2 previous = texelFetch(previous_limits, ivec2(gl_FragCoord.xy), 0).rg;
    float nearest = -previous.r;
    float farthest = previous.g;
    if (distance < nearest || distance > farthest)
        discard;
    Surface surface = surface_at();
    bool in_front = distance == nearest;
    bool in_back = !in_front && distance == farthest;
    vec4 normal = vec4(encode_octahedral(surface.normal), surface.base.a, 1.0);
    vec4 diffuse = vec4(surface.base.rgb, 1.0);
    vec4 material = vec4(surface.material, 1.0);
    const vec4 none = vec4(0.0);
    limits = in_front || in_back ? NO_LAYER : vec2(-distance, distance);
    front_normal = in_front ? normal : none;
    front_diffuse = in_front ? diffuse : none;
    front_material = in_front ? material : none;
    back_normal = in_back ? normal : none;
    back_diffuse = in_back ? diffuse : none;
    back_material = in_back ? material : none;
}

#endif
