// Position from depth: frame/shading.h.

layout(location = 17) uniform vec3 depth_to_z; // scale and offset to 1/z, least 1/z
layout(location = 18) uniform vec4 ray;        // scale, offset of x and y

vec3 unproject(ivec2 pixel, float depth)
{
    precise float inverse_z = max(depth * depth_to_z.x + depth_to_z.y, depth_to_z.z);
    precise float z = 1.0 / inverse_z;
    precise vec2 position = (vec2(pixel) * ray.xy + ray.zw) * z;
    return vec3(position, -z);
}
