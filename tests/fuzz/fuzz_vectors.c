/* Files of test vectors: a file that can be read, written in every form, reads the same. */
#include "fuzz.h"

#include "blend/sequence.h"
#include "blend/vector_file.h"

#include <stdbool.h>
#include <stdlib.h>

enum {
    KEPT_MAX = 1 << 16 /* pixels of results: more than a file of some KiB has */
};

/* What a file holds besides its operands, which are those of its header. */
typedef struct Contents {
    VectorHeader header;
    size_t count; /* pixels */
    unsigned char pixels[KEPT_MAX * VECTOR_PIXEL_MAX];
    bool given[KEPT_MAX]; /* of sequences: whether the file has this pixel */
} Contents;

static float source[VECTOR_BLOCK][4];
static unsigned char destination[VECTOR_BLOCK * VECTOR_PIXEL_MAX];

static bool has_sequences(const Contents *contents)
{
    return contents->header.spec.set == VECTORS_SEQUENCES;
}

/* The next pixels; *some is 0 at the end. */
static Result read_some(VectorReader *reader, Contents *out, size_t *some)
{
    size_t size = format_pixel_bytes(out->header.spec.format);
    unsigned char *at = out->pixels + out->count * size;
    int layers = 0;
    Result result;
    if (has_sequences(out)) {
        result = vector_reader_next_sequence(reader, &layers, source, at, out->given + out->count);
        *some = (size_t)layers;
        FUZZ_CHECK(layers >= 0 && layers <= SEQUENCE_LAYERS_MAX, "%d layers", layers);
    } else {
        result = vector_reader_next(reader, source, destination, at, some);
    }
    return result;
}

/* RESULT_UNSUPPORTED for more pixels than are kept. */
static Result read_all(const char *path, Contents *out)
{
    VectorReader *reader = NULL;
    size_t some = 1;
    out->count = 0;
    Result result = vector_reader_open(path, &out->header, &reader);
    while (result == RESULT_OK && some) {
        if (out->count > KEPT_MAX - VECTOR_BLOCK)
            result = RESULT_UNSUPPORTED;
        else
            result = read_some(reader, out, &some);
        out->count += result == RESULT_OK ? some : 0;
    }
    vector_reader_close(reader);
    return result;
}

static void write_all(const char *path, VectorForm form, const Contents *contents)
{
    const VectorHeader *header = &contents->header;
    size_t size = format_pixel_bytes(header->spec.format);
    VectorWriter *writer;
    Result result = vector_writer_open(path, form, header, &writer);
    FUZZ_CHECK(result == RESULT_OK, "%s", result_message());
    const unsigned char *at = contents->pixels;
    for (uint64_t i = 0; i < header->count && has_sequences(contents); i++) {
        int layers = sequence_make(&header->spec, header->first + i, source);
        result = vector_writer_put_sequence(writer, layers, (const float(*)[4])source, at);
        FUZZ_CHECK(result == RESULT_OK, "%s", result_message());
        at += (size_t)layers * size;
    }
    for (uint64_t i = 0; i < header->count && !has_sequences(contents); i += VECTOR_BLOCK) {
        uint64_t left = header->count - i;
        size_t count = left < VECTOR_BLOCK ? (size_t)left : VECTOR_BLOCK;
        vectors_make(&header->spec, header->first + i, count, source, destination);
        result = vector_writer_put(writer, (const float(*)[4])source, destination, at, count);
        FUZZ_CHECK(result == RESULT_OK, "%s", result_message());
        at += count * size;
    }
    result = vector_writer_close(writer, true);
    FUZZ_CHECK(result == RESULT_OK, "%s", result_message());
}

/* NaN is NaN: text has no other bits of it. */
static void check_equal(const Contents *got, const Contents *expected, VectorForm form)
{
    const VectorHeader *a = &got->header, *b = &expected->header;
    PixelFormat format = b->spec.format;
    const FormatInfo *info = format_info(format);
    size_t size = format_pixel_bytes(format);
    FUZZ_CHECK(a->spec.set == b->spec.set && a->spec.format == format &&
                   a->spec.seed == b->spec.seed && a->first == b->first && a->count == b->count &&
                   strcmp(a->arithmetic, b->arithmetic) == 0 && got->count == expected->count &&
                   memcmp(&a->equation, &b->equation, sizeof a->equation) == 0,
               "the head as %s", vector_form_name(form));
    for (size_t i = 0; i < expected->count; i++)
        for (int c = 0; c < info->channels; c++)
            FUZZ_CHECK((has_sequences(expected) && !expected->given[i]) ||
                           format_ulp(info->kind, format_bits(format, got->pixels + i * size, c),
                                      format_bits(format, expected->pixels + i * size, c)) == 0,
                       "pixel %zu as %s", i, vector_form_name(form));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static Contents contents, again;
    memset(&contents.header, 0, sizeof contents.header);
    Result result = read_all(fuzz_file(0, data, size), &contents);
    if (result != RESULT_OK) {
        if (result != RESULT_UNSUPPORTED)
            fuzz_check_message();
        return 0;
    }
    /* A sequence may have its last pixel alone; what is written has all. */
    for (int form = 0; form < VECTOR_FORM_COUNT; form++) {
        write_all(fuzz_output(), (VectorForm)form, &contents);
        result = read_all(fuzz_output(), &again);
        FUZZ_CHECK(result == RESULT_OK, "%s", result_message());
        check_equal(&again, &contents, (VectorForm)form);
    }
    return 0;
}
