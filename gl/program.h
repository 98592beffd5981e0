/* Shader programs: the embedded sources behind a common prelude of constants and switches. */
#ifndef PEEL_GL_PROGRAM_H
#define PEEL_GL_PROGRAM_H

#include "api.h"

enum {
    PROGRAM_PARTS = 8,
    PROGRAM_CONSTANTS = 768
};

/* Embedded from shaders/; static, NUL-terminated. */
extern const char shader_geometry_vert[];
extern const char shader_geometry_frag[];
extern const char shader_surface[];
extern const char shader_peel_test[];
extern const char shader_octahedral[];
extern const char shader_gbuffer[];
extern const char shader_shade[];
extern const char shader_forward_frag[];
extern const char shader_compose_frag[];
extern const char shader_unproject[];
extern const char shader_fullscreen_vert[];
extern const char shader_lighting_frag[];
extern const char shader_resolve_frag[];
extern const char shader_peel_id_frag[];
extern const char shader_linked_list_frag[];
extern const char shader_minmax[];
extern const char shader_minmax_frag[];
extern const char shader_dual_frag[];
extern const char shader_forward_dual_frag[];
extern const char shader_weighted_average_frag[];
extern const char shader_weighted_sum_frag[];
extern const char shader_weighted_blended_frag[];
extern const char shader_painter_frag[];
extern const char shader_fuses_vert[];
extern const char shader_fuses_frag[];
extern const char shader_experiment_vert[];
extern const char shader_experiment_frag[];

/* The constants of frame/shading.h as lines of "#define ...\n". */
void program_constants(char out[PROGRAM_CONSTANTS]);

/* Compiles and links the vertex source and the fragment sources, at most PROGRAM_PARTS, each stage
 * behind "#version 450 core", the constants of frame/shading.h and `defines` (lines of "#define
 * ...\n", "" for none). name is for messages. NO_GL with the compiler's text on failure, and *out
 * is 0. The caller deletes the program. */
Result program_build(const char *name, const char *defines, const char *vertex,
                     const char *const *fragment, int parts, GLuint *out);

#endif
