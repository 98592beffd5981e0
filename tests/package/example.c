/* A program of somebody else's: blends, renders panes of glass by the reference and by the truth,
 * and compares the two. Only the installed peel.h and libpeel are there.
 *
 *     example [PICTURE.ppm] */
#include <peel.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    WIDTH = 320,
    HEIGHT = 240
};

/* Names that the library uses inside: they must not clash, shared or static. */
int file_write(void);
int result_fail(void);
int scene_free(void);
int file_write(void)
{
    return 1;
}
int result_fail(void)
{
    return 2;
}
int scene_free(void)
{
    return 3;
}

static void check(PeelResult result, const char *what)
{
    if (result != PEEL_OK) {
        fprintf(stderr, "%s: %s: %s\n", what, peel_result_text(result), peel_message());
        exit(EXIT_FAILURE);
    }
}

static void expect(int holds, const char *what)
{
    if (!holds) {
        fprintf(stderr, "example: expected %s\n", what);
        exit(EXIT_FAILURE);
    }
}

/* ---- blending ---- */

static void blend(void)
{
    static const float source[4] = {0.25f, 0.5f, 0.75f, 0.5f}, seventh[4] = {0.7f, 0.7f, 0.7f, 1};
    unsigned char codes[4];
    uint16_t nearest[4], truncated[4];
    uint32_t ulp[4];
    PeelArithmetic exact, driver;
    PeelEquation under, replace;
    check(peel_arithmetic_parse("exact", &exact), "exact");
    check(peel_arithmetic_parse("driver", &driver), "driver");
    check(peel_equation_parse("under", &under), "under");
    check(peel_equation_parse("one,zero", &replace), "one,zero");

    check(peel_clear(PEEL_RGBA8, 1, codes), "clear");
    check(peel_blend(&driver, &under, PEEL_RGBA8, 1, source, codes), "blend");
    printf("under, rgba8, driver: %d %d %d %d\n", codes[0], codes[1], codes[2], codes[3]);
    expect(codes[0] == 64 && codes[1] == 128 && codes[2] == 191 && codes[3] == 127,
           "64 128 191 127");

    check(peel_clear(PEEL_RGBA16F, 1, nearest), "clear");
    check(peel_store(PEEL_RGBA16F, 1, seventh, truncated), "store");
    check(peel_blend(&exact, &replace, PEEL_RGBA16F, 1, seventh, nearest), "blend");
    check(peel_ulp(PEEL_RGBA16F, nearest, truncated, ulp), "ulp");
    printf("0.7 as a half: nearest %#x, truncated %#x, %u ULP\n", nearest[0], truncated[0], ulp[0]);
    expect(nearest[0] == 0x399a && truncated[0] == 0x3999 && ulp[0] == 1, "0x399a, 0x3999, 1 ULP");
}

/* ---- a scene from arrays ---- */

static const float square[] = {-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0};
static const float square_normals[] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
static const float square_uvs[] = {0, 3, 3, 3, 3, 0, 0, 0};
static const uint32_t square_indices[] = {0, 1, 2, 0, 2, 3};
static const unsigned char checkers[] = {230, 225, 210, 255, 40,  60,  90,  255,
                                         40,  60,  90,  255, 230, 225, 210, 255};

static PeelScene *make_scene(void)
{
    const PeelMesh mesh = {4, 2, square, square_normals, square_uvs, square_indices};
    const PeelTexture texture = {
        .width = 2, .height = 2, .codes = checkers, .srgb = true, .nearest = true};
    const PeelMaterial materials[] = {
        {.base_color = {1, 1, 1, 1}, .roughness = 0.9f, .occlusion = 1, .base_color_texture = 1},
        {.base_color = {0.9f, 0.15f, 0.1f, 0.5f},
         .roughness = 0.3f,
         .occlusion = 1,
         .alpha_mode = PEEL_TRANSPARENT,
         .double_sided = true},
        {.base_color = {0.1f, 0.75f, 0.2f, 0.5f},
         .roughness = 0.3f,
         .occlusion = 1,
         .alpha_mode = PEEL_TRANSPARENT,
         .double_sided = true},
        {.base_color = {0.15f, 0.3f, 0.95f, 0.5f},
         .roughness = 0.3f,
         .occlusion = 1,
         .alpha_mode = PEEL_TRANSPARENT,
         .double_sided = true},
    };
    /* The floor lies; the panes cross each other. */
    static const double floor_matrix[] = {3, 0, 0, 0, 0, 0, -3, 0, 0, 1, 0, 0, 0, -1, 0, 1};
    static const double red[] = {0.8, 0, 0.6, 0, 0, 1, 0, 0, -0.6, 0, 0.8, 0, 0.0, 0, 0, 1};
    static const double green[] = {0.8, 0, -0.6, 0, 0, 1, 0, 0, 0.6, 0, 0.8, 0, 0.2, 0.1, 0, 1};
    static const double blue[] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -0.2, -0.1, 0.3, 1};
    const PeelInstance instances[] = {
        {0, 0, floor_matrix}, {0, 1, red}, {0, 2, green}, {0, 3, blue}};
    const PeelLight light = {
        .position = {2, 3, 4}, .color = {70, 67, 63}, .attenuation = {1, 0, 1}, .range = 20};
    const PeelCamera camera = {.eye = {1.2, 1.1, 4.6},
                               .target = {0, -0.1, 0},
                               .up = {0, 1, 0},
                               .yfov = 0.65,
                               .near_plane = 0.5,
                               .far_plane = 20};
    const PeelSceneDesc desc = {.mesh_count = 1,
                                .texture_count = 1,
                                .material_count = 4,
                                .instance_count = 4,
                                .light_count = 1,
                                .camera_count = 1,
                                .meshes = &mesh,
                                .textures = &texture,
                                .materials = materials,
                                .instances = instances,
                                .lights = &light,
                                .cameras = &camera,
                                .ambient = {0.3f, 0.3f, 0.3f},
                                .background = {0.02f, 0.03f, 0.05f}};
    PeelScene *scene = NULL;
    check(peel_scene_create(&desc, &scene), "scene");
    return scene;
}

