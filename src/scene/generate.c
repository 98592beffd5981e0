#include "scene/generate.h"

#include "base/random.h"
#include "scene/pieces.h"
#include "scene/shapes.h"
#include "scene/teapot.h"

#include <stdio.h>
#include <string.h>

/* ---- teapot_hall and teapot_hall_stress ----------------------------------------------------- */

/* Source: L. Rapetta's program, public repository rapfamily4/DeferredTransparency: planes of 5 × 5
 * teapots in a bevelled room. */
typedef struct HallPlane {
    const char *name;
    double z;
    float color[4];
    float metallic;
} HallPlane;

enum {
    HALL_LIGHTS = 128
};
enum {
    HALL_SEED = 2021
};
/* The source's colours are uniform in [0, 1]³; times this the first 16 lights expose the picture
 * well under c/(c + 1), and all 128 do not yet wash it out. */
#define HALL_BRIGHTNESS 8.0

static void hall_lights(Builder *builder)
{
    Random random = random_seed(HALL_SEED);
    for (int i = 0; i < HALL_LIGHTS; i++) {
        Light light = {.attenuation = {1.0f, 0.14f, 0.07f}};
        for (int k = 0; k < 3; k++)
            light.position[k] = pieces_float(random_range(&random, -10.0, 10.0));
        for (int k = 0; k < 3; k++)
            light.color[k] = (float)(HALL_BRIGHTNESS * random_unit(&random));
        builder_light(builder, &light);
    }
    builder->scene.light_degrees_per_second = 15.0;
}

static void hall_plane(Builder *builder, const HallPlane *plane, uint32_t teapot)
{
    uint32_t material = pieces_surface(builder, plane->name, plane->color, 0.25f, plane->metallic);
    for (int row = 0; row < 5; row++)
        for (int column = 0; column < 5; column++) {
            char name[64];
            snprintf(name, sizeof name, "teapot %s %d %d", plane->name, row, column);
            pieces_place_at(builder, name, teapot, material, 2.5 * column - 5.0, 2.5 * row - 5.0,
                            plane->z);
        }
}

static Result hall(const char *name, const HallPlane planes[4], const Gaze *gazes, int gaze_count,
                   Scene *out)
{
    Builder builder = builder_begin(name);
    Mesh mesh;
    Result made = shapes_room(10.0, 1.0, &mesh);
    uint32_t room = builder_mesh(&builder, made, &mesh);
    made = teapot_mesh(&mesh);
    uint32_t teapot = builder_mesh(&builder, made, &mesh);
    uint32_t wall =
        pieces_surface(&builder, "room", (const float[4]){0.75f, 0.75f, 0.75f, 1.0f}, 0.45f, 1.0f);
    pieces_place_at(&builder, "room", room, wall, 0.0, 0.0, 0.0);
    for (int i = 0; i < 4; i++)
        hall_plane(&builder, &planes[i], teapot);
    for (int i = 0; i < gaze_count; i++)
        pieces_look(&builder, &gazes[i]);
    hall_lights(&builder);
    return builder_finish(&builder, out);
}

static Result generate_teapot_hall(Scene *out)
{
    static const HallPlane planes[4] = {{"red", -8.0, {1.0f, 0.0f, 0.0f, 1.0f}, 0.0f},
                                        {"green", -4.0, {0.0f, 1.0f, 0.0f, 0.5f}, 0.0f},
                                        {"violet", 4.0, {0.75f, 0.35f, 1.0f, 0.5f}, 1.0f},
                                        {"amber", 8.0, {0.75f, 0.35f, 0.0f, 1.0f}, 1.0f}};
    static const Gaze gazes[] = {
        {"default", {1.0, 2.0, 6.75}, {0.0, 0.5, -4.0}, 80.0 * PIECES_PI / 180.0, 0.125, 1000.0},
        {"side", {7.5, 1.25, 5.25}, {0.0, 0.5, 3.75}, 80.0 * PIECES_PI / 180.0, 0.125, 1000.0}};
    return hall("teapot_hall", planes, gazes, 2, out);
}

static Result generate_teapot_hall_stress(Scene *out)
{
    static const HallPlane planes[4] = {{"red", -8.0, {1.0f, 0.0f, 0.0f, 0.5f}, 0.0f},
                                        {"green", -4.0, {0.0f, 1.0f, 0.0f, 0.5f}, 0.0f},
                                        {"violet", 4.0, {0.75f, 0.35f, 1.0f, 0.5f}, 1.0f},
                                        {"amber", 8.0, {0.75f, 0.35f, 0.0f, 0.5f}, 1.0f}};
    static const Gaze gazes[] = {
        {"default", {0.125, 0.625, 9.0}, {0.0, 0.5, 0.0}, 80.0 * PIECES_PI / 180.0, 0.125, 1000.0}};
    return hall("teapot_hall_stress", planes, gazes, 1, out);
}

