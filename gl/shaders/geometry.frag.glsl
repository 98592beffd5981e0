// Geometry pass: one fragment into the G-buffer.
//
// OUT_NORMAL …   draw buffers; no OUT_POSITION where positions are not stored
// OCTAHEDRAL     normals are stored in two channels
// TEXTURED       the scene has textures
// FACED          normals are turned to the viewer
// TRANSPARENT    compare with the opaque depth
// NEXT_PEEL      compare with the previous peel's depth as well
// TEST_RAW       compare gl_FragCoord.z itself instead of its stored value
// REVERSED       depth is 1 near and 0 far: comparisons are mirrored
// DEPTH_24       depth is stored in 24 bits
// DEPTH_16       in 16 bits

layout(location = 0) in vec3 v_position;
layout(location = 1) in vec3 v_normal;
#ifdef TEXTURED
layout(location = 2) in vec2 v_uv;
#endif

layout(location = 3) uniform vec4 base_color;
layout(location = 4) uniform vec3 material;   // roughness, metallic, occlusion
layout(location = 5) uniform bool cull_back;
layout(location = 6) uniform bool flipped;    // the model matrix mirrors
#ifdef TEXTURED
// 1 where there is a texture; wrap of s and t: 0 repeat, 1 clamp, 2 mirror; 1 for nearest.
layout(location = 7) uniform ivec4 base_color_sampler;
layout(location = 8) uniform ivec4 metallic_roughness_sampler;
layout(location = 9) uniform float alpha_cutoff; // 0 unless masked

layout(binding = 2) uniform sampler2D base_color_texture;
layout(binding = 3) uniform sampler2D metallic_roughness_texture;
#endif

layout(location = OUT_NORMAL) out vec4 out_normal;
#ifdef OUT_POSITION
layout(location = OUT_POSITION) out vec4 out_position;
#endif
layout(location = OUT_DIFFUSE) out vec4 out_diffuse;
layout(location = OUT_MATERIAL) out vec4 out_material;

#ifdef TRANSPARENT
// The fetched values of the two greatest 24-bit depths are both 1, so the integers are compared
// where these can meet: at the far end, or reversed near the eye.
#if defined(DEPTH_24) && !defined(TEST_RAW)
#define OPAQUE_CODE
#ifdef REVERSED
#define PREVIOUS_CODE
#endif
#endif
#ifdef OPAQUE_CODE
layout(binding = 1) uniform usampler2D opaque_depth;
#else
layout(binding = 1) uniform sampler2D opaque_depth;
#endif
#ifdef PREVIOUS_CODE
layout(binding = 0) uniform usampler2D previous_depth;
#else
layout(binding = 0) uniform sampler2D previous_depth;
#endif

#ifdef REVERSED
#define AT_OR_BEHIND(a, b) ((a) <= (b))
#else
#define AT_OR_BEHIND(a, b) ((a) >= (b))
#endif

bool is_peeled_or_hidden()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    precise float z = gl_FragCoord.z;
#ifndef TEST_RAW
    // As the depth buffer stores it; NaN becomes 1.
    z = z < 1.0 ? z : 1.0;
    z = z > 0.0 ? z : 0.0;
#ifdef DEPTH_24
    precise float scaled = z * 16777215.0;
    precise float code = roundEven(scaled);
    if (AT_OR_BEHIND(uint(code), texelFetch(opaque_depth, pixel, 0).r))
        return true;
#if defined(NEXT_PEEL) && defined(PREVIOUS_CODE)
    if (AT_OR_BEHIND(texelFetch(previous_depth, pixel, 0).r, uint(code)))
        return true;
#endif
    z = code * (1.0 / 16777215.0); // what a fetch of the stored depth gives
#endif
#ifdef DEPTH_16
    precise float scaled = z * (65535.0 / 65536.0);
    precise float shifted = scaled + 128.0; // the low bits of the mantissa are the code
    z = float(floatBitsToUint(shifted) & 0xffffu) * (1.0 / 65535.0);
