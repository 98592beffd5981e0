/* glTF 2.0 in (through Assimp) and out (our own writer). */
#ifndef PEEL_SCENE_GLTF_H
#define PEEL_SCENE_GLTF_H

#include "scene/scene.h"

/* Loads a .gltf or .glb file (by extension, then by content). Geometry is unaltered: triangles,
 * strips and fans become triangles in the file's order; vertices that nothing uses are left out;
 * primitives made of the same accessors share one mesh. Missing normals are made flat, as glTF
 * demands. World matrices are products of the nodes' matrices in double, from the root down. A
 * scene without cameras gets a framing camera, one without point lights the default lights. What
 * the file has and Peel does not model is named in one warning.
 *
 * Textures of base colour and of metallic and roughness, PNG or JPEG, are decoded to linear texels
 * (scene/texture.h): one for every image, sampler and encoding that drawn materials use, at most
 * 2^28 texels in all. Mesh.uv is the set that the base-colour texture names (without one, the
 * metallic-roughness texture; without textures, TEXCOORD_0), floats with the file's bits. A
 * metallic-roughness texture on another set is left out.
 *
 * Point lights have the colour, intensity and range of KHR_lights_punctual.
 *
 * Beyond glTF, extras of nodes:
 *   "attenuation": [c, l, q]        on a light's node; without it (0, 0, 1), as the extension says
 *   "ambient": [r, g, b]            on any node; 0.25 without
 *   "background": [r, g, b]         on any node; 0 without
 *   "light_degrees_per_second": d   on any node; 0 without
 * Occlusion is 1: glTF has it only as a texture.
 *
 * Fails with BAD_INPUT, IO, NO_MEMORY or UNSUPPORTED and a one-line message that begins with path;
 * *out is then empty. */
Result gltf_load(const char *path, Scene *out);

/* The same. Once the document is known to be well-formed, and before anything is made of it, file
 * is told its path and bytes and those of every file that it names; what fails there fails the
 * load. */
typedef Result (*GltfFile)(void *context, const char *path, uint64_t bytes);
Result gltf_load_files(const char *path, GltfFile file, void *context, Scene *out);

/* Writes .gltf (buffers embedded) or .glb by the extension, to a temporary name, then renames. All
 * numbers keep their bits; loading gives the same floats, and matrices rounded to float. The extras
 * above are written. Textures are embedded as PNG of 8 bits: texels that come from 8 bits keep
 * their bits, others are rounded with a warning. Dropped: occlusion other than 1 (with a warning),
 * meshes without an instance, textures without a material, the cutoff of materials that are not
 * MASK. BAD_INPUT, IO, NO_MEMORY or UNSUPPORTED (2 GiB of geometry and images, 2^28 texels in one
 * texture, or more). */
Result gltf_write(const Scene *scene, const char *path);

#endif
