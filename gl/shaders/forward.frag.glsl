// Geometry pass that shades: the lit, premultiplied colour. Behind surface.glsl, shade.glsl and, for
// transparent lists, peel_test.glsl.
//
// OUT_DIFFUSE    draw buffer of the colour
// OUT_MATERIAL   draw buffer of the material, where there is one
// CLAMP_COLOR    the colour is stored in 8 bits a channel
// TRANSPARENT    compare with the opaque depth and earlier peels

layout(location = OUT_DIFFUSE) out vec4 out_color;
#ifdef OUT_MATERIAL
layout(location = OUT_MATERIAL) out vec4 out_material;
#endif

void main()
{
    if (is_culled())
        discard;
#ifdef TRANSPARENT
    if (is_peeled_or_hidden())
        discard;
#endif
    Surface surface = surface_at();
    vec4 base = surface.base;
#ifndef TRANSPARENT
    base.a = 1.0;
#endif
    out_color = vec4(0.0, 0.0, 0.0, base.a);
    if (base.a > ALPHA_TEST)
        out_color = shade(surface.normal, v_position, base, surface.material);
#ifdef CLAMP_COLOR
    // What the store does anyway; without AVX, llvmpipe turns 2^31/255 and more into 0.
    out_color = clamp(out_color, 0.0, 1.0);
#endif
#ifdef OUT_MATERIAL
    out_material = vec4(surface.material, 1.0);
#endif
}
