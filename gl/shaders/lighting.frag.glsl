// Lighting pass: shades one stored fragment; the result is premultiplied and blended. Behind
// octahedral.glsl, shade.glsl and, with RECONSTRUCT, unproject.glsl.
//
// OCTAHEDRAL       normals are stored in two channels
// RECONSTRUCT      the position follows from the stored depth
// NO_NORMAL        normals are not stored, since nothing depends on them
// NO_POSITION      nor are positions
// CONSTANT_MATERIAL   all that is shaded has one material
// ACCUM_CLAMP(c)   clamps a colour where the accumulation has 8 bits a channel
// EDGES            outlines: fragments that differ from a neighbour are black

#ifndef NO_NORMAL
layout(binding = 0) uniform sampler2D normal_buffer;
#endif
#ifdef RECONSTRUCT
layout(binding = 1) uniform sampler2D depth_buffer;
#elif !defined(NO_POSITION)
layout(binding = 1) uniform sampler2D position_buffer;
#endif
layout(binding = 2) uniform sampler2D diffuse_buffer;
#ifdef CONSTANT_MATERIAL
layout(location = 19) uniform vec3 constant_material; // as a fetch would give it
#else
layout(binding = 3) uniform sampler2D material_buffer;
#endif

layout(location = 0) out vec4 source;

vec3 fetch_position(ivec2 pixel)
{
#if defined(NO_POSITION)
    return vec3(0.0);
#elif defined(RECONSTRUCT)
    return unproject(pixel, texelFetch(depth_buffer, pixel, 0).r);
#else
    return texelFetch(position_buffer, pixel, 0).xyz;
#endif
}

vec3 fetch_material(ivec2 pixel)
{
#ifdef CONSTANT_MATERIAL
    return constant_material;
#else
    return texelFetch(material_buffer, pixel, 0).xyz;
#endif
}

vec3 fetch_normal(ivec2 pixel)
{
#if defined(NO_NORMAL)
    return vec3(0.0);
#elif defined(OCTAHEDRAL)
    return decode_octahedral(texelFetch(normal_buffer, pixel, 0).xy);
#else
    return texelFetch(normal_buffer, pixel, 0).xyz;
#endif
}

#ifdef EDGES
bool differs_from(ivec2 other, vec3 N, float z)
{
    if (any(lessThan(other, ivec2(0))) ||
        any(greaterThanEqual(other, textureSize(material_buffer, 0))))
        return false;
    if (texelFetch(material_buffer, other, 0).a == 0.0)
        return true;
    precise float turn = dot(N, fetch_normal(other));
    precise float apart = abs(z + fetch_position(other).z);
    precise float most = EDGE_DEPTH * z;
    return turn < EDGE_DOT || apart > most;
}

bool is_edge(ivec2 pixel, vec3 N, float z)
{
    return differs_from(pixel - ivec2(1, 0), N, z) || differs_from(pixel + ivec2(1, 0), N, z) ||
           differs_from(pixel - ivec2(0, 1), N, z) || differs_from(pixel + ivec2(0, 1), N, z);
}
#endif

void main()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 diffuse_alpha = texelFetch(diffuse_buffer, pixel, 0);
    if (diffuse_alpha.a <= ALPHA_TEST)
        discard;
    vec3 N = fetch_normal(pixel), P = fetch_position(pixel);
    source = shade(N, P, diffuse_alpha, fetch_material(pixel));
#ifdef EDGES
    if (is_edge(pixel, N, -P.z))
        source.rgb = vec3(0.0);
#endif
    source = ACCUM_CLAMP(source);
}