#endif
#endif
#ifndef OPAQUE_CODE
    if (AT_OR_BEHIND(z, texelFetch(opaque_depth, pixel, 0).r))
        return true;
#endif
#if defined(NEXT_PEEL) && !defined(PREVIOUS_CODE)
    if (AT_OR_BEHIND(texelFetch(previous_depth, pixel, 0).r, z))
        return true;
#endif
    return false;
}
#endif

#ifdef TEXTURED
int wrapped_index(int i, int size, int wrap)
{
    if (wrap == 0)
        return i < 0 ? i + size : i >= size ? i - size : i;
    return clamp(i, 0, size - 1);
}

// Texels along one axis; nearest: the first.
ivec2 tap(float u, int size, int wrap, bool nearest, out float fraction)
{
    precise float repeated = u - floor(u);
    precise float m = u - 2.0 * floor(u * 0.5);
    precise float back = 2.0 - m;
    float c = wrap == 0 ? repeated : wrap == 1 ? u : m > 1.0 ? back : m;
    precise float at = clamp(c, 0.0, 1.0) * float(size);
    precise float centred = at - 0.5;
    precise float x = nearest ? at : centred;
    precise float low = floor(x);
    precise float rest = x - low;
    fraction = rest;
    int i = int(low);
    return ivec2(wrapped_index(i, size, wrap), wrapped_index(i + 1, size, wrap));
}

// Fetches and arithmetic of our own: the driver's filter works with fewer bits.
vec4 sample_texture(sampler2D image, ivec4 how)
{
    ivec2 size = textureSize(image, 0);
    bool nearest = how.w != 0;
    float f, g;
    ivec2 x = tap(v_uv.x, size.x, how.y, nearest, f);
    ivec2 y = tap(v_uv.y, size.y, how.z, nearest, g);
    vec4 t00 = texelFetch(image, ivec2(x[0], y[0]), 0);
    if (nearest)
        return t00;
    vec4 t10 = texelFetch(image, ivec2(x[1], y[0]), 0);
    vec4 t01 = texelFetch(image, ivec2(x[0], y[1]), 0);
    vec4 t11 = texelFetch(image, ivec2(x[1], y[1]), 0);
    precise vec4 low = mix(t00, t10, vec4(f));
    precise vec4 high = mix(t01, t11, vec4(f));
    precise vec4 value = mix(low, high, vec4(g));
    return value;
}
#endif

#ifdef OCTAHEDRAL
vec2 encode_octahedral(vec3 n)
{
    precise float length1 = max(abs(n.x) + abs(n.y) + abs(n.z), TINY);
    precise vec2 p = n.xy / length1;
    precise vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    if (n.z < 0.0)
        p = folded;
    precise vec2 stored = p * 0.5 + 0.5;
    return stored;
}
#endif

void main()
{
    bool front = gl_FrontFacing != flipped;
    if (cull_back && !front)
        discard;
#ifdef TRANSPARENT
    if (is_peeled_or_hidden())
        discard;
#endif
    precise vec4 base = base_color;
    precise vec3 surface = material;
#ifdef TEXTURED
    if (base_color_sampler.x != 0)
        base *= sample_texture(base_color_texture, base_color_sampler);
    if (metallic_roughness_sampler.x != 0)
        surface.xy *= sample_texture(metallic_roughness_texture, metallic_roughness_sampler).gb;
    if (base.a < alpha_cutoff)
        discard;
#endif
    precise float length2 = max(dot(v_normal, v_normal), TINY);
    precise vec3 normal = v_normal * inversesqrt(length2);
#ifdef FACED
    if (!front)
        normal = -normal;
#endif
#ifdef OCTAHEDRAL
    out_normal = vec4(encode_octahedral(normal), 0.0, 0.0);
#else
    out_normal = vec4(normal, 0.0);
#endif
#ifdef OUT_POSITION
    out_position = vec4(v_position, 1.0);
#endif
#ifdef TRANSPARENT
    out_diffuse = base;
#else
    out_diffuse = vec4(base.rgb, 1.0);
#endif
    out_material = vec4(surface, 1.0);
}
