#include "study/blend_layers.h"

#include "number/numeral.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const channel_names[4] = {"red", "green", "blue", "alpha"};

void blend_colour_init(BlendColour *out)
{
    for (int i = 0; i < 4; i++)
        rational_init(&out->channels[i]);
}

void blend_colour_clear(BlendColour *colour)
{
    for (int i = 0; i < 4; i++)
        rational_clear(&colour->channels[i]);
}

/* ---- one colour ---- */

/* How many hexadecimal digits a code has that begins with '#'; −1 if it is no code. */
static int code_digits(const char *text, size_t length)
{
    if (length == 0 || text[0] != '#')
        return -1;
    for (size_t i = 1; i < length; i++)
        if (!isxdigit((unsigned char)text[i]))
            return -1;
    return length == 7 || length == 9 || length == 17 ? (int)length - 1 : -1;
}

static void read_code(const char *text, int digits, BlendColour *out)
{
    int each = digits == 16 ? 4 : 2;
    for (int i = 0; i < 4; i++) {
        char part[5] = "";
        unsigned long most = digits == 16 ? 65535 : 255;
        memcpy(part, text + 1 + each * i, i * each < digits ? (size_t)each : 0);
        rational_set_ratio(*part ? strtoul(part, NULL, 16) : most, most, &out->channels[i]);
    }
}

typedef struct Token {
    const char *text;
    size_t length;
} Token;

enum {
    TOKENS = 5 /* one more than there may be */
};

/* What is between commas, or between blanks where there is no comma. */
static int split(const char *text, size_t length, Token out[TOKENS])
{
    bool commas = memchr(text, ',', length);
    const char *end = text + length;
    int count = 0;
    while (count < TOKENS) {
        const char *at = text;
        while (at < end && (commas ? *at != ',' : !isspace((unsigned char)*at)))
            at++;
        out[count++] = (Token){text, (size_t)(at - text)};
        if (at == end)
            break;
        text = at + 1;
        while (!commas && text < end && isspace((unsigned char)*text))
            text++;
    }
    return count;
}

static Result read_numbers(const char *place, const char *text, size_t length, int least,
                           BlendColour *out)
{
    Token tokens[TOKENS];
    int count = split(text, length, tokens);
    static const char *const expected[] = {"", "1 to ", "2 to ", "3 to ", ""};
    if (count > 4 || count < least)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: '%.*s': expected %s4 numbers red,green,blue,alpha; found %s", place,
                           (int)(length < 60 ? length : 60), text, expected[least],
                           (const char *[]){"1", "2", "3", "4", "more"}[count - 1]);
    for (int i = 0; i < 4; i++) {
        if (i >= count)
            rational_set(i == 3 ? 1.0 : 0.0, &out->channels[i]);
        else if (numeral_read(tokens[i].text, tokens[i].length, &out->channels[i]) != RESULT_OK)
            return result_fail(RESULT_BAD_INPUT, "%s: %s: %s", place, channel_names[i],
                               result_message());
    }
    return RESULT_OK;
}

Result blend_colour_read(const char *place, const char *text, size_t length, int least,
                         BlendColour *out)
{
    while (length && isspace((unsigned char)*text)) {
        text++;
        length--;
    }
    while (length && isspace((unsigned char)text[length - 1]))
        length--;
    int digits = code_digits(text, length);
    if (digits > 0) {
        read_code(text, digits, out);
        return RESULT_OK;
    }
    if (length && text[0] == '#')
        return result_fail(RESULT_BAD_INPUT,
                           "%s: '%.*s': expected #rrggbb, #rrggbbaa or #rrrrggggbbbbaaaa", place,
                           (int)(length < 60 ? length : 60), text);
    return read_numbers(place, text, length, least, out);
}

/* ---- layers ---- */

static Result make_room(BlendLayers *layers)
{
    if (layers->count < layers->room)
        return RESULT_OK;
    size_t room = layers->room ? 2 * layers->room : 16;
    BlendColour *more = realloc(layers->colours, room * sizeof *more);
    if (!more)
        return result_fail(RESULT_NO_MEMORY, "out of memory for %zu layers", room);
    layers->colours = more;
    layers->room = room;
    return RESULT_OK;
}

