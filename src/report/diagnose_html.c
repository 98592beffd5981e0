/* The page of `peel diagnose --report`. */
#include "base/memory.h"
#include "image/png.h"
#include "report/diagnose.h"
#include "report/heatmap.h"
#include "report/html_parts.h"
#include "report/pictures.h"
#include "report/summary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct Page {
    const DiagnoseSubject *subject;
    const Diagnosis *diagnosis;
} Page;

static const uint8_t class_colors[DIAGNOSE_PIXEL_CLASSES][3] = {
    [DIAGNOSE_PIXEL_AGREES] = {16, 16, 20},          [DIAGNOSE_PIXEL_EXPLAINED] = {0, 158, 115},
    [DIAGNOSE_PIXEL_NEARER] = {230, 159, 0},         [DIAGNOSE_PIXEL_UNEXPLAINED] = {213, 94, 0},
    [DIAGNOSE_PIXEL_CONTRADICTED] = {204, 121, 167},
};

/* ---- pictures -------------------------------------------------------------------------------- */

/* Takes over image. made: the result of making it. */
static Result write_made(Result made, Image *image, const char *dir, const char *name)
{
    char *path = made == RESULT_OK ? pictures_path(dir, name) : NULL;
    Result result = made != RESULT_OK ? made : path ? png_write(image, path) : RESULT_NO_MEMORY;
    free(path);
    image_free(image);
    return result;
}

/* Encoded values as they are, linear ones display-transformed; magenta where there is none. */
static Result make_display(const Image *values, GivenEncoding encoding, Image *out)
{
    Result result = image_create(values->width, values->height, FORMAT_RGBA8, out);
    if (result != RESULT_OK)
        return result;
    const float *in = values->pixels;
    uint8_t *pixel = out->pixels;
    size_t pixels = (size_t)values->width * (size_t)values->height;
    GivenEncoding shown = encoding == GIVEN_LINEAR ? GIVEN_SEED : GIVEN_LINEAR;
    for (size_t i = 0; i < pixels; i++, in += 4, pixel += 4) {
        bool number = !isnan(in[0]) && !isnan(in[1]) && !isnan(in[2]);
        for (int c = 0; c < 3; c++) {
            double value = given_stored_value(FORMAT_RGBA8, shown, number ? (double)in[c] : 0.0);
            pixel[c] = number ? (uint8_t)lrint(255.0 * value) : c == 1 ? 0 : 255;
        }
        pixel[3] = 255;
    }
    return RESULT_OK;
}

static Result make_classes(const Diagnosis *diagnosis, Image *out)
{
    Result result =
        image_create(diagnosis->theirs.width, diagnosis->theirs.height, FORMAT_RGBA8, out);
    if (result != RESULT_OK)
        return result;
    uint8_t *pixel = out->pixels;
    for (uint64_t i = 0; i < diagnosis->pixels; i++, pixel += 4) {
        memcpy(pixel, class_colors[diagnosis->classes[i]], 3);
        pixel[3] = 255;
    }
    return RESULT_OK;
}

static bool has_best(const Diagnosis *diagnosis)
{
    return diagnosis->verdict != DIAGNOSE_AGREES && diagnosis->count > 0 &&
           diagnosis->rows[0].explains > 0.0;
}

static Result write_pictures(const Diagnosis *diagnosis, const char *dir)
{
    GivenEncoding encoding = diagnosis->form.encoding;
    Image image = {0};
    Result made = make_display(&diagnosis->theirs, encoding, &image);
    Result result = write_made(made, &image, dir, "theirs.png");
    if (result != RESULT_OK)
        return result;
    made = make_display(&diagnosis->reference, encoding, &image);
    result = write_made(made, &image, dir, "reference.png");
    if (result != RESULT_OK)
        return result;
    made = heatmap_image(&diagnosis->theirs, &diagnosis->reference, &image);
    result = write_made(made, &image, dir, "difference.png");
    if (result == RESULT_OK)
        result = pictures_write_scale(dir);
    if (result != RESULT_OK || !has_best(diagnosis))
        return result;
    made = make_display(&diagnosis->best, encoding, &image);
    result = write_made(made, &image, dir, "mistake.png");
    if (result != RESULT_OK)
        return result;
    made = heatmap_image(&diagnosis->theirs, &diagnosis->best, &image);
    result = write_made(made, &image, dir, "left.png");
    if (result != RESULT_OK)
        return result;
    made = make_classes(diagnosis, &image);
    return write_made(made, &image, dir, "classes.png");
}

