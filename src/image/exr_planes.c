#include "image/exr_planes.h"

#include "base/memory.h"
#include "image/exr_core.h"

#include <stdlib.h>
#include <string.h>

struct ExrFile {
    ExrReader reader;
    int count;
};

Result exr_file_open(const char *path, ExrFile **out)
{
    ExrFile *file = memory_array(1, sizeof *file);
    *out = NULL;
    if (!file)
        return RESULT_NO_MEMORY;
    Result result = exr_reader_open(path, &file->reader);
    if (result != RESULT_OK) {
        free(file);
        return result;
    }
    exr_result_t code = exr_get_count(file->reader.context, &file->count);
    if (code != EXR_ERR_SUCCESS) {
        result = exr_reader_fail(&file->reader, code);
        exr_file_close(file);
        return result;
    }
    *out = file;
    return RESULT_OK;
}

void exr_file_close(ExrFile *file)
{
    if (!file)
        return;
    exr_reader_close(&file->reader);
    free(file);
}

int exr_file_count(const ExrFile *file)
{
    return file->count;
}

const char *exr_file_name(const ExrFile *file, int part)
{
    const char *name = NULL;
    return exr_get_name(file->reader.context, part, &name) == EXR_ERR_SUCCESS && name ? name : "";
}

bool exr_file_is_deep(const ExrFile *file, int part)
{
    exr_storage_t storage;
    return exr_get_storage(file->reader.context, part, &storage) == EXR_ERR_SUCCESS &&
           (storage == EXR_STORAGE_DEEP_SCANLINE || storage == EXR_STORAGE_DEEP_TILED);
}

bool exr_file_is_trace(const ExrFile *file)
{
    const char *text;
    int32_t length;
    for (int part = 0; part < file->count; part++)
        if (!*exr_file_name(file, part) ||
            exr_attr_get_string(file->reader.context, part, EXR_FORMAT_ATTRIBUTE, &length, &text) !=
                EXR_ERR_SUCCESS)
            return false;
    return true;
}

/* ---- reading ---- */

Result exr_file_image(const ExrFile *file, int part, Image *out)
{
    *out = (Image){0};
    exr_message_clear();
    Result result = exr_reader_image(&file->reader, part, NULL, out);
    if (result != RESULT_OK)
        image_free(out);
    return result;
}

/* Where a chunk's values go: from (x, y) of the planes on. */
static void point_at(exr_decode_pipeline_t *pipeline, const Planes *planes, int x, int y)
{
    size_t at = (size_t)y * (size_t)planes->width + (size_t)x;
    for (int i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *channel = &pipeline->channels[i];
        int index = planes_find(planes, channel->channel_name);
        channel->user_data_type = channel->data_type;
        channel->user_bytes_per_element = channel->bytes_per_element;
        channel->user_pixel_stride = sizeof(uint32_t);
        channel->user_line_stride = planes->width * (int)sizeof(uint32_t);
        channel->decode_to_ptr = index < 0 ? NULL : (uint8_t *)(planes->planes[index].bits + at);
    }
}

/* One chunk, whose place is known to be inside the planes if it has the size that it should. */
static exr_result_t read_chunk(const ExrFile *file, int part, const exr_chunk_info_t *chunk,
                               const int box[4], const Planes *planes,
                               exr_decode_pipeline_t *pipeline)
{
    exr_context_t context = file->reader.context;
    bool first = pipeline->context == NULL;
    if (chunk->width != box[2] || chunk->height != box[3])
        return EXR_ERR_BAD_CHUNK_LEADER;
    exr_result_t code = first ? exr_decoding_initialize(context, part, chunk, pipeline)
                              : exr_decoding_update(context, part, chunk, pipeline);
    if (code != EXR_ERR_SUCCESS)
        return code;
    point_at(pipeline, planes, box[0], box[1]);
    if (first)
        code = exr_choose_decoding(context, part, pipeline);
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(context, part, pipeline) : code;
}

static int at_most(int a, int b)
{
    return a < b ? a : b;
}

static exr_result_t read_scanlines(const ExrFile *file, int part, const Planes *planes,
                                   exr_decode_pipeline_t *pipeline)
{
    int32_t rows;
    exr_result_t code = exr_get_scanlines_per_chunk(file->reader.context, part, &rows);
    if (code == EXR_ERR_SUCCESS && rows < 1)
        code = EXR_ERR_INVALID_ATTR;
    for (int y = 0; y < planes->height && code == EXR_ERR_SUCCESS; y += rows) {
        const int box[4] = {0, y, planes->width, at_most(rows, planes->height - y)};
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(file->reader.context, part, planes->y + y, &chunk);
        if (code == EXR_ERR_SUCCESS)
            code = read_chunk(file, part, &chunk, box, planes, pipeline);
    }
    return code;
}

