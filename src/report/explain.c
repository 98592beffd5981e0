/* Puts a page of `peel explain` together. */
#include "report/explain.h"

#include "base/file.h"
#include "report/explain_data.h"
#include "report/html_parts.h"
#include "report/pictures.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const char report_style_css[], page_css[], page_live_css[], page_course_css[], page_html[],
    page_engine_js[], page_draw_js[], page_app_js[], page_number_js[], page_figure_js[],
    page_sides_js[], page_walk_js[], page_walk_end_js[], page_walk_others_js[], page_methods_js[],
    page_steps_js[], page_ray_js[], page_pixel_js[], page_camera_js[], page_edits_js[],
    page_live_js[], page_controls_js[], page_steer_js[], page_live_panel_js[], page_space_js[],
    page_lessons_js[], page_course_js[];

static const char *const styles[] = {report_style_css, page_css, page_live_css, page_course_css};
static const char *const scripts[] = {
    page_engine_js,  page_draw_js,     page_app_js,      page_number_js,      page_figure_js,
    page_sides_js,   page_walk_js,     page_walk_end_js, page_walk_others_js, page_methods_js,
    page_steps_js,   page_ray_js,      page_pixel_js,    page_camera_js,      page_edits_js,
    page_live_js,    page_controls_js, page_steer_js,    page_live_panel_js,  page_space_js,
    page_lessons_js, page_course_js};

static void put(FileWriter *page, const char *text)
{
    file_writer_put(page, text, strlen(text));
}

static void put_page(FileWriter *page, const ExplainDesc *explain, const Text *data)
{
    put(page, "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
              "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>");
    html_text(page, explain->name);
    put(page, " - explained</title>\n<style>\n");
    for (size_t i = 0; i < sizeof styles / sizeof styles[0]; i++)
        put(page, styles[i]);
    put(page, "</style>\n</head>\n<body");
    if (explain->lesson) {
        char lesson[32];
        snprintf(lesson, sizeof lesson, " data-lesson=\"%d\"", explain->lesson->number);
        put(page, lesson);
    }
    put(page, ">\n");
    put(page, page_html);
    put(page, "<script type=\"application/json\" id=\"data\">");
    file_writer_put(page, data->bytes, data->count);
    put(page, "</script>\n");
    for (size_t i = 0; i < sizeof scripts / sizeof scripts[0]; i++) {
        put(page, "<script>\n");
        put(page, scripts[i]);
        put(page, "</script>\n");
    }
    put(page, "<script>\napp.start();\n</script>\n</body>\n</html>\n");
}

/* An upper bound, by a few kilobytes. */
static size_t page_size(const ExplainDesc *explain, const Text *data)
{
    enum {
        MARKUP = 4096,   /* that put_page writes itself */
        LONGEST_NAME = 6 /* of a character that html_text escapes */
    };
    size_t size = MARKUP + LONGEST_NAME * strlen(explain->name) + data->count + strlen(page_html);
    for (size_t i = 0; i < sizeof styles / sizeof styles[0]; i++)
        size += strlen(styles[i]);
    for (size_t i = 0; i < sizeof scripts / sizeof scripts[0]; i++)
        size += strlen(scripts[i]);
    return size;
}

static Result check_size(const ExplainDesc *explain, const ExplainRoom *room, size_t size)
{
    size_t most = explain->max_bytes ? explain->max_bytes : EXPLAIN_MAX_BYTES;
    if (size <= most)
        return RESULT_OK;
    return result_fail(RESULT_UNSUPPORTED,
                       "%s: the page would take %.1f MB, expected at most %.1f: the scene %.1f, "
                       "gl's differences %.1f, the truth's %.1f, the rest %.1f",
                       explain->name, 1e-6 * (double)size, 1e-6 * (double)most,
                       1e-6 * (double)room->scene, 1e-6 * (double)room->gl,
                       1e-6 * (double)room->truth,
                       1e-6 * (double)(size - room->scene - room->gl - room->truth));
}

static Result write(const ExplainDesc *explain, const Text *data, const char *dir, const char *file)
{
    FileWriter page;
    char *path = pictures_path(dir, file);
    Result result = path ? file_writer_open(path, &page) : RESULT_NO_MEMORY;
    free(path);
    if (result != RESULT_OK)
        return result;
    put_page(&page, explain, data);
    return file_writer_close(&page, true);
}

static Result pass_on(TraceSink *sink, const TraceBuffer *buffer)
{
    ExplainSink *all = (ExplainSink *)sink;
    all->bytes +=
        format_pixel_bytes(buffer->format) * (size_t)buffer->width * (size_t)buffer->height;
    if (all->bytes <= EXPLAIN_MAX_TRACE_BYTES)
        return all->next->put(all->next, buffer);
    all->full = true;
    return result_fail(RESULT_UNSUPPORTED,
                       "%s: a page cannot keep this frame, its buffers up to %s take more than "
                       "%.0f MB: expected a smaller --size, or fewer --passes",
                       all->name, buffer->name, 1e-6 * (double)EXPLAIN_MAX_TRACE_BYTES);
}

ExplainSink report_explain_sink(TraceSink *next, const char *name)
{
    return (ExplainSink){.sink = {.put = pass_on, .details = true}, .next = next, .name = name};
}

Result report_explain_write(const ExplainDesc *explain, const char *dir, const char *file,
                            size_t *bytes)
{
    Text data = {0};
    ExplainRoom room = {0};
    Result result = explain_data(explain, &data, &room);
    if (result == RESULT_OK)
        result = check_size(explain, &room, page_size(explain, &data));
    if (result == RESULT_OK)
        result = write(explain, &data, dir, file);
    if (bytes)
        *bytes = page_size(explain, &data);
    text_free(&data);
    return result;
}
