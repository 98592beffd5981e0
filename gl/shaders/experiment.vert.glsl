// Experiments: corners of triangles from the operand textures, a triangle over the whole viewport,
// or a point a texel.
//
// TRIANGLES     corners 3·i … are texels 3·i …: clip position in a, varyings in b
// VERTEX_STAGE  one point a texel; BODY is done here

layout(binding = 0) uniform sampler2D a_texture;
layout(binding = 1) uniform sampler2D b_texture;

#ifdef TRIANGLES
layout(location = 0) flat out int v_triangle;
layout(location = 1) out vec3 v_varying;
#endif
#ifdef VERTEX_STAGE
#define PIXEL vec2(0.0)
layout(location = 0) flat out vec4 v_result;

vec4 perform(vec4 a, vec4 b)
{
    precise vec4 r;
    BODY
    return r;
}
#endif

void main()
{
#if defined(TRIANGLES) || defined(VERTEX_STAGE)
    ivec2 size = textureSize(a_texture, 0);
    ivec2 at = ivec2(gl_VertexID % size.x, gl_VertexID / size.x);
    vec4 a = texelFetch(a_texture, at, 0), b = texelFetch(b_texture, at, 0);
#endif
#if defined(TRIANGLES)
    gl_Position = a;
    v_varying = b.xyz;
    v_triangle = gl_VertexID / 3 + 1;
#elif defined(VERTEX_STAGE)
    gl_Position = vec4((vec2(at) * 2.0 + 1.0) / vec2(size) - 1.0, 0.0, 1.0);
    v_result = perform(a, b);
#else
    vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
#endif
}
