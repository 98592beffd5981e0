/* The shaders of foreign.c. The lighting formula is not here: shade.glsl of the contract goes
 * before surface_text. MISTAKE_...: see there. */
#ifndef FOREIGN_SHADERS_H
#define FOREIGN_SHADERS_H

static const char *vertex_text =
    "#version 450 core\n"
    "layout(location = 0) in vec3 position;\nlayout(location = 1) in vec3 normal;\n"
    "layout(location = 0) uniform mat4 model_view;\nlayout(location = 1) uniform mat3 turn;\n"
    "layout(location = 2) uniform mat4 projection;\n"
    "layout(location = 0) out vec3 P;\nlayout(location = 1) out vec3 N;\n"
    "void main() {\n"
    "    precise vec4 view = model_view * vec4(position, 1.0);\n"
    "    precise vec4 clip = projection * vec4(view.xyz, 1.0);\n"
    "    precise vec3 turned = turn * normal;\n"
    "    gl_Position = clip;\n    P = view.xyz;\n    N = turned;\n}\n";
static const char *surface_text =
    "layout(location = 0) in vec3 P;\nlayout(location = 1) in vec3 N;\n"
    "layout(location = 3) uniform vec4 base;\nlayout(location = 4) uniform vec3 material;\n"
    "layout(location = 5) uniform ivec2 facing;\nlayout(location = 6) uniform int peel;\n"
    "layout(binding = 0) uniform sampler2D opaque;\nlayout(binding = 1) uniform sampler2D last;\n"
    "layout(location = 0) out vec4 color;\n"
    "void main() {\n"
    "    float z = gl_FragCoord.z;\n"
    "    ivec2 at = ivec2(gl_FragCoord.xy);\n"
#ifndef MISTAKE_OPAQUE_DEPTH_IGNORED
    "    if (peel >= 0 && z >= texelFetch(opaque, at, 0).r) discard;\n"
#endif
    "    if (peel > 0 && z <= texelFetch(last, at, 0).r) discard;\n"
    "    bool front = gl_FrontFacing != (facing.x != 0);\n"
    "    if (facing.y != 0 && !front) discard;\n"
    "    precise vec3 n = N * inversesqrt(max(dot(N, N), TINY));\n"
    "    color = shade(front ? n : -n, P, base, material);\n"
#ifdef MISTAKE_NOT_PREMULTIPLIED
    "    color.rgb /= base.a;\n"
#endif
    "}\n";
static const char *screen_text =
    "#version 450 core\n"
    "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0, 1); "
    "}\n";
static const char *layer_text = "#version 450 core\nlayout(binding = 0) uniform sampler2D layer;\n"
                                "layout(location = 0) out vec4 color;\n"
                                "void main() {\n"
                                "    color = texelFetch(layer, ivec2(gl_FragCoord.xy), 0);\n"
                                "    if (color.a <= 1e-4) discard;\n}\n";
static const char *display_text =
    "#version 450 core\nlayout(binding = 0) uniform sampler2D accum;\n"
    "layout(location = 0) uniform vec3 background;\nlayout(location = 0) out vec4 color;\n"
    "void main() {\n"
    "    vec4 c = texelFetch(accum, ivec2(gl_FragCoord.xy), 0);\n"
#ifndef MISTAKE_BACKGROUND_FORGOTTEN
    "    c.rgb += background * c.a;\n"
#endif
    "    color = vec4(pow(c.rgb / (c.rgb + 1.0), vec3(1.0 / 2.2)), 1.0);\n}\n";

#endif
