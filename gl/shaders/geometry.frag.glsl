// Geometry pass: one fragment into the G-buffer. Behind surface.glsl, octahedral.glsl, gbuffer.glsl
// and, for transparent lists, peel_test.glsl.
//
// TRANSPARENT    compare with the opaque depth and earlier peels

void main()
{
    if (is_culled())
        discard;
#ifdef TRANSPARENT
    if (is_peeled_or_hidden())
        discard;
#endif
    Surface surface = surface_at();
#ifdef TRANSPARENT
    write_surface(surface, surface.base.a);
#else
    write_surface(surface, 1.0);
#endif
}
