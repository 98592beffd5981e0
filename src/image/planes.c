#include "image/planes.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

Result planes_fit(int width, int height, int count, size_t max_bytes, const char *label)
{
    size_t pixels = (size_t)width * (size_t)height;
    if (!max_bytes || pixels * sizeof(uint32_t) <= max_bytes / (size_t)count)
        return RESULT_OK;
    return result_fail(RESULT_NO_MEMORY, "%s: %d channels of %dx%d pixels need more than %zu bytes",
                       label, count, width, height, max_bytes);
}

Result planes_create(int width, int height, int count, size_t max_bytes, const char *label,
                     Planes *out)
{
    size_t pixels = (size_t)width * (size_t)height;
    *out = (Planes){.width = width, .height = height};
    Result result = planes_fit(width, height, count, max_bytes, label);
    if (result != RESULT_OK)
        return result;
    out->planes = memory_array((size_t)count, sizeof *out->planes);
    if (!out->planes)
        return RESULT_NO_MEMORY;
    out->count = count;
    for (int i = 0; i < count; i++) {
        out->planes[i].bits = memory_array(pixels, sizeof(uint32_t));
        if (!out->planes[i].bits)
            return RESULT_NO_MEMORY;
    }
    return RESULT_OK;
}

static void free_plane(Plane *plane)
{
    free(plane->name);
    free(plane->bits);
}

void planes_free(Planes *planes)
{
    for (int i = 0; i < planes->count; i++)
        free_plane(&planes->planes[i]);
    free(planes->planes);
    *planes = (Planes){0};
}

Result planes_name(Plane *plane, const char *name)
{
    plane->name = strdup(name);
    return plane->name ? RESULT_OK : result_fail(RESULT_NO_MEMORY, "%s: out of memory", name);
}

static int place(const char *name)
{
    static const char order[] = "YRGBA";
    const char *at = name[0] && !name[1] ? strchr(order, name[0]) : NULL;
    return at ? (int)(at - order) : (int)sizeof order;
}

void planes_sort(Planes *planes)
{
    for (int i = 1; i < planes->count; i++) {
        Plane plane = planes->planes[i];
        int at = i;
        for (; at > 0 && place(planes->planes[at - 1].name) > place(plane.name); at--)
            planes->planes[at] = planes->planes[at - 1];
        planes->planes[at] = plane;
    }
}

int planes_find(const Planes *planes, const char *name)
{
    for (int i = 0; i < planes->count; i++)
        if (strcmp(planes->planes[i].name, name) == 0)
            return i;
    return -1;
}

/* The next of the names between commas, NULL behind the last; *rest moves on. */
static int find_next(const Planes *planes, const char **rest)
{
    size_t length = strcspn(*rest, ",");
    int found = -1;
    for (int i = 0; i < planes->count && found < 0; i++)
        if (strlen(planes->planes[i].name) == length &&
            memcmp(planes->planes[i].name, *rest, length) == 0)
            found = i;
    *rest += length + ((*rest)[length] == ',');
    return found;
}

bool planes_keep(Planes *planes, const char *names)
{
    for (const char *rest = names; *rest;)
        if (find_next(planes, &rest) < 0)
            return false;
    int kept = 0;
    for (const char *rest = names; *rest;) {
        int from = find_next(planes, &rest);
        if (from < kept)
            continue; /* named twice */
        Plane plane = planes->planes[from];
        planes->planes[from] = planes->planes[kept];
        planes->planes[kept++] = plane;
    }
    for (int i = kept; i < planes->count; i++)
        free_plane(&planes->planes[i]);
    planes->count = kept;
    return true;
}

Result planes_from_image(const Image *image, int channels, Planes *out)
{
    static const char *const names[4][4] = {
        {"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}};
    const FormatInfo *info = format_info(image->format);
    Result result = planes_create(image->width, image->height, channels, 0, "", out);
    for (int c = 0; c < channels && result == RESULT_OK; c++) {
        Plane *plane = &out->planes[c];
        int from = channels == 2 && c == 1 ? 3 : c;
        plane->kind = info->kind;
        plane->unorm_max = info->unorm_max;
        result = planes_name(plane, names[channels - 1][c]);
        size_t pixel_bytes = format_pixel_bytes(image->format);
        const unsigned char *at = image->pixels;
        for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++, at += pixel_bytes)
            plane->bits[i] = format_bits(image->format, at, from);
    }
    if (result != RESULT_OK)
        planes_free(out);
    return result;
}

double planes_value(FormatKind kind, uint32_t unorm_max, uint32_t bits)
{
    float value;
    switch (kind) {
    case KIND_FLOAT:
        memcpy(&value, &bits, sizeof value);
        return (double)value;
    case KIND_HALF:
        return (double)half_to_float((uint16_t)bits);
    case KIND_UNORM:
        return (double)(float)((double)bits / unorm_max);
    case KIND_UINT:
        break;
    }
    return (double)bits;
}

const char *planes_kind_name(FormatKind kind, uint32_t unorm_max)
{
    if (kind == KIND_UNORM)
        return unorm_max == 0xff ? "unorm8" : unorm_max == 0xffff ? "unorm16" : "unorm24";
    return kind == KIND_FLOAT ? "float" : kind == KIND_HALF ? "half" : "uint";
}
