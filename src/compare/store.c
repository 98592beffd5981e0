#define _GNU_SOURCE /* O_TMPFILE */
#include "compare/store.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    PIXEL_BYTES_MAX = 16
};
enum {
    TILE_BYTES_MAX = TRACE_TILE * TRACE_TILE * PIXEL_BYTES_MAX
};

typedef enum TileKind {
    TILE_ABSENT = 0,
    TILE_CONSTANT,
    TILE_MEMORY,
    TILE_FILE
} TileKind;

typedef struct TileRef {
    TileKind kind;
    uint64_t hash; /* of the bytes, to find candidates for sharing */
    union {
        unsigned char constant[PIXEL_BYTES_MAX];
        unsigned char *memory;
        uint64_t offset;
    };
} TileRef;

typedef struct Entry {
    StoredBuffer buffer;
    TileRef *tiles;
    int columns;
    int previous; /* entry of the same buffer in the previous peel, or −1 */
} Entry;

struct TraceStore {
    TraceSink sink;
    size_t budget;
    Entry *entries;
    size_t count, capacity;
    unsigned char **blocks; /* tiles in memory, each its own allocation */
    size_t block_count, block_capacity;
    uint64_t memory_bytes, file_bytes;
    FILE *file;
    unsigned char tile[TILE_BYTES_MAX], other[TILE_BYTES_MAX];
};

static int columns_of(int width)
{
    return (width + TRACE_TILE - 1) / TRACE_TILE;
}

/* FNV-1a over 64-bit words: only a filter, equality is decided by the bytes. */
static uint64_t hash_bytes(const unsigned char *bytes, size_t size)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i + 8 <= size; i += 8) {
        uint64_t word;
        memcpy(&word, bytes + i, sizeof word);
        hash = (hash ^ word) * 0x100000001b3u;
        hash ^= hash >> 29;
    }
    for (size_t i = size & ~(size_t)7; i < size; i++)
        hash = (hash ^ bytes[i]) * 0x100000001b3u;
    return hash;
}

/* "peel.7.accum" → entry of "peel.6.accum". */
static int find_previous(const TraceStore *store, const char *name)
{
    const char *rest;
    int peel = trace_peel_number(name, &rest);
    if (peel < 1)
        return -1;
    char previous[64];
    snprintf(previous, sizeof previous, "peel.%d%s", peel - 1, rest);
    return store_find(store, previous);
}

static bool is_same_shape(const StoredBuffer *stored, const TraceBuffer *buffer)
{
    return stored->format == buffer->format && stored->width == buffer->image_width &&
           stored->height == buffer->image_height;
}

static Result add_entry(TraceStore *store, const TraceBuffer *buffer)
{
    Result result = memory_grow((void **)&store->entries, &store->capacity, store->count + 1,
                                sizeof *store->entries);
    if (result != RESULT_OK)
        return result;
    Entry entry = {
        .buffer = {.step = buffer->step,
                   .format = buffer->format,
                   .width = buffer->image_width,
                   .height = buffer->image_height},
        .columns = columns_of(buffer->image_width),
        .previous = find_previous(store, buffer->name),
    };
    if (entry.previous >= 0 && !is_same_shape(&store->entries[entry.previous].buffer, buffer))
        entry.previous = -1;
    snprintf(entry.buffer.name, sizeof entry.buffer.name, "%s", buffer->name);
    entry.tiles = memory_array((size_t)entry.columns * (size_t)columns_of(buffer->image_height),
                               sizeof *entry.tiles);
    if (!entry.tiles)
        return RESULT_NO_MEMORY;
    store->entries[store->count++] = entry;
    return RESULT_OK;
}

static Result load_tile(const TraceStore *store, const TileRef *ref, size_t pixel_bytes,
                        size_t pixels, unsigned char *out)
{
    size_t bytes = pixel_bytes * pixels;
    switch (ref->kind) {
    case TILE_ABSENT:
        break;
    case TILE_CONSTANT:
        for (size_t i = 0; i < pixels; i++)
            memcpy(out + i * pixel_bytes, ref->constant, pixel_bytes);
        break;
    case TILE_MEMORY:
        memcpy(out, ref->memory, bytes);
        break;
    case TILE_FILE:
        errno = 0;
        if (pread(fileno(store->file), out, bytes, (off_t)ref->offset) != (ssize_t)bytes)
            return result_fail(RESULT_IO, "temporary trace file: read failed: %s",
                               strerror(errno ? errno : EIO));
        break;
    }
    return RESULT_OK;
}

