// The light that a surface sends to the eye, premultiplied. The formula and its order of
// operations: frame/shading.h.
//
// PHONG            one directional light instead
// LIGHT_COUNT      number of lights
// LIGHTS_STORAGE   they do not fit a uniform block
// LIGHT_RANGES     some of them reach only so far
// GGX_STABLE       the distribution without cancellation
// BACK_LIGHT       lights behind the surface add their specular lobe

layout(location = 16) uniform vec3 ambient;

#if LIGHT_COUNT > 0
struct Light {
    vec4 position; // view space
    vec4 color;
    vec4 attenuation; // constant, linear, quadratic; 1/range²
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

#ifdef PHONG
vec4 shade(vec3 N, vec3 P, vec4 diffuse_alpha, vec3 material)
{
    const vec3 L = vec3(PHONG_LIGHT_X, PHONG_LIGHT_Y, PHONG_LIGHT_Z);
    precise float NL = dot(N, L);
    precise float reflected_z = 2.0 * NL * N.z - L.z;
    precise float x = max(reflected_z, 0.0);
    precise float x2 = x * x;
    precise float x4 = x2 * x2;
    precise float x8 = x4 * x4;
    precise float x20 = x8 * x8 * x4;
    precise vec3 I = vec3(PHONG_AMBIENT_R, PHONG_AMBIENT_GB, PHONG_AMBIENT_GB);
    precise vec3 color = I + max(NL, 0.0) * diffuse_alpha.rgb + x20;
    precise vec3 premultiplied = color * diffuse_alpha.a;
    return vec4(premultiplied, diffuse_alpha.a);
}
#else
// N: normal, P: position in view space; material: roughness, metallic, occlusion.
vec4 shade(vec3 N, vec3 P, vec4 diffuse_alpha, vec3 material)
{
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
#ifdef LIGHT_RANGES
        precise float q = min(d2 * lights[i].attenuation.w, 1.0);
        att = att * (1.0 - q * q);
#endif
        precise vec3 radiance = lights[i].color.rgb * att * NL;
        sum = sum + ((1.0 - F) * direct + F * s) * radiance;
    }
#endif
    precise vec3 color = sum + ambient * diffuse * material.z;
    precise vec3 premultiplied = color * diffuse_alpha.a;
    return vec4(premultiplied, diffuse_alpha.a);
}
#endif
