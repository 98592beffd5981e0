/* What the readers and writers of the three forms share; for vector_*.c alone. */
#ifndef PEEL_BLEND_VECTOR_PARTS_H
#define PEEL_BLEND_VECTOR_PARTS_H

#include "base/file.h"
#include "blend/vector_file.h"
#include "number/rational.h"

#include <stdio.h>

#define VECTOR_CSV_START "# peel-blend-vectors: "

enum {
    VECTOR_TEXT_BLOCK = 1 << 16,
    VECTOR_ROW_MAX = 1024, /* bytes of one vector as text */
    VECTOR_LINE_MAX = 1 << 22,
    VECTOR_NAME = 16,
    VECTOR_NOTE = sizeof((VectorHeader *)0)->arithmetic,
    VECTOR_BINARY_HEAD = 296,
    VECTOR_BINARY_END = 48,
    VECTOR_LAST_ONLY = 1 /* flag: of each sequence there is only the last pixel */
};

extern const char vector_binary_start[8], vector_binary_end[8];

/* The little-endian bytes that files have and checksums are of; returns their number. */
size_t vector_file_source(const float source[4], unsigned char out[16]);
size_t vector_file_pixel(PixelFormat format, const void *pixel, unsigned char *out);

/* ---- writing ---- */

struct VectorWriter {
    FileWriter file;
    VectorForm form;
    VectorHeader header;
    VectorDigest *digest;
    uint64_t next;
    Result failed; /* the first failure */
    char *text;    /* VECTOR_TEXT_BLOCK + VECTOR_ROW_MAX, of which `used` wait to be written */
    size_t used;
};

/* What is known of a sequence besides its layers. */
typedef struct SequenceFacts {
    Rational exact[4];
    unsigned char rounded[VECTOR_PIXEL_MAX];
    double low[4], high[4];
} SequenceFacts;

void vector_write_bytes(VectorWriter *writer, const void *bytes, size_t size);
void vector_write_text_head(VectorWriter *writer);
void vector_write_text_row(VectorWriter *writer, const float source[4], const void *destination,
                           const void *result);
void vector_write_text_sequence(VectorWriter *writer, int layers, const float (*source)[4],
                                const char *results, const SequenceFacts *facts);
void vector_write_text_end(VectorWriter *writer, const char *checksum);

/* ---- reading ---- */

typedef struct VectorRow {
    uint64_t index;
    float source[4];
    uint32_t destination[4], result[4]; /* bits of the format */
} VectorRow;

/* As a file has it; the arrays are the reader's. */
typedef struct VectorSequence {
    uint64_t index;
    int layers;
    float (*source)[4]; /* room for SEQUENCE_LAYERS_MAX, as the others */
    unsigned char *results;
    bool *given;
} VectorSequence;

typedef struct VectorFormReader {
    /* The header but for its equation's and set's consistency; the stream is behind it then. */
    Result (*head)(VectorReader *reader, VectorHeader *header);
    Result (*row)(VectorReader *reader, VectorRow *out);
    /* layers: how many the sequence has, which the file must say too. */
    Result (*sequence)(VectorReader *reader, int layers, VectorSequence *out);
    Result (*end)(VectorReader *reader, uint64_t *count, char checksum[VECTOR_DIGEST_TEXT]);
} VectorFormReader;

extern const VectorFormReader vector_csv_reader, vector_json_reader, vector_binary_reader;

struct VectorReader {
    FILE *stream;
    char *path;
    const VectorFormReader *form;
    VectorHeader header;
    VectorDigest *digest;
    uint64_t next; /* vectors or sequences that were handed out */
    uint64_t row;  /* vectors that were read */
    bool ended;    /* the end was read, too */
    bool last_only;
    unsigned char *buffer; /* VECTOR_TEXT_BLOCK, of which [at, filled) is unread */
    size_t at, filled;
    uint64_t position; /* of the byte at `at` in the file */
    char *line;        /* the current line, without its end; of text */
    size_t length, room;
    uint64_t line_number;  /* 0: none yet, and of binary files */
    float (*expected)[4];  /* VECTOR_BLOCK */
    unsigned char *pixels; /* VECTOR_BLOCK pixels */
};

/* BAD_INPUT with path, line or byte, and the text. */
Result vector_read_fail(const VectorReader *reader, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
#if defined __clang_analyzer__ || defined PEEL_ANALYZER /* see result_fail */
#define vector_read_fail(reader, ...)                                                              \
    __extension__({                                                                                \
        (void)vector_read_fail(reader, __VA_ARGS__);                                               \
        RESULT_BAD_INPUT;                                                                          \
    })
#endif

/* The start of text as it can stand in a message. */
enum {
    VECTOR_QUOTE = 48
};
const char *vector_read_quote(const char *text, char out[VECTOR_QUOTE]);

/* The note of the header: as much of text as there is room for, in characters that every form can
 * hold. */
void vector_read_note(const char *text, char out[VECTOR_NOTE]);

/* Fills the buffer where it is empty; IO. *any: whether there is a byte. */
Result vector_read_more(VectorReader *reader, bool *any);

/* The next line to reader->line. what: was expected instead of the file's end. */
Result vector_read_line(VectorReader *reader, const char *what);

/* Nothing but blank lines may follow. */
Result vector_read_rest(VectorReader *reader);

/* Texts of the header to what they mean. */
Result vector_read_set(const VectorReader *reader, const char *text, VectorSet *out);
Result vector_read_format(const VectorReader *reader, const char *text, PixelFormat *out);
Result vector_read_equation(const VectorReader *reader, const char *text, BlendEquation *out);
Result vector_read_version(const VectorReader *reader, const char *text);
bool vector_read_count(const char *text, uint64_t *out); /* decimal, at most 2^53 − 1 */

/* A channel of a stored pixel, from text. name: of the column or member. */
Result vector_read_channel(const VectorReader *reader, const char *name, const char *text,
                           uint32_t *bits);
Result vector_read_source(const VectorReader *reader, const char *name, const char *text,
                          float *out);
/* The bits of a float that is one of the format's: half or float. False where it is not. */
bool vector_read_bits(PixelFormat format, float x, uint32_t *bits);

#endif
