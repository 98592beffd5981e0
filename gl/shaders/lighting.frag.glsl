// Lighting pass: shades one stored fragment; the result is premultiplied and blended. Behind
// octahedral.glsl and shade.glsl.
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

#ifdef RECONSTRUCT
layout(location = 17) uniform vec3 depth_to_z; // scale and offset to 1/z, least 1/z
layout(location = 18) uniform vec4 ray;        // scale, offset of x and y
#endif

layout(location = 0) out vec4 source;

#ifdef RECONSTRUCT
vec3 fetch_position(ivec2 pixel)
{
    float depth = texelFetch(depth_buffer, pixel, 0).r;
    precise float inverse_z = max(depth * depth_to_z.x + depth_to_z.y, depth_to_z.z);
    precise float z = 1.0 / inverse_z;
    precise vec2 position = (vec2(pixel) * ray.xy + ray.zw) * z;
    return vec3(position, -z);
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
