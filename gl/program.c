#include "program.h"

#include "frame/shading.h"

#include <stdio.h>

/* Nine digits give back the same float. */
#define PRELUDE_FORMAT                                                                             \
    "#define TINY %.9g\n"                                                                          \
    "#define ALPHA_TEST %.9g\n"                                                                    \
    "#define ROUGHNESS_MIN %.9g\n"                                                                 \
    "#define DISTANCE2_MIN %.9g\n"                                                                 \
    "#define SPECULAR_BIAS %.9g\n"                                                                 \
    "#define EDGE_DOT %.9g\n"                                                                      \
    "#define EDGE_DEPTH %.9g\n"                                                                    \
    "#define PI %.9g\n"                                                                            \
    "#define PHONG_LIGHT_X %.9g\n"                                                                 \
    "#define PHONG_LIGHT_Y %.9g\n"                                                                 \
    "#define PHONG_LIGHT_Z %.9g\n"                                                                 \
    "#define PHONG_AMBIENT_R %.9g\n"                                                               \
    "#define PHONG_AMBIENT_GB %.9g\n"                                                              \
    "#define DISPLAY_POWER %.9g\n"

static Result compile(const char *name, GLenum stage, const char *prelude, const char *defines,
                      const char *const *sources, int count, GLuint *out)
{
    const char *parts[3 + 2 * PROGRAM_PARTS] = {"#version 450 core\n", prelude, defines};
    for (int i = 0; i < count; i++) {
        parts[3 + 2 * i] = "#line 1\n";
        parts[4 + 2 * i] = sources[i];
    }
    GLuint shader = gl.CreateShader(stage);
    gl.ShaderSource(shader, 3 + 2 * count, parts, NULL);
    gl.CompileShader(shader);
    GLint done = GL_FALSE;
    gl.GetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (!done) {
        char log[512] = "";
        gl.GetShaderInfoLog(shader, sizeof log, NULL, log);
        gl.DeleteShader(shader);
        return result_fail(RESULT_NO_GL, "OpenGL: the %s %s shader does not compile: %s", name,
                           stage == GL_VERTEX_SHADER ? "vertex" : "fragment", log);
    }
    *out = shader;
    return RESULT_OK;
}

static Result link(const char *name, GLuint vertex, GLuint fragment, GLuint *out)
{
    GLuint program = gl.CreateProgram();
    gl.AttachShader(program, vertex);
    gl.AttachShader(program, fragment);
    gl.LinkProgram(program);
    gl.DetachShader(program, vertex);
    gl.DetachShader(program, fragment);
    GLint done = GL_FALSE;
    gl.GetProgramiv(program, GL_LINK_STATUS, &done);
    if (!done) {
        char log[512] = "";
        gl.GetProgramInfoLog(program, sizeof log, NULL, log);
        gl.DeleteProgram(program);
        return result_fail(RESULT_NO_GL, "OpenGL: the %s program does not link: %s", name, log);
    }
    *out = program;
    return RESULT_OK;
}

void program_constants(char out[PROGRAM_CONSTANTS])
{
    snprintf(out, PROGRAM_CONSTANTS, PRELUDE_FORMAT, (double)SHADING_TINY,
             (double)SHADING_ALPHA_TEST, (double)SHADING_ROUGHNESS_MIN,
             (double)SHADING_DISTANCE2_MIN, (double)SHADING_SPECULAR_BIAS, (double)SHADING_EDGE_DOT,
             (double)SHADING_EDGE_DEPTH, (double)SHADING_PI, (double)SHADING_PHONG_LIGHT_X,
             (double)SHADING_PHONG_LIGHT_Y, (double)SHADING_PHONG_LIGHT_Z,
             (double)SHADING_PHONG_AMBIENT_R, (double)SHADING_PHONG_AMBIENT_GB,
             (double)SHADING_DISPLAY_POWER);
}

Result program_build(const char *name, const char *defines, const char *vertex,
                     const char *const *fragment, int parts, GLuint *out)
{
    *out = 0;
    char prelude[PROGRAM_CONSTANTS];
    program_constants(prelude);
    GLuint stages[2] = {0, 0};
    Result result = compile(name, GL_VERTEX_SHADER, prelude, defines, &vertex, 1, &stages[0]);
    if (result == RESULT_OK)
        result = compile(name, GL_FRAGMENT_SHADER, prelude, defines, fragment, parts, &stages[1]);
    if (result == RESULT_OK)
        result = link(name, stages[0], stages[1], out);
    gl.DeleteShader(stages[0]); /* 0 is ignored */
    gl.DeleteShader(stages[1]);
    return result;
}
