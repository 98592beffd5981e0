/* Writing. Source of the file format: "OpenEXR File Layout", openexr.com; OpenEXRCore 3.1. */
#include "image/exr.h"

#include "base/memory.h"
#include "image/exr_core.h"

#include <stdlib.h>
#include <string.h>

struct ExrWriter {
    ExrOutput output;
    ExrPart *parts; /* names are the caller's, not used after opening */
    int part_count;
    int next;                  /* part to be given */
    const ImageWindow *window; /* of a single part; NULL: all are from 0, 0 on */
};

/* The format wants one display window for all parts: their union. */
static exr_attr_box2i_t display_window(const ExrWriter *writer)
{
    exr_attr_box2i_t window = {.max = {.x = 0, .y = 0}};
    const ImageWindow *given = writer->window;
    if (given)
        return (exr_attr_box2i_t){.min = {.x = given->left, .y = given->top},
                                  .max = {.x = given->right, .y = given->bottom}};
    for (int i = 0; i < writer->part_count; i++) {
        const ExrPart *part = &writer->parts[i];
        window.max.x = part->width > window.max.x + 1 ? part->width - 1 : window.max.x;
        window.max.y = part->height > window.max.y + 1 ? part->height - 1 : window.max.y;
    }
    return window;
}

static exr_result_t add_part(exr_context_t context, const ExrPart *part, const ImageWindow *window,
                             const exr_attr_box2i_t *display)
{
    const exr_attr_box2i_t data = {
        .min = {.x = window ? window->x : 0, .y = window ? window->y : 0},
        .max = {.x = (window ? window->x : 0) + part->width - 1,
                .y = (window ? window->y : 0) + part->height - 1}};
    ExrLayout layout = exr_layout(part->format);
    int index;
    exr_result_t code = exr_add_part(context, part->name, EXR_STORAGE_SCANLINE, &index);
    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr_simple(context, index, part->width, part->height,
                                                   EXR_COMPRESSION_ZIP);
    if (code == EXR_ERR_SUCCESS)
        code = exr_set_data_window(context, index, &data);
    if (code == EXR_ERR_SUCCESS)
        code = exr_set_display_window(context, index, display);
    if (code == EXR_ERR_SUCCESS)
        code = exr_set_zip_compression_level(context, index, EXR_ZIP_LEVEL);
    for (int i = 0; i < layout.channels && code == EXR_ERR_SUCCESS; i++)
        code = exr_add_channel(context, index, exr_channel_name(part->format, i), layout.type,
                               EXR_PERCEPTUALLY_LINEAR, 1, 1);
    if (code == EXR_ERR_SUCCESS)
        code = exr_attr_set_string(context, index, EXR_FORMAT_ATTRIBUTE,
                                   format_info(part->format)->name);
    return code;
}

static Result start(const char *path, ExrWriter *writer)
{
    Result result = exr_output_open(path, &writer->output);
    if (result != RESULT_OK)
        return result;
    exr_attr_box2i_t display = display_window(writer);
    exr_result_t code = EXR_ERR_SUCCESS;
    for (int i = 0; i < writer->part_count && code == EXR_ERR_SUCCESS; i++)
        code = add_part(writer->output.context, &writer->parts[i], writer->window, &display);
    if (code == EXR_ERR_SUCCESS)
        code = exr_write_header(writer->output.context);
    return code == EXR_ERR_SUCCESS ? RESULT_OK : exr_output_fail(&writer->output, code);
}

/* OpenEXRCore lets two parts have one name; other readers do not. */
static Result check_parts(const char *path, const ExrPart *parts, int part_count)
{
    if (part_count < 1)
        return result_fail(RESULT_INTERNAL, "%s: no parts to write, expected at least one", path);
    for (int i = 0; i < part_count && part_count > 1; i++) {
        if (!parts[i].name)
            return result_fail(RESULT_INTERNAL, "%s: part %d has no name", path, i);
        for (int j = 0; j < i; j++)
            if (strcmp(parts[i].name, parts[j].name) == 0)
                return result_fail(RESULT_INTERNAL, "%s: parts %d and %d are both named %s", path,
                                   j, i, parts[i].name);
    }
    return RESULT_OK;
}

static Result open_writer(const char *path, const ExrPart *parts, int part_count,
                          const ImageWindow *window, ExrWriter **out)
{
    *out = NULL;
    Result result = check_parts(path, parts, part_count);
    if (result != RESULT_OK)
        return result;
    ExrWriter *writer = memory_array(1, sizeof *writer);
    if (!writer)
        return RESULT_NO_MEMORY;
    writer->part_count = part_count;
    writer->window = window;
    writer->parts = memory_array((size_t)part_count, sizeof *parts);
    result = RESULT_NO_MEMORY;
    if (writer->parts) {
        memcpy(writer->parts, parts, (size_t)part_count * sizeof *parts);
        result = start(path, writer);
    }
    if (result == RESULT_OK)
        *out = writer;
    else
        exr_writer_close(writer, false);
    return result;
}

