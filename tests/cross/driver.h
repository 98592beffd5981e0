/* What the tests against the driver share: a context, two operand textures of seeded inputs, and
 * programs that compute on them. A failing test prints operands that reproduce it.
 *
 * Loops over values abort on a difference instead of asserting each: check sends a message to its
 * parent process for every assertion. */
#ifndef PEEL_TESTS_DRIVER_H
#define PEEL_TESTS_DRIVER_H

#include "testing.h"

#include "base/random.h"
#include "gl/context.h"
#include "gl/gl_renderer.h"
#include "gl/program.h"
#include "number/op.h"

#include <math.h>
#include <stdio.h>

enum {
    WIDTH = 256,
    HEIGHT = 128,
    TEXELS = WIDTH * HEIGHT,
    VALUES = 4 * TEXELS
};

static Context *context;
static bool fused;
static GLuint operands[2]; /* RGBA32F textures, units 0 and 1 */
static float a[TEXELS][4], b[TEXELS][4], got[TEXELS][4];
static Random random_state;

static inline void driver_open(void)
{
    ck_assert_msg(context_open(0, &context) == RESULT_OK, "%s", result_message());
    gl.CreateTextures(GL_TEXTURE_2D, 2, operands);
    for (GLuint i = 0; i < 2; i++) {
        gl.TextureStorage2D(operands[i], 1, GL_RGBA32F, WIDTH, HEIGHT);
        gl.TextureParameteri(operands[i], GL_TEXTURE_MIN_FILTER, GL_NEAREST);
        gl.BindTextureUnit(i, operands[i]);
    }
    GLuint vertex_array;
    gl.CreateVertexArrays(1, &vertex_array);
    gl.BindVertexArray(vertex_array);
    gl.Viewport(0, 0, WIDTH, HEIGHT);
    random_state = random_seed(2024);
}

static inline void driver_close(void)
{
    ck_assert_msg(context_check(context, "test") == RESULT_OK, "%s", result_message());
    context_close(context);
}

/* The driver's mode, found before a context of this test is current. */
static inline void driver_open_after_mode(void)
{
    ck_assert_msg(gl_driver_fuses(0, &fused) == RESULT_OK, "%s", result_message());
    driver_open();
}

static inline void driver_upload(void)
{
    gl.TextureSubImage2D(operands[0], 0, 0, 0, WIDTH, HEIGHT, GL_RGBA, GL_FLOAT, a);
    gl.TextureSubImage2D(operands[1], 0, 0, 0, WIDTH, HEIGHT, GL_RGBA, GL_FLOAT, b);
}

/* A program whose fragment shader has operands a and b and declares its own output. */
static inline GLuint driver_build(const char *outputs, const char *body)
{
    char source[1024];
    snprintf(source, sizeof source,
             "layout(binding = 0) uniform sampler2D ta;\n"
             "layout(binding = 1) uniform sampler2D tb;\n"
             "%s\n"
             "void main() {\n"
             "    ivec2 at = ivec2(gl_FragCoord.xy);\n"
             "    vec4 a = texelFetch(ta, at, 0), b = texelFetch(tb, at, 0);\n"
             "    %s\n"
             "}\n",
             outputs, body);
    GLuint program = 0;
    ck_assert_msg(program_build("test", "", shader_fullscreen_vert, source, &program) == RESULT_OK,
                  "%s", result_message());
    return program;
}

static const char driver_color_output[] = "layout(location = 0) out vec4 result;";

/* Renders to a texture of `format`, attached where it belongs; the caller reads it. */
static inline GLuint driver_target(GLenum format, bool depth)
{
    GLuint texture, framebuffer;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, 1, format, WIDTH, HEIGHT);
    gl.TextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.CreateFramebuffers(1, &framebuffer);
    gl.NamedFramebufferTexture(framebuffer, depth ? GL_DEPTH_ATTACHMENT : GL_COLOR_ATTACHMENT0,
                               texture, 0);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    return texture;
}

static inline void driver_draw(GLuint program)
{
    gl.UseProgram(program);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
}

/* ---- inputs -------------------------------------------------------------------------------- */

static const float specials[] = {
    0.0f,     -0.0f,   1.0f,     -1.0f,     0.5f,    2.0f,     INFINITY,    -INFINITY,
    NAN,      1e-40f,  -1e-40f,  0x1p-126f, 3.4e38f, 65504.0f, 65519.9f,    65520.0f,
    65536.0f, 6.1e-5f, 5.96e-8f, 2.98e-8f,  1e-30f,  32767.9f, 0.99999994f, 1.0000001f,
};

typedef enum InputSet {
    INPUT_UNIT,
    INPUT_SIGNED,
    INPUT_BITS,
    INPUT_SPECIAL,
    INPUT_SETS
} InputSet;

static inline float driver_input(InputSet set)
{
    switch (set) {
    case INPUT_UNIT:
        return (float)random_unit(&random_state);
    case INPUT_SIGNED:
        return (float)random_range(&random_state, -8.0, 8.0);
    case INPUT_BITS:
        return op_from_bits((uint32_t)random_bits(&random_state));
    default:
        break;
    }
    uint64_t pick = random_bits(&random_state);
    size_t count = sizeof specials / sizeof *specials;
    return pick & 3 ? specials[(pick >> 2) % count] : (float)random_unit(&random_state);
}

static inline void driver_fill(InputSet set)
{
    for (int i = 0; i < TEXELS; i++)
        for (int k = 0; k < 4; k++) {
            a[i][k] = driver_input(set);
            b[i][k] = driver_input(set);
        }
}

static inline bool driver_same(float x, float y)
{
    return op_bits(op_canonical(x)) == op_bits(op_canonical(y));
}

#endif
