// The outputs of a geometry pass: a surface into the G-buffer. Behind surface.glsl and
// octahedral.glsl.
//
// OUT_NORMAL …   draw buffers; no OUT_POSITION where positions are not stored
// OCTAHEDRAL     normals are stored in two channels

layout(location = OUT_NORMAL) out vec4 out_normal;
#ifdef OUT_POSITION
layout(location = OUT_POSITION) out vec4 out_position;
#endif
layout(location = OUT_DIFFUSE) out vec4 out_diffuse;
layout(location = OUT_MATERIAL) out vec4 out_material;

void write_surface(Surface surface, float alpha)
{
#ifdef OCTAHEDRAL
    out_normal = vec4(encode_octahedral(surface.normal), 0.0, 0.0);
#else
    out_normal = vec4(surface.normal, 0.0);
#endif
#ifdef OUT_POSITION
    out_position = vec4(v_position, 1.0);
#endif
    out_diffuse = vec4(surface.base.rgb, alpha);
    out_material = vec4(surface.material, 1.0);
}