static bool is_constant(const unsigned char *tile, size_t bytes, size_t pixel_bytes)
{
    return memcmp(tile, tile + pixel_bytes, bytes - pixel_bytes) == 0;
}

/* An unnamed file in TMPDIR, or where tmpfile puts it. */
static FILE *open_temporary(void)
{
    const char *directory = getenv("TMPDIR");
    int descriptor = directory ? open(directory, O_TMPFILE | O_RDWR | O_CLOEXEC, 0600) : -1;
    if (descriptor < 0)
        return tmpfile();
    FILE *file = fdopen(descriptor, "w+b");
    if (!file)
        close(descriptor);
    return file;
}

static Result spill(TraceStore *store, size_t bytes, TileRef *ref)
{
    if (!store->file && !(store->file = open_temporary()))
        return result_fail(RESULT_IO, "temporary trace file: %s", strerror(errno));
    errno = 0;
    if (pwrite(fileno(store->file), store->tile, bytes, (off_t)store->file_bytes) != (ssize_t)bytes)
        return result_fail(RESULT_IO, "temporary trace file: write failed: %s",
                           strerror(errno ? errno : ENOSPC));
    ref->kind = TILE_FILE;
    ref->offset = store->file_bytes;
    store->file_bytes += bytes;
    return RESULT_OK;
}

static Result keep(TraceStore *store, size_t bytes, TileRef *ref)
{
    if (store->memory_bytes + bytes > store->budget)
        return spill(store, bytes, ref);
    Result result = memory_grow((void **)&store->blocks, &store->block_capacity,
                                store->block_count + 1, sizeof *store->blocks);
    if (result != RESULT_OK)
        return result;
    unsigned char *block = malloc(bytes);
    if (!block)
        return result_fail(RESULT_NO_MEMORY, "out of memory: a trace tile of %zu bytes", bytes);
    memcpy(block, store->tile, bytes);
    store->blocks[store->block_count++] = block;
    store->memory_bytes += bytes;
    ref->kind = TILE_MEMORY;
    ref->memory = block;
    return RESULT_OK;
}

/* Stores the tile in store->tile (pixels × pixel_bytes, packed). */
static Result put_tile(TraceStore *store, const TileRef *previous, size_t pixel_bytes,
                       size_t pixels, TileRef *ref)
{
    size_t bytes = pixels * pixel_bytes;
    if (is_constant(store->tile, bytes, pixel_bytes)) {
        ref->kind = TILE_CONSTANT;
        memcpy(ref->constant, store->tile, pixel_bytes);
        return RESULT_OK;
    }
    ref->hash = hash_bytes(store->tile, bytes);
    if (previous && previous->hash == ref->hash && previous->kind >= TILE_MEMORY) {
        Result result = load_tile(store, previous, pixel_bytes, pixels, store->other);
        if (result != RESULT_OK)
            return result;
        if (memcmp(store->tile, store->other, bytes) == 0) {
            *ref = *previous;
            return RESULT_OK;
        }
    }
    return keep(store, bytes, ref);
}

static int minimum(int a, int b)
{
    return a < b ? a : b;
}

static Result put(TraceSink *sink, const TraceBuffer *buffer)
{
    TraceStore *store = (TraceStore *)sink;
    int index = store_find(store, buffer->name);
    if (index < 0) {
        Result result = add_entry(store, buffer);
        if (result != RESULT_OK)
            return result;
        index = (int)store->count - 1;
    }
    const Entry *entry = &store->entries[index];
    if (!is_same_shape(&entry->buffer, buffer))
        return result_fail(RESULT_INTERNAL, "trace: %s came twice, in two sizes or formats",
                           buffer->name);
    size_t pixel_bytes = format_pixel_bytes(buffer->format);
    for (int y = 0; y < buffer->height; y += TRACE_TILE)
        for (int x = 0; x < buffer->width; x += TRACE_TILE) {
            int width = minimum(TRACE_TILE, buffer->width - x);
            int height = minimum(TRACE_TILE, buffer->height - y);
            const unsigned char *from = (const unsigned char *)buffer->pixels +
                                        (size_t)y * buffer->row_bytes + (size_t)x * pixel_bytes;
            size_t row = (size_t)width * pixel_bytes;
            for (int i = 0; i < height; i++)
                memcpy(store->tile + (size_t)i * row, from + (size_t)i * buffer->row_bytes, row);
            size_t tile = (size_t)((buffer->y + y) / TRACE_TILE) * (size_t)entry->columns +
                          (size_t)((buffer->x + x) / TRACE_TILE);
            const TileRef *previous =
                entry->previous >= 0 ? &store->entries[entry->previous].tiles[tile] : NULL;
            Result result = put_tile(store, previous, pixel_bytes, (size_t)width * (size_t)height,
                                     &entry->tiles[tile]);
            if (result != RESULT_OK)
                return result;
        }
    return RESULT_OK;
}

