// Experiments: what one fragment gives.
//
// BODY         statements that set r from the operands a and b at this pixel
// VERTEX_STAGE the vertex stage has done that
// TRIANGLES    fragments of triangles, as LAYOUT says: 0 everything there is, 1 depth only,
//              2 four targets and a discard that never happens, 3 a count of 1
// WRITE_DEPTH  a.x is the depth

#if defined(TRIANGLES)

layout(location = 0) flat in int v_triangle;
layout(location = 1) in vec3 v_varying;

#if LAYOUT == 0
layout(location = 0) out vec4 out_where;
layout(location = 1) out vec4 out_varying;
void main()
{
    out_where = vec4(float(v_triangle), gl_FrontFacing ? 1.0 : 0.0, gl_FragCoord.zw);
    out_varying = vec4(v_varying, 0.0);
}
#elif LAYOUT == 1
void main()
{
}
#elif LAYOUT == 2
layout(location = 0) out vec4 out_targets[4];
void main()
{
    if (v_triangle < 0)
        discard;
    vec3 n = normalize(v_varying);
    out_targets[0] = vec4(n, 1.0);
    out_targets[1] = vec4(pow(abs(n), vec3(0.4)), gl_FragCoord.z);
    out_targets[2] = gl_FrontFacing ? gl_FragCoord : vec4(0.0);
    out_targets[3] = vec4(float(v_triangle));
}
#else
layout(location = 0) out vec4 out_count;
void main()
{
    out_count = vec4(1.0);
}
#endif

#else

layout(binding = 0) uniform sampler2D a_texture;
layout(binding = 1) uniform sampler2D b_texture;

#ifndef WRITE_DEPTH
layout(location = 0) out vec4 out_result;
#endif

#ifdef VERTEX_STAGE
layout(location = 0) flat in vec4 v_result;
#else
#define PIXEL gl_FragCoord.xy
vec4 perform(vec4 a, vec4 b)
{
    precise vec4 r;
    BODY
    return r;
}
#endif

void main()
{
#ifdef VERTEX_STAGE
    out_result = v_result;
#else
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 r = perform(texelFetch(a_texture, at, 0), texelFetch(b_texture, at, 0));
#ifdef WRITE_DEPTH
    gl_FragDepth = r.x;
#else
    out_result = r;
#endif
#endif
}
#endif
