// Half of the viewport, at the clip-space depths that fuses.c gives as DEPTHS.

void main()
{
    const vec2 corners[3] = vec2[3](vec2(1.0, -1.0), vec2(-1.0, -1.0), vec2(-1.0, 1.0));
    const float depths[3] = DEPTHS;
    gl_Position = vec4(corners[gl_VertexID], depths[gl_VertexID], 1.0);
}