static exr_result_t read_tiles(const ExrFile *file, int part, const Planes *planes,
                               exr_decode_pipeline_t *pipeline)
{
    int32_t columns, rows;
    exr_context_t context = file->reader.context;
    exr_result_t code = exr_get_tile_sizes(context, part, 0, 0, &columns, &rows);
    if (code == EXR_ERR_SUCCESS && (columns < 1 || rows < 1))
        code = EXR_ERR_INVALID_ATTR;
    if (code != EXR_ERR_SUCCESS)
        return code;
    columns = at_most(columns, EXR_SIZE_MAX); /* x and y stay integers */
    rows = at_most(rows, EXR_SIZE_MAX);
    for (int y = 0; y < planes->height; y += rows)
        for (int x = 0; x < planes->width; x += columns) {
            const int box[4] = {x, y, at_most(columns, planes->width - x),
                                at_most(rows, planes->height - y)};
            exr_chunk_info_t chunk;
            code = exr_read_tile_chunk_info(context, part, x / columns, y / rows, 0, 0, &chunk);
            if (code == EXR_ERR_SUCCESS)
                code = read_chunk(file, part, &chunk, box, planes, pipeline);
            if (code != EXR_ERR_SUCCESS)
                return code;
        }
    return code;
}

/* Halves were decoded to the first two bytes of each value; integers must be what they say. */
static Result finish_plane(const ExrFile *file, int part, Plane *plane, size_t pixels)
{
    uint32_t greatest = 0;
    for (size_t i = 0; i < pixels; i++) {
        uint16_t half;
        memcpy(&half, &plane->bits[i], sizeof half);
        plane->bits[i] = plane->kind == KIND_HALF ? half : plane->bits[i];
        greatest = plane->bits[i] > greatest ? plane->bits[i] : greatest;
    }
    if (plane->kind == KIND_UNORM && greatest > plane->unorm_max)
        return result_fail(RESULT_BAD_INPUT, "%s: part %d holds integers beyond the %s range",
                           file->reader.path, part, planes_kind_name(KIND_UNORM, plane->unorm_max));
    return RESULT_OK;
}

static Result name_planes(const ExrFile *file, int part, const exr_attr_chlist_t *list, Planes *out)
{
    PixelFormat format = FORMAT_NONE;
    bool declared = exr_declared_format(&file->reader, part, list, &format);
    Result result = RESULT_OK;
    for (int i = 0; i < list->num_channels && result == RESULT_OK; i++) {
        static const FormatKind kinds[] = {
            [EXR_PIXEL_UINT] = KIND_UINT,
            [EXR_PIXEL_HALF] = KIND_HALF,
            [EXR_PIXEL_FLOAT] = KIND_FLOAT,
        };
        const exr_attr_chlist_entry_t *channel = &list->entries[i];
        Plane *plane = &out->planes[i];
        plane->kind = declared ? format_info(format)->kind : kinds[channel->pixel_type];
        plane->unorm_max = declared ? format_info(format)->unorm_max : 0;
        result = planes_name(plane, channel->name.str);
    }
    return result;
}

/* Size and channels; *out has no pixels yet. */
static Result read_header(const ExrFile *file, int part, size_t max_bytes, Planes *out)
{
    const exr_attr_chlist_t *list;
    exr_attr_box2i_t window;
    exr_result_t code = exr_get_data_window(file->reader.context, part, &window);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_channels(file->reader.context, part, &list);
    if (code != EXR_ERR_SUCCESS)
        return exr_reader_fail(&file->reader, code);
    int64_t width = (int64_t)window.max.x - window.min.x + 1;
    int64_t height = (int64_t)window.max.y - window.min.y + 1;
    if (width < 1 || width > EXR_SIZE_MAX || height < 1 || height > EXR_SIZE_MAX)
        return result_fail(RESULT_BAD_INPUT, "%s: part %d has a size that is not 1 to %d pixels",
                           file->reader.path, part, (int)EXR_SIZE_MAX);
    if (list->num_channels < 1)
        return result_fail(RESULT_BAD_INPUT, "%s: part %d has no channels", file->reader.path,
                           part);
    for (int i = 0; i < list->num_channels; i++)
        if (list->entries[i].x_sampling != 1 || list->entries[i].y_sampling != 1 ||
            list->entries[i].pixel_type > EXR_PIXEL_FLOAT)
            return result_fail(RESULT_UNSUPPORTED,
                               "%s: channel %s is subsampled or of no known type, expected one "
                               "value per pixel",
                               file->reader.path, list->entries[i].name.str);
    Result result = planes_create((int)width, (int)height, list->num_channels, max_bytes,
                                  file->reader.path, out);
    out->x = window.min.x;
    out->y = window.min.y;
    return result == RESULT_OK ? name_planes(file, part, list, out) : result;
}

