/* Bytes of .gltf and .glb files, whole; what they mean is gltf_json's and gltf_write's business. */
#ifndef PEEL_SCENE_GLTF_FILE_H
#define PEEL_SCENE_GLTF_FILE_H

#include "base/result.h"

#include <stddef.h>

/* The path of an external buffer: the uri, its %XX decoded (RFC 3986, 2.1), beside the file at
 * path. The caller frees *out. BAD_INPUT for a malformed escape or %00, NO_MEMORY. */
Result gltf_file_beside(const char *path, const char *uri, char **out);

/* 1 for .glb, 0 for .gltf, −1 for anything else; case does not matter. */
int gltf_file_kind(const char *path);

/* The bytes of a .glb: JSON chunk and, unless empty, BIN chunk. The caller frees *out. */
Result gltf_file_assemble(const char *text, const unsigned char *binary, size_t binary_count,
                          unsigned char **out, size_t *out_count);

/* The bytes of a "data:" uri in base64 (RFC 2397, RFC 4648; padding may be missing). The caller
 * frees *bytes. BAD_INPUT with a message that names neither file nor place, NO_MEMORY. */
Result gltf_file_from_data_uri(const char *uri, unsigned char **bytes, size_t *count);

/* The bytes that a uri names, embedded or in a file beside the one at path; what ("buffer") and
 * index name it in messages. The caller frees *bytes. As the two above; BAD_INPUT where there is no
 * such file. */
Result gltf_file_uri(const char *path, const char *what, size_t index, const char *uri,
                     unsigned char **bytes, size_t *count);

/* "data:TYPE;base64," and the bytes (RFC 4648), type being a media type such as "image/png"; the
 * caller frees it. NULL without memory. */
char *gltf_file_data_uri(const char *type, const unsigned char *bytes, size_t count);

#endif
