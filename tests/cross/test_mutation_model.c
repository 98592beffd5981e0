/* Mistakes in blending, peeling and compositing against a few lines of double precision that say
 * what each is: they take the lit layers of a right rendering and make the mistake with them. */
#include "testing.h"

#include "compare/store.h"
#include "frame/mutation.h"
#include "ref/pipeline/pipeline.h"
#include "scene/generate.h"

#include <math.h>
#include <stdio.h>

enum {
    WIDTH = 72,
    HEIGHT = 54,
    LAYERS_MAX = 16
};

/* A pixel's lit, premultiplied layers, front to back; alpha 0 where there is none. */
typedef struct Pixel {
    double layer[LAYERS_MAX][4], opaque[4];
    double ambient[LAYERS_MAX][4]; /* the ambient light's part of it */
    double background[3];
    int count; /* of this pixel */
    int peels; /* of the frame */
} Pixel;

typedef struct Mix {
    double color[3], transmittance;
} Mix;

static const Mix empty = {{0.0, 0.0, 0.0}, 1.0};

static void under(Mix *mix, const double source[4])
{
    for (int i = 0; i < 3; i++)
        mix->color[i] += source[i] * mix->transmittance;
    mix->transmittance *= 1.0 - source[3];
}

static void over(Mix *mix, const double source[4])
{
    for (int i = 0; i < 3; i++)
        mix->color[i] = source[i] + mix->color[i] * (1.0 - source[3]);
    mix->transmittance *= 1.0 - source[3];
}

static void swapped(Mix *mix, const double source[4])
{
    for (int i = 0; i < 3; i++)
        mix->color[i] = source[i] + mix->color[i] * mix->transmittance;
    mix->transmittance = source[3] * (1.0 - source[3]);
}

static double encode(double c)
{
    return pow(c, 1.0 / 2.2);
}

/* A source as the lighting pass writes it. */
static void write_source(MutationId id, const double source[4], double out[4])
{
    double alpha = source[3];
    memcpy(out, source, 4 * sizeof *out);
    for (int i = 0; i < 3 && alpha > 0.0; i++) {
        if (id == MUTATION_NOT_PREMULTIPLIED)
            out[i] = source[i] / alpha;
        if (id == MUTATION_PREMULTIPLIED_TWICE)
            out[i] = source[i] * alpha;
        if (id == MUTATION_SRGB_BLENDED)
            out[i] = encode(source[i] / alpha) * alpha;
    }
}

static void blend(MutationId id, bool transparent, const double source[4], Mix *mix)
{
    static const double black[4] = {0.0, 0.0, 0.0, 1.0};
    double written[4];
    if (source[3] == 0.0 && id == MUTATION_GBUFFER_CLEAR_ALPHA_1)
        source = black;
    if (source[3] <= 1e-4 || (id == MUTATION_ALPHA_TEST_HALF && source[3] <= 0.5))
        return;
    write_source(id, source, written);
    if (id == MUTATION_OVER_FRONT_TO_BACK)
        over(mix, written);
    else if (id == MUTATION_BLEND_FACTORS_SWAPPED)
        swapped(mix, written);
    else
        under(mix, written);
    if (id == MUTATION_DUAL_MIDDLE_TWICE && transparent)
        under(mix, written);
}

/* The layer that peel k takes of a pixel, or −1. */
static int taken(MutationId id, const Pixel *pixel, int k)
{
    switch (id) {
    case MUTATION_LAYERS_REVERSED:
        return pixel->count - 1 - k;
    case MUTATION_PASSES_SHORT:
        return k == pixel->peels - 1 ? -1 : k;
    case MUTATION_PEEL_TEST_STRICT:
        return 0;
    case MUTATION_DEPTH_NOT_SWAPPED:
        return k == 0 ? 0 : 1;
    case MUTATION_PREVIOUS_DEPTH_STALE:
        return -1;
    case MUTATION_ONE_DEPTH_BUFFER:
        return k == 0 ? 0 : -1;
    case MUTATION_PEEL_DEPTH_NOT_CLEARED:
        return k < 2 ? k : -1;
    default:
        return k;
    }
}

