/* Hard cases of coverage and clipping. */
#include "scene/hard_kit.h"
#include "scene/hard_scenes.h"

#include "base/memory.h"
#include "base/random.h"
#include "scene/shapes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double facing[4][3] = {
    {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0}};

/* The eye inside a ball of glass, another that the near plane cuts open, and things outside. */
Result hard_scenes_inside_glass(Scene *out)
{
    static const double balls[4][4] = {{0.0, 0.0, 0.0, 3.0},
                                       {0.1, -0.1, 0.0, 0.1875},
                                       {1.0, 0.5, -2.75, 1.0},
                                       {-2.0, 0.0, -6.0, 2.0}};
    Builder builder = hard_kit_begin("inside_glass", 0.125, 100.0);
    hard_kit_lamps(&builder);
    Mesh mesh;
    Result made = shapes_sphere(1.0, 24, 12, &mesh);
    uint32_t ball = builder_mesh(&builder, made, &mesh);
    for (int i = 0; i < 4; i++) {
        Matrix scale = matrix_scale(balls[i][3], balls[i][3], balls[i][3]);
        Matrix move = matrix_translate(balls[i][0], balls[i][1], balls[i][2]);
        Matrix world = matrix_multiply(&move, &scale);
        pieces_place(&builder, "", ball, hard_kit_tint(&builder, i, 0.4f), &world);
    }
    return builder_finish(&builder, out);
}

/* A floor from far in front to far behind, a triangle with a corner in the eye's own plane, one
 * with a corner in the eye itself, one all behind. */
Result hard_scenes_behind_the_eye(Scene *out)
{
    static const double floor[4][3] = {
        {-50.0, -1.0, 50.0}, {50.0, -1.0, 50.0}, {50.0, -1.0, -50.0}, {-50.0, -1.0, -50.0}};
    static const HardTriangle triangles[3] = {
        {{-1.5, 0.25, -2.0}, {0.75, 0.5, 0.0}, {-0.5, 1.0, -2.0}},
        {{0.0, 0.0, 0.0}, {2.0, 0.25, -3.0}, {1.0, 2.0, -3.0}},
        {{-1.0, -1.0, 2.0}, {1.0, -1.0, 2.0}, {0.0, 1.0, 3.0}}};
    Builder builder = hard_kit_begin("behind_the_eye", 0.125, 100.0);
    hard_kit_put(&builder, hard_kit_patch(&builder, floor, facing),
                 hard_kit_tint(&builder, 0, 0.5f));
    for (int i = 0; i < 3; i++)
        hard_kit_put(&builder, hard_kit_triangles(&builder, &triangles[i], 1),
                     hard_kit_tint(&builder, 1 + i, 0.5f));
    return builder_finish(&builder, out);
}

/* Panes in the near plane, in the far plane, a little inside each, and one through both. With
 * these planes the projection's floats are exact, and so are the depths 0 and 1. */
Result hard_scenes_near_and_far_planes(Scene *out)
{
    static const double through[4][3] = {
        {-0.5, -0.5, -0.5}, {0.0, -1.5, -4.5}, {0.0, 1.5, -4.5}, {-0.5, 0.5, -0.5}};
    static const HardQuad quads[4] = {{0.0625, 0.5, 0.75, 0.875, -1.0},
                                      {0.0625, 0.0625, 0.75, 0.4375, -0x1.000002p+0},
                                      {0.1875, -1.3125, 2.25, -0.1875, -3.0},
                                      {0.1875, -2.625, 2.25, -1.5, -0x1.7ffffp+1}};
    Builder builder = hard_kit_begin("near_and_far_planes", 1.0, 3.0);
    for (int i = 0; i < 4; i++)
        hard_kit_put(&builder, hard_kit_quads(&builder, &quads[i], 1),
                     hard_kit_tint(&builder, i, 0.5f));
    hard_kit_put(&builder, hard_kit_patch(&builder, through, facing),
                 hard_kit_tint(&builder, 4, 0.5f));
    return builder_finish(&builder, out);
}

/* Pairs of triangles on the two sides of a diagonal through pixel centres, 1 to 2^-10 pixels thin:
 * whose centres they are is decided by the tie rule alone. */
