// The painter's geometry pass: a shaded fragment, premultiplied, to be blended over what is there.
// Behind surface.glsl, peel_test.glsl and shade.glsl.
//
// ACCUM_8   the accumulation buffer has 8 bits a channel

layout(location = 0) out vec4 source;

void main()
{
    if (is_culled() || is_peeled_or_hidden())
        discard;
    Surface surface = surface_at();
    if (surface.base.a <= ALPHA_TEST)
        discard;
    source = shade(surface.normal, v_position, surface.base, surface.material);
#ifdef ACCUM_8
    // What the store does anyway; without AVX, llvmpipe turns 2^31/255 and more into 0.
    source = clamp(source, 0.0, 1.0);
#endif
}
