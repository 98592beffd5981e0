// One triangle that covers the viewport, at the depth that buffers are cleared to: for passes that
// are depth-tested against a layer.
//
// REVERSED         depth 0 is far

void main()
{
    vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
#ifdef REVERSED
    float far = 0.0;
#else
    float far = 1.0;
#endif
    gl_Position = vec4(corner * 2.0 - 1.0, far, 1.0);
}
