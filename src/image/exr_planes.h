/* Parts of any flat OpenEXR file, scanlines or tiles, with all their channels. */
#ifndef PEEL_IMAGE_EXR_PLANES_H
#define PEEL_IMAGE_EXR_PLANES_H

#include "image/planes.h"

typedef struct ExrFile ExrFile;

/* Parses the headers. BAD_INPUT or IO with a message naming path; the caller closes. */
Result exr_file_open(const char *path, ExrFile **out);
void exr_file_close(ExrFile *file); /* NULL is fine */

int exr_file_count(const ExrFile *file);
const char *exr_file_name(const ExrFile *file, int part); /* "" if none; the file's */
bool exr_file_is_deep(const ExrFile *file, int part);
/* Whether every part has a name and says which PixelFormat it holds, as in a trace. */
bool exr_file_is_trace(const ExrFile *file);

/* A part's pixels as exr_read gives them. The caller frees *out; after a failure it is empty. */
Result exr_file_image(const ExrFile *file, int part, Image *out);

/* Integer channels are KIND_UNORM where the part says so (EXR_FORMAT_ATTRIBUTE), else KIND_UINT. Of
 * a tiled part its full size. UNSUPPORTED for subsampled channels and deep parts, BAD_INPUT for
 * broken files, NO_MEMORY beyond max_bytes. The caller frees *out; after a failure it is empty. */
Result exr_file_planes(ExrFile *file, int part, size_t max_bytes, Planes *out);

/* Writes planes of floats as one part: scanlines, ZIP; to a temporary name, then renamed. */
Result exr_planes_write(const Planes *planes, const char *path);

#endif
