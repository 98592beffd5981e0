/* Hard cases of order and depth. */
#include "scene/hard_kit.h"
#include "scene/hard_scenes.h"

#include "scene/shapes.h"

#include <math.h>

/* A rectangle of 32 × 32 of 96 × 96 pixels three times in one plane, once wound the other way, and
 * one that leans, twice. */
Result hard_scenes_coincident_faces(Scene *out)
{
    static const double leaning[4][3] = {
        {4.0, -16.0, -48.0}, {72.0, -32.0, -96.0}, {72.0, 32.0, -96.0}, {4.0, 16.0, -48.0}};
    static const HardQuad flat = {-36.0, -16.0, -4.0, 16.0, -48.0};
    static const HardTriangle turned[2] = {
        {{-36.0, -16.0, -48.0}, {-4.0, 16.0, -48.0}, {-4.0, -16.0, -48.0}},
        {{-36.0, -16.0, -48.0}, {-36.0, 16.0, -48.0}, {-4.0, 16.0, -48.0}}};
    static const double up[4][3] = {
        {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}};
    Builder builder = hard_kit_begin("coincident_faces", 1.0, 100.0);
    uint32_t quad = hard_kit_quads(&builder, &flat, 1);
    uint32_t back = hard_kit_triangles(&builder, turned, 2);
    uint32_t lean = hard_kit_patch(&builder, leaning, up);
    hard_kit_put(&builder, quad, hard_kit_tint(&builder, 0, 0.5f));
    hard_kit_put(&builder, quad, hard_kit_tint(&builder, 1, 0.5f));
    hard_kit_put(&builder, back, hard_kit_tint(&builder, 2, 0.5f));
    hard_kit_put(&builder, lean, hard_kit_tint(&builder, 3, 0.5f));
    hard_kit_put(&builder, lean, hard_kit_tint(&builder, 5, 0.5f));
    return builder_finish(&builder, out);
}

/* With the far plane at infinity depth is 1 − 1/z: at z = 4 a step of 2^-20 is one of 2^-24. */
Result hard_scenes_layers_one_ulp(Scene *out)
{
    Builder builder = hard_kit_begin("layers_one_ulp", 1.0, INFINITY);
    hard_kit_stack(&builder, 16, 4.0, 0x1p-20, 8, 0.25f);
    return builder_finish(&builder, out);
}

/* Each plane turned by half of 0.001° about the vertical line at z = −48. */
Result hard_scenes_crossing_nearly_coplanar(Scene *out)
{
    double rise = 40.0 * matrix_tan(0.0005 * PIECES_PI / 180.0);
    Builder builder = hard_kit_begin("crossing_nearly_coplanar", 1.0, 100.0);
    static const double up[4][3] = {
        {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}};
    for (int side = 0; side < 2; side++) {
        double left = -48.0 + (side ? rise : -rise), right = -48.0 - (side ? rise : -rise);
        const double corners[4][3] = {
            {-40.0, -40.0, left}, {40.0, -40.0, right}, {40.0, 40.0, right}, {-40.0, 40.0, left}};
        uint32_t plane = hard_kit_patch(&builder, corners, up);
        hard_kit_put(&builder, plane, hard_kit_tint(&builder, 2 * side, 0.5f));
    }
    return builder_finish(&builder, out);
}

/* Four balls through each other, each of two shells 0.2 % apart. */
Result hard_scenes_thin_shells(Scene *out)
{
    static const double centers[4][3] = {
        {-0.5, -0.3, -3.5}, {0.5, -0.25, -3.6}, {0.0, 0.5, -3.55}, {0.05, 0.0, -3.1}};
    Builder builder = hard_kit_begin("thin_shells", 0.5, 50.0);
    hard_kit_lamps(&builder);
    Mesh mesh;
    Result made = shapes_sphere(1.0, 32, 16, &mesh);
    uint32_t ball = builder_mesh(&builder, made, &mesh);
    for (int i = 0; i < 4; i++) {
        uint32_t tint = hard_kit_tint(&builder, i, 0.3f);
        for (int inner = 0; inner < 2; inner++) {
            double size = inner ? 0.998 : 1.0;
            Matrix scale = matrix_scale(size, size, size);
            Matrix move = matrix_translate(centers[i][0], centers[i][1], centers[i][2]);
            Matrix world = matrix_multiply(&move, &scale);
            pieces_place(&builder, "", ball, tint, &world);
        }
    }
    return builder_finish(&builder, out);
}

