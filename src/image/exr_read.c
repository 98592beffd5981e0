/* Reading. */
#include "image/exr.h"

#include "base/memory.h"
#include "image/exr_core.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

bool exr_declared_format(const ExrReader *reader, int part, const exr_attr_chlist_t *list,
                         PixelFormat *out)
{
    const char *text;
    int32_t length;
    if (exr_attr_get_string(reader->context, part, EXR_FORMAT_ATTRIBUTE, &length, &text) !=
        EXR_ERR_SUCCESS)
        return false;
    for (int f = 0; f < FORMAT_COUNT; f++) {
        const char *name = format_info((PixelFormat)f)->name;
        if ((size_t)length != strlen(name) || memcmp(text, name, strlen(name)) != 0)
            continue;
        ExrLayout layout = exr_layout((PixelFormat)f);
        exr_pixel_type_t type;
        for (int i = 0; i < layout.channels; i++)
            if (!exr_find_channel(list, exr_channel_name((PixelFormat)f, i), &type) ||
                type != layout.type)
                return false;
        *out = (PixelFormat)f;
        return list->num_channels == layout.channels;
    }
    return false;
}

/* Other programs' files: the format that keeps every value. */
static Result guess_format(const ExrReader *reader, const exr_attr_chlist_t *list, PixelFormat *out)
{
    exr_pixel_type_t r, g, b, a;
    if (exr_find_channel(list, "R", &r) && exr_find_channel(list, "G", &g) &&
        exr_find_channel(list, "B", &b)) {
        if (!exr_find_channel(list, "A", &a))
            a = r;
        bool integers = r == EXR_PIXEL_UINT || g == EXR_PIXEL_UINT || b == EXR_PIXEL_UINT ||
                        a == EXR_PIXEL_UINT;
        if (integers)
            return result_fail(RESULT_UNSUPPORTED,
                               "%s: integer colour channels without a %s attribute, expected "
                               "float or half",
                               reader->path, EXR_FORMAT_ATTRIBUTE);
        bool halves = r == EXR_PIXEL_HALF && g == EXR_PIXEL_HALF && b == EXR_PIXEL_HALF &&
                      a == EXR_PIXEL_HALF;
        *out = halves ? FORMAT_RGBA16F : FORMAT_RGBA32F;
        return RESULT_OK;
    }
    if (list->num_channels != 1)
        return result_fail(RESULT_UNSUPPORTED,
                           "%s: %d channels, expected R, G, B (A) or a single one", reader->path,
                           list->num_channels);
    *out = list->entries[0].pixel_type == EXR_PIXEL_UINT ? FORMAT_R32UI : FORMAT_D32F;
    return RESULT_OK;
}

static Result part_format(const ExrReader *reader, int part, PixelFormat *out)
{
    exr_storage_t storage;
    const exr_attr_chlist_t *list;
    exr_result_t code = exr_get_storage(reader->context, part, &storage);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_channels(reader->context, part, &list);
    if (code != EXR_ERR_SUCCESS)
        return exr_reader_fail(reader, code);
    if (storage != EXR_STORAGE_SCANLINE)
        return result_fail(RESULT_UNSUPPORTED,
                           "%s: part %d is tiled or deep, expected flat scanlines", reader->path,
                           part);
    for (int i = 0; i < list->num_channels; i++)
        if (list->entries[i].x_sampling != 1 || list->entries[i].y_sampling != 1)
            return result_fail(RESULT_UNSUPPORTED,
                               "%s: channel %s is subsampled, expected one value per pixel",
                               reader->path, list->entries[i].name.str);
    if (exr_declared_format(reader, part, list, out))
        return RESULT_OK;
    return guess_format(reader, list, out);
}

static void point_at(exr_decode_pipeline_t *pipeline, PixelFormat format, int width, uint8_t *rows)
{
    ExrLayout layout = exr_layout(format);
    for (int i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[i];
        int index = layout.channels == 1 ? 0 : exr_channel_index(format, channel->channel_name);
        channel->user_bytes_per_element = (int16_t)layout.bytes;
        channel->user_data_type = (uint16_t)layout.type;
        channel->user_pixel_stride = layout.channels * layout.bytes;
        channel->user_line_stride = width * layout.channels * layout.bytes;
        channel->decode_to_ptr = index < 0 ? NULL : rows + index * layout.bytes;
    }
}