Result hard_scenes_slivers(Scene *out)
{
    enum {
        PAIRS = 11
    };
    HardTriangle sides[2][PAIRS];
    Builder builder = hard_kit_begin("slivers", 1.0, 100.0);
    for (int i = 0; i < PAIRS; i++) {
        double x = -44.0 + 4.0 * i, y = -44.0, width = ldexp(1.0, -i), length = 44.0;
        const HardTriangle below = {
            {x, y, -48.0}, {x + width, y, -48.0}, {x + length, y + length, -48.0}};
        const HardTriangle above = {
            {x, y, -48.0}, {x + length, y + length, -48.0}, {x, y + width, -48.0}};
        memcpy(sides[0][i], below, sizeof below);
        memcpy(sides[1][i], above, sizeof above);
    }
    for (int i = 0; i < 2; i++) {
        uint32_t mesh = hard_kit_triangles(&builder, (const HardTriangle *)sides[i], PAIRS);
        hard_kit_put(&builder, mesh, hard_kit_tint(&builder, i, 0.5f));
    }
    return builder_finish(&builder, out);
}

enum {
    FAN = 10000
};

/* A disc of 10,000 triangles whose common corner is the centre of a pixel. */
static Result make_fan(Mesh *out)
{
    const double hub[3] = {0.5, 0.5, -48.0}, radius = 40.0625;
    Result result = shapes_allocate(FAN + 1, FAN, out);
    for (uint32_t i = 0; result == RESULT_OK && i <= FAN; i++) {
        double angle = 2.0 * PIECES_PI * i / FAN;
        const double corner[3] = {hub[0] + radius * matrix_cos(angle),
                                  hub[1] + radius * matrix_sin(angle), hub[2]};
        for (size_t k = 0; k < 3; k++) {
            out->position[3 * i + k] = (float)(i < FAN ? corner[k] : hub[k]);
            out->normal[3 * i + k] = k == 2 ? 1.0f : 0.0f;
        }
        if (i == FAN)
            break;
        out->index[3 * i] = FAN;
        out->index[3 * i + 1] = i;
        out->index[3 * i + 2] = (i + 1) % FAN;
    }
    return result;
}

Result hard_scenes_fan(Scene *out)
{
    Builder builder = hard_kit_begin("fan", 1.0, 100.0);
    Mesh mesh;
    Result made = make_fan(&mesh);
    uint32_t fan = builder_mesh(&builder, made, &mesh);
    hard_kit_put(&builder, fan, hard_kit_tint(&builder, 2, 0.5f));
    return builder_finish(&builder, out);
}

/* Above, two quads with a common edge through pixel centres; below, two triangles with a slanting
 * one, drawn in two draws each. */
Result hard_scenes_shared_edges(Scene *out)
{
    static const HardQuad left = {-32.0, 4.0, 0.5, 40.0, -48.0};
    static const HardQuad right = {0.5, 4.0, 32.0, 40.0, -48.0};
    static const HardTriangle upper = {
        {-32.0, -40.0, -48.0}, {32.0, -4.0, -48.0}, {-32.0, -4.0, -48.0}};
    static const HardTriangle lower = {
        {-32.0, -40.0, -48.0}, {32.0, -40.0, -48.0}, {32.0, -4.0, -48.0}};
    Builder builder = hard_kit_begin("shared_edges", 1.0, 100.0);
    hard_kit_put(&builder, hard_kit_quads(&builder, &left, 1), hard_kit_tint(&builder, 0, 0.5f));
    hard_kit_put(&builder, hard_kit_quads(&builder, &right, 1), hard_kit_tint(&builder, 1, 0.5f));
    hard_kit_put(&builder, hard_kit_triangles(&builder, (const HardTriangle *)upper, 1),
                 hard_kit_tint(&builder, 2, 0.5f));
    hard_kit_put(&builder, hard_kit_triangles(&builder, (const HardTriangle *)lower, 1),
                 hard_kit_tint(&builder, 3, 0.5f));
    return builder_finish(&builder, out);
}

enum {
    CONFETTI = 1200,
    CONFETTI_SEED = 7
};

static void throw_confetti(Random *random, HardTriangle *triangles, int count)
{
    for (int i = 0; i < count; i++) {
        double x = random_range(random, -44.0, 44.0), y = random_range(random, -44.0, 44.0);
        double z = random_range(random, 40.0, 56.0), size = random_range(random, 0.0625, 1.0);
        for (int k = 0; k < 3; k++) {
            double dx = random_range(random, -0.5, 0.5), dy = random_range(random, -0.5, 0.5);
            triangles[i][k][0] = (x + size * dx) * z / 48.0;
            triangles[i][k][1] = (y + size * dy) * z / 48.0;
            triangles[i][k][2] = -z;
        }
    }
}

