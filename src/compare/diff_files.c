#include "compare/diff_files.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/text.h"
#include "image/decode.h"
#include "image/exr.h"
#include "image/exr_deep.h"
#include "image/exr_planes.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- a file ---- */

typedef struct Source {
    const char *path;
    ExrFile *exr; /* NULL: the only part is in `image` */
    Planes image;
} Source;

static void close_source(Source *source)
{
    exr_file_close(source->exr);
    planes_free(&source->image);
}

static Result read_png(const char *path, size_t max_bytes, Planes *out)
{
    unsigned char *bytes;
    size_t count;
    Image image = {0};
    Result result = file_load(path, &bytes, &count);
    if (result != RESULT_OK)
        return result;
    if (count < 4 || (memcmp(bytes, "\x89PNG", 4) != 0 && memcmp(bytes, "\xff\xd8\xff", 3) != 0))
        result =
            result_fail(RESULT_BAD_INPUT, "%s: neither PNG nor EXR, expected one of them", path);
    int width, height, channels = 0;
    if (result == RESULT_OK)
        result = decode_size(bytes, count, path, &width, &height, &channels);
    if (result == RESULT_OK)
        result = planes_fit(width, height, channels, max_bytes, path);
    if (result == RESULT_OK)
        result = decode_image(bytes, count, path, &image);
    if (result == RESULT_OK)
        result = planes_from_image(&image, channels, out);
    image_free(&image);
    free(bytes);
    return result;
}

static Result open_source(const char *path, size_t max_bytes, Source *out)
{
    bool exr = false;
    *out = (Source){.path = path};
    Result result = exr_is(path, &exr);
    if (result == RESULT_OK)
        result = exr ? exr_file_open(path, &out->exr) : read_png(path, max_bytes, &out->image);
    return result;
}

static int part_count(const Source *source)
{
    return source->exr ? exr_file_count(source->exr) : 1;
}

static const char *part_name(const Source *source, int part)
{
    return source->exr ? exr_file_name(source->exr, part) : "";
}

static bool is_deep(const Source *source, int part)
{
    return source->exr && exr_file_is_deep(source->exr, part);
}

static bool is_trace(const Source *source)
{
    return source->exr && exr_file_is_trace(source->exr) && part_count(source) > 1;
}

/* The caller frees *out. */
static Result read_planes(Source *source, int part, size_t max_bytes, Planes *out)
{
    if (source->exr)
        return exr_file_planes(source->exr, part, max_bytes, out);
    *out = source->image;
    source->image = (Planes){0};
    return RESULT_OK;
}

/* ---- a part ---- */

/* The worst verdict of all parts; the first part that differs. */
static void note(DiffReport *report, const DiffPart *part)
{
    bool differs = part->differing || part->lacks[0] || part->lacks[1];
    if (part->verdict > report->verdict)
        report->verdict = part->verdict;
    if (differs && report->first < 0)
        report->first = (int)report->count - 1;
}

/* Takes over *part, under a name; frees it after a failure, which may have come before. */
static Result add_part(DiffReport *report, const char *name, Result result, DiffPart *part)
{
    if (result == RESULT_OK)
        result = memory_grow((void **)&report->parts, &report->capacity, report->count + 1,
                             sizeof *report->parts);
    if (result == RESULT_OK && !(part->name = strdup(name)))
        result = result_fail(RESULT_NO_MEMORY, "out of memory");
    if (result != RESULT_OK) {
        diff_part_free(part);
        return result;
    }
    text_make_line(part->name);
    report->parts[report->count++] = *part;
    note(report, part);
    return RESULT_OK;
}

static Result add_lacking(DiffReport *report, const char *name, int side)
{
    size_t length = strlen(name);
    if (report->trace && length > 10 && strcmp(name + length - 10, ".primitive") == 0) {
        report->left_out++;
        return RESULT_OK;
    }
    DiffPart part = {.verdict = DIFF_FAILURE};
    part.lacks[side] = true;
    return add_part(report, name, RESULT_OK, &part);
}

static bool same_size(DiffReport *report, const char *name, DiffSize a, DiffSize b)
{
    if (a.x == b.x && a.y == b.y && a.width == b.width && a.height == b.height)
        return true;
    report->sizes_differ = true;
    report->sizes[0] = a;
    report->sizes[1] = b;
    snprintf(report->size_part, sizeof report->size_part, "%s", name);
    text_make_line(report->size_part);
    return false;
}