/* EXR's 4-byte integers to what the format stores; false when one does not fit. */
static bool narrow(const uint32_t *in, Image *image, int y, int rows)
{
    const FormatInfo *info = format_info(image->format);
    size_t count = (size_t)rows * (size_t)image->width * (size_t)info->channels;
    void *out = image_pixel(image, 0, y);
    uint32_t greatest = 0;
    for (size_t i = 0; i < count; i++) {
        greatest = in[i] > greatest ? in[i] : greatest;
        if (info->channel_bytes == 1)
            ((uint8_t *)out)[i] = (uint8_t)in[i];
        else if (info->channel_bytes == 2)
            ((uint16_t *)out)[i] = (uint16_t)in[i];
        else
            ((uint32_t *)out)[i] = in[i];
    }
    return greatest <= info->unorm_max;
}

/* scratch: room for one chunk, for formats that need narrow(). */
static Result read_chunks(const ExrReader *reader, int part, int first_y, int chunk_rows,
                          uint32_t *scratch, exr_decode_pipeline_t *pipeline, Image *image)
{
    exr_context_t context = reader->context;
    for (int y = 0; y < image->height; y += chunk_rows) {
        exr_chunk_info_t chunk;
        exr_result_t code = exr_read_scanline_chunk_info(context, part, first_y + y, &chunk);
        if (code == EXR_ERR_SUCCESS)
            code = y ? exr_decoding_update(context, part, &chunk, pipeline)
                     : exr_decoding_initialize(context, part, &chunk, pipeline);
        if (code == EXR_ERR_SUCCESS &&
            (chunk.width != image->width || chunk.height > image->height - y ||
             chunk.height > chunk_rows))
            code = EXR_ERR_BAD_CHUNK_LEADER;
        if (code != EXR_ERR_SUCCESS)
            return exr_reader_fail(reader, code);
        point_at(pipeline, image->format, image->width,
                 scratch ? (uint8_t *)scratch : image_pixel(image, 0, y));
        if (y == 0)
            code = exr_choose_decoding(context, part, pipeline);
        if (code == EXR_ERR_SUCCESS)
            code = exr_decoding_run(context, part, pipeline);
        if (code != EXR_ERR_SUCCESS)
            return exr_reader_fail(reader, code);
        if (scratch && !narrow(scratch, image, y, chunk.height))
            return result_fail(RESULT_BAD_INPUT, "%s: part %d holds integers beyond the %s range",
                               reader->path, part, format_info(image->format)->name);
    }
    return RESULT_OK;
}

/* Files without A are opaque. */
static void fill_alpha(const exr_attr_chlist_t *list, Image *image)
{
    exr_pixel_type_t type;
    if (format_info(image->format)->channels != 4 || exr_find_channel(list, "A", &type))
        return;
    size_t count = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < count; i++)
        if (image->format == FORMAT_RGBA32F)
            ((float *)image->pixels)[4 * i + 3] = 1.0f;
        else
            ((uint16_t *)image->pixels)[4 * i + 3] = 0x3c00;
}

Result exr_reader_image(const ExrReader *reader, int part, const int *size, Image *out)
{
    PixelFormat format = FORMAT_RGBA32F;
    Result result = part_format(reader, part, &format);
    if (result != RESULT_OK)
        return result;
    exr_attr_box2i_t window, display;
    int32_t chunk_rows;
    const exr_attr_chlist_t *list;
    exr_result_t code = exr_get_data_window(reader->context, part, &window);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_display_window(reader->context, part, &display);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_scanlines_per_chunk(reader->context, part, &chunk_rows);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_channels(reader->context, part, &list);
    if (code != EXR_ERR_SUCCESS)
        return exr_reader_fail(reader, code);
    int64_t width = (int64_t)window.max.x - window.min.x + 1;
    int64_t height = (int64_t)window.max.y - window.min.y + 1;
    if (width < 1 || width > EXR_SIZE_MAX || height < 1 || height > EXR_SIZE_MAX || chunk_rows < 1)
        return result_fail(RESULT_BAD_INPUT, "%s: part %d has a size that is not 1 to %d pixels",
                           reader->path, part, (int)EXR_SIZE_MAX);
    if (window.min.x != display.min.x || window.min.y != display.min.y)
        return result_fail(RESULT_UNSUPPORTED,
                           "%s: part %d has pixels from %d,%d on, expected from %d,%d, where its "
                           "display window begins",
                           reader->path, part, window.min.x, window.min.y, display.min.x,
                           display.min.y);
    if (size && (width != size[0] || height != size[1])) {
        *out = (Image){.width = (int)width, .height = (int)height, .format = format};
        return RESULT_OK;
    }
    result = image_create((int)width, (int)height, format, out);
    if (result != RESULT_OK)
        return result;
    uint32_t *scratch = NULL;
    if (format_info(format)->kind == KIND_UNORM) {
        scratch = memory_array((size_t)chunk_rows * (size_t)width * 4, sizeof *scratch);
        if (!scratch)
            return RESULT_NO_MEMORY;
    }
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    result = read_chunks(reader, part, window.min.y, chunk_rows, scratch, &pipeline, out);
    exr_decoding_destroy(reader->context, &pipeline);
    free(scratch);
    fill_alpha(list, out);
    return exr_reader_check(reader, result);
}