static void put_picture(FileWriter *page, const Diagnosis *diagnosis, const char *file,
                        const char *caption)
{
    html_open_picture(page, &(HtmlPicture){.shown = file,
                                           .width = diagnosis->theirs.width,
                                           .height = diagnosis->theirs.height});
    html_text(page, caption);
    file_writer_print(page, "\"></a>\n<figcaption>");
    html_text(page, caption);
    file_writer_print(page, "</figcaption>\n</figure>\n");
}

static void put_pictures(FileWriter *page, const Diagnosis *diagnosis)
{
    char name[DIAGNOSE_NAME], caption[DIAGNOSE_LINE];
    file_writer_print(page, "<section aria-labelledby=\"pictures\">\n<h2 id=\"pictures\">"
                            "Pictures</h2>\n<div class=\"three\">\n");
    put_picture(page, diagnosis, "theirs.png", "theirs");
    put_picture(page, diagnosis, "reference.png", "the reference");
    put_picture(page, diagnosis, "difference.png", "difference of theirs from the reference");
    if (has_best(diagnosis)) {
        diagnose_name(diagnosis->rows[0].mutations, name);
        snprintf(caption, sizeof caption, "the reference with %s", name);
        put_picture(page, diagnosis, "mistake.png", caption);
        snprintf(caption, sizeof caption, "what %s explains, pixel by pixel", name);
        put_picture(page, diagnosis, "classes.png", caption);
        snprintf(caption, sizeof caption, "difference of theirs from the reference with %s", name);
        put_picture(page, diagnosis, "left.png", caption);
    }
    file_writer_print(page, "</div>\n<p class=\"note\">Differences are of the values that their "
                            "file stores, encoded ones as they are.</p>\n");
    html_scale(page);
    file_writer_print(page, "</section>\n");
}

/* ---- text ------------------------------------------------------------------------------------ */

static void put_verdict(FileWriter *page, const DiagnoseSubject *subject,
                        const Diagnosis *diagnosis)
{
    char line[DIAGNOSE_LINE];
    report_diagnose_verdict(diagnosis, line);
    html_open_verdict(page, diagnosis->verdict == DIAGNOSE_AGREES, line);
    report_diagnose_why(diagnosis, line);
    html_item(page, line);
    snprintf(line, sizeof line, "%s: %s", subject->image_path, diagnosis->described);
    html_item(page, line);
    html_close_verdict(page);
}

static void put_cause(FileWriter *page, uint64_t mutations)
{
    for (int id = 0; id < MUTATION_COUNT; id++) {
        const MutationInfo *info = mutation_info((MutationId)id);
        if (!(mutations & mutation_bit((MutationId)id)))
            continue;
        file_writer_print(page, "<dt>%s</dt>\n<dd>Cause: ", info->name);
        html_text(page, info->cause);
        file_writer_print(page, ".<br>Cure: ");
        html_text(page, info->cure);
        file_writer_print(page, ".</dd>\n");
    }
}

/* Of the best, equals included. */
static void put_causes(FileWriter *page, const Diagnosis *diagnosis)
{
    if (diagnosis->verdict != DIAGNOSE_MISTAKE)
        return;
    file_writer_print(page,
                      "<section aria-labelledby=\"guide\">\n<h2 id=\"guide\">Cause and cure</h2>\n"
                      "<dl>\n");
    for (size_t i = 0; i < diagnosis->equals; i++)
        put_cause(page, diagnosis->rows[i].mutations);
    file_writer_print(page, "</dl>\n</section>\n");
}

static void put_ranking(FileWriter *page, const Diagnosis *diagnosis)
{
    static const char *const columns[] = {"mistake", "rank", "explains", "pixels left"};
    size_t shown = report_diagnose_shown(diagnosis);
    if (!shown)
        return;
    html_open_table(page, "What explains the difference", columns, 4);
    for (size_t i = 0; i < shown; i++) {
        const DiagnoseRow *row = &diagnosis->rows[i];
        char name[DIAGNOSE_NAME], left[SUMMARY_NUMBER];
        html_open_row(page, "", diagnose_name(row->mutations, name));
        file_writer_print(page, "<td>%d</td><td>%.2f %%</td><td>%s</td></tr>\n", row->rank,
                          100.0 * row->explains, summary_count(row->beyond, left));
    }
    html_close_table(page);
    if (diagnosis->equals > 1)
        file_writer_print(page,
                          "<p>The first %zu are equals: here they make the same file, or all "
                          "explain it exactly.</p>\n",
                          diagnosis->equals);
}