Result hard_scenes_layers_64(Scene *out)
{
    Builder builder = hard_kit_begin("layers_64", 1.0, 100.0);
    hard_kit_stack(&builder, 64, 40.0, 0.5, 8, 0.0625f);
    return builder_finish(&builder, out);
}

Result hard_scenes_layers_256(Scene *out)
{
    Builder builder = hard_kit_begin("layers_256", 1.0, 100.0);
    hard_kit_stack(&builder, 256, 32.0, 0.25, 8, 0.03125f);
    return builder_finish(&builder, out);
}

Result hard_scenes_layers_1000(Scene *out)
{
    Builder builder = hard_kit_begin("layers_1000", 1.0, 100.0);
    hard_kit_stack(&builder, 1000, 32.0, 0.0625, 1, 1.0f / 255.0f);
    return builder_finish(&builder, out);
}

/* A wall, and panes in its plane, just before and just behind it; one that leans with its wall. */
Result hard_scenes_at_opaque_depth(Scene *out)
{
    static const double leaning[4][3] = {
        {4.0, -16.0, -40.0}, {60.0, -32.0, -80.0}, {60.0, 32.0, -80.0}, {4.0, 16.0, -40.0}};
    static const double up[4][3] = {
        {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}};
    static const HardQuad wall = {-44.0, -44.0, 0.0, 44.0, -48.0};
    static const HardQuad inside = {-40.0, 16.0, -4.0, 40.0, -48.0};
    static const HardQuad behind = {-40.0, -10.0, -4.0, 10.0, -48.015625};
    static const HardQuad before = {-40.0, -40.0, -4.0, -16.0, -47.984375};
    Builder builder = hard_kit_begin("at_opaque_depth", 1.0, 100.0);
    uint32_t gray = hard_kit_wall(&builder, 0.5f), lean = hard_kit_patch(&builder, leaning, up);
    hard_kit_put(&builder, hard_kit_quads(&builder, &wall, 1), gray);
    hard_kit_put(&builder, lean, gray);
    hard_kit_put(&builder, hard_kit_quads(&builder, &inside, 1), hard_kit_tint(&builder, 0, 0.5f));
    hard_kit_put(&builder, hard_kit_quads(&builder, &behind, 1), hard_kit_tint(&builder, 1, 0.5f));
    hard_kit_put(&builder, hard_kit_quads(&builder, &before, 1), hard_kit_tint(&builder, 2, 0.5f));
    hard_kit_put(&builder, lean, hard_kit_tint(&builder, 3, 0.5f));
    return builder_finish(&builder, out);
}

/* At z = 48 one code of 16 bits is 0.035 deep: eight layers lie in about three codes. */
Result hard_scenes_depth_16_aliasing(Scene *out)
{
    Builder builder = hard_kit_begin("depth_16_aliasing", 1.0, 100.0);
    hard_kit_stack(&builder, 8, 48.0, 0.01, 8, 0.375f);
    return builder_finish(&builder, out);
}

/* Panes that lean, close to the eye, so that depths of all values meet the 24-bit codes. */
Result hard_scenes_raw_24(Scene *out)
{
    Builder builder = hard_kit_begin("raw_24", 1.0, 100.0);
    static const double up[4][3] = {
        {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}};
    for (int i = 0; i < 4; i++) {
        double left = 1.125 + 0.125 * i, right = 1.25 + 0.25 * i;
        const double corners[4][3] = {{-0.625 * left, -0.625 * left, -left},
                                      {0.625 * right, -0.625 * right, -right},
                                      {0.625 * right, 0.625 * right, -right},
                                      {-0.625 * left, 0.625 * left, -left}};
        uint32_t pane = hard_kit_patch(&builder, corners, up);
        hard_kit_put(&builder, pane, hard_kit_tint(&builder, i, 0.5f));
    }
    return builder_finish(&builder, out);
}

