/* The scene: what is drawn, with what materials, under what lights, from what cameras.
 *
 * Everything is in the file's units. Right-handed, y up; counter-clockwise triangles face front.
 * Colours are linear. A Scene owns all its arrays; renderers only read it.
 * Source of the material and camera model: glTF 2.0. */
#ifndef PEEL_SCENE_SCENE_H
#define PEEL_SCENE_SCENE_H

#include "base/result.h"
#include "scene/matrix.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct Mesh {
    uint32_t vertex_count;
    uint32_t triangle_count;
    float *position; /* 3 per vertex, finite */
    float *normal;   /* 3 per vertex, as stored: not normalised here */
    float *uv;       /* 2 per vertex, v down as in glTF, within 1e15; NULL if the file has none */
    uint32_t *index; /* 3 per triangle, each < vertex_count */
} Mesh;

typedef enum TextureWrap {
    WRAP_REPEAT = 0,
    WRAP_CLAMP, /* to the edge */
    WRAP_MIRROR /* mirrored repeat */
} TextureWrap;

/* An image with its sampler: no mip levels. How it is sampled: frame/shading.h. */
typedef struct Texture {
    uint32_t width, height; /* 1 … TEXTURE_MAX_PIXELS */
    float *texels;          /* RGBA, linear, each in [0, 1]; row 0 is at v = 0 */
    TextureWrap wrap_s, wrap_t;
    bool nearest; /* else bilinear */
} Texture;

enum {
    TEXTURE_MAX_PIXELS = 16384
}; /* per side */

typedef enum AlphaMode {
    ALPHA_OPAQUE = 0,
    ALPHA_MASK,
    ALPHA_BLEND
} AlphaMode;

typedef struct Material {
    char *name;          /* "" if the file gives none */
    float base_color[4]; /* linear RGB in [0, 1], alpha in [0, 1]; not premultiplied */
    float roughness;     /* [0, 1] */
    float metallic;      /* [0, 1] */
    float occlusion;     /* [0, 1], 1 is unoccluded */
    AlphaMode alpha_mode;
    float alpha_cutoff; /* for ALPHA_MASK: below it a fragment is discarded */
    bool double_sided;
    /* 1 + index into the scene's textures, 0 for none. Multiplied with base_color; green with
     * roughness and blue with metallic. Without the mesh's uv they are sampled at (0, 0). */
    uint32_t base_color_texture, metallic_roughness_texture;
} Material;

typedef struct Instance {
    char *name;
    uint32_t mesh;
    uint32_t material;
    Matrix world; /* affine */
} Instance;

typedef struct Light {
    double position[3];   /* world space */
    float color[3];       /* radiant intensity, ≥ 0, finite */
    float attenuation[3]; /* constant, linear, quadratic: 1/(c + l·d + q·d²) */
    float range;          /* how far it reaches, > 0: times 1 − (d/range)⁴; 0: without end */
} Light;

typedef struct Camera {
    char *name;
    Matrix world;     /* camera to world; looks down −z with y up */
    double yfov;      /* vertical field of view, radians, in (0, π) */
    double near, far; /* 0 < near < far; far may be INFINITY */
} Camera;

typedef struct Scene {
    char *name; /* the file's name without folder and extension */
    size_t mesh_count, texture_count, material_count, instance_count, light_count, camera_count;
    Mesh *meshes;
    Texture *textures;
    Material *materials;
    Instance *instances; /* in the scene's draw order */
    Light *lights;
    Camera *cameras;
    float ambient[3];                /* light that reaches every surface; default 0.25 grey */
    float background[3];             /* linear; default 0 */
    double light_degrees_per_second; /* lights turn about the world's y axis; default 0 */
} Scene;

void scene_free(Scene *scene); /* frees what the scene owns and zeroes it */

uint64_t scene_triangle_count(const Scene *scene); /* over all instances */

/* Every rule stated above; BAD_INPUT names the first breach as "mesh 3: ...". Loaders and
 * generators end with it, so renderers need not check again. Also: names and arrays are present,
 * a mesh has a vertex and a triangle, nothing in world space lies beyond 1e15 from the origin, no
 * component of a normal beyond 1e15,
 * light is at most 1e12 and c + 0.01·l + 1e-4·q of its attenuation at least 1e-8 (so that single
 * precision cannot overflow), and there are fewer than 2^32 − 1 triangles over all instances.
 * Zero-area triangles and singular instance matrices are legal. NO_MEMORY is possible. */
Result scene_validate(const Scene *scene);
/* Of these, the rules of one material, light or camera, which messages call `number`; of ambient,
 * background, rotation and name. */
Result scene_validate_material(const Scene *scene, const Material *material, size_t number);
Result scene_validate_light(const Light *light, size_t number);
Result scene_validate_camera(const Camera *camera, size_t number);
Result scene_validate_surroundings(const Scene *scene);

/* Brings the axes of its world matrix, but those of length 0, to unit length: lights are at
 * distances in world units. Source: glTF 2.0, 3.10.1 (a camera knows no scale). */
void scene_unscale_camera(Camera *camera);

/* World-space bounding box of all instances. False when there is no vertex. */
bool scene_bounds(const Scene *scene, double low[3], double high[3]);

/* Makes every material's opacity, which the alpha of a texture multiplies, A in [0, 1]: BLEND below
 * 1, OPAQUE at 1 (a MASK material keeps its mode at 1 only). */
void scene_override_opacity(Scene *scene, float opacity);

/* A camera that sees the whole scene, from a little above and the side; vertical field of view
 * 45°, for images at least as wide as high. Appends it. */
Result scene_add_framing_camera(Scene *scene);
/* Three point lights around the scene: key, fill, rim, two to three of its radii away, without
 * falloff (attenuation 1, 0, 0). Appends them. */
Result scene_add_default_lights(Scene *scene);

#endif