Result hard_scenes_confetti(Scene *out)
{
    HardTriangle *triangles = memory_array(CONFETTI / 4, sizeof *triangles);
    if (!triangles)
        return RESULT_NO_MEMORY;
    Random random = random_seed(CONFETTI_SEED);
    Builder builder = hard_kit_begin("confetti", 1.0, 100.0);
    for (int i = 0; i < 4; i++) {
        throw_confetti(&random, triangles, CONFETTI / 4);
        uint32_t mesh = hard_kit_triangles(&builder, (const HardTriangle *)triangles, CONFETTI / 4);
        hard_kit_put(&builder, mesh, hard_kit_tint(&builder, i, 0.5f));
    }
    free(triangles);
    return builder_finish(&builder, out);
}

/* Corners at 1e6 times the image's width, and at the limit of what a scene may hold. */
Result hard_scenes_huge_triangles(Scene *out)
{
    static const HardTriangle triangles[3] = {
        {{-5e7, -5e7, -48.0}, {5e7, -1e6, -48.0}, {-1e6, 5e7, -48.0}},
        {{-9e14, -9e14, -8e14}, {9e14, -9e14, -8e14}, {0.0, 1e6, -64.0}},
        {{4.0, -24.0, -32.0}, {3e9, 1e9, -4e9}, {3.0, 24.0, -32.0}}};
    Builder builder = hard_kit_begin("huge_triangles", 1.0, INFINITY);
    for (int i = 0; i < 3; i++)
        hard_kit_put(&builder, hard_kit_triangles(&builder, &triangles[i], 1),
                     hard_kit_tint(&builder, i, 0.5f));
    return builder_finish(&builder, out);
}

/* Triangles without area, a ball flattened to a disc and one flattened to a line, around a pane. */
Result hard_scenes_degenerate(Scene *out)
{
    static const HardTriangle flat[3] = {
        {{-20.0, 0.5, -40.0}, {0.5, 0.5, -40.0}, {20.0, 0.5, -40.0}},
        {{0.5, 0.5, -40.0}, {0.5, 0.5, -40.0}, {0.5, 0.5, -40.0}},
        {{-20.0, -20.0, -40.0}, {20.0, 20.0, -40.0}, {-20.0, -20.0, -40.0}}};
    static const double scales[2][3] = {{16.0, 16.0, 0.0}, {0.0, 24.0, 0.0}};
    Builder builder = hard_kit_begin("degenerate", 1.0, 100.0);
    HardQuad pane = hard_kit_pane(-60.0, 2.0 / 3.0);
    hard_kit_put(&builder, hard_kit_triangles(&builder, flat, 3), hard_kit_tint(&builder, 0, 0.5f));
    Mesh mesh;
    Result made = shapes_sphere(1.0, 16, 8, &mesh);
    uint32_t ball = builder_mesh(&builder, made, &mesh);
    for (int i = 0; i < 2; i++) {
        Matrix scale = matrix_scale(scales[i][0], scales[i][1], scales[i][2]);
        Matrix move = matrix_translate(-8.0 + 16.0 * i, 0.0, -48.0);
        Matrix world = matrix_multiply(&move, &scale);
        pieces_place(&builder, "", ball, hard_kit_tint(&builder, 1 + i, 0.5f), &world);
    }
    hard_kit_put(&builder, hard_kit_quads(&builder, &pane, 1), hard_kit_tint(&builder, 3, 0.5f));
    return builder_finish(&builder, out);
}

/* A single-sided ball of glass and its mirror image: the matrix turns every triangle round. */
Result hard_scenes_mirrored(Scene *out)
{
    Builder builder = hard_kit_begin("mirrored", 0.5, 100.0);
    hard_kit_lamps(&builder);
    Mesh mesh;
    Result made = shapes_torus(1.0, 0.375, 32, 16, &mesh);
    uint32_t ring = builder_mesh(&builder, made, &mesh);
    for (int i = 0; i < 2; i++) {
        Material material = {.base_color = {0.9f, 0.5f, 0.2f, 0.5f},
                             .roughness = 0.5f,
                             .occlusion = 1.0f,
                             .alpha_mode = ALPHA_BLEND,
                             .alpha_cutoff = 0.5f};
        Matrix tilt = {{[0] = i ? -1.0 : 1.0,
                        [5] = 0.8,
                        [6] = 0.6,
                        [9] = -0.6,
                        [10] = 0.8,
                        [12] = i ? 1.5 : -1.5,
                        [14] = -4.0,
                        [15] = 1.0}};
        pieces_place(&builder, "", ring, builder_material(&builder, &material, "ring"), &tilt);
    }
    return builder_finish(&builder, out);
}