/* Depths 0.5, 0.50006, 0.50012, …: a bias of 1e-4 passes every second layer over. */
Result hard_scenes_bias(Scene *out)
{
    Builder builder = hard_kit_begin("bias", 1.0, INFINITY);
    for (int i = 0; i < 16; i++) {
        HardQuad pane = hard_kit_pane(-pieces_float(1.0 / (0.5 - 6e-5 * i)), 2.0 / 3.0);
        uint32_t mesh = hard_kit_quads(&builder, &pane, 1);
        hard_kit_put(&builder, mesh, hard_kit_tint(&builder, i, 0.25f));
    }
    return builder_finish(&builder, out);
}

/* Pairs of panes 1 % apart, from 5e-4 to 5e3 away. */
static void put_pairs(Builder *builder)
{
    double z = 5e-4;
    for (int i = 0; i < 8; i++) {
        HardQuad quads[2] = {hard_kit_pane(-pieces_float(z), 2.0 / 3.0),
                             hard_kit_pane(-pieces_float(1.01 * z), 2.0 / 3.0)};
        for (int k = 1; k >= 0; k--) {
            uint32_t mesh = hard_kit_quads(builder, &quads[k], 1);
            hard_kit_put(builder, mesh, hard_kit_tint(builder, 2 * i + k, 0.25f));
        }
        z *= 10.0;
    }
}

Result hard_scenes_near_far_wide(Scene *out)
{
    Builder builder = hard_kit_begin("near_far_wide", 1e-4, 1e4);
    put_pairs(&builder);
    return builder_finish(&builder, out);
}

Result hard_scenes_far_infinite(Scene *out)
{
    Builder builder = hard_kit_begin("far_infinite", 1e-4, INFINITY);
    put_pairs(&builder);
    static const HardQuad far_away = {-6e14, -6e14, 6e14, 6e14, -9e14};
    uint32_t mesh = hard_kit_quads(&builder, &far_away, 1);
    hard_kit_put(&builder, mesh, hard_kit_tint(&builder, 7, 0.5f));
    return builder_finish(&builder, out);
}

/* Reversed depth is near/z: 2^-121, 2^-122, … 2^-130. The least normal number is 2^-126. */
Result hard_scenes_denormal_depths(Scene *out)
{
    Builder builder = hard_kit_begin("denormal_depths", 0x1p-120, INFINITY);
    for (int i = 1; i <= 10; i++) {
        HardQuad pane = hard_kit_pane(-ldexp(1.0, i), 2.0 / 3.0);
        uint32_t mesh = hard_kit_quads(&builder, &pane, 1);
        hard_kit_put(&builder, mesh, hard_kit_tint(&builder, i, 0.25f));
    }
    return builder_finish(&builder, out);
}

/* Two in one plane, three through each other, one behind: six draws. */
Result hard_scenes_draw_order(Scene *out)
{
    static const double up[4][3] = {
        {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}};
    static const HardQuad low = {-36.0, -36.0, 36.0, -4.0, -48.0};
    static const HardQuad back = {-60.0, -60.0, 60.0, 60.0, -72.0};
    Builder builder = hard_kit_begin("draw_order", 1.0, 100.0);
    uint32_t plane = hard_kit_quads(&builder, &low, 1);
    hard_kit_put(&builder, plane, hard_kit_tint(&builder, 0, 0.5f));
    hard_kit_put(&builder, plane, hard_kit_tint(&builder, 1, 0.5f));
    for (int i = 0; i < 3; i++) {
        double turn = 0.3 + PIECES_PI / 3.0 * i;
        double x = 24.0 * matrix_cos(turn), z = 24.0 * matrix_sin(turn);
        const double corners[4][3] = {
            {-x, 0.0, -48.0 - z}, {x, 0.0, -48.0 + z}, {x, 32.0, -48.0 + z}, {-x, 32.0, -48.0 - z}};
        uint32_t crossing = hard_kit_patch(&builder, corners, up);
        hard_kit_put(&builder, crossing, hard_kit_tint(&builder, 2 + i, 0.5f));
    }
    hard_kit_put(&builder, hard_kit_quads(&builder, &back, 1), hard_kit_tint(&builder, 5, 0.5f));
    return builder_finish(&builder, out);
}
