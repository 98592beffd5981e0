/* A scene as one block of bytes, for a program that has no file libraries.
 *
 * Every float keeps its bits; textures take a byte a channel where 256 values suffice.
 * Little-endian, as the machines that Peel runs on. The form is not kept from version to version:
 * write and read with the same Peel. */
#ifndef PEEL_SCENE_BLOB_H
#define PEEL_SCENE_BLOB_H

#include "scene/scene.h"

/* The caller frees *bytes. NO_MEMORY is possible. */
Result blob_write(const Scene *scene, unsigned char **bytes, size_t *count);

/* The scene, valid as scene_validate wants it; the caller frees it. BAD_INPUT where the bytes are
 * not what blob_write makes; *out is then empty. */
Result blob_read(const unsigned char *bytes, size_t count, Scene *out);

#endif
