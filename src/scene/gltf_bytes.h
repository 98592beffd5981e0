/* The bytes behind a checked document: of its buffers, images and texture coordinates. */
#ifndef PEEL_SCENE_GLTF_BYTES_H
#define PEEL_SCENE_GLTF_BYTES_H

#include "scene/gltf.h"
#include "scene/gltf_json.h"

typedef struct GltfSpan {
    const unsigned char *bytes;
    size_t count;
    unsigned char *owned; /* to free; NULL where the bytes are somebody else's */
} GltfSpan;

/* Buffers are read when they are first needed, and kept. */
typedef struct GltfBytes {
    const char *path;
    const GltfJson *json;
    GltfSpan *buffers; /* one per buffer of the document, NULL until the first is read */
} GltfBytes;

void gltf_bytes_free(GltfBytes *bytes); /* buffers only */

/* An image's encoded file, from its uri or its bufferView; the caller frees out->owned. The other
 * bytes live as long as *bytes. BAD_INPUT ("PATH: image 3: …"), IO or NO_MEMORY leave *out empty.
 */
Result gltf_bytes_image(GltfBytes *bytes, size_t image, GltfSpan *out);

/* Tells file of the document's file and of all files that it names, as often as it names them; the
 * first failure ends it. */
Result gltf_bytes_files(const GltfBytes *bytes, GltfFile file, void *context);

/* The texture coordinates of a checked accessor, 2 floats per vertex: floats with the file's bits,
 * normalised integers as c/255 and c/65535. The caller frees *out; NULL after a failure. */
Result gltf_bytes_uv(GltfBytes *bytes, size_t accessor, float **out);

#endif