Result exr_file_planes(ExrFile *file, int part, size_t max_bytes, Planes *out)
{
    exr_storage_t storage;
    *out = (Planes){0};
    exr_message_clear();
    if (exr_get_storage(file->reader.context, part, &storage) != EXR_ERR_SUCCESS ||
        (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED))
        return result_fail(RESULT_UNSUPPORTED, "%s: part %d is deep, expected flat pixels",
                           file->reader.path, part);
    Result result = read_header(file, part, max_bytes, out);
    if (result == RESULT_OK) {
        exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
        exr_result_t code = storage == EXR_STORAGE_TILED
                                ? read_tiles(file, part, out, &pipeline)
                                : read_scanlines(file, part, out, &pipeline);
        exr_decoding_destroy(file->reader.context, &pipeline);
        if (code != EXR_ERR_SUCCESS)
            result = exr_reader_fail(&file->reader, code);
        result = exr_reader_check(&file->reader, result);
    }
    for (int i = 0; i < out->count && result == RESULT_OK; i++)
        result =
            finish_plane(file, part, &out->planes[i], (size_t)out->width * (size_t)out->height);
    if (result != RESULT_OK)
        planes_free(out);
    else
        planes_sort(out);
    return result;
}

/* ---- writing ---- */

/* Readers know by a flag of the file that its names may have more than 31 bytes, up to 255. */
static bool has_long_name(const Planes *planes)
{
    for (int i = 0; i < planes->count; i++)
        if (strlen(planes->planes[i].name) > 31)
            return true;
    return false;
}

static exr_result_t write_header(exr_context_t context, const Planes *planes)
{
    int part;
    const exr_attr_box2i_t window = {
        .min = {.x = planes->x, .y = planes->y},
        .max = {.x = planes->x + planes->width - 1, .y = planes->y + planes->height - 1}};
    exr_result_t code = exr_set_longname_support(context, has_long_name(planes));
    if (code == EXR_ERR_SUCCESS)
        code = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr_simple(context, part, planes->width, planes->height,
                                                   EXR_COMPRESSION_ZIP);
    if (code == EXR_ERR_SUCCESS)
        code = exr_set_data_window(context, part, &window);
    if (code == EXR_ERR_SUCCESS)
        code = exr_set_display_window(context, part, &window);
    if (code == EXR_ERR_SUCCESS)
        code = exr_set_zip_compression_level(context, part, EXR_ZIP_LEVEL);
    for (int i = 0; i < planes->count && code == EXR_ERR_SUCCESS; i++)
        code = exr_add_channel(context, part, planes->planes[i].name, EXR_PIXEL_FLOAT,
                               EXR_PERCEPTUALLY_LINEAR, 1, 1);
    return code == EXR_ERR_SUCCESS ? exr_write_header(context) : code;
}

static exr_result_t write_rows(exr_context_t context, const Planes *planes,
                               exr_encode_pipeline_t *pipeline)
{
    int32_t rows = 1;
    exr_result_t code = exr_get_scanlines_per_chunk(context, 0, &rows);
    for (int y = 0; y < planes->height && code == EXR_ERR_SUCCESS; y += rows) {
        exr_chunk_info_t chunk;
        code = exr_write_scanline_chunk_info(context, 0, planes->y + y, &chunk);
        if (code == EXR_ERR_SUCCESS)
            code = y ? exr_encoding_update(context, 0, &chunk, pipeline)
                     : exr_encoding_initialize(context, 0, &chunk, pipeline);
        for (int i = 0; i < pipeline->channel_count && code == EXR_ERR_SUCCESS; i++) {
            exr_coding_channel_info_t *channel = &pipeline->channels[i];
            int index = planes_find(planes, channel->channel_name);
            channel->user_bytes_per_element = sizeof(uint32_t);
            channel->user_data_type = EXR_PIXEL_FLOAT;
            channel->user_pixel_stride = sizeof(uint32_t);
            channel->user_line_stride = planes->width * (int)sizeof(uint32_t);
            channel->encode_from_ptr =
                (const uint8_t *)(planes->planes[index].bits + (size_t)y * (size_t)planes->width);
        }
        if (code == EXR_ERR_SUCCESS && y == 0)
            code = exr_choose_encoding(context, 0, pipeline);
        if (code == EXR_ERR_SUCCESS)
            code = exr_encoding_run(context, 0, pipeline);
    }
    return code;
}

Result exr_planes_write(const Planes *planes, const char *path)
{
    ExrOutput output;
    Result result = exr_output_open(path, &output);
    if (result == RESULT_OK) {
        exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
        exr_result_t code = write_header(output.context, planes);
        if (code == EXR_ERR_SUCCESS)
            code = write_rows(output.context, planes, &pipeline);
        exr_encoding_destroy(output.context, &pipeline);
        if (code != EXR_ERR_SUCCESS)
            result = exr_output_fail(&output, code);
    }
    Result closed = exr_output_close(&output, result == RESULT_OK);
    return result == RESULT_OK ? closed : result;
}
