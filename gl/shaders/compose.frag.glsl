// Full-screen pass of a forward method: a stored colour, premultiplied, to be blended.
//
// ACCUM_8   the accumulation buffer has 8 bits a channel

layout(binding = 2) uniform sampler2D color_buffer;

layout(location = 0) out vec4 source;

void main()
{
    source = texelFetch(color_buffer, ivec2(gl_FragCoord.xy), 0);
    if (source.a <= ALPHA_TEST)
        discard;
#ifdef ACCUM_8
    // What the store does anyway; without AVX, llvmpipe turns 2^31/255 and more into 0.
    source = clamp(source, 0.0, 1.0);
#endif
}