static size_t number_bits(const Rational *number)
{
    return mpz_sizeinbase(mpq_numref(number->value), 2) +
           mpz_sizeinbase(mpq_denref(number->value), 2);
}

/* By how much a layer lengthens the fraction: its longest colour's product with its alpha. */
static size_t colour_bits(const BlendColour *colour)
{
    size_t most = 0;
    for (int c = 0; c < 3; c++) {
        size_t bits = number_bits(&colour->channels[c]);
        most = bits > most ? bits : most;
    }
    return most + number_bits(&colour->channels[3]);
}

Result blend_layers_add(const char *place, const char *text, size_t length, BlendLayers *layers)
{
    if (layers->count == BLEND_LAYERS_MOST)
        return result_fail(RESULT_BAD_INPUT, "%s: one layer too many: expected at most %d", place,
                           BLEND_LAYERS_MOST);
    Result result = make_room(layers);
    if (result != RESULT_OK)
        return result;
    BlendColour *colour = &layers->colours[layers->count++]; /* freed with the others */
    blend_colour_init(colour);
    result = blend_colour_read(place, text, length, 4, colour);
    layers->bits += colour_bits(colour);
    if (result == RESULT_OK && layers->bits > BLEND_LAYERS_BITS)
        result = result_fail(RESULT_BAD_INPUT,
                             "%s: too many digits for an exact result: expected numbers of "
                             "together %d bits, this layer's end at %zu",
                             place, BLEND_LAYERS_BITS, layers->bits);
    return result;
}

static bool is_comment(const char *line, size_t length)
{
    while (length && isspace((unsigned char)*line)) {
        line++;
        length--;
    }
    while (length && isspace((unsigned char)line[length - 1]))
        length--;
    return length == 0 || (line[0] == '#' && code_digits(line, length) < 0);
}

enum {
    LINE_ROOM = 8192
};

/* A line without its end; false at the end of the file. *length is LINE_ROOM of a longer one. */
static bool read_line(FILE *in, char line[LINE_ROOM], size_t *length)
{
    int c = getc(in);
    for (*length = 0; c != EOF && c != '\n' && *length < LINE_ROOM; c = getc(in))
        line[(*length)++] = (char)c;
    return c != EOF || *length > 0;
}

static Result load_lines(const char *path, FILE *in, BlendLayers *layers)
{
    char line[LINE_ROOM], place[512];
    size_t length;
    Result result = RESULT_OK;
    for (size_t number = 1; result == RESULT_OK && read_line(in, line, &length); number++) {
        snprintf(place, sizeof place, "%s:%zu", path, number);
        if (length == LINE_ROOM)
            result = result_fail(RESULT_BAD_INPUT, "%s: a line of %d characters or more", place,
                                 LINE_ROOM);
        else if (!is_comment(line, length))
            result = blend_layers_add(place, line, length, layers);
    }
    if (result == RESULT_OK && ferror(in))
        result = result_fail(RESULT_IO, "%s: cannot read: %s", path, strerror(errno));
    return result;
}

Result blend_layers_load(const char *path, BlendLayers *layers)
{
    bool standard = strcmp(path, "-") == 0;
    FILE *in = standard ? stdin : fopen(path, "r");
    if (!in)
        return result_fail(RESULT_IO, "%s: cannot read: %s", path, strerror(errno));
    size_t before = layers->count;
    Result result = load_lines(standard ? "standard input" : path, in, layers);
    if (!standard)
        (void)fclose(in);
    if (result == RESULT_OK && layers->count == before)
        result = result_fail(RESULT_BAD_INPUT, "%s: no layers: expected a line r,g,b,a for each",
                             standard ? "standard input" : path);
    return result;
}

void blend_layers_free(BlendLayers *layers)
{
    for (size_t i = 0; i < layers->count; i++)
        blend_colour_clear(&layers->colours[i]);
    free(layers->colours);
    *layers = (BlendLayers){0};
}
