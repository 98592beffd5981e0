#include "report/pictures.h"

#include "base/memory.h"
#include "image/png.h"
#include "report/heatmap.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    SCALE_WIDTH = 512,
    CHECKER = 8,
    PREVIEW_WIDTH = 640
};

const char *pictures_final(int renderer, char out[PICTURES_NAME])
{
    snprintf(out, PICTURES_NAME, "%s.png", threeway_renderer_name(renderer));
    return out;
}

const char *pictures_difference(const PairReport *pair, char out[PICTURES_NAME])
{
    snprintf(out, PICTURES_NAME, "difference-%s-%s.png", threeway_renderer_name(pair->a),
             threeway_renderer_name(pair->b));
    return out;
}

const char *pictures_preview(const PairReport *pair, int block, char out[PICTURES_NAME])
{
    if (block == 1)
        return pictures_difference(pair, out);
    snprintf(out, PICTURES_NAME, "difference-%s-%s-small.png", threeway_renderer_name(pair->a),
             threeway_renderer_name(pair->b));
    return out;
}

int pictures_block(const Threeway *report)
{
    return (report->desc.width + PREVIEW_WIDTH - 1) / PREVIEW_WIDTH;
}

const char *pictures_accum(const PeelPicture *peel, char out[PICTURES_NAME])
{
    snprintf(out, PICTURES_NAME, "peel-%03d-accumulated.png", peel->peel);
    return out;
}

const char *pictures_added(const PeelPicture *peel, char out[PICTURES_NAME])
{
    snprintf(out, PICTURES_NAME, "peel-%03d-added.png", peel->peel);
    return out;
}

char *pictures_path(const char *dir, const char *name)
{
    size_t size = strlen(dir) + strlen(name) + 2;
    char *path = memory_array(size, 1);
    if (path)
        snprintf(path, size, "%s/%s", dir, name);
    return path;
}

static Result write_image(const Image *image, const char *dir, const char *name)
{
    char *path = pictures_path(dir, name);
    Result result = path ? png_write(image, path) : RESULT_NO_MEMORY;
    free(path);
    return result;
}

/* Writes and frees. made: the result of making image. */
static Result write_made(Result made, Image *image, const char *dir, const char *name)
{
    Result result = made == RESULT_OK ? write_image(image, dir, name) : made;
    image_free(image);
    return result;
}

static uint8_t display(float linear)
{
    if (!(linear > 0.0f))
        return 0;
    double mapped = isinf(linear) ? 1.0 : (double)linear / ((double)linear + 1.0);
    return (uint8_t)lround(255.0 * pow(mapped, 1.0 / 2.2));
}

/* FORMAT_RGBA32F to FORMAT_RGBA8. checker: pixels whose alpha is 0 have nothing to show. */
static Result make_thumbnail(const Image *linear, bool checker, Image *out)
{
    Result result = image_create(linear->width, linear->height, FORMAT_RGBA8, out);
    if (result != RESULT_OK)
        return result;
    for (int y = 0; y < linear->height; y++)
        for (int x = 0; x < linear->width; x++) {
            const float *in = image_pixel(linear, x, y);
            uint8_t *pixel = image_pixel(out, x, y);
            uint8_t gray = (x / CHECKER + y / CHECKER) % 2 ? 58 : 46;
            for (int c = 0; c < 3; c++)
                pixel[c] = checker && in[3] == 0.0f ? gray : display(in[c]);
            pixel[3] = 255;
        }
    return RESULT_OK;
}

static Result write_peel(const PeelPicture *peel, const char *dir)
{
    Image image = {0};
    char name[PICTURES_NAME];
    Result made = make_thumbnail(&peel->accum, false, &image);
    Result result = write_made(made, &image, dir, pictures_accum(peel, name));
    if (result != RESULT_OK)
        return result;
    made = make_thumbnail(&peel->added, true, &image);
    return write_made(made, &image, dir, pictures_added(peel, name));
}

static Result write_difference(const Threeway *report, const PairReport *pair, const char *dir)
{
    const Image *a = &report->frames[pair->a].final, *b = &report->frames[pair->b].final;
    char name[PICTURES_NAME];
    Image image;
    Result made = heatmap_image(a, b, &image);
    Result result = write_made(made, &image, dir, pictures_difference(pair, name));
    int block = pictures_block(report);
    if (result != RESULT_OK || block == 1)
        return result;
    made = heatmap_reduced(a, b, block, &image);
    return write_made(made, &image, dir, pictures_preview(pair, block, name));
}

Result pictures_write_scale(const char *dir)
{
    Image image;
    Result made = heatmap_scale(SCALE_WIDTH, 16, &image);
    return write_made(made, &image, dir, PICTURES_SCALE);
}

Result pictures_write(const Threeway *report, const char *dir)
{
    char name[PICTURES_NAME];
    Result result = RESULT_OK;
    for (int i = 0; i < RENDERER_COUNT && result == RESULT_OK; i++)
        result = write_image(&report->frames[i].display, dir, pictures_final(i, name));
    for (int i = 0; i < 3 && result == RESULT_OK; i++)
        result = write_difference(report, &report->pairs[i], dir);
    if (result == RESULT_OK)
        result = pictures_write_scale(dir);
    for (size_t i = 0; i < report->peel_count && result == RESULT_OK; i++)
        result = write_peel(&report->peels[i], dir);
    return result;
}

/* Whether name is that of a peel's picture, and none of the report's. */
static bool is_stale(const Threeway *report, const char *name)
{
    PeelPicture peel = {0};
    char accum[PICTURES_NAME], added[PICTURES_NAME];
    if (sscanf(name, "peel-%9d-", &peel.peel) != 1) /* NOLINT(cert-err34-c): nine digits fit */
        return false;
    if (strcmp(name, pictures_accum(&peel, accum)) != 0 &&
        strcmp(name, pictures_added(&peel, added)) != 0)
        return false;
    for (size_t i = 0; i < report->peel_count; i++)
        if (report->peels[i].peel == peel.peel)
            return false;
    return peel.peel >= 0;
}

static Result remove_file(const char *path)
{
    struct stat status;
    if (lstat(path, &status) != 0 || !S_ISREG(status.st_mode) || unlink(path) == 0)
        return RESULT_OK;
    return result_fail(RESULT_IO, "%s: cannot remove this picture of an earlier report: %s", path,
                       strerror(errno));
}

Result pictures_remove_stale(const Threeway *report, const char *dir)
{
    DIR *directory = opendir(dir);
    if (!directory)
        return result_fail(RESULT_IO, "%s: cannot list this directory: %s", dir, strerror(errno));
    Result result = RESULT_OK;
    for (struct dirent *entry; result == RESULT_OK && (entry = readdir(directory));) {
        if (!is_stale(report, entry->d_name))
            continue;
        char *path = pictures_path(dir, entry->d_name);
        result = path ? remove_file(path) : RESULT_NO_MEMORY;
        free(path);
    }
    closedir(directory);
    return result;
}
