/* What the camera makes of a scene: the floats that all three renderers share.
 *
 * Matrices are computed in double and rounded to float once; lights are brought to view space the
 * same way. Draws are in scene order; primitive ids count triangles through all draws, so a
 * smaller id is earlier in the scene whatever list a draw is in. */
#ifndef PEEL_FRAME_VIEW_H
#define PEEL_FRAME_VIEW_H

#include "frame/render_desc.h"
#include "scene/scene.h"

typedef struct Draw {
    uint32_t instance, mesh, material;
    uint32_t first_primitive; /* id of its first triangle */
    bool transparent;         /* alpha mode BLEND */
    bool flipped;             /* the matrix mirrors: front and back change places */
    bool cull_back;           /* back faces are discarded */
    bool masked;              /* fragments are discarded by the alpha of a texture */
    float model_view[16];     /* column-major; last row 0 0 0 1 */
    float normal_matrix[9];   /* column-major inverse transpose of model_view's 3×3, by a power of
                               * two:   largest element in [0.5, 1) */
} Draw;

typedef struct ViewLight {
    float position[3]; /* view space */
    float color[3];
    float attenuation[3];
    float inverse_range2; /* 1/range², at most 2e4; 0: without end */
} ViewLight;

/* Position from depth: see frame/shading.h. */
typedef struct Unprojection {
    float depth_scale, depth_offset, inverse_far;
    float ray_scale[2], ray_offset[2];
} Unprojection;

typedef struct View {
    int width, height;
    DepthRange depth_range;    /* which clip space projection leads to */
    float world_to_camera[16]; /* column-major, as projection; no renderer needs it */
    float projection[16];
    Unprojection unprojection;
    size_t draw_count;
    Draw *draws;             /* invisible instances (masked away, alpha < 1e-4) left out */
    size_t light_count;      /* those that can light anything, or with desc->model_all all */
    size_t dark_light_count; /* left out: black, or unused by Phong */
    ViewLight *lights;
    /* No light is further from the eye; 0 where that is not known, beyond 2^47, or a light is not
     * what scene_validate wants, so that shading it may overflow. */
    float light_reach;
    bool ranged; /* some light has a range */
    float ambient[3], background[3];
} View;

/* Draw.normal_matrix of a matrix that takes a mesh to view space. */
void view_normal_matrix(const Matrix *model_view, float out[9]);

/* Fails with BAD_INPUT when desc is out of range (render_desc_check) or names no camera of the
 * scene. */
Result view_build(const Scene *scene, const RenderDesc *desc, View *out);
void view_free(View *view);

#endif
