// Lighting pass: shades one stored fragment; the result is premultiplied and blended.
// The formula and its order of operations: frame/shading.h.
//
// LIGHT_COUNT      number of lights
// OCTAHEDRAL       normals are stored in two channels
// RECONSTRUCT      the position follows from the stored depth
// LIGHTS_STORAGE   they do not fit a uniform block
// GGX_STABLE       the distribution without cancellation
// BACK_LIGHT       lights behind the surface add their specular lobe
// ACCUM_8          the accumulation buffer has 8 bits a channel

layout(binding = 0) uniform sampler2D normal_buffer;
#ifdef RECONSTRUCT
layout(binding = 1) uniform sampler2D depth_buffer;
#else
layout(binding = 1) uniform sampler2D position_buffer;
#endif
layout(binding = 2) uniform sampler2D diffuse_buffer;
layout(binding = 3) uniform sampler2D material_buffer;

layout(location = 0) uniform vec3 ambient;
#ifdef RECONSTRUCT
layout(location = 1) uniform vec3 depth_to_z; // scale and offset to 1/z, least 1/z
layout(location = 2) uniform vec4 ray;        // scale, offset of x and y
#endif

layout(location = 0) out vec4 source;

#if LIGHT_COUNT > 0
struct Light {
    vec4 position; // view space
    vec4 color;
    vec4 attenuation; // constant, linear, quadratic
};
#ifdef LIGHTS_STORAGE
layout(std430, binding = 0) readonly buffer Lights
#else
layout(std140, binding = 0) uniform Lights
#endif
{
    Light lights[LIGHT_COUNT];
};
#endif

#ifdef OCTAHEDRAL
vec3 fetch_normal(ivec2 pixel)
{
    precise vec2 p = texelFetch(normal_buffer, pixel, 0).xy * 2.0 - 1.0;
    precise float z = 1.0 - abs(p.x) - abs(p.y);
    precise vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    if (z < 0.0)
        p = folded;
    precise vec3 v = vec3(p, z);
    precise float length2 = max(dot(v, v), TINY);
    precise vec3 normal = v * inversesqrt(length2);
    return normal;
}
#else
vec3 fetch_normal(ivec2 pixel)
{
    return texelFetch(normal_buffer, pixel, 0).xyz;
}
#endif

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
    vec3 N = fetch_normal(pixel);
    vec3 P = fetch_position(pixel);
    vec3 material = texelFetch(material_buffer, pixel, 0).xyz;
    vec3 diffuse = diffuse_alpha.rgb;
    float metallic = material.y;

    precise float position2 = max(dot(P, P), TINY);
    precise vec3 V = (-P) * inversesqrt(position2);
    precise float r = min(max(material.x, ROUGHNESS_MIN), 1.0);
    precise float a = r * r;
    precise float a2 = a * a;
    precise float am = a2 - 1.0;
    precise float k1 = r + 1.0;
    precise float k = k1 * k1 * 0.125;
    precise float km = 1.0 - k;
    precise float NV = max(dot(N, V), 0.0);
    precise float GV = NV / (NV * km + k);
    precise float NV4 = 4.0 * NV;
    precise vec3 F0 = mix(vec3(0.04), diffuse, vec3(metallic));
    precise vec3 Fm = 1.0 - F0;
    precise vec3 lambert = diffuse * (1.0 - metallic) / PI;
    precise vec3 sum = vec3(0.0);
#if LIGHT_COUNT > 0
    for (int i = 0; i < LIGHT_COUNT; i++) {
        vec3 attenuation = lights[i].attenuation.xyz;
        precise vec3 D = lights[i].position.xyz - P;
        precise float d2 = max(dot(D, D), DISTANCE2_MIN);
        precise float d = sqrt(d2);
        precise vec3 L = D * (1.0 / d);
        precise float u = dot(N, L);
#ifdef BACK_LIGHT
        precise float m = max(-u, 0.0);
        L = L + 2.0 * m * N;
        precise float NL = max(u, m);
        precise vec3 direct = u < 0.0 ? vec3(0.0) : lambert;
#else
        precise float NL = max(u, 0.0);
        precise vec3 direct = lambert;
#endif
        precise vec3 h = V + L;
        precise float h2 = max(dot(h, h), TINY);
        precise vec3 H = h * inversesqrt(h2);
        precise float NH = max(dot(N, H), 0.0);
        precise float HV = max(dot(H, V), 0.0);
#ifdef GGX_STABLE
        precise vec3 S = cross(N, H);
        precise float S2 = dot(S, S);
        precise float den = max(NH * NH * a2 + S2, a2);
#else
        precise float den = NH * NH * am + 1.0;
#endif
        precise float dist = a2 / (PI * den * den);
        precise float GL = NL / (NL * km + k);
        precise float x = clamp(1.0 - HV, 0.0, 1.0);
        precise float x2 = x * x;
        precise float x5 = x2 * x2 * x;
        precise vec3 F = F0 + Fm * x5;
        precise float s = dist * (GV * GL) / (NV4 * NL + SPECULAR_BIAS);
        precise float att = 1.0 / (attenuation.x + attenuation.y * d + attenuation.z * d2);
        precise vec3 radiance = lights[i].color.rgb * att * NL;
        sum = sum + ((1.0 - F) * direct + F * s) * radiance;
    }
#endif
    precise vec3 color = sum + ambient * diffuse * material.z;
    precise vec3 premultiplied = color * diffuse_alpha.a;
    source = vec4(premultiplied, diffuse_alpha.a);
#ifdef ACCUM_8
    // What the store does anyway; without AVX, llvmpipe turns 2^31/255 and more into 0.
    source = clamp(source, 0.0, 1.0);
#endif
}