Result store_create(size_t budget, TraceStore **out)
{
    TraceStore *store = memory_array(1, sizeof *store);
    *out = store;
    if (!store)
        return RESULT_NO_MEMORY;
    store->sink.put = put;
    store->budget = budget ? budget : (size_t)512 << 20;
    return RESULT_OK;
}

void store_destroy(TraceStore *store)
{
    if (!store)
        return;
    for (size_t i = 0; i < store->block_count; i++)
        free(store->blocks[i]);
    for (size_t i = 0; i < store->count; i++)
        free(store->entries[i].tiles);
    if (store->file)
        (void)fclose(store->file);
    free(store->blocks);
    free(store->entries);
    free(store);
}

TraceSink *store_sink(TraceStore *store)
{
    return &store->sink;
}

int store_count(const TraceStore *store)
{
    return (int)store->count;
}

const StoredBuffer *store_buffer(const TraceStore *store, int index)
{
    return &store->entries[index].buffer;
}

int store_find(const TraceStore *store, const char *name)
{
    /* From the end: the buffers of the latest peels are the ones looked for. */
    for (size_t i = store->count; i-- > 0;)
        if (strcmp(store->entries[i].buffer.name, name) == 0)
            return (int)i;
    return -1;
}

Result store_read(const TraceStore *store, int index, int x, int y, int width, int height,
                  void *pixels, size_t row_bytes)
{
    const Entry *entry = &store->entries[index];
    const StoredBuffer *buffer = &entry->buffer;
    size_t pixel_bytes = format_pixel_bytes(buffer->format);
    unsigned char tile[TILE_BYTES_MAX];
    for (int ty = y / TRACE_TILE * TRACE_TILE; ty < y + height; ty += TRACE_TILE)
        for (int tx = x / TRACE_TILE * TRACE_TILE; tx < x + width; tx += TRACE_TILE) {
            int tile_width = minimum(TRACE_TILE, buffer->width - tx);
            int tile_height = minimum(TRACE_TILE, buffer->height - ty);
            memset(tile, buffer->format == FORMAT_R32UI ? 0xff : 0, sizeof tile);
            const TileRef *ref = &entry->tiles[(size_t)(ty / TRACE_TILE) * (size_t)entry->columns +
                                               (size_t)(tx / TRACE_TILE)];
            Result result =
                load_tile(store, ref, pixel_bytes, (size_t)tile_width * (size_t)tile_height, tile);
            if (result != RESULT_OK)
                return result;
            int x0 = tx > x ? tx : x, x1 = minimum(tx + tile_width, x + width);
            int y0 = ty > y ? ty : y, y1 = minimum(ty + tile_height, y + height);
            for (int row = y0; row < y1; row++)
                memcpy((unsigned char *)pixels + (size_t)(row - y) * row_bytes +
                           (size_t)(x0 - x) * pixel_bytes,
                       tile + ((size_t)(row - ty) * (size_t)tile_width + (size_t)(x0 - tx)) *
                                  pixel_bytes,
                       (size_t)(x1 - x0) * pixel_bytes);
        }
    return RESULT_OK;
}

Result store_image(const TraceStore *store, int index, Image *out)
{
    const StoredBuffer *buffer = store_buffer(store, index);
    Result result = image_create(buffer->width, buffer->height, buffer->format, out);
    if (result == RESULT_OK)
        result = store_read(store, index, 0, 0, buffer->width, buffer->height, out->pixels,
                            (size_t)buffer->width * format_pixel_bytes(buffer->format));
    if (result != RESULT_OK)
        image_free(out);
    return result;
}

uint64_t store_memory_bytes(const TraceStore *store)
{
    return store->memory_bytes;
}

uint64_t store_file_bytes(const TraceStore *store)
{
    return store->file_bytes;
}
