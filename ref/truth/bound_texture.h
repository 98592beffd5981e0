/* A texture's sample and a material's values where uv is not certain. */
#ifndef PEEL_REF_TRUTH_BOUND_TEXTURE_H
#define PEEL_REF_TRUTH_BOUND_TEXTURE_H

#include "ref/truth/bounded.h"
#include "ref/truth/radiance_bound.h"
#include "scene/scene.h"

/* value is texture_lookup's. Where uv's error reaches the border of a nearest texel, the greatest
 * difference of the texels concerned; where it spans more than a texel, the whole range [0, 1]. */
void bound_texture(const Texture *texture, const Bounded uv[2], Bounded rgba[4]);

/* diffuse with its alpha, roughness, metallic and occlusion of surface. textures: the scene's. */
void bound_material(const Texture *textures, const Material *material, const Bounded uv[2],
                    BoundedSurface *surface);

#endif