/* ---- the tutorial's scenes ------------------------------------------------------------------ */

/* Teapot, plane and sphere, all transparent, the sphere reaching into the teapot and both through
 * the plane. The background is not black, so that a wrong weight of it shows. */
static Result generate_tutorial(Scene *out)
{
    Builder builder = builder_begin("tutorial");
    Mesh mesh;
    Result made = shapes_plane(5.0, 4.0, 1, 1, &mesh);
    uint32_t plane = builder_mesh(&builder, made, &mesh);
    made = teapot_mesh(&mesh);
    uint32_t teapot = builder_mesh(&builder, made, &mesh);
    made = shapes_sphere(0.75, 48, 24, &mesh);
    uint32_t sphere = builder_mesh(&builder, made, &mesh);
    uint32_t red =
        pieces_surface(&builder, "teapot", (const float[4]){0.9f, 0.25f, 0.2f, 0.5f}, 0.3f, 0.0f);
    uint32_t blue =
        pieces_surface(&builder, "plane", (const float[4]){0.25f, 0.45f, 0.9f, 0.5f}, 0.5f, 0.0f);
    uint32_t green =
        pieces_surface(&builder, "sphere", (const float[4]){0.3f, 0.85f, 0.35f, 0.5f}, 0.3f, 0.0f);
    Matrix floor = pieces_lying(0.0, 0.1875, 0.0);
    pieces_place_at(&builder, "teapot", teapot, red, -0.5, 0.0, 0.0);
    pieces_place(&builder, "plane", plane, blue, &floor);
    pieces_place_at(&builder, "sphere", sphere, green, 0.75, 0.5, 0.625);
    pieces_look(
        &builder,
        &(Gaze){"default", {1.5, 2.0, 4.0}, {0.0, 0.375, 0.0}, PIECES_PI / 4.0, 0.125, 100.0});
    pieces_lamp(&builder, 3.0, 5.0, 4.0, 2.5f, 2.5f, 2.5f);
    pieces_lamp(&builder, -4.0, 3.0, -2.0, 0.8f, 0.9f, 1.2f);
    const float background[3] = {0.04f, 0.06f, 0.1f};
    memcpy(builder.scene.background, background, sizeof background);
    return builder_finish(&builder, out);
}

static uint32_t ground(Builder *builder, double y)
{
    Mesh mesh;
    Result made = shapes_plane(12.0, 12.0, 1, 1, &mesh);
    uint32_t plane = builder_mesh(builder, made, &mesh);
    uint32_t gray =
        pieces_surface(builder, "ground", (const float[4]){0.6f, 0.58f, 0.55f, 1.0f}, 0.8f, 0.0f);
    Matrix floor = pieces_lying(0.0, y, 0.0);
    pieces_place(builder, "ground", plane, gray, &floor);
    return plane;
}

/* Rings that hold each other: no order of whole objects draws them right. */
static Result generate_chain(Scene *out)
{
    static const float colors[][4] = {{0.9f, 0.2f, 0.15f, 0.5f},  {0.95f, 0.6f, 0.1f, 0.5f},
                                      {0.85f, 0.85f, 0.2f, 0.5f}, {0.2f, 0.75f, 0.3f, 0.5f},
                                      {0.15f, 0.7f, 0.8f, 0.5f},  {0.2f, 0.35f, 0.9f, 0.5f},
                                      {0.65f, 0.3f, 0.85f, 0.5f}};
    enum {
        LINKS = sizeof colors / sizeof colors[0]
    };
    Builder builder = builder_begin("chain");
    ground(&builder, -1.0);
    Mesh mesh;
    Result made = shapes_torus(0.5, 0.125, 64, 24, &mesh);
    uint32_t ring = builder_mesh(&builder, made, &mesh);
    for (int i = 0; i < LINKS; i++) {
        char name[32];
        snprintf(name, sizeof name, "link %d", i);
        uint32_t material = pieces_surface(&builder, name, colors[i], 0.25f, 0.0f);
        int place = i - LINKS / 2;
        double x = 0.71875 * place;
        Matrix world = i % 2 ? pieces_lying(x, 0.0, 0.0) : matrix_translate(x, 0.0, 0.0);
        pieces_place(&builder, name, ring, material, &world);
    }
    pieces_look(
        &builder,
        &(Gaze){"default", {1.5, 1.75, 4.25}, {0.0, -0.125, 0.0}, PIECES_PI / 4.0, 0.125, 100.0});
    pieces_lamp(&builder, 3.0, 5.0, 4.0, 2.5f, 2.4f, 2.3f);
    pieces_lamp(&builder, -4.0, 3.0, 1.0, 0.8f, 0.9f, 1.1f);
    return builder_finish(&builder, out);
}

