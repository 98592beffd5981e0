/* Reading. Nothing that the file says is believed before it is checked against what is there: sizes
 * of chunks, totals of samples, order. */
#include "image/exr_deep.h"

#include "base/memory.h"
#include "base/text.h"
#include "image/exr_deep_core.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    ZBACK = DEEP_CHANNELS, /* read, but not kept */
    UNUSED,
    DEFLATE_RATIO = 1032 /* no byte of deflate or run lengths gives more bytes */
};

/* A sample with what decides its place in its pixel. */
typedef struct Incoming {
    DeepSample sample;
    float z_back;
    uint32_t index;
} Incoming;

/* A buffer that grows; never NULL once it has. */
typedef struct Bytes {
    uint8_t *data;
    size_t capacity;
} Bytes;

typedef struct DeepReader {
    ExrReader file;
    int part;
    exr_attr_box2i_t window;
    exr_compression_t compression;
    const exr_attr_chlist_t *list;
    uint8_t *target;     /* of each channel in the file: DEEP_…, ZBACK or UNUSED */
    size_t sample_bytes; /* of all channels */
    bool has_z_back;
    DeepImage *image;
    Bytes packed_table, packed, scratch, raw, z_back;
    Bytes incoming;   /* of one pixel */
    uint32_t *counts; /* of one row */
} DeepReader;

static Result grow(Bytes *bytes, size_t size)
{
    void *data = bytes->data;
    Result result = memory_grow(&data, &bytes->capacity, size ? size : 1, 1);
    bytes->data = data;
    return result;
}

static Result fail_row(const DeepReader *reader, int y, const char *what)
{
    return result_fail(RESULT_BAD_INPUT, "%s: row %d: %s", reader->file.path, y, what);
}

/* ---- header --------------------------------------------------------------------------------- */

static Result find_part(DeepReader *reader)
{
    int count = 0;
    exr_result_t code = exr_get_count(reader->file.context, &count);
    for (int part = 0; part < count && code == EXR_ERR_SUCCESS; part++) {
        exr_storage_t storage;
        code = exr_get_storage(reader->file.context, part, &storage);
        if (code == EXR_ERR_SUCCESS && storage == EXR_STORAGE_DEEP_SCANLINE) {
            reader->part = part;
            return RESULT_OK;
        }
    }
    if (code != EXR_ERR_SUCCESS)
        return exr_reader_fail(&reader->file, code);
    return result_fail(RESULT_UNSUPPORTED, "%s: flat or tiled, expected a part of deep scanlines",
                       reader->file.path);
}

static int find_target(const exr_attr_chlist_entry_t *channel)
{
    for (int i = 0; i < DEEP_CHANNELS; i++) {
        bool id = deep_channels[i].kind == KIND_UINT;
        if (strcmp(channel->name.str, deep_channels[i].name) == 0)
            return !id || channel->pixel_type == EXR_PIXEL_UINT ? i : UNUSED;
    }
    return strcmp(channel->name.str, "ZBack") == 0 ? ZBACK : UNUSED;
}

static Result read_channels(DeepReader *reader)
{
    exr_result_t code = exr_get_channels(reader->file.context, reader->part, &reader->list);
    if (code != EXR_ERR_SUCCESS)
        return exr_reader_fail(&reader->file, code);
    for (int i = 0; i <= DEEP_Z; i++) {
        exr_pixel_type_t type;
        if (!exr_find_channel(reader->list, deep_channels[i].name, &type))
            return result_fail(RESULT_UNSUPPORTED, "%s: no channel %s, expected R, G, B, A and Z",
                               reader->file.path, deep_channels[i].name);
    }
    reader->target = memory_array((size_t)reader->list->num_channels, 1);
    if (!reader->target)
        return RESULT_NO_MEMORY;
    for (int i = 0; i < reader->list->num_channels; i++) {
        const exr_attr_chlist_entry_t *channel = &reader->list->entries[i];
        if (channel->pixel_type > EXR_PIXEL_FLOAT || channel->x_sampling != 1 ||
            channel->y_sampling != 1)
            return result_fail(RESULT_BAD_INPUT, "%s: channel %s of no known type or subsampled",
                               reader->file.path, channel->name.str);
        reader->target[i] = (uint8_t)find_target(channel);
        reader->has_z_back |= reader->target[i] == ZBACK;
        reader->sample_bytes += channel->pixel_type == EXR_PIXEL_HALF ? 2 : 4;
    }
    return RESULT_OK;
}

