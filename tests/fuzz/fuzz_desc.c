/* Small languages: numbers, hexadecimal floats, equations, arithmetics and colours as text, and the
 * web engine's settings by name. The first byte of an input says which. What is read, printed and
 * read again is the same. */
#include "fuzz.h"

#include "blend/arithmetic.h"
#include "frame/setting.h"
#include "number/hexfloat.h"
#include "number/numeral.h"
#include "scene/blob.h"
#include "scene/generate.h"
#include "study/blend_layers.h"
#include "web/engine.h"

#include <jansson.h>
#include <math.h>
#include <stdlib.h>

/* ---- numbers --------------------------------------------------------------------------------- */

/* The C library's number is the nearest double of what was read. */
static void check_nearest(const char *text, const Rational *read)
{
    char *end;
    double value = strtod(text, &end);
    if (*end || end == text || strpbrk(text, "()"))
        return;
    double ours = rational_to_double(read);
    FUZZ_CHECK(ours == value || (isnan(ours) && isnan(value)), "'%s': %a, expected %a", text, ours,
               value);
}

static void try_numeral(const char *text)
{
    Rational read, again;
    rational_init(&read);
    rational_init(&again);
    if (numeral_read(text, strlen(text), &read) == RESULT_OK) {
        char *fraction = numeral_fraction(&read), both[NUMERAL_BOTH];
        check_nearest(text, &read);
        numeral_both(rational_to_double(&read), both);
        if (numeral_read(fraction, strlen(fraction), &again) == RESULT_OK)
            FUZZ_CHECK(rational_equal(&read, &again), "'%s', printed '%s'", text, fraction);
        else
            FUZZ_CHECK(strlen(fraction) > 1000 || strchr(fraction, '^'), "printed '%s': %s",
                       fraction, result_message());
        free(fraction);
    } else {
        fuzz_check_message();
    }
    rational_clear(&read);
    rational_clear(&again);
}

static void try_hexfloat(const char *text)
{
    char printed[HEXFLOAT_TEXT], *end;
    float value, again;
    double expected = strtod(text, &end);
    bool whole = *text && !*end && strpbrk(text, "xXiInN") && !strpbrk(text, " \t\n\v\f\r");
    bool exact = whole && (isnan(expected) || (double)(float)expected == expected);
    if (!hexfloat_parse(text, &value)) {
        /* strtod may have rounded: to 0, to infinity, or more digits than a double has. */
        bool rounded =
            expected == 0.0 || (isinf(expected) && strpbrk(text, "xX")) || strlen(text) > 14;
        FUZZ_CHECK(!exact || rounded, "'%s' is a float", text);
        return;
    }
    FUZZ_CHECK(isnan(value) || (double)value == expected, "'%s': %a, expected %a", text,
               (double)value, expected);
    hexfloat_print(value, printed);
    FUZZ_CHECK(hexfloat_parse(printed, &again) && (isnan(value) ? isnan(again) : again == value) &&
                   !signbit(again) == !(signbit(value) && !isnan(value)),
               "'%s', printed '%s'", text, printed);
}

/* ---- blending -------------------------------------------------------------------------------- */

static void try_equation(const char *text)
{
    BlendEquation read, again;
    char printed[EQUATION_TEXT];
    if (equation_parse(text, &read) != RESULT_OK) {
        fuzz_check_message();
        return;
    }
    equation_print(&read, printed);
    FUZZ_CHECK(equation_parse(printed, &again) == RESULT_OK &&
                   memcmp(&read, &again, sizeof read) == 0,
               "'%s', printed '%s'", text, printed);
}

/* A blend in each format that the arithmetic is of. */
static void blend(const Arithmetic *arithmetic)
{
    static const float source[1][4] = {{0.3f, -2.0f, 1e30f, 0.75f}};
    const BlendEquation *under = &equation_info(EQUATION_UNDER)->equation;
    for (int i = 0; i < ARITHMETIC_FORMATS; i++) {
        unsigned char pixel[16];
        memset(pixel, 0x38, sizeof pixel);
        if (!arithmetic_refuses(arithmetic, under, arithmetic_formats[i]))
            arithmetic_blend(arithmetic, under, arithmetic_formats[i], 1, source, pixel);
    }
}

static void try_arithmetic(const char *text)
{
    Arithmetic read, again;
    char printed[ARITHMETIC_TEXT];
    if (arithmetic_parse(text, &read) != RESULT_OK) {
        fuzz_check_message();
        return;
    }
    arithmetic_print(&read, printed);
    FUZZ_CHECK(arithmetic_parse(printed, &again) == RESULT_OK &&
                   memcmp(&read, &again, sizeof read) == 0,
               "'%s', printed '%s'", text, printed);
    blend(&read);
}

