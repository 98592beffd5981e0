// Geometry pass: object space to clip space, position and normal in view space.
// TEXTURED   the scene has textures
//
// `precise` on every value keeps the order of operations of frame/shading.h.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;

#ifdef TEXTURED
layout(location = 2) in vec2 uv;
#endif

layout(location = 0) uniform mat4 model_view;
layout(location = 1) uniform mat3 normal_matrix;
layout(location = 2) uniform mat4 projection;

layout(location = 0) out vec3 v_position;
layout(location = 1) out vec3 v_normal;
#ifdef TEXTURED
layout(location = 2) out vec2 v_uv;
#endif

void main()
{
    precise vec4 view = model_view * vec4(position, 1.0);
    precise vec4 clip = projection * vec4(view.xyz, 1.0);
    precise vec3 turned = normal_matrix * normal;
    gl_Position = clip;
    v_position = view.xyz;
    v_normal = turned;
#ifdef TEXTURED
    v_uv = uv;
#endif
}