static void put_value(FileWriter *page, const Diagnosis *diagnosis, const char *name,
                      const float value[4])
{
    char text[DIAGNOSE_LINE];
    report_diagnose_value(diagnosis, value, text);
    html_open_row(page, "", name);
    file_writer_print(page, "<td>%s</td></tr>\n", text);
}

static void put_pixel(FileWriter *page, const Diagnosis *diagnosis)
{
    const DiagnosePixel *pixel = &diagnosis->pixel;
    static const char *const columns[] = {"", "stored values"};
    char name[DIAGNOSE_NAME], caption[80];
    if (!diagnosis->has_pixel)
        return;
    snprintf(caption, sizeof caption, "Pixel %d,%d tells the best from the next", pixel->x,
             pixel->y);
    html_open_table(page, caption, columns, 2);
    put_value(page, diagnosis, "theirs", pixel->theirs);
    put_value(page, diagnosis, diagnose_name(diagnosis->rows[0].mutations, name), pixel->first);
    if (diagnosis->has_second)
        put_value(page, diagnosis,
                  diagnose_name(diagnosis->rows[diagnosis->second].mutations, name), pixel->second);
    put_value(page, diagnosis, "the reference", pixel->reference);
    html_close_table(page);
}

static void put_classes(FileWriter *page, const Diagnosis *diagnosis)
{
    static const char *const columns[] = {"pixels", "count", ""};
    char count[SUMMARY_NUMBER];
    if (!has_best(diagnosis))
        return;
    html_open_table(page, "What the first explains, pixel by pixel", columns, 3);
    for (int i = 0; i < DIAGNOSE_PIXEL_CLASSES; i++) {
        const uint8_t *color = class_colors[i];
        html_open_row(page, "", diagnose_class_text((DiagnoseClass)i));
        file_writer_print(page,
                          "<td>%s</td><td><span class=\"key\" style=\"background:#%02x%02x%02x\">"
                          "</span></td></tr>\n",
                          summary_count(diagnosis->class_counts[i], count), color[0], color[1],
                          color[2]);
    }
    html_close_table(page);
}

static void put_invisible(FileWriter *page, const Diagnosis *diagnosis)
{
    const char *separator = "";
    if (!diagnosis->invisible)
        return;
    file_writer_print(page, "<p class=\"note\">Mistakes that would not show in this image: ");
    for (int id = 0; id < MUTATION_COUNT; id++)
        if (diagnosis->invisible & mutation_bit((MutationId)id)) {
            file_writer_print(page, "%s%s", separator, mutation_info((MutationId)id)->name);
            separator = ", ";
        }
    file_writer_print(page, ".</p>\n");
}

static Result put_page(FileWriter *page, const void *what)
{
    const Page *it = what;
    const Diagnosis *diagnosis = it->diagnosis;
    Threeway head = {.scene_name = it->subject->scene_name, .scene_path = it->subject->scene_path};
    html_open(page, "Diagnosis of another renderer", &head);
    html_open_main(page);
    put_verdict(page, it->subject, diagnosis);
    put_causes(page, diagnosis);
    put_pictures(page, diagnosis);
    file_writer_print(page, "<section aria-labelledby=\"evidence\">\n<h2 id=\"evidence\">Evidence"
                            "</h2>\n");
    put_ranking(page, diagnosis);
    put_pixel(page, diagnosis);
    put_classes(page, diagnosis);
    put_invisible(page, diagnosis);
    file_writer_print(page, "</section>\n");
    html_command(page, it->subject->command);
    return html_close(page);
}

Result report_diagnose_html(const DiagnoseSubject *subject, const Diagnosis *diagnosis,
                            const char *dir)
{
    Page page = {subject, diagnosis};
    Result result = file_make_directories(dir);
    if (result == RESULT_OK)
        result = write_pictures(diagnosis, dir);
    return result == RESULT_OK ? html_write(dir, put_page, &page) : result;
}