/* Four planes through each other: only cut along their lines of intersection could they be sorted.
 */
static Result generate_crossing_planes(Scene *out)
{
    static const float colors[4][4] = {{0.9f, 0.2f, 0.2f, 0.5f},
                                       {0.2f, 0.8f, 0.3f, 0.5f},
                                       {0.25f, 0.4f, 0.95f, 0.5f},
                                       {0.95f, 0.8f, 0.2f, 0.5f}};
    static const char *const names[4] = {"red", "green", "blue", "yellow"};
    Builder builder = builder_begin("crossing_planes");
    ground(&builder, -1.25);
    Mesh mesh;
    Result made = shapes_plane(2.0, 2.0, 1, 1, &mesh);
    uint32_t plane = builder_mesh(&builder, made, &mesh);
    for (int i = 0; i < 4; i++) {
        uint32_t material = pieces_surface(&builder, names[i], colors[i], 0.4f, 0.0f);
        Matrix world =
            i < 3 ? matrix_rotate_y((0.1 + i / 3.0) * PIECES_PI) : pieces_lying(0.0, 0.0, 0.0);
        pieces_place(&builder, names[i], plane, material, &world);
    }
    pieces_look(
        &builder,
        &(Gaze){"default", {1.25, 1.5, 3.5}, {0.0, -0.125, 0.0}, PIECES_PI / 4.0, 0.125, 100.0});
    pieces_lamp(&builder, 3.0, 5.0, 4.0, 2.5f, 2.4f, 2.3f);
    pieces_lamp(&builder, -4.0, 3.0, 1.0, 0.8f, 0.9f, 1.1f);
    return builder_finish(&builder, out);
}

/* ---- alpha_ladder --------------------------------------------------------------------------- */

enum {
    LADDER_ROWS = 8,
    LADDER_COLUMNS = 16
};

/* Light and dark stripes, so that every cell stands before both. */
static void ladder_backdrop(Builder *builder, double z)
{
    Mesh mesh;
    Result made = shapes_plane(18.0, 10.0, 1, 1, &mesh);
    uint32_t wall = builder_mesh(builder, made, &mesh);
    made = shapes_plane(0.5, 10.0, 1, 1, &mesh);
    uint32_t stripe = builder_mesh(builder, made, &mesh);
    uint32_t light =
        pieces_surface(builder, "light", (const float[4]){0.9f, 0.9f, 0.9f, 1.0f}, 0.9f, 0.0f);
    uint32_t dark =
        pieces_surface(builder, "dark", (const float[4]){0.08f, 0.08f, 0.08f, 1.0f}, 0.9f, 0.0f);
    pieces_place_at(builder, "wall", wall, light, 0.0, 0.0, z);
    for (int column = 0; column < LADDER_COLUMNS; column++) {
        char name[32];
        snprintf(name, sizeof name, "stripe %d", column + 1);
        pieces_place_at(builder, name, stripe, dark, column - 7.25, 0.0, z + 0.0625);
    }
}

/* Column c (from 1) has c equal layers, row r one alpha; the nearest layer is drawn first. */
static Result generate_alpha_ladder(Scene *out)
{
    static const double alphas[LADDER_ROWS] = {1.0 / 255.0, 0.01, 0.25,          0.5,
                                               0.75,        0.99, 254.0 / 255.0, 1.0};
    Builder builder = builder_begin("alpha_ladder");
    ladder_backdrop(&builder, -0.5);
    Mesh mesh;
    Result made = shapes_plane(0.75, 0.75, 1, 1, &mesh);
    uint32_t quad = builder_mesh(&builder, made, &mesh);
    for (int row = 0; row < LADDER_ROWS; row++) {
        char name[64];
        snprintf(name, sizeof name, "alpha %.4g", alphas[row]);
        Material material = {.base_color = {0.95f, 0.45f, 0.1f, (float)alphas[row]},
                             .roughness = 0.9f,
                             .occlusion = 1.0f,
                             .alpha_mode = ALPHA_BLEND,
                             .alpha_cutoff = 0.5f};
        uint32_t tint = builder_material(&builder, &material, name);
        for (int column = 0; column < LADDER_COLUMNS; column++)
            for (int layer = 0; layer <= column; layer++) {
                snprintf(name, sizeof name, "row %d column %d layer %d", row + 1, column + 1,
                         layer + 1);
                pieces_place_at(&builder, name, quad, tint, column - 7.5, 3.5 - row, -layer / 64.0);
            }
    }
    pieces_look(&builder,
                &(Gaze){"default", {0.0, 0.0, 40.0}, {0.0, 0.0, 0.0}, 0.2375, 10.0, 100.0});
    pieces_lamp(&builder, 10.0, 20.0, 40.0, 2.5f, 2.5f, 2.5f);
    return builder_finish(&builder, out);
}

