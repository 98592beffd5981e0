// Full-screen pass of a forward method: a stored colour, premultiplied, to be blended.
//
// ACCUM_CLAMP(c)   clamps a colour where the accumulation has 8 bits a channel

layout(binding = 2) uniform sampler2D color_buffer;

layout(location = 0) out vec4 source;

void main()
{
    source = texelFetch(color_buffer, ivec2(gl_FragCoord.xy), 0);
    if (source.a <= ALPHA_TEST)
        discard;
    source = ACCUM_CLAMP(source);
}
