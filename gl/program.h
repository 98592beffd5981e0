/* Shader programs: the embedded sources behind a common prelude of constants and switches. */
#ifndef PEEL_GL_PROGRAM_H
#define PEEL_GL_PROGRAM_H

#include "api.h"

/* Embedded from shaders/; static, NUL-terminated. */
extern const char shader_geometry_vert[];
extern const char shader_geometry_frag[];
extern const char shader_fullscreen_vert[];
extern const char shader_lighting_frag[];
extern const char shader_resolve_frag[];
extern const char shader_fuses_vert[];
extern const char shader_fuses_frag[];
extern const char shader_experiment_vert[];
extern const char shader_experiment_frag[];

/* Compiles and links vertex and fragment source, each behind "#version 450 core", the constants
 * of frame/shading.h and `defines` (lines of "#define ...\n", "" for none). name is for messages.
 * NO_GL with the compiler's text on failure, and *out is 0. The caller deletes the program. */
Result program_build(const char *name, const char *defines, const char *vertex,
                     const char *fragment, GLuint *out);

#endif
