/* Writing. */
#include "image/exr_deep.h"

#include "base/memory.h"
#include "image/exr_deep_core.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

/* "comments", a standard attribute. */
static const char comments[] =
    "Every fragment, front to back; transparent ones in front of the nearest opaque one, then that "
    "one with A = 1; the background is no sample. R, G, B are linear, multiplied by A. Z: distance "
    "along the view axis. depth.window: 0 near to 1 far. primitiveid counts the scene's triangles; "
    "materialid its materials.";

/* DIS_TIDY of the C++ library, which OpenEXRCore does not know. */
static const uint8_t tidy = 3;

/* One row in the making. */
typedef struct Row {
    uint8_t *raw, *scratch;  /* the longest row, or its table */
    uint8_t *table, *packed; /* compressed */
} Row;

static void put_u32(uint8_t *out, uint32_t value)
{
    for (int i = 0; i < 4; i++)
        out[i] = (uint8_t)(value >> 8 * i);
}

static uint64_t row_samples(const DeepImage *image, int y)
{
    uint64_t total = 0;
    for (int x = 0; x < image->width; x++)
        total += image->counts[(size_t)y * (size_t)image->width + (size_t)x];
    return total;
}

/* No pixel has two samples of one Z. */
static bool is_tidy(const DeepImage *image)
{
    size_t pixels = (size_t)image->width * (size_t)image->height;
    for (size_t at = 0; at < pixels; at++)
        for (uint32_t i = 1; i < image->counts[at]; i++)
            if (!(image->pixels[at][i].z > image->pixels[at][i - 1].z))
                return false;
    return true;
}

static exr_result_t set_camera(exr_context_t context, const DeepImage *image)
{
    if (!image->has_camera)
        return EXR_ERR_SUCCESS;
    /* Rows of the file's matrix, which is for row vectors, are columns of ours. */
    exr_attr_m44f_t matrix;
    memcpy(matrix.m, image->world_to_camera, sizeof matrix.m);
    exr_result_t code = exr_attr_set_m44f(context, 0, "worldToCamera", &matrix);
    memcpy(matrix.m, image->world_to_ndc, sizeof matrix.m);
    return code == EXR_ERR_SUCCESS ? exr_attr_set_m44f(context, 0, "worldToNDC", &matrix) : code;
}

static exr_result_t write_header(exr_context_t context, const DeepImage *image)
{
    int index;
    uint32_t most = deep_most(image);
    exr_result_t code = exr_add_part(context, "deep", EXR_STORAGE_DEEP_SCANLINE, &index);
    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr_simple(context, index, image->width, image->height,
                                                   EXR_COMPRESSION_ZIPS);
    for (int i = 0; i < DEEP_CHANNELS && code == EXR_ERR_SUCCESS; i++)
        code =
            exr_add_channel(context, index, deep_channels[i].name,
                            deep_channels[i].kind == KIND_UINT ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT,
                            EXR_PERCEPTUALLY_LINEAR, 1, 1);
    if (code == EXR_ERR_SUCCESS)
        code = exr_attr_set_int(context, index, "maxSamplesPerPixel",
                                most < INT_MAX ? (int32_t)most : INT_MAX);
    if (code == EXR_ERR_SUCCESS)
        code = exr_attr_set_string(context, index, "comments", comments);
    if (code == EXR_ERR_SUCCESS && is_tidy(image))
        code = exr_attr_set_user(context, index, "deepImageState", "deepImageState", sizeof tidy,
                                 &tidy);
    if (code == EXR_ERR_SUCCESS)
        code = set_camera(context, image);
    return code == EXR_ERR_SUCCESS ? exr_write_header(context) : code;
}

/* Running totals of the row's counts; their bytes are returned. */
static size_t pack_table(const DeepImage *image, int y, Row *row)
{
    uint32_t total = 0;
    for (int x = 0; x < image->width; x++) {
        uint32_t count;
        deep_pixel(image, x, y, &count);
        total += count;
        put_u32(row->raw + 4 * (size_t)x, total);
    }
    return exr_deep_zip(row->raw, 4 * (size_t)image->width, row->scratch, row->table);
}

/* The row's samples channel by channel; *size: their bytes before compression. */
static size_t pack_samples(const DeepImage *image, int y, Row *row, size_t *size)
{
    uint8_t *out = row->raw;
    for (int channel = 0; channel < DEEP_CHANNELS; channel++)
        for (int x = 0; x < image->width; x++) {
            uint32_t count;
            const DeepSample *samples = deep_pixel(image, x, y, &count);
            for (uint32_t i = 0; i < count; i++, out += 4) {
                uint32_t bits;
                memcpy(&bits, (const char *)&samples[i] + deep_channels[channel].offset,
                       sizeof bits);
                put_u32(out, bits);
            }
        }
    *size = (size_t)(out - row->raw);
    return exr_deep_zip(row->raw, *size, row->scratch, row->packed);
}

static exr_result_t write_rows(exr_context_t context, const DeepImage *image, Row *row)
{
    exr_result_t code = EXR_ERR_SUCCESS;
    for (int y = 0; y < image->height && code == EXR_ERR_SUCCESS; y++) {
        size_t size, table = pack_table(image, y, row);
        size_t packed = pack_samples(image, y, row, &size);
        code = exr_write_deep_scanline_chunk(context, 0, y, row->packed, packed, size, row->table,
                                             table);
    }
    return code;
}

static Result create_row(const DeepImage *image, const char *path, Row *out)
{
    *out = (Row){0};
    uint64_t most = 0;
    for (int y = 0; y < image->height; y++) {
        uint64_t samples = row_samples(image, y);
        if (samples > INT32_MAX / (4 * DEEP_CHANNELS))
            return result_fail(RESULT_UNSUPPORTED,
                               "%s: row %d has %llu samples, expected at most %d in deep EXR", path,
                               y, (unsigned long long)samples, INT32_MAX / (4 * DEEP_CHANNELS));
        most = samples > most ? samples : most;
    }
    size_t table = 4 * (size_t)image->width, raw = 4 * DEEP_CHANNELS * (size_t)most;
    raw = raw > table ? raw : table;
    out->raw = memory_array(raw, 1);
    out->scratch = memory_array(raw, 1);
    out->table = memory_array(exr_deep_bound(table), 1);
    out->packed = memory_array(exr_deep_bound(raw), 1);
    return out->raw && out->scratch && out->table && out->packed ? RESULT_OK : RESULT_NO_MEMORY;
}

static void free_row(Row *row)
{
    free(row->raw);
    free(row->scratch);
    free(row->table);
    free(row->packed);
}

Result exr_deep_write(const DeepImage *image, const char *path)
{
    Row row;
    Result result = create_row(image, path, &row);
    if (result == RESULT_OK) {
        ExrOutput output;
        result = exr_output_open(path, &output);
        if (result == RESULT_OK) {
            exr_result_t code = write_header(output.context, image);
            if (code == EXR_ERR_SUCCESS)
                code = write_rows(output.context, image, &row);
            if (code != EXR_ERR_SUCCESS)
                result = exr_output_fail(&output, code);
        }
        Result closed = exr_output_close(&output, result == RESULT_OK);
        result = result == RESULT_OK ? closed : result;
    }
    free_row(&row);
    return result;
}
