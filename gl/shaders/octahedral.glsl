// Octahedral normals: frame/shading.h.

vec2 octahedral_fold(vec2 p)
{
    precise vec2 folded = (1.0 - abs(p.yx)) * vec2(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0);
    return folded;
}

vec2 encode_octahedral(vec3 n)
{
    precise float length1 = max(abs(n.x) + abs(n.y) + abs(n.z), TINY);
    precise vec2 p = n.xy / length1;
    if (n.z < 0.0)
        p = octahedral_fold(p);
    precise vec2 stored = p * 0.5 + 0.5;
    return stored;
}

vec3 decode_octahedral(vec2 stored)
{
    precise vec2 p = stored * 2.0 - 1.0;
    precise float z = 1.0 - abs(p.x) - abs(p.y);
    if (z < 0.0)
        p = octahedral_fold(p);
    precise vec3 v = vec3(p, z);
    precise float length2 = max(dot(v, v), TINY);
    precise vec3 normal = v * inversesqrt(length2);
    return normal;
}
