/* libFuzzer's own mutations, and every other time one of the JSON tree inside a .gltf or .glb file:
 * a value replaced, moved, doubled or left out, so that the text stays JSON and the readers behind
 * the parser are reached. libFuzzer alone calls it. */
#include "fuzz.h"

#include "base/random.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdlib.h>

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t max_size) __attribute__((weak));
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed);

/* ---- the tree -------------------------------------------------------------------------------- */

static size_t count_values(const json_t *tree)
{
    size_t count = 0, i;
    const char *key;
    json_t *child;
    json_array_foreach(tree, i, child)
    {
        count += 1 + count_values(child);
    }
    json_object_foreach((json_t *)tree, key, child)
    {
        count += 1 + count_values(child);
    }
    return count;
}

/* A value's place: in an array by index, in an object by key. */
typedef struct Place {
    json_t *parent;
    size_t index;
    const char *key;
} Place;

/* The value of that number in order, from 0; *number counts down. */
static bool find(json_t *tree, size_t *number, Place *out)
{
    size_t i;
    const char *key;
    json_t *child;
    json_array_foreach(tree, i, child)
    {
        *out = (Place){tree, i, NULL};
        if ((*number)-- == 0 || find(child, number, out))
            return true;
    }
    json_object_foreach(tree, key, child)
    {
        *out = (Place){tree, 0, key};
        if ((*number)-- == 0 || find(child, number, out))
            return true;
    }
    return false;
}

static Place find_any(json_t *tree, Random *random)
{
    size_t count = count_values(tree), number = count ? random_bits(random) % count : 0;
    Place place = {0};
    return count && find(tree, &number, &place) ? place : (Place){0};
}

static json_t *value_at(const Place *place)
{
    return place->key ? json_object_get(place->parent, place->key)
                      : json_array_get(place->parent, place->index);
}

static void put(const Place *place, json_t *value)
{
    if (place->key)
        json_object_set_new(place->parent, place->key, value);
    else
        json_array_set_new(place->parent, place->index, value);
}

static void leave_out(const Place *place)
{
    if (place->key)
        json_object_del(place->parent, place->key);
    else
        json_array_remove(place->parent, place->index);
}

/* ---- one change ------------------------------------------------------------------------------ */

/* The integer and `step`, modulo 2^64. */
static json_t *beside(const json_t *integer, uint64_t step)
{
    return json_integer((json_int_t)((uint64_t)json_integer_value(integer) + step));
}

static json_t *odd_value(const json_t *old, Random *random)
{
    static const json_int_t integers[] = {0,    1,          2,          3,           -1,
                                          4,    252,        5121,       5123,        5125,
                                          5126, 0x7fffffff, 0xffffffff, 0x100000000, INT64_MAX};
    static const double reals[] = {0.0,   -0.0, 0.5,  1.0,  -1.0,   1e-45, 1e-30,
                                   1e-10, 1e10, 1e15, 1e38, 3.5e38, 1e308, -1e15};
    json_int_t integer = integers[random_bits(random) % (sizeof integers / sizeof *integers)];
    switch (random_bits(random) % 6) {
    case 0:
        return json_real(reals[random_bits(random) % (sizeof reals / sizeof *reals)]);
    case 1:
        return json_is_integer(old) ? beside(old, 1) : json_null();
    case 2:
        return json_is_integer(old) ? beside(old, UINT64_MAX) : json_true();
    case 3:
        return random_bits(random) % 2 ? json_array() : json_object();
    case 4:
        return json_string(random_bits(random) % 2 ? "" : "VEC3");
    default:
        return json_integer(integer);
    }
}

static void change(json_t *tree, Random *random)
{
    Place place = find_any(tree, random), other = find_any(tree, random);
    if (!place.parent)
        return;
    switch (random_bits(random) % 6) {
    case 0:
        leave_out(&place);
        return;
    case 1:
        put(&place, json_deep_copy(value_at(&other)));
        return;
    case 2: /* once more at the end */
        if (!place.key)
            json_array_append_new(place.parent, json_deep_copy(value_at(&place)));
        else if (other.key)
            json_object_set_new(place.parent, other.key, json_deep_copy(value_at(&other)));
        return;
    default:
        put(&place, odd_value(value_at(&place), random));
        return;
    }
}

/* ---- files ----------------------------------------------------------------------------------- */

static uint32_t word(const uint8_t *bytes)
{
    return bytes[0] | (uint32_t)bytes[1] << 8 | (uint32_t)bytes[2] << 16 | (uint32_t)bytes[3] << 24;
}

static void put_word(uint8_t *bytes, size_t value)
{
    for (int i = 0; i < 4; i++)
        bytes[i] = (uint8_t)(value >> 8 * i);
}

/* Where the JSON text is: *begin and *end; the whole but in a binary file. */
static bool find_text(const uint8_t *data, size_t size, size_t *begin, size_t *end)
{
    bool binary = size >= 20 && memcmp(data, "glTF", 4) == 0;
    *begin = binary ? 20 : 0;
    *end = binary ? 20 + (size_t)word(data + 12) : size;
    return *end <= size;
}

/* The tree in place of the text; 0 where there is no room. */
static size_t put_tree(const json_t *tree, uint8_t *data, size_t size, size_t max_size,
                       size_t begin, size_t end)
{
    char *text = json_dumps(tree, JSON_COMPACT | JSON_ENCODE_ANY);
    size_t length = text ? strlen(text) : 0, padding = begin ? -length % 4 : 0;
    size_t out = begin + length + padding + (size - end);
    if (!text || out > max_size) {
        free(text);
        return 0;
    }
    memmove(data + begin + length + padding, data + end, size - end);
    memcpy(data + begin, text, length);
    memset(data + begin + length, ' ', padding);
    free(text);
    if (begin) {
        put_word(data + 8, out);
        put_word(data + 12, length + padding);
    }
    return out;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t max_size, unsigned seed)
{
    Random random = random_seed(seed);
    size_t begin, end, out = 0;
    json_t *tree = NULL;
    if (random_bits(&random) % 3 && find_text(data, size, &begin, &end))
        tree = json_loadb((const char *)data + begin, end - begin, 0, NULL);
    if (tree) {
        for (uint64_t i = random_bits(&random) % 4; i < 4; i++)
            change(tree, &random);
        out = put_tree(tree, data, size, max_size, begin, end);
        json_decref(tree);
    }
    return out ? out : LLVMFuzzerMutate(data, size, max_size);
}