/* What the image tells of the file's channels. */
static Result note_channels(const DeepReader *reader)
{
    DeepImage *image = reader->image;
    Text names = {0};
    for (int i = 0; i < DEEP_CHANNELS; i++)
        image->missing[i] = true;
    for (int i = 0; i < reader->list->num_channels; i++) {
        const exr_attr_chlist_entry_t *channel = &reader->list->entries[i];
        int target = reader->target[i];
        if (target >= DEEP_CHANNELS) {
            text_print(&names, "%s%s", names.count ? ", " : "", channel->name.str);
            continue;
        }
        image->missing[target] = false;
        image->half[target] = channel->pixel_type == EXR_PIXEL_HALF;
    }
    image->left_out = names.bytes;
    return names.result;
}

static void read_camera(const DeepReader *reader)
{
    exr_attr_m44f_t camera, ndc;
    DeepImage *image = reader->image;
    exr_const_context_t context = reader->file.context;
    if (exr_attr_get_m44f(context, reader->part, "worldToCamera", &camera) != EXR_ERR_SUCCESS ||
        exr_attr_get_m44f(context, reader->part, "worldToNDC", &ndc) != EXR_ERR_SUCCESS)
        return;
    image->has_camera = true;
    memcpy(image->world_to_camera, camera.m, sizeof image->world_to_camera);
    memcpy(image->world_to_ndc, ndc.m, sizeof image->world_to_ndc);
}

static Result read_header(DeepReader *reader, size_t max_bytes)
{
    Result result = find_part(reader);
    if (result == RESULT_OK)
        result = read_channels(reader);
    if (result != RESULT_OK)
        return result;
    exr_context_t context = reader->file.context;
    int32_t chunk_rows = 0;
    exr_attr_box2i_t display;
    exr_result_t code = exr_get_data_window(context, reader->part, &reader->window);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_display_window(context, reader->part, &display);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_compression(context, reader->part, &reader->compression);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_scanlines_per_chunk(context, reader->part, &chunk_rows);
    if (code != EXR_ERR_SUCCESS)
        return exr_reader_fail(&reader->file, code);
    int64_t width = (int64_t)reader->window.max.x - reader->window.min.x + 1;
    int64_t height = (int64_t)reader->window.max.y - reader->window.min.y + 1;
    if (width < 1 || width > EXR_SIZE_MAX || height < 1 || height > EXR_SIZE_MAX || chunk_rows != 1)
        return result_fail(RESULT_BAD_INPUT,
                           "%s: expected 1 to %d pixels a side and chunks of one row",
                           reader->file.path, (int)EXR_SIZE_MAX);
    reader->counts = memory_array((size_t)width, sizeof *reader->counts);
    if (!reader->counts)
        return RESULT_NO_MEMORY;
    result = deep_create((int)width, (int)height, max_bytes, reader->image);
    reader->image->part = reader->part;
    reader->image->has_window = true;
    reader->image->window =
        (ImageWindow){reader->window.min.x, reader->window.min.y, display.min.x,
                      display.min.y,        display.max.x,        display.max.y};
    if (result == RESULT_OK)
        read_camera(reader);
    return result == RESULT_OK ? note_channels(reader) : result;
}

/* ---- rows ----------------------------------------------------------------------------------- */

static uint32_t get_u32(const uint8_t *in)
{
    return in[0] | (uint32_t)in[1] << 8 | (uint32_t)in[2] << 16 | (uint32_t)in[3] << 24;
}

/* Running totals to counts; false when they decrease or leave 31 bits. */
static bool unpack_counts(const uint8_t *table, int width, uint32_t *counts, uint32_t *total)
{
    *total = 0;
    for (int x = 0; x < width; x++) {
        uint32_t sum = get_u32(table + 4 * (size_t)x);
        if (sum < *total || sum > INT32_MAX)
            return false;
        counts[x] = sum - *total;
        *total = sum;
    }
    return true;
}

