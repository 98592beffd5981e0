// Geometry pass: one fragment into the G-buffer. Behind surface.glsl, octahedral.glsl and, for
// transparent lists, peel_test.glsl.
//
// OUT_NORMAL …   draw buffers; no OUT_POSITION where positions are not stored
// OCTAHEDRAL     normals are stored in two channels
// TRANSPARENT    compare with the opaque depth and earlier peels

layout(location = OUT_NORMAL) out vec4 out_normal;
#ifdef OUT_POSITION
layout(location = OUT_POSITION) out vec4 out_position;
#endif
layout(location = OUT_DIFFUSE) out vec4 out_diffuse;
layout(location = OUT_MATERIAL) out vec4 out_material;

void main()
{
    if (is_culled())
        discard;
#ifdef TRANSPARENT
    if (is_peeled_or_hidden())
        discard;
#endif
    Surface surface = surface_at();
#ifdef OCTAHEDRAL
    out_normal = vec4(encode_octahedral(surface.normal), 0.0, 0.0);
#else
    out_normal = vec4(surface.normal, 0.0);
#endif
#ifdef OUT_POSITION
    out_position = vec4(v_position, 1.0);
#endif
#ifdef TRANSPARENT
    out_diffuse = surface.base;
#else
    out_diffuse = vec4(surface.base.rgb, 1.0);
#endif
    out_material = vec4(surface.material, 1.0);
}