/* ---- lamps ---------------------------------------------------------------------------------- */

enum {
    LAMPS_SIDE = 8, /* cells; a lamp in each */
    LAMPS_SEED = 64
};

/* Pools of light that overlap with their neighbours at most, as glTF means it: 1/d² and a range.
 * Whatever the number of lights asked for, they are all over the floor. */
static void lamps_lights(Builder *builder)
{
    Random random = random_seed(LAMPS_SEED);
    for (int i = 0; i < LAMPS_SIDE * LAMPS_SIDE; i++) {
        int cell = (i * 27 + 36) % (LAMPS_SIDE * LAMPS_SIDE), row = cell / LAMPS_SIDE;
        Light light = {.attenuation = {0.0f, 0.0f, 1.0f}};
        light.position[0] =
            pieces_float(2.0 * (cell % LAMPS_SIDE) - 7.0 + random_range(&random, -0.5, 0.5));
        light.position[1] = pieces_float(random_range(&random, 0.5, 1.25));
        light.position[2] = pieces_float(2.0 * row - 7.0 + random_range(&random, -0.5, 0.5));
        for (int k = 0; k < 3; k++)
            light.color[k] = k == i % 3 ? 4.0f : (float)(3.0 * random_unit(&random));
        light.range = (float)random_range(&random, 1.25, 2.5);
        builder_light(builder, &light);
    }
}

/* Frosted panes through each other, upright on a floor, between lamps that do not reach far: the
 * edges of their light cross every surface. */
static Result generate_lamps(Scene *out)
{
    static const float tints[2][4] = {{0.75f, 0.85f, 0.95f, 0.375f}, {0.95f, 0.85f, 0.7f, 0.5f}};
    Builder builder = builder_begin("lamps");
    Mesh mesh;
    Result made = shapes_plane(16.0, 16.0, 1, 1, &mesh);
    uint32_t floor = builder_mesh(&builder, made, &mesh);
    made = shapes_plane(16.0, 2.0, 1, 1, &mesh);
    uint32_t pane = builder_mesh(&builder, made, &mesh);
    uint32_t stone =
        pieces_surface(&builder, "floor", (const float[4]){0.7f, 0.68f, 0.65f, 1.0f}, 0.8f, 0.0f);
    Matrix lying = pieces_lying(0.0, 0.0, 0.0);
    pieces_place(&builder, "floor", floor, stone, &lying);
    for (int i = 0; i < 2; i++) {
        uint32_t glass = pieces_surface(&builder, i ? "amber" : "blue", tints[i], 0.6f, 0.0f);
        Matrix turn = matrix_rotate_y((0.01 + 0.5 * i) * PIECES_PI);
        for (int k = 0; k < 4; k++) {
            char name[32];
            snprintf(name, sizeof name, "%s %d", i ? "amber" : "blue", k + 1);
            Matrix world = matrix_translate(0.0, 1.0, 4.0 * k - 6.0);
            world = matrix_multiply(&turn, &world);
            pieces_place(&builder, name, pane, glass, &world);
        }
    }
    pieces_look(&builder,
                &(Gaze){"default", {8.0, 6.0, 15.5}, {-0.25, -0.5, 1.0}, 0.6875, 0.5, 100.0});
    lamps_lights(&builder);
    for (int k = 0; k < 3; k++)
        builder.scene.ambient[k] = 0.03125f;
    return builder_finish(&builder, out);
}

/* ---- table ---------------------------------------------------------------------------------- */

static const BuiltinScene scenes[] = {
    {"teapot_hall", "four planes of 5 x 5 teapots in a room, two of them transparent, 128 lights",
     generate_teapot_hall},
    {"teapot_hall_stress", "the same, all transparent, the camera close to one teapot",
     generate_teapot_hall_stress},
    {"tutorial", "teapot, plane and sphere through each other, all transparent", generate_tutorial},
    {"chain", "inter-linked rings: no order of objects is right", generate_chain},
    {"crossing_planes", "four planes through each other: no order of objects is right",
     generate_crossing_planes},
    {"alpha_ladder", "1 to 16 equal layers by eight alphas from 1/255 to 1", generate_alpha_ladder},
    {"lamps", "crossing panes among 64 lights of limited range", generate_lamps},
};

const BuiltinScene *generate_table(size_t *count)
{
    *count = sizeof scenes / sizeof scenes[0];
    return scenes;
}

const BuiltinScene *generate_find(const char *name)
{
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++)
        if (strcmp(scenes[i].name, name) == 0)
            return &scenes[i];
    return NULL;
}