/* The row's counts, and its packed samples. */
static Result read_chunk(DeepReader *reader, int y, exr_chunk_info_t *chunk, uint32_t *total)
{
    exr_context_t context = reader->file.context;
    int width = reader->image->width;
    size_t table = 4 * (size_t)width;
    exr_result_t code =
        exr_read_scanline_chunk_info(context, reader->part, reader->window.min.y + y, chunk);
    if (code != EXR_ERR_SUCCESS)
        return exr_reader_fail(&reader->file, code);
    if (chunk->width != width || chunk->height != 1 || chunk->sample_count_table_size > table ||
        chunk->packed_size > chunk->unpacked_size ||
        chunk->unpacked_size / DEFLATE_RATIO > chunk->packed_size)
        return fail_row(reader, y, "sizes that cannot be");
    Result result = grow(&reader->packed_table, table);
    if (result == RESULT_OK)
        result = grow(&reader->packed, chunk->packed_size);
    if (result == RESULT_OK)
        result = grow(&reader->scratch, table);
    if (result == RESULT_OK)
        result = grow(&reader->raw, table);
    if (result != RESULT_OK)
        return result;
    code = exr_read_deep_chunk(context, reader->part, chunk, reader->packed.data,
                               reader->packed_table.data);
    if (code != EXR_ERR_SUCCESS)
        return exr_reader_fail(&reader->file, code);
    if (!exr_deep_unpack(reader->compression, reader->packed_table.data,
                         chunk->sample_count_table_size, reader->scratch.data, reader->raw.data,
                         table) ||
        !unpack_counts(reader->raw.data, width, reader->counts, total))
        return fail_row(reader, y, "a broken table of sample counts");
    if (*total * reader->sample_bytes != chunk->unpacked_size)
        return fail_row(reader, y, "counts and sizes of samples that do not agree");
    return RESULT_OK;
}

static float to_float(const uint8_t *in, exr_pixel_type_t type)
{
    if (type == EXR_PIXEL_HALF)
        return half_to_float((uint16_t)(in[0] | in[1] << 8));
    uint32_t bits = get_u32(in);
    float value;
    memcpy(&value, &bits, sizeof value);
    return type == EXR_PIXEL_UINT ? (float)bits : value;
}

/* All values of one channel into the samples, or ZBack's. */
static void unpack_channel(const uint8_t *in, exr_pixel_type_t type, int target, uint32_t total,
                           DeepSample *out, float *z_back)
{
    size_t bytes = type == EXR_PIXEL_HALF ? 2 : 4;
    for (uint32_t i = 0; i < total; i++, in += bytes) {
        if (target == ZBACK) {
            z_back[i] = to_float(in, type);
            continue;
        }
        float value = to_float(in, type);
        uint32_t id = deep_channels[target].kind == KIND_UINT ? get_u32(in) : 0;
        void *to = (char *)&out[i] + deep_channels[target].offset;
        if (deep_channels[target].kind == KIND_UINT)
            memcpy(to, &id, sizeof id);
        else
            memcpy(to, &value, sizeof value);
    }
}

static int compare_incoming(const void *a, const void *b)
{
    const Incoming *p = a, *q = b;
    if (p->sample.z != q->sample.z)
        return p->sample.z < q->sample.z ? -1 : 1;
    if (p->z_back != q->z_back)
        return p->z_back < q->z_back ? -1 : 1;
    return p->index < q->index ? -1 : p->index > q->index;
}

/* Puts one pixel's samples in order: by Z, ZBack and place in the file. z_back: theirs; NULL where
 * the file has none. */
static Result sort_pixel(DeepReader *reader, int x, int y, DeepSample *samples, const float *z_back)
{
    uint32_t count = reader->counts[x];
    Incoming *incoming = (Incoming *)(void *)reader->incoming.data;
    bool sorted = true;
    for (uint32_t i = 0; i < count; i++) {
        incoming[i] = (Incoming){samples[i], z_back ? z_back[i] : 0.0f, i};
        if (isnan(incoming[i].sample.z) || isnan(incoming[i].z_back))
            return fail_row(reader, y, "Z that is no number");
        sorted = sorted && (i == 0 || compare_incoming(&incoming[i - 1], &incoming[i]) < 0);
    }
    if (!sorted)
        qsort(incoming, count, sizeof *incoming, compare_incoming);
    for (uint32_t i = 1; i < count && z_back; i++)
        if (incoming[i - 1].z_back > incoming[i].sample.z)
            return result_fail(RESULT_UNSUPPORTED,
                               "%s: pixel %d,%d: samples overlap in depth (ZBack), expected one "
                               "behind the other",
                               reader->file.path, x, y);
    for (uint32_t i = 0; i < count; i++)
        samples[i] = incoming[i].sample;
    return RESULT_OK;
}

