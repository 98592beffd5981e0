/* A trace kept for later: sparse, and in a file past a memory budget.
 *
 * Buffers are cut into tiles of TRACE_TILE². A tile of one value is that value; a tile equal to
 * the one that the same buffer of the previous peel had is shared with it; the rest is kept, in
 * memory up to the budget, then in an unnamed temporary file. So the cost of a deep peel is that
 * of the pixels it changes. */
#ifndef PEEL_COMPARE_STORE_H
#define PEEL_COMPARE_STORE_H

#include "frame/trace.h"
#include "image/image.h"

#include <stdint.h>

typedef struct TraceStore TraceStore;

typedef struct StoredBuffer {
    char name[48];
    int step;
    PixelFormat format;
    int width, height;
} StoredBuffer;

/* budget: bytes of tiles in memory; 0 means 512 MiB. The caller destroys. */
Result store_create(size_t budget, TraceStore **out);
void store_destroy(TraceStore *store); /* NULL is fine */

TraceSink *store_sink(TraceStore *store); /* owned by the store; takes every buffer */

/* In order of first arrival. Index −1 from find: there is no such buffer. */
int store_count(const TraceStore *store);
const StoredBuffer *store_buffer(const TraceStore *store, int index);
int store_find(const TraceStore *store, const char *name);

/* Copies rows y … y + height − 1 of columns x … x + width − 1 to pixels, any rectangle inside the
 * buffer. Pixels never put read as 0, or as UINT32_MAX in FORMAT_R32UI. */
Result store_read(const TraceStore *store, int index, int x, int y, int width, int height,
                  void *pixels, size_t row_bytes);

/* A whole buffer as an image; the caller frees it. */
Result store_image(const TraceStore *store, int index, Image *out);

uint64_t store_memory_bytes(const TraceStore *store);
uint64_t store_file_bytes(const TraceStore *store);

#endif
