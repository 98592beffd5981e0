#include "fuses.h"

#include "number/op.h"
#include "program.h"

#include <stdio.h>

enum {
    SIDE = 16
};

/* Window depths at (16, 0), (0, 0) and (0, 16): multiples of 2^-24, so that the way to clip space
 * and back is exact and only the interpolation can tell the modes apart. It falls steeply towards
 * 0, where the rounding of a product is large against the sum. */
static const float depth_window[3] = {20011 * 0x1p-24f, 15777213 * 0x1p-24f, 30011 * 0x1p-24f};

/* gl_FragCoord.z at pixel (x, y) of that triangle: llvmpipe's plane equation. */
static float predict(bool fused, int x, int y)
{
    const float *z = depth_window;
    float side = (float)SIDE;
    float dz01 = op_sub(z[0], z[1]), dz20 = op_sub(z[2], z[0]);
    float scale = op_div(1.0f, op_mul(side, side));
    float dx01 = op_mul(side, scale), dx20 = op_mul(-side, scale), dy20 = op_mul(side, scale);
    float dzdx = op_mul(dz01, dy20); /* dy01 is 0 */
    float dzdy = op_sub(op_mul(dz20, dx01), op_mul(dz01, dx20));
    float start = op_sub(z[0], op_add(op_mul(dzdx, op_sub(side, 0.5f)), op_mul(dzdy, -0.5f)));
    return op_muladd(fused, dzdy, (float)y, op_muladd(fused, dzdx, (float)x, start));
}

static Result render(Context *context, float depth[SIDE * SIDE])
{
    char defines[128];
    snprintf(defines, sizeof defines, "#define DEPTHS float[3](%.9g, %.9g, %.9g)\n",
             2.0 * (double)depth_window[0] - 1.0, 2.0 * (double)depth_window[1] - 1.0,
             2.0 * (double)depth_window[2] - 1.0);
    GLuint program, texture, framebuffer, vertex_array;
    const char *fragment = shader_fuses_frag;
    Result result = program_build("arithmetic", defines, shader_fuses_vert, &fragment, 1, &program);
    if (result != RESULT_OK)
        return result;
    gl.CreateTextures(GL_TEXTURE_2D, 1, &texture);
    gl.TextureStorage2D(texture, 1, GL_R32F, SIDE, SIDE);
    gl.CreateFramebuffers(1, &framebuffer);
    gl.NamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, texture, 0);
    gl.CreateVertexArrays(1, &vertex_array);
    gl.BindVertexArray(vertex_array);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.Viewport(0, 0, SIDE, SIDE);
    static const float none[4] = {-1.0f, 0.0f, 0.0f, 0.0f};
    gl.ClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, none);
    gl.UseProgram(program);
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.ReadPixels(0, 0, SIDE, SIDE, GL_RED, GL_FLOAT, depth);
    result = context_check(context, "arithmetic");
    gl.DeleteFramebuffers(1, &framebuffer);
    gl.DeleteTextures(1, &texture);
    gl.DeleteVertexArrays(1, &vertex_array);
    gl.DeleteProgram(program);
    return result;
}

/* Pixels whose depth differs from the prediction of each mode. */
static void compare(const float depth[SIDE * SIDE], int differing[2])
{
    differing[0] = differing[1] = 0;
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x + y < SIDE - 1; x++)
            for (int fused = 0; fused < 2; fused++)
                differing[fused] +=
                    op_bits(depth[y * SIDE + x]) != op_bits(predict(fused != 0, x, y));
}

Result fuses_detect(Context *context, FusesMode *mode)
{
    static bool known;
    static FusesMode found;
    if (!known) {
        float depth[SIDE * SIDE];
        Result result = render(context, depth);
        if (result != RESULT_OK)
            return result;
        int differing[2];
        uint32_t flushing = op_enter();
        compare(depth, differing);
        op_leave(flushing);
        if ((differing[0] == 0) != (differing[1] == 0))
            found = differing[1] == 0 ? FUSES_YES : FUSES_NOT;
        known = true;
    }
    *mode = found;
    return RESULT_OK;
}
