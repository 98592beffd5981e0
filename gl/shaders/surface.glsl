// What a fragment's surface is: normal, base colour and material, from varyings, uniforms and
// textures. Discards what culling and the alpha mask leave out.
//
// TEXTURED             some textures are fetched: BASE_COLOR_TEXTURE, MATERIAL_TEXTURE
// MASKED               some materials have an alpha mask
// CULLED               back faces of some materials are culled
// FACED                normals are turned to the viewer
// HALF_TARGET          some target stores half floats

layout(location = 0) in vec3 v_position;
layout(location = 1) in vec3 v_normal;
#ifdef TEXTURED
layout(location = 2) in vec2 v_uv;
#endif

layout(location = 3) uniform vec4 base_color;
layout(location = 4) uniform vec3 material;   // roughness, metallic, occlusion
#ifdef CULLED
layout(location = 5) uniform bool cull_back;
#endif
layout(location = 6) uniform bool flipped;    // the model matrix mirrors
#ifdef TEXTURED
// 1 where there is a texture; wrap of s and t: 0 repeat, 1 clamp, 2 mirror; 1 for nearest.
#ifdef BASE_COLOR_TEXTURE
layout(location = 7) uniform ivec4 base_color_sampler;
layout(binding = 2) uniform sampler2D base_color_texture;
#endif
#ifdef MATERIAL_TEXTURE
layout(location = 8) uniform ivec4 metallic_roughness_sampler;
layout(binding = 3) uniform sampler2D metallic_roughness_texture;
#endif

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

#ifdef MASKED
layout(location = 9) uniform float alpha_cutoff; // 0 unless masked
#endif

struct Surface {
    vec3 normal;   // view space
    vec4 base;     // with the material's alpha, blended or not
    vec3 material; // roughness, metallic, occlusion
};

bool is_front()
{
    return gl_FrontFacing != flipped;
}

bool is_culled()
{
#ifdef CULLED
    return cull_back && !is_front();
#elif defined(HALF_TARGET)
    // Never. But without a discard Mesa 22.3 skips the store of 4x4 pixels that the depth test
    // hides, and behind it the way back to flushing denormals, for the rest of its thread's life.
    return gl_FragCoord.x < 0.0;
#else
    return false;
#endif
}

Surface surface_at()
{
    Surface surface;
    precise vec4 base = base_color;
    precise vec3 factors = material;
#ifdef BASE_COLOR_TEXTURE
    if (base_color_sampler.x != 0)
        base *= sample_texture(base_color_texture, base_color_sampler);
#endif
#ifdef MATERIAL_TEXTURE
    if (metallic_roughness_sampler.x != 0)
        factors.xy *= sample_texture(metallic_roughness_texture, metallic_roughness_sampler).gb;
#endif
#ifdef MASKED
    if (base.a < alpha_cutoff)
        discard;
#endif
    precise float length2 = max(dot(v_normal, v_normal), TINY);
    precise vec3 normal = v_normal * inversesqrt(length2);
#ifdef FACED
    if (!is_front())
        normal = -normal;
#endif
    surface.normal = normal;
    surface.base = base;
    surface.material = factors;
    return surface;
}
