/* The container that src/dump/peel_dump.h writes: named buffers, one after another. The format is
 * described there. */
#ifndef PEEL_IMAGE_DUMP_H
#define PEEL_IMAGE_DUMP_H

#include "image/image.h"

#include <stdbool.h>

enum {
    DUMP_NAME = 48
};
#define DUMP_MAGIC "peel-dump "

/* Takes one buffer, rows from top to bottom; the image is the reader's. A failure ends the reading
 * with that result. */
typedef Result (*DumpTake)(void *context, const char *name, const Image *image);

/* Gives every buffer of the file to take, in its order. BAD_INPUT with the buffer's number for a
 * line that is none, a format that does not exist, integers beyond their format or a file that ends
 * too early; UNSUPPORTED for another byte order than this machine's. */
Result dump_read(const char *path, DumpTake take, void *context);

#endif