/* Names with commas between, cut to the room there is. */
static void list_channels(const Planes *planes, char *out, size_t size)
{
    size_t length = 0;
    out[0] = 0;
    for (int i = 0; i < planes->count && length < size; i++)
        length += (size_t)snprintf(out + length, size - length, "%s%s", i ? ", " : "",
                                   planes->planes[i].name);
}

static Result match_channels(const DiffFilesOptions *options, const char *const paths[],
                             Planes planes[DIFF_SIDES])
{
    char names[DIFF_SIDES][120];
    bool common = false;
    for (int side = 0; side < DIFF_SIDES; side++) {
        list_channels(&planes[side], names[side], sizeof names[side]);
        if (options->channels && !planes_keep(&planes[side], options->channels))
            return result_fail(RESULT_BAD_INPUT, "--channels %s: %s has only %s", options->channels,
                               paths[side], names[side]);
    }
    for (int i = 0; i < planes[0].count; i++)
        common |= planes_find(&planes[1], planes[0].planes[i].name) >= 0;
    if (common)
        return RESULT_OK;
    return result_fail(RESULT_BAD_INPUT, "%s has the channels %s, %s has %s: none in common",
                       paths[0], names[0], paths[1], names[1]);
}

/* The latest part is pictured where it is the first, or the first that differs; others keep no
 * pixels. */
static void picture(DiffReport *report, Planes planes[DIFF_SIDES])
{
    int index = (int)report->count - 1;
    DiffPart *part = &report->parts[index];
    const DiffPart *before = report->pictured < 0 ? NULL : &report->parts[report->pictured];
    if (before && (before->differing || !part->differing)) {
        diff_part_release_pixels(part);
        return;
    }
    if (report->pictured >= 0)
        diff_part_release_pixels(&report->parts[report->pictured]);
    report->pictured = index;
    for (int side = 0; side < DIFF_SIDES; side++) {
        planes_free(&report->of[side]);
        report->of[side] = planes[side];
        planes[side] = (Planes){0};
    }
}

static Result compare_flat(Source sources[DIFF_SIDES], const int parts[DIFF_SIDES],
                           const DiffFilesOptions *options, DiffReport *report)
{
    Planes planes[DIFF_SIDES] = {0};
    const char *name = part_name(&sources[0], parts[0]);
    Result result = RESULT_OK;
    for (int side = 0; side < DIFF_SIDES && result == RESULT_OK; side++)
        result = read_planes(&sources[side], parts[side], options->diff.max_bytes, &planes[side]);
    const Planes *a = &planes[0], *b = &planes[1];
    if (result == RESULT_OK && same_size(report, name, (DiffSize){a->x, a->y, a->width, a->height},
                                         (DiffSize){b->x, b->y, b->width, b->height})) {
        DiffPart part = {0};
        result = match_channels(options, report->paths, planes);
        if (result == RESULT_OK)
            result = diff_planes(a, b, &options->diff, &part);
        result = add_part(report, name, result, &part);
        if (result == RESULT_OK)
            picture(report, planes);
    }
    planes_free(&planes[0]);
    planes_free(&planes[1]);
    return result;
}

static DiffSize deep_size(const DeepImage *image)
{
    return (DiffSize){image->has_window ? image->window.x : 0,
                      image->has_window ? image->window.y : 0, image->width, image->height};
}

static Result compare_deep(const Source sources[DIFF_SIDES], const char *name,
                           const DiffFilesOptions *options, DiffReport *report)
{
    DeepImage images[DIFF_SIDES] = {0};
    Planes none[DIFF_SIDES] = {0};
    size_t most = options->diff.max_bytes ? options->diff.max_bytes : SIZE_MAX;
    Result result = RESULT_OK;
    for (int side = 0; side < DIFF_SIDES && result == RESULT_OK; side++) {
        result = exr_deep_read(sources[side].path, most, &images[side]);
        if (result == RESULT_OK && images[side].part > 0)
            result = result_fail(RESULT_UNSUPPORTED,
                                 "%s: part 0 is of deep tiles, expected deep scanlines",
                                 sources[side].path);
    }
    const DeepImage *a = &images[0], *b = &images[1];
    if (result == RESULT_OK && same_size(report, name, deep_size(a), deep_size(b))) {
        DiffPart part = {0};
        result = diff_deep(a, b, options->channels, &options->diff, &part);
        result = add_part(report, name, result, &part);
        if (result == RESULT_OK)
            picture(report, none);
    }
    deep_free(&images[0]);
    deep_free(&images[1]);
    return result;
}