/* Room for what a row takes beside its samples, within the image's limit. */
static Result grow_row(DeepReader *reader, size_t size, uint32_t total)
{
    uint32_t most = 0;
    for (int x = 0; x < reader->image->width; x++)
        most = reader->counts[x] > most ? reader->counts[x] : most;
    size_t z_back = reader->has_z_back ? total * sizeof(float) : 0;
    size_t incoming = most * sizeof(Incoming);
    Result result =
        deep_room(reader->image, 2 * size + z_back + incoming + reader->packed.capacity);
    if (result == RESULT_OK)
        result = grow(&reader->scratch, size);
    if (result == RESULT_OK)
        result = grow(&reader->raw, size);
    if (result == RESULT_OK)
        result = grow(&reader->z_back, z_back);
    return result == RESULT_OK ? grow(&reader->incoming, incoming) : result;
}

/* The chunk's samples, unpacked and in order, into a block of the image. */
static Result read_samples(DeepReader *reader, int y, const exr_chunk_info_t *chunk, uint32_t total)
{
    DeepSample *samples;
    size_t size = chunk->unpacked_size;
    Result result = deep_block(reader->image, total, &samples);
    if (result == RESULT_OK)
        result = grow_row(reader, size, total);
    if (result != RESULT_OK)
        return result;
    if (!exr_deep_unpack(reader->compression, reader->packed.data, chunk->packed_size,
                         reader->scratch.data, reader->raw.data, size))
        return fail_row(reader, y, "broken samples");
    float *z_back = (float *)(void *)reader->z_back.data;
    for (uint32_t i = 0; i < total; i++)
        samples[i] = (DeepSample){.primitive = DEEP_NO_ID, .material = DEEP_NO_ID};
    const uint8_t *in = reader->raw.data;
    for (int i = 0; i < reader->list->num_channels; i++) {
        exr_pixel_type_t type = reader->list->entries[i].pixel_type;
        if (reader->target[i] != UNUSED)
            unpack_channel(in, type, reader->target[i], total, samples, z_back);
        in += (size_t)total * (type == EXR_PIXEL_HALF ? 2 : 4);
    }
    uint32_t first = 0;
    for (int x = 0; x < reader->image->width && result == RESULT_OK; x++) {
        const float *pixel_z_back = reader->has_z_back ? z_back + first : NULL;
        result = sort_pixel(reader, x, y, samples + first, pixel_z_back);
        deep_set(reader->image, x, y, samples + first, reader->counts[x]);
        first += reader->counts[x];
    }
    return result;
}

static void free_reader(DeepReader *reader)
{
    free(reader->target);
    free(reader->counts);
    free(reader->packed_table.data);
    free(reader->packed.data);
    free(reader->scratch.data);
    free(reader->raw.data);
    free(reader->z_back.data);
    free(reader->incoming.data);
    exr_reader_close(&reader->file);
}

Result exr_deep_read(const char *path, size_t max_bytes, DeepImage *out)
{
    *out = (DeepImage){0};
    DeepReader reader = {.image = out};
    Result result = exr_reader_open(path, &reader.file);
    if (result != RESULT_OK)
        return result;
    result = read_header(&reader, max_bytes);
    for (int y = 0; y < out->height && result == RESULT_OK; y++) {
        exr_chunk_info_t chunk;
        uint32_t total = 0;
        exr_message_clear();
        result = read_chunk(&reader, y, &chunk, &total);
        if (result == RESULT_OK)
            result = read_samples(&reader, y, &chunk, total);
        result = exr_reader_check(&reader.file, result);
    }
    free_reader(&reader);
    if (result != RESULT_OK)
        deep_free(out);
    return result;
}