/* ---- pictures ---- */

static void write_picture(const char *path, const unsigned char *display)
{
    FILE *file = fopen(path, "wb");
    expect(file != NULL, "a file that can be written");
    fprintf(file, "P6\n%d %d\n255\n", WIDTH, HEIGHT);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        fwrite(display + 4 * i, 1, 3, file);
    expect(fclose(file) == 0, "room for the picture");
}

static int count_buffer(void *context, const PeelBuffer *buffer)
{
    int *count = context;
    *count += strcmp(buffer->name, "peel.0.depth") == 0 && buffer->format == PEEL_D32F;
    return 0;
}

static void render(const PeelScene *scene, const char *picture)
{
    size_t pixels = (size_t)WIDTH * HEIGHT;
    float *fast = calloc(pixels, 16), *traced = calloc(pixels, 16), *truth = calloc(pixels, 16);
    float *accum = calloc(pixels, 16);
    unsigned char *display = calloc(pixels, 4);
    int seen = 0;
    PeelSettings settings = {.width = WIDTH, .height = HEIGHT};
    PeelImages images = {.linear = fast, .display = display};
    PeelTrace trace = {count_buffer, &seen};
    PeelFigures figures;
    PeelDifference difference;
    expect(fast && traced && truth && accum && display, "memory");

    check(peel_scene_render(scene, &settings, NULL, &images, &figures), "ref");
    printf("ref: %d passes, %d layers, %d fragments\n", figures.passes, (int)figures.max_layers,
           (int)figures.fragments);
    expect(figures.passes == 3 && figures.max_layers == 3 && figures.lost_to_ties == 0,
           "three panes");
    if (picture)
        write_picture(picture, display);

    images = (PeelImages){.linear = traced, .accum = accum};
    check(peel_scene_render(scene, &settings, &trace, &images, NULL), "ref, traced");
    expect(seen == 1, "the first layer's depths, once");
    check(peel_compare(PEEL_RGBA32F, WIDTH, HEIGHT, fast, traced, &difference), "compare");
    printf("ref's two paths: %d values differ\n", (int)difference.differing_values);
    expect(difference.differing_values == 0, "the same bits");

    settings.renderer = PEEL_TRUTH;
    images = (PeelImages){.linear = truth};
    check(peel_scene_render(scene, &settings, NULL, &images, &figures), "truth");
    check(peel_compare(PEEL_RGBA32F, WIDTH, HEIGHT, fast, truth, &difference), "compare");
    printf("ref and truth: rms %.1e, at most %.1e at %d,%d channel %d, %u ULP\n", difference.rms,
           difference.max, difference.max_at[0], difference.max_at[1], difference.max_at[2],
           difference.max_ulp);
    expect(difference.rms > 0 && difference.rms < 1e-5, "a root mean square error below 1e-5");
    free(fast);
    free(traced);
    free(truth);
    free(accum);
    free(display);
}

int main(int argc, char **argv)
{
    printf("libpeel %s\n", peel_version());
    expect(file_write() == 1 && result_fail() == 2 && scene_free() == 3, "our own functions");
    blend();
    PeelScene *scene = make_scene();
    render(scene, argc > 1 ? argv[1] : NULL);
    peel_scene_free(scene);
    return EXIT_SUCCESS;
}