/* A layer whose ambient part was added without its alpha. */
static void add_ambient(const Pixel *pixel, int layer, double out[4])
{
    double alpha = pixel->layer[layer][3];
    memcpy(out, pixel->layer[layer], sizeof pixel->layer[layer]);
    for (int i = 0; i < 3 && alpha > 0.0; i++)
        out[i] += pixel->ambient[layer][i] / alpha * (1.0 - alpha);
}

static Mix accumulate(MutationId id, const Pixel *pixel)
{
    Mix mix = empty;
    if (id == MUTATION_DESTINATION_ALPHA_ZERO)
        mix.transmittance = 0.0;
    if (id == MUTATION_OPAQUE_BLENDED_FIRST)
        blend(id, false, pixel->opaque, &mix);
    for (int k = 0; k < pixel->peels; k++) {
        int layer = taken(id, pixel, k);
        if (id == MUTATION_ACCUMULATION_CLEARED)
            mix = empty;
        if (layer < 0 || layer >= LAYERS_MAX)
            continue;
        double lit[4];
        memcpy(lit, pixel->layer[layer], sizeof lit);
        if (id == MUTATION_AMBIENT_PER_LAYER)
            add_ambient(pixel, layer, lit);
        blend(id, 2 * layer + 1 == pixel->count, lit, &mix);
    }
    if (id != MUTATION_OPAQUE_BLENDED_FIRST)
        blend(id, false, pixel->opaque, &mix);
    return mix;
}

static void composite(MutationId id, const Pixel *pixel, double out[4])
{
    Mix mix = accumulate(id, pixel);
    double transmittance = mix.transmittance, weight = transmittance;
    if (id == MUTATION_TRANSMITTANCE_AS_COVERAGE)
        weight = 1.0 - transmittance;
    if (id == MUTATION_BACKGROUND_WEIGHTED_WRONGLY)
        weight = 1.0;
    if (id == MUTATION_BACKGROUND_FORGOTTEN)
        weight = 0.0;
    for (int i = 0; i < 3; i++) {
        double c = mix.color[i], background = pixel->background[i];
        if (id == MUTATION_RESOLVED_AS_STRAIGHT)
            c *= 1.0 - transmittance;
        out[i] = c + weight * background;
        if (id == MUTATION_SRGB_BLENDED)
            out[i] = pow(c + weight * encode(background), 2.2);
        if (id == MUTATION_SRGB_ENCODED_TWICE)
            out[i] = encode(out[i]);
    }
    out[3] = id == MUTATION_TRANSMITTANCE_AS_COVERAGE ? transmittance : 1.0 - transmittance;
}

/* ---- the layers of a right rendering ---- */

static void read_color(const TraceStore *store, const char *name, Image *out)
{
    int index = store_find(store, name);
    ck_assert_msg(index >= 0, "%s", name);
    ck_assert_int_eq(store_image(store, index, out), RESULT_OK);
}

/* Forward peeling stores lit colours; the frame's bits are those of deferred peeling. ambient: the
 * ambient light alone, to where it goes. Returns the peels. */
static int read_layers(const Scene *scene, bool ambient, Pixel *pixels)
{
    TraceStore *store;
    Frame frame;
    RenderDesc desc = {.width = WIDTH, .height = HEIGHT, .method = METHOD_FORWARD};
    desc.lights = ambient ? -1 : 0;
    ck_assert_int_eq(store_create(0, &store), RESULT_OK);
    ck_assert_int_eq(pipeline_render(scene, &desc, store_sink(store), &frame), RESULT_OK);
    ck_assert_int_le(frame.peels, LAYERS_MAX);
    ck_assert_uint_eq(frame.layers.lost_to_ties, 0);
    for (int k = -1; k < frame.peels; k++) {
        char name[32] = "opaque.color";
        Image layer;
        if (k >= 0)
            snprintf(name, sizeof name, "peel.%d.color", k);
        read_color(store, name, &layer);
        for (int p = 0; p < WIDTH * HEIGHT; p++) {
            double *out = k >= 0 ? pixels[p].layer[k] : pixels[p].opaque;
            if (ambient)
                out = pixels[p].ambient[k >= 0 ? k : 0]; /* the opaque one is overwritten */
            for (int i = 0; i < 4; i++)
                out[i] = ((const float *)layer.pixels)[4 * p + i];
        }
        image_free(&layer);
    }
    store_destroy(store);
    int peels = frame.peels;
    frame_free(&frame);
    return peels;
}

