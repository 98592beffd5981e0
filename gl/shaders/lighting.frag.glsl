// Lighting pass: shades one stored fragment; the result is premultiplied and blended. Behind
// octahedral.glsl, shade.glsl and, with RECONSTRUCT, unproject.glsl.
//
// OCTAHEDRAL       normals are stored in two channels
// RECONSTRUCT      the position follows from the stored depth
// ACCUM_8          the accumulation buffer has 8 bits a channel

layout(binding = 0) uniform sampler2D normal_buffer;
#ifdef RECONSTRUCT
layout(binding = 1) uniform sampler2D depth_buffer;
#else
layout(binding = 1) uniform sampler2D position_buffer;
#endif
layout(binding = 2) uniform sampler2D diffuse_buffer;
layout(binding = 3) uniform sampler2D material_buffer;

layout(location = 0) out vec4 source;

#ifdef RECONSTRUCT
vec3 fetch_position(ivec2 pixel)
{
    return unproject(pixel, texelFetch(depth_buffer, pixel, 0).r);
}
#else
vec3 fetch_position(ivec2 pixel)
{
    return texelFetch(position_buffer, pixel, 0).xyz;
}
#endif

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 diffuse_alpha = texelFetch(diffuse_buffer, pixel, 0);
    if (diffuse_alpha.a <= ALPHA_TEST)
        discard;
#ifdef OCTAHEDRAL
    vec3 N = decode_octahedral(texelFetch(normal_buffer, pixel, 0).xy);
#else
    vec3 N = texelFetch(normal_buffer, pixel, 0).xyz;
#endif
    vec3 material = texelFetch(material_buffer, pixel, 0).xyz;
    source = shade(N, fetch_position(pixel), diffuse_alpha, material);
#ifdef ACCUM_8
    // What the store does anyway; without AVX, llvmpipe turns 2^31/255 and more into 0.
    source = clamp(source, 0.0, 1.0);
#endif
}
