#include "image/image.h"

#include "base/memory.h"

#include <stdlib.h>

Result image_create(int width, int height, PixelFormat format, Image *out)
{
    *out = (Image){width, height, format, NULL};
    if (width < 1 || height < 1)
        return result_fail(RESULT_BAD_INPUT, "image of %d×%d pixels, expected at least 1×1", width,
                           height);
    out->pixels = memory_array((size_t)width * (size_t)height, format_pixel_bytes(format));
    return out->pixels ? RESULT_OK : RESULT_NO_MEMORY;
}

void image_free(Image *image)
{
    free(image->pixels);
    *image = (Image){0};
}