static Pixel *right_layers(const Scene *scene)
{
    Pixel *pixels = calloc(WIDTH * HEIGHT, sizeof *pixels);
    ck_assert_ptr_nonnull(pixels);
    int peels = read_layers(scene, false, pixels);
    ck_assert_int_eq(read_layers(scene, true, pixels), peels);
    for (Pixel *pixel = pixels; pixel < pixels + WIDTH * HEIGHT; pixel++) {
        pixel->peels = peels;
        while (pixel->count < peels && pixel->layer[pixel->count][3] > 0.0)
            pixel->count++;
        for (int i = 0; i < 3; i++)
            pixel->background[i] = scene->background[i];
    }
    return pixels;
}

/* ---- the comparison ---- */

static void check(const char *name, MutationId id, const Scene *scene, const Pixel *pixels)
{
    RenderDesc desc = {.width = WIDTH, .height = HEIGHT};
    Frame frame;
    desc.mutations = id == MUTATION_COUNT ? 0 : mutation_bit(id);
    ck_assert_msg(pipeline_render(scene, &desc, NULL, &frame) == RESULT_OK, "%s", result_message());
    for (int p = 0; p < WIDTH * HEIGHT; p++) {
        const float *got = (const float *)frame.final.pixels + 4 * p;
        double expected[4];
        composite(id, &pixels[p], expected);
        for (int i = 0; i < 4; i++)
            ck_assert_msg(fabs((double)got[i] - expected[i]) <= 1e-5 * fmax(1.0, expected[i]),
                          "%s, %s: pixel (%d, %d) channel %d: got %.9g, expected %.9g", name,
                          id == MUTATION_COUNT ? "no mistake" : mutation_info(id)->name, p % WIDTH,
                          p / WIDTH, i, (double)got[i], expected[i]);
    }
    frame_free(&frame);
}

static const MutationId modelled[] = {
    MUTATION_COUNT, /* none */
    MUTATION_NOT_PREMULTIPLIED,
    MUTATION_PREMULTIPLIED_TWICE,
    MUTATION_BLEND_FACTORS_SWAPPED,
    MUTATION_OVER_FRONT_TO_BACK,
    MUTATION_DESTINATION_ALPHA_ZERO,
    MUTATION_ACCUMULATION_CLEARED,
    MUTATION_LAYERS_REVERSED,
    MUTATION_DUAL_MIDDLE_TWICE,
    MUTATION_TRANSMITTANCE_AS_COVERAGE,
    MUTATION_BACKGROUND_WEIGHTED_WRONGLY,
    MUTATION_BACKGROUND_FORGOTTEN,
    MUTATION_RESOLVED_AS_STRAIGHT,
    MUTATION_OPAQUE_BLENDED_FIRST,
    MUTATION_PEEL_TEST_STRICT,
    MUTATION_PREVIOUS_DEPTH_STALE,
    MUTATION_DEPTH_NOT_SWAPPED,
    MUTATION_ONE_DEPTH_BUFFER,
    MUTATION_PEEL_DEPTH_NOT_CLEARED,
    MUTATION_PASSES_SHORT,
    MUTATION_ALPHA_TEST_HALF,
    MUTATION_GBUFFER_CLEAR_ALPHA_1,
    MUTATION_AMBIENT_PER_LAYER,
    MUTATION_SRGB_ENCODED_TWICE,
    MUTATION_SRGB_BLENDED,
};

START_TEST(test_model)
{
    static const char *const names[] = {"tutorial", "chain", "crossing_planes", "lamps"};
    static const float background[3] = {0.2f, 0.3f, 0.6f};
    Scene scene;
    ck_assert_int_eq(generate_find(names[_i])->generate(&scene), RESULT_OK);
    memcpy(scene.background, background, sizeof background);
    Pixel *pixels = right_layers(&scene);
    for (size_t i = 0; i < sizeof modelled / sizeof *modelled; i++)
        check(names[_i], modelled[i], &scene, pixels);
    free(pixels);
    scene_free(&scene);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("mutation_model");
    TCase *all = tcase_create("all");
    tcase_set_timeout(all, 300);
    tcase_add_loop_test(all, test_model, 0, 4);
    suite_add_tcase(suite, all);
    return testing_run(suite);
}