static Result compare_parts(Source sources[DIFF_SIDES], int a, int b,
                            const DiffFilesOptions *options, DiffReport *report)
{
    const int parts[DIFF_SIDES] = {a, b};
    bool deep[DIFF_SIDES] = {is_deep(&sources[0], a), is_deep(&sources[1], b)};
    if (deep[0] != deep[1]) {
        report->deep_differs = true;
        report->verdict = DIFF_FAILURE;
        return RESULT_OK;
    }
    if (!deep[0])
        return compare_flat(sources, parts, options, report);
    if (a > 0 || b > 0)
        return result_fail(RESULT_UNSUPPORTED,
                           "%s: part %d is deep, expected a deep part to be the first",
                           report->paths[0], a);
    return compare_deep(sources, part_name(&sources[0], a), options, report);
}

/* ---- files ---- */

static int by_name(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Parts are told apart by their names. Source: OpenEXR, "Multi-Part Files": names are unique. */
static Result check_names(const Source *source)
{
    int count = part_count(source);
    const char **names = memory_array((size_t)count, sizeof *names);
    Result result = names ? RESULT_OK : RESULT_NO_MEMORY;
    for (int i = 0; names && i < count; i++)
        names[i] = part_name(source, i);
    if (names)
        qsort(names, (size_t)count, sizeof *names, by_name);
    for (int i = 1; i < count && result == RESULT_OK; i++)
        if (*names[i] && strcmp(names[i], names[i - 1]) == 0)
            result = result_fail(RESULT_BAD_INPUT, "%s: two parts are called %s, expected one",
                                 source->path, names[i]);
    free(names);
    return result;
}

/* The other file's part of the same name; of the same place where one of these has no name; −1. */
static int find_part(const Source *other, const char *name, int part)
{
    if (part < part_count(other) && (!*name || !*part_name(other, part)))
        return part;
    for (int i = 0; i < part_count(other); i++)
        if (*name && strcmp(part_name(other, i), name) == 0)
            return i;
    return -1;
}

static Result compare_all(Source sources[DIFF_SIDES], const DiffFilesOptions *options,
                          DiffReport *report)
{
    Result result = RESULT_OK;
    for (int i = 0; i < part_count(&sources[0]) && result == RESULT_OK; i++) {
        const char *name = part_name(&sources[0], i);
        int other = find_part(&sources[1], name, i);
        result = other < 0 ? add_lacking(report, name, 1)
                           : compare_parts(sources, i, other, options, report);
        if (report->sizes_differ || report->deep_differs)
            return result;
    }
    for (int i = 0; i < part_count(&sources[1]) && result == RESULT_OK; i++) {
        const char *name = part_name(&sources[1], i);
        if (find_part(&sources[0], name, i) < 0)
            result = add_lacking(report, name, 0);
    }
    return result;
}

Result diff_files(const char *a, const char *b, const DiffFilesOptions *options, DiffReport *out)
{
    Source sources[DIFF_SIDES] = {0};
    *out = (DiffReport){.paths = {a, b}, .first = -1, .pictured = -1};
    Result result = open_source(a, options->diff.max_bytes, &sources[0]);
    if (result == RESULT_OK)
        result = open_source(b, options->diff.max_bytes, &sources[1]);
    for (int side = 0; side < DIFF_SIDES && result == RESULT_OK; side++)
        result = check_names(&sources[side]);
    if (result == RESULT_OK) {
        out->trace = is_trace(&sources[0]) && is_trace(&sources[1]);
        out->all = options->all || out->trace;
        for (int side = 0; side < DIFF_SIDES; side++)
            out->part_counts[side] = part_count(&sources[side]);
        result = out->all ? compare_all(sources, options, out)
                          : compare_parts(sources, 0, 0, options, out);
    }
    close_source(&sources[0]);
    close_source(&sources[1]);
    bool perceived = !options->diff.perceptual || out->sizes_differ || out->deep_differs;
    for (size_t i = 0; i < out->count; i++)
        perceived |= out->parts[i].perceived;
    if (result == RESULT_OK && !perceived)
        result = result_fail(RESULT_BAD_INPUT,
                             "%s, %s: nothing to see, expected R, G and B in both", a, b);
    return result;
}

void diff_report_free(DiffReport *report)
{
    for (size_t i = 0; i < report->count; i++)
        diff_part_free(&report->parts[i]);
    free(report->parts);
    planes_free(&report->of[0]);
    planes_free(&report->of[1]);
    *report = (DiffReport){0};
}
