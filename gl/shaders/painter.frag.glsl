// The painter's geometry pass: a shaded fragment, premultiplied, to be blended over what is there.
// Behind surface.glsl, peel_test.glsl and shade.glsl.
//
// ACCUM_CLAMP(c)   clamps a colour where the accumulation has 8 bits a channel

layout(location = 0) out vec4 source;

void main()
{
    if (is_culled() || is_peeled_or_hidden())
        discard;
    Surface surface = surface_at();
    if (surface.base.a <= ALPHA_TEST)
        discard;
    source = ACCUM_CLAMP(shade(surface.normal, v_position, surface.base, surface.material));
}
