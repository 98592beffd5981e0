#include "image/exr_core.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static _Thread_local char message[512];

ExrLayout exr_layout(PixelFormat format)
{
    const FormatInfo *info = format_info(format);
    ExrLayout layout = {info->channels, EXR_PIXEL_UINT, 4, info->channel_bytes < 4};
    if (info->kind == KIND_FLOAT)
        layout.type = EXR_PIXEL_FLOAT;
    if (info->kind == KIND_HALF)
        layout = (ExrLayout){info->channels, EXR_PIXEL_HALF, 2, false};
    return layout;
}

const char *exr_channel_name(PixelFormat format, int index)
{
    static const char *const colors[] = {"R", "G", "B", "A"};
    if (format_info(format)->channels > 1)
        return colors[index];
    return format == FORMAT_R32UI ? "ID" : format == FORMAT_R32F ? "R" : "Z";
}

int exr_channel_index(PixelFormat format, const char *name)
{
    for (int i = 0; i < format_info(format)->channels; i++)
        if (strcmp(exr_channel_name(format, i), name) == 0)
            return i;
    return -1;
}

/* An allocation of OpenEXRCore's failed: it says something else of that, or goes on without. */
static _Thread_local bool starved;

static bool is_memory(exr_result_t code)
{
    return starved || code == EXR_ERR_OUT_OF_MEMORY;
}

void exr_message_keep(exr_const_context_t context, exr_result_t code, const char *text)
{
    (void)context;
    (void)code;
    if (!message[0])
        snprintf(message, sizeof message, "%s", text);
}

void exr_message_clear(void)
{
    message[0] = 0;
    starved = false;
}

const char *exr_message(exr_result_t code)
{
    if (is_memory(code))
        return "out of memory";
    return message[0] ? message : exr_get_default_error_message(code);
}

bool exr_find_channel(const exr_attr_chlist_t *list, const char *name, exr_pixel_type_t *type)
{
    for (int i = 0; i < list->num_channels; i++)
        if (strcmp(list->entries[i].name.str, name) == 0) {
            *type = list->entries[i].pixel_type;
            return true;
        }
    return false;
}

/* ---- reading ---- */

Result exr_reader_fail(const ExrReader *reader, exr_result_t code)
{
    return result_fail(is_memory(code) ? RESULT_NO_MEMORY : RESULT_BAD_INPUT,
                       "%s: not a readable OpenEXR file: %s", reader->path, exr_message(code));
}

Result exr_reader_check(const ExrReader *reader, Result result)
{
    return result == RESULT_OK && starved ? exr_reader_fail(reader, EXR_ERR_OUT_OF_MEMORY) : result;
}

static int64_t read_at(exr_const_context_t context, void *user, void *buffer, uint64_t size,
                       uint64_t offset, exr_stream_error_func_ptr_t error)
{
    (void)context;
    (void)error;
    const ExrReader *reader = user;
    uint64_t done = 0;
    while (done < size) {
        ssize_t got =
            pread(reader->descriptor, (char *)buffer + done, size - done, (off_t)(offset + done));
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0)
            return -1;
        if (got == 0)
            break;
        done += (uint64_t)got;
    }
    return (int64_t)done;
}

static int64_t file_size(exr_const_context_t context, void *user)
{
    (void)context;
    return ((const ExrReader *)user)->size;
}

void exr_reader_close(ExrReader *reader)
{
    if (reader->context)
        exr_finish(&reader->context);
    if (reader->descriptor >= 0)
        close(reader->descriptor);
}

/* On success the caller ends with reader_close. */
/* What a broken chunk of run lengths leaves out is 0, and not what memory had there. */
static void *allocate_zeroed(size_t bytes)
{
    void *memory = calloc(bytes, 1);
    starved |= !memory;
    return memory;
}

Result exr_reader_open(const char *path, ExrReader *out)
{
    /* A pipe must not be waited for. */
    int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    *out = (ExrReader){.path = path, .descriptor = descriptor};
    struct stat status;
    Result result = RESULT_OK;
    if (descriptor < 0 || fstat(descriptor, &status) != 0)
        result = result_fail(RESULT_IO, "%s: cannot read this file: %s", path, strerror(errno));
    else if (!S_ISREG(status.st_mode))
        result = result_fail(RESULT_BAD_INPUT, "%s: not a regular file", path);
    if (result != RESULT_OK) {
        exr_reader_close(out);
        return result;
    }
    out->size = status.st_size;
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = exr_message_keep;
    setup.user_data = out;
    setup.alloc_fn = allocate_zeroed;
    setup.free_fn = free;
    setup.read_fn = read_at;
    setup.size_fn = file_size;
    setup.max_image_width = setup.max_image_height = EXR_SIZE_MAX;
    exr_message_clear();
    exr_result_t code = exr_start_read(&out->context, path, &setup);
    if (code == EXR_ERR_SUCCESS && !starved)
        return RESULT_OK;
    result = exr_reader_fail(out, code);
    exr_reader_close(out);
    return result;
}