static void try_colour(const char *text)
{
    BlendLayers layers = {0};
    size_t length = strlen(text);
    for (int i = 0; i < 2; i++)
        if (blend_layers_add("input", text, length, &layers) != RESULT_OK)
            fuzz_check_message();
    FUZZ_CHECK(layers.count <= 2, "%zu layers", layers.count);
    blend_layers_free(&layers);
}

/* ---- the engine ------------------------------------------------------------------------------ */

enum {
    STEPS_MAX = 16
};

static void check_json(const char *text)
{
    json_error_t error;
    FUZZ_CHECK(text, "%s", result_message());
    json_t *value = json_loads(text, 0, &error);
    FUZZ_CHECK(value, "%s: %.60s", error.text, text);
    json_decref(value);
}

static void open_engine(void)
{
    static unsigned char *bytes;
    static size_t count;
    Scene scene;
    if (!bytes) {
        FUZZ_CHECK(generate_find("crossing_planes")->generate(&scene) == RESULT_OK &&
                       blob_write(&scene, &bytes, &count) == RESULT_OK,
                   "%s", result_message());
        scene_free(&scene);
    }
    FUZZ_CHECK(engine_open(bytes, count) == RESULT_OK, "%s", engine_message());
}

/* Whole numbers as often as any others. */
static double take_value(FuzzBytes *bytes)
{
    return fuzz_take(bytes, 1) & 1 ? fuzz_take_double(bytes)
                                   : (double)(int8_t)fuzz_take(bytes, 1) / 4.0;
}

static int set_any(FuzzBytes *bytes)
{
    static const char *const others[] = {
        "method",  "passes",    "lights",          "camera",     "time",         "bias",
        "unfused", "draw-seed", "nodes-per-pixel", "draw-order", "opaque-blend", "no such name"};
    size_t count = sizeof others / sizeof *others, which = fuzz_take(bytes, 1);
    which %= count + SETTING_COUNT;
    const char *name =
        which < count ? others[which] : setting_info((SettingId)(which - count))->name;
    return engine_set(name, take_value(bytes));
}

static int set_camera(FuzzBytes *bytes)
{
    double world[16] = {[0] = 1, [5] = 1, [10] = 1, [15] = 1, [14] = 8};
    double lens[3] = {0.8, 0.1, 100.0};
    size_t element = fuzz_take(bytes, 1) % 19;
    *(element < 16 ? &world[element] : &lens[element - 16]) = take_value(bytes);
    return engine_set_camera((int)(int8_t)fuzz_take(bytes, 1), world, lens[0], lens[1], lens[2]);
}

static int render(FuzzBytes *bytes)
{
    int width = 1 + (int)(fuzz_take(bytes, 1) % 24), height = 1 + (int)(fuzz_take(bytes, 1) % 16);
    int result = engine_render(width, height, fuzz_take(bytes, 1) & 1);
    if (result == RESULT_OK)
        check_json(engine_frame());
    return result;
}

static int history(FuzzBytes *bytes)
{
    int x = (int8_t)fuzz_take(bytes, 1), y = (int8_t)fuzz_take(bytes, 1);
    const char *text = engine_history(x, y);
    if (text)
        check_json(text);
    return text ? RESULT_OK : RESULT_BAD_INPUT;
}

static int step(FuzzBytes *bytes)
{
    double value;
    switch (fuzz_take(bytes, 1) % 7) {
    case 0:
    case 1:
        return set_any(bytes);
    case 2:
        value = take_value(bytes);
        return engine_set_material((int)(int8_t)fuzz_take(bytes, 1), (int)fuzz_take(bytes, 1) % 10,
                                   value);
    case 3:
        value = take_value(bytes);
        return engine_set_ambient(value, take_value(bytes), 0.25);
    case 4:
        return set_camera(bytes);
    case 5:
        return render(bytes);
    default:
        return history(bytes);
    }
}

static void try_engine(const uint8_t *data, size_t size)
{
    FuzzBytes bytes = {data, size};
    open_engine();
    for (int i = 0; i < STEPS_MAX && bytes.left; i++)
        if (step(&bytes) != RESULT_OK)
            fuzz_check_message();
    check_json(engine_scene());
    check_json(engine_settings());
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static void (*const texts[])(const char *text) = {try_numeral, try_hexfloat, try_equation,
                                                      try_arithmetic, try_colour};
    enum {
        TEXTS = sizeof texts / sizeof *texts
    };
    if (size == 0)
        return 0;
    size_t which = data[0] % (TEXTS + 1);
    if (which == TEXTS) {
        try_engine(data + 1, size - 1);
        return 0;
    }
    char *text = malloc(size);
    FUZZ_CHECK(text, "out of memory");
    memcpy(text, data + 1, size - 1);
    text[size - 1] = '\0';
    texts[which](text);
    free(text);
    return 0;
}