Result exr_writer_open(const char *path, const ExrPart *parts, int part_count, ExrWriter **out)
{
    return open_writer(path, parts, part_count, NULL, out);
}

/* Unsigned integers of 1 or 2 bytes to the 4 that EXR has. */
static void widen(const Image *image, int y, int rows, uint32_t *out)
{
    const FormatInfo *info = format_info(image->format);
    size_t count = (size_t)rows * (size_t)image->width * (size_t)info->channels;
    const void *in = image_pixel(image, 0, y);
    for (size_t i = 0; i < count; i++)
        out[i] = info->channel_bytes == 1 ? ((const uint8_t *)in)[i] : ((const uint16_t *)in)[i];
}

static void point_at(exr_encode_pipeline_t *pipeline, PixelFormat format, int width,
                     const uint8_t *rows)
{
    ExrLayout layout = exr_layout(format);
    for (int i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[i];
        int index = exr_channel_index(format, channel->channel_name);
        channel->user_bytes_per_element = (int16_t)layout.bytes;
        channel->user_data_type = (uint16_t)layout.type;
        channel->user_pixel_stride = layout.channels * layout.bytes;
        channel->user_line_stride = width * layout.channels * layout.bytes;
        channel->encode_from_ptr = rows + index * layout.bytes;
    }
}

/* scratch: room for one chunk, for formats that are widened. */
static exr_result_t write_chunks(ExrWriter *writer, const Image *image, int chunk_rows,
                                 uint32_t *scratch, exr_encode_pipeline_t *pipeline)
{
    exr_result_t code = EXR_ERR_SUCCESS;
    for (int y = 0; y < image->height && code == EXR_ERR_SUCCESS; y += chunk_rows) {
        exr_chunk_info_t chunk;
        code = exr_write_scanline_chunk_info(writer->output.context, writer->next,
                                             y + (writer->window ? writer->window->y : 0), &chunk);
        if (code == EXR_ERR_SUCCESS)
            code =
                y ? exr_encoding_update(writer->output.context, writer->next, &chunk, pipeline)
                  : exr_encoding_initialize(writer->output.context, writer->next, &chunk, pipeline);
        if (code != EXR_ERR_SUCCESS)
            break;
        const uint8_t *rows = image_pixel(image, 0, y);
        if (scratch) {
            widen(image, y, chunk.height, scratch);
            rows = (const uint8_t *)scratch;
        }
        point_at(pipeline, image->format, image->width, rows);
        if (y == 0)
            code = exr_choose_encoding(writer->output.context, writer->next, pipeline);
        if (code == EXR_ERR_SUCCESS)
            code = exr_encoding_run(writer->output.context, writer->next, pipeline);
    }
    return code;
}

Result exr_writer_part(ExrWriter *writer, const Image *image)
{
    const ExrPart *part = &writer->parts[writer->next];
    if (writer->next >= writer->part_count || image->format != part->format ||
        image->width != part->width || image->height != part->height)
        return result_fail(RESULT_INTERNAL, "%s: part %d is not what was announced",
                           writer->output.path, writer->next);
    exr_message_clear();
    int32_t chunk_rows;
    exr_result_t code =
        exr_get_scanlines_per_chunk(writer->output.context, writer->next, &chunk_rows);
    if (code != EXR_ERR_SUCCESS)
        return exr_output_fail(&writer->output, code);
    uint32_t *scratch = NULL;
    if (exr_layout(image->format).widened) {
        scratch = memory_array((size_t)chunk_rows * (size_t)image->width * 4, sizeof *scratch);
        if (!scratch)
            return RESULT_NO_MEMORY;
    }
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    code = write_chunks(writer, image, chunk_rows, scratch, &pipeline);
    exr_encoding_destroy(writer->output.context, &pipeline);
    free(scratch);
    if (code != EXR_ERR_SUCCESS)
        return exr_output_fail(&writer->output, code);
    writer->next++;
    return RESULT_OK;
}

Result exr_writer_close(ExrWriter *writer, bool commit)
{
    if (!writer)
        return RESULT_OK;
    Result result = RESULT_OK;
    bool complete = writer->next == writer->part_count;
    if (commit && !complete)
        result = result_fail(RESULT_INTERNAL, "%s: %d of %d parts were given", writer->output.path,
                             writer->next, writer->part_count);
    Result closed = exr_output_close(&writer->output, commit && complete);
    free(writer->parts);
    free(writer);
    return result == RESULT_OK ? closed : result;
}

Result exr_write_at(const Image *image, const ImageWindow *window, const char *path)
{
    ExrPart part = {NULL, image->format, image->width, image->height};
    ExrWriter *writer;
    Result result = open_writer(path, &part, 1, window, &writer);
    if (result != RESULT_OK)
        return result;
    result = exr_writer_part(writer, image);
    Result closed = exr_writer_close(writer, result == RESULT_OK);
    return result == RESULT_OK ? closed : result;
}

Result exr_write(const Image *image, const char *path)
{
    return exr_write_at(image, NULL, path);
}