/* ---- writing ---- */

static int64_t write_at(exr_const_context_t context, void *user, const void *data, uint64_t size,
                        uint64_t offset, exr_stream_error_func_ptr_t error)
{
    (void)context;
    (void)error; /* the file's own message is kept and says more */
    ExrOutput *output = user;
    return file_writer_put_at(&output->file, data, size, offset) == RESULT_OK ? (int64_t)size : -1;
}

Result exr_output_fail(const ExrOutput *output, exr_result_t code)
{
    if (output->file.error)
        return result_fail(RESULT_IO, "%s: cannot write this file: %s", output->path,
                           strerror(output->file.error));
    return result_fail(is_memory(code) ? RESULT_NO_MEMORY : RESULT_INTERNAL,
                       "%s: OpenEXR refused to write: %s", output->path, exr_message(code));
}

Result exr_output_open(const char *path, ExrOutput *out)
{
    *out = (ExrOutput){.path = strdup(path)};
    if (!out->path)
        return result_fail(RESULT_NO_MEMORY, "%s: out of memory", path);
    Result result = file_writer_open(path, &out->file);
    if (result != RESULT_OK)
        return result;
    exr_context_initializer_t setup = EXR_DEFAULT_CONTEXT_INITIALIZER;
    setup.error_handler_fn = exr_message_keep;
    setup.user_data = out;
    setup.write_fn = write_at;
    exr_message_clear();
    exr_result_t code = exr_start_write(&out->context, path, EXR_WRITE_FILE_DIRECTLY, &setup);
    return code == EXR_ERR_SUCCESS ? RESULT_OK : exr_output_fail(out, code);
}

Result exr_output_close(ExrOutput *output, bool commit)
{
    exr_message_clear();
    exr_result_t code = output->context ? exr_finish(&output->context) : EXR_ERR_SUCCESS;
    Result result = RESULT_OK;
    if (commit && code != EXR_ERR_SUCCESS)
        result = exr_output_fail(output, code);
    Result closed = file_writer_close(&output->file, commit && code == EXR_ERR_SUCCESS);
    free(output->path);
    return result == RESULT_OK ? closed : result;
}

typedef exr_result_t (*Compress)(exr_encode_pipeline_t *pipeline);

static _Thread_local Compress default_compress;

static exr_result_t compress(exr_encode_pipeline_t *pipeline)
{
    exr_result_t code = default_compress(pipeline);
    if (code == EXR_ERR_SUCCESS && pipeline->compressed_bytes == pipeline->packed_bytes)
        memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, pipeline->packed_bytes);
    return code;
}

exr_result_t exr_choose_encoding(exr_context_t context, int part, exr_encode_pipeline_t *pipeline)
{
    exr_result_t code = exr_encoding_choose_default_routines(context, part, pipeline);
    if (code == EXR_ERR_SUCCESS && pipeline->compress_fn) {
        default_compress = pipeline->compress_fn;
        pipeline->compress_fn = compress;
    }
    return code;
}

typedef exr_result_t (*Decompress)(exr_decode_pipeline_t *pipeline);

static _Thread_local Decompress default_decompress;

static exr_result_t decompress(exr_decode_pipeline_t *pipeline)
{
    if (pipeline->chunk.packed_size != pipeline->chunk.unpacked_size)
        return default_decompress(pipeline);
    memmove(pipeline->unpacked_buffer, pipeline->packed_buffer, pipeline->chunk.packed_size);
    return EXR_ERR_SUCCESS;
}

exr_result_t exr_choose_decoding(exr_context_t context, int part, exr_decode_pipeline_t *pipeline)
{
    exr_result_t code = exr_decoding_choose_default_routines(context, part, pipeline);
    if (code == EXR_ERR_SUCCESS && pipeline->decompress_fn) {
        default_decompress = pipeline->decompress_fn;
        pipeline->decompress_fn = decompress;
    }
    return code;
}
