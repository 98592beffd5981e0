/* What the EXR writers and readers share: files, OpenEXRCore's messages, the layout of channels.
 * Private to src/image. */
#ifndef PEEL_IMAGE_EXR_CORE_H
#define PEEL_IMAGE_EXR_CORE_H

#include "base/file.h"
#include "image/image.h"

#include <openexr.h>
#include <stdbool.h>
#include <stdint.h>

/* Names the PixelFormat of a part, so that unorm formats come back as what they were. */
#define EXR_FORMAT_ATTRIBUTE "peel:format"

/* Of zlib. Measured on a smooth float image of 1280×720: level 9 saves 1 % of the size for 1.6
 * times the CPU time. */
enum {
    EXR_SIZE_MAX = 16384, /* per side, as for rendering */
    EXR_ZIP_LEVEL = 1
};

/* How a PixelFormat lies in a file: `channels` values of `bytes` each per pixel. */
typedef struct ExrLayout {
    int channels;
    exr_pixel_type_t type;
    int bytes;    /* of one value in the file: 2 for half, else 4 */
    bool widened; /* values in memory are narrower unsigned integers */
} ExrLayout;

ExrLayout exr_layout(PixelFormat format);

/* The channel's name in the file; index in memory order: R, G, B, A, or 0 alone. Static. */
const char *exr_channel_name(PixelFormat format, int index);
/* The inverse; −1 when the format has no such channel. */
int exr_channel_index(PixelFormat format, const char *name);

/* The type of the channel called name; false when there is none. */
bool exr_find_channel(const exr_attr_chlist_t *list, const char *name, exr_pixel_type_t *type);

/* ---- files ---- */

/* A file being read; at its address until it is closed. */
typedef struct ExrReader {
    const char *path; /* the caller's */
    int descriptor;
    int64_t size;
    exr_context_t context;
} ExrReader;

/* Parses the header. On success the caller ends with exr_reader_close. */
Result exr_reader_open(const char *path, ExrReader *out);
void exr_reader_close(ExrReader *reader);
/* A part as exr_read_sized gives it, which has checked that it is there; after a failure the caller
 * frees *out, too. */
Result exr_reader_image(const ExrReader *reader, int part, const int *size, Image *out);
/* code as a Result, with a message naming the file. */
Result exr_reader_fail(const ExrReader *reader, exr_result_t code);
/* result, or NO_MEMORY where that was well although OpenEXRCore found no memory since
 * exr_message_clear: it may have left something out. */
Result exr_reader_check(const ExrReader *reader, Result result);

/* A file being written; at its address until it is closed. */
typedef struct ExrOutput {
    FileWriter file;
    char *path;
    exr_context_t context;
} ExrOutput;

/* Opens a temporary file and a context for its header. The caller ends with exr_output_close,
 * after a failure too. */
Result exr_output_open(const char *path, ExrOutput *out);
/* Finishes the file and renames it into place if commit is true and all went well, else removes
 * it. */
Result exr_output_close(ExrOutput *output, bool commit);
Result exr_output_fail(const ExrOutput *output, exr_result_t code);

/* Sets up a pipeline that is at its first chunk, as exr_encoding_choose_default_routines does, and
 * mends what OpenEXRCore 3.1.5 gets wrong: what is as long packed as it was must be stored as it
 * was, or readers take one for the other. */
exr_result_t exr_choose_encoding(exr_context_t context, int part, exr_encode_pipeline_t *pipeline);
/* The same for reading, of flat pixels: B44 unpacks floats and integers that are stored as they
 * were, without an error. */
exr_result_t exr_choose_decoding(exr_context_t context, int part, exr_decode_pipeline_t *pipeline);

/* The format that the part says it holds (EXR_FORMAT_ATTRIBUTE), if its channels can hold it. */
bool exr_declared_format(const ExrReader *reader, int part, const exr_attr_chlist_t *list,
                         PixelFormat *out);

/* ---- messages ---- */

/* Keeps OpenEXRCore's first message since exr_message_clear, on the calling thread, instead of
 * letting it go to stderr. */
void exr_message_keep(exr_const_context_t context, exr_result_t code, const char *text);
void exr_message_clear(void);
/* That message, or the library's text for code, or that there was no memory. */
const char *exr_message(exr_result_t code);

#endif