Result exr_is(const char *path, bool *is)
{
    static const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};
    unsigned char head[4];
    size_t count;
    Result result = file_head(path, head, sizeof head, &count);
    *is = result == RESULT_OK && count == 4 && memcmp(head, magic, 4) == 0;
    return result;
}

Result exr_part_count(const char *path, int *count)
{
    *count = 0;
    ExrReader reader;
    Result result = exr_reader_open(path, &reader);
    if (result != RESULT_OK)
        return result;
    exr_result_t code = exr_get_count(reader.context, count);
    if (code != EXR_ERR_SUCCESS)
        result = exr_reader_fail(&reader, code);
    exr_reader_close(&reader);
    return result;
}

static void copy_name(const ExrReader *reader, int part, char name[64])
{
    const char *text;
    name[0] = 0;
    if (exr_get_name(reader->context, part, &text) == EXR_ERR_SUCCESS && text)
        snprintf(name, 64, "%s", text);
}

/* The reader is open, and the caller's to close, on success. */
static Result open_channels(const char *path, int part, ExrReader *reader,
                            const exr_attr_chlist_t **list)
{
    Result result = exr_reader_open(path, reader);
    if (result != RESULT_OK)
        return result;
    exr_result_t code = exr_get_channels(reader->context, part, list);
    if (code == EXR_ERR_SUCCESS)
        return RESULT_OK;
    result = exr_reader_fail(reader, code);
    exr_reader_close(reader);
    return result;
}

Result exr_has_channel(const char *path, int part, const char *channel, bool *has)
{
    ExrReader reader;
    const exr_attr_chlist_t *list;
    exr_pixel_type_t type;
    Result result = open_channels(path, part, &reader, &list);
    if (result != RESULT_OK)
        return result;
    *has = exr_find_channel(list, channel, &type);
    exr_reader_close(&reader);
    return RESULT_OK;
}

Result exr_is_half(const char *path, int part, bool *half)
{
    ExrReader reader;
    const exr_attr_chlist_t *list;
    Result result = open_channels(path, part, &reader, &list);
    if (result != RESULT_OK)
        return result;
    *half = true;
    for (int i = 0; i < list->num_channels; i++)
        *half = *half && list->entries[i].pixel_type == EXR_PIXEL_HALF;
    exr_reader_close(&reader);
    return RESULT_OK;
}

Result exr_read_sized(const char *path, int part, const int size[2], Image *out, char name[64])
{
    *out = (Image){0};
    name[0] = 0;
    ExrReader reader;
    Result result = exr_reader_open(path, &reader);
    if (result != RESULT_OK)
        return result;
    int count = 0;
    exr_get_count(reader.context, &count);
    if (part < 0 || part >= count)
        result =
            result_fail(RESULT_BAD_INPUT, "%s: no part %d, the file has %d", path, part, count);
    else
        result = exr_reader_image(&reader, part, size, out);
    if (result != RESULT_OK)
        image_free(out);
    else
        copy_name(&reader, part, name);
    exr_reader_close(&reader);
    return result;
}

Result exr_read(const char *path, int part, Image *out, char name[64])
{
    return exr_read_sized(path, part, NULL, out, name);
}
