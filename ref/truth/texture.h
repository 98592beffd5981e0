/* Textures in double precision: frame/shading.h's sampling function, and a material at one point
 * of a surface.
 *
 * Level 0 only: no mip levels, no derivatives. The function jumps at the borders of nearest texels,
 * so there the last bit of uv decides; everywhere else it is continuous. */
#ifndef PEEL_REF_TRUTH_TEXTURE_H
#define PEEL_REF_TRUTH_TEXTURE_H

#include "scene/scene.h"

/* A material's factors times the samples of its textures. */
typedef struct MaterialSample {
    double base_color[4];
    double roughness, metallic, occlusion;
} MaterialSample;

/* The texture at uv, v down; linear RGBA in [0, 1]. uv may be any number, infinite or none. */
void texture_lookup(const Texture *texture, const double uv[2], double rgba[4]);

/* textures: the scene's; not read where the material has none. */
void texture_material(const Texture *textures, const Material *material, const double uv[2],
                      MaterialSample *out);

#endif
