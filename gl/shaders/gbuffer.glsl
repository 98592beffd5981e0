// The outputs of a geometry pass: a surface into the G-buffer. Behind surface.glsl and
// octahedral.glsl.
//
// OUT_NORMAL …   draw buffers, but of what is not stored; diffuse always is
// OCTAHEDRAL     normals are stored in two channels

#ifdef OUT_NORMAL
layout(location = OUT_NORMAL) out vec4 out_normal;
#endif
#ifdef OUT_POSITION
layout(location = OUT_POSITION) out vec4 out_position;
#endif
layout(location = OUT_DIFFUSE) out vec4 out_diffuse;
#ifdef OUT_MATERIAL
layout(location = OUT_MATERIAL) out vec4 out_material;
#endif

void write_surface(Surface surface, float alpha)
{
#if defined(OUT_NORMAL) && defined(OCTAHEDRAL)
    out_normal = vec4(encode_octahedral(surface.normal), 0.0, 0.0);
#elif defined(OUT_NORMAL)
    out_normal = vec4(surface.normal, 0.0);
#endif
#ifdef OUT_POSITION
    out_position = vec4(v_position, 1.0);
#endif
    out_diffuse = vec4(surface.base.rgb, alpha);
#ifdef OUT_MATERIAL
    out_material = vec4(surface.material, 1.0);
#endif
}
