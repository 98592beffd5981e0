#include "ref/pipeline/buffers.h"

Result gbuffer_create(const RenderDesc *desc, GBuffer *out)
{
    GBufferLayout layout = render_desc_layout(desc);
    *out = (GBuffer){0};
    struct {
        Image *image;
        PixelFormat format;
    } images[] = {
        {&out->depth, render_desc_depth(desc)}, {&out->normal, layout.normal},
        {&out->position, layout.position},      {&out->diffuse, layout.diffuse},
        {&out->material, layout.material},      {&out->primitive, FORMAT_R32UI},
    };
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++) {
        images[i].image->format = images[i].format;
        if (images[i].format == FORMAT_NONE)
            continue;
        Result result = image_create(desc->width, desc->height, images[i].format, images[i].image);
        if (result != RESULT_OK) {
            gbuffer_free(out);
            return result;
        }
    }
    gbuffer_clear(out, desc->depth_range);
    return RESULT_OK;
}

void gbuffer_free(GBuffer *buffers)
{
    image_free(&buffers->depth);
    image_free(&buffers->normal);
    image_free(&buffers->position);
    image_free(&buffers->diffuse);
    image_free(&buffers->material);
    image_free(&buffers->primitive);
}

static void clear_color(Image *image)
{
    if (image->pixels)
        memset(image->pixels, 0,
               (size_t)image->width * (size_t)image->height * format_pixel_bytes(image->format));
}

void gbuffer_clear_colors(GBuffer *buffers)
{
    const Image *primitive = &buffers->primitive;
    clear_color(&buffers->normal);
    clear_color(&buffers->position);
    clear_color(&buffers->diffuse);
    clear_color(&buffers->material);
    memset(primitive->pixels, 0xff,
           (size_t)primitive->width * (size_t)primitive->height * sizeof(uint32_t));
}

void gbuffer_clear_depth(Image *depth, DepthRange range)
{
    uint32_t far = depth_key_far(depth->format, range), *keys = depth->pixels;
    size_t pixels = (size_t)depth->width * (size_t)depth->height;
    for (size_t i = 0; i < pixels; i++)
        keys[i] = far;
}

void gbuffer_clear(GBuffer *buffers, DepthRange range)
{
    gbuffer_clear_colors(buffers);
    gbuffer_clear_depth(&buffers->depth, range);
}

/* The pixel of an image, or NULL of one that is not stored. */
static void *pixel_of(const Image *image, int x, int y)
{
    return image->pixels ? image_pixel(image, x, y) : NULL;
}

void gbuffer_store(GBuffer *buffers, int x, int y, const Texel *texel)
{
    format_store(buffers->normal.format, texel->normal, pixel_of(&buffers->normal, x, y));
    format_store(buffers->position.format, texel->position, pixel_of(&buffers->position, x, y));
    format_store(buffers->diffuse.format, texel->diffuse, pixel_of(&buffers->diffuse, x, y));
    format_store(buffers->material.format, texel->material, pixel_of(&buffers->material, x, y));
}

void gbuffer_load(const GBuffer *buffers, int x, int y, Texel *out)
{
    format_fetch(buffers->normal.format, pixel_of(&buffers->normal, x, y), out->normal);
    format_fetch(buffers->position.format, pixel_of(&buffers->position, x, y), out->position);
    format_fetch(buffers->diffuse.format, pixel_of(&buffers->diffuse, x, y), out->diffuse);
    format_fetch(buffers->material.format, pixel_of(&buffers->material, x, y), out->material);
}

static void quantise(PixelFormat format, float value[4])
{
    if (format == FORMAT_RGBA32F)
        return;
    unsigned char pixel[16];
    format_store(format, value, pixel);
    format_fetch(format, pixel, value);
}

void texel_quantise(const GBufferLayout *layout, Texel *texel)
{
    quantise(layout->normal, texel->normal);
    quantise(layout->position, texel->position);
    quantise(layout->diffuse, texel->diffuse);
    quantise(layout->material, texel->material);
}
