/* The page of `peel check --report`. */
#include "image/png.h"
#include "report/check.h"
#include "report/heatmap.h"
#include "report/html_parts.h"
#include "report/pictures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct Page {
    const CheckReport *report;
    const char *command;
} Page;

/* ---- pictures ---------------------------------------------------------------------------------
 */

static Result write_picture(const char *dir, const char *name, const Image *image)
{
    char *path = pictures_path(dir, name);
    Result result = path ? png_write(image, path) : RESULT_NO_MEMORY;
    free(path);
    return result;
}

/* Linear colours as peel render shows them; what is no number as magenta. */
static Result write_display(const char *dir, const char *name, const Image *linear)
{
    Image display;
    Result result = image_create(linear->width, linear->height, FORMAT_RGBA8, &display);
    if (result != RESULT_OK)
        return result;
    size_t pixels = (size_t)linear->width * (size_t)linear->height;
    const float *in = linear->pixels;
    uint8_t *out = display.pixels;
    for (size_t i = 0; i < pixels; i++, in += 4, out += 4) {
        bool number = !isnan(in[0]) && !isnan(in[1]) && !isnan(in[2]);
        for (int c = 0; c < 3; c++)
            out[c] = number ? (uint8_t)lrint(255.0 * given_encode(GIVEN_SEED, (double)in[c]))
                            : (uint8_t)(c == 1 ? 0 : 255);
        out[3] = 255;
    }
    result = write_picture(dir, name, &display);
    image_free(&display);
    return result;
}

/* Where alpha was not given, it is not shown as different. */
static Result write_difference(const CheckReport *report, const char *dir)
{
    Image reference, heat;
    const Image *final = &report->frame.final;
    Result result = image_create(final->width, final->height, FORMAT_RGBA32F, &reference);
    if (result != RESULT_OK)
        return result;
    size_t pixels = (size_t) final->width * (size_t) final->height;
    memcpy(reference.pixels, final->pixels, pixels * sizeof(float[4]));
    for (size_t i = 0; i < pixels; i++)
        ((float *)reference.pixels)[4 * i + 3] = ((float *)report->theirs_image.pixels)[4 * i + 3];
    result = heatmap_image(&report->theirs_image, &reference, &heat);
    image_free(&reference);
    if (result != RESULT_OK)
        return result;
    result = write_picture(dir, "difference.png", &heat);
    image_free(&heat);
    return result;
}

static Result write_pictures(const CheckReport *report, const char *dir)
{
    Result result = write_picture(dir, "reference.png", &report->frame.display);
    if (result != RESULT_OK || !report->theirs_image.pixels)
        return result;
    result = write_display(dir, "theirs.png", &report->theirs_image);
    if (result == RESULT_OK)
        result = write_difference(report, dir);
    return result == RESULT_OK ? pictures_write_scale(dir) : result;
}

/* ---- the page ---------------------------------------------------------------------------------
 */

static void put_picture(FileWriter *page, const CheckReport *report, const char *name,
                        const char *caption)
{
    HtmlPicture picture = {
        .shown = name, .width = report->desc.width, .height = report->desc.height};
    html_open_picture(page, &picture);
    file_writer_print(page, "%s\"></a>\n<figcaption>%s</figcaption>\n</figure>\n", caption,
                      caption);
}

static void put_pictures(FileWriter *page, const CheckReport *report)
{
    file_writer_print(page, "<section aria-labelledby=\"pictures\">\n<h2 id=\"pictures\">Pictures"
                            "</h2>\n<div class=\"three\">\n");
    if (report->theirs_image.pixels)
        put_picture(page, report, "theirs.png", "Theirs, display-transformed");
    put_picture(page, report, "reference.png", "The reference (ref)");
    if (report->theirs_image.pixels)
        put_picture(page, report, "difference.png", "Difference of the linear colours");
    file_writer_print(page, "</div>\n");
    if (report->theirs_image.pixels)
        html_scale(page);
    file_writer_print(page, "</section>\n");
}

static void put_step(FileWriter *page, const CheckStep *step)
{
    const JudgeFigures *f = &step->figures;
    const uint64_t counts[] = {f->equal, f->stored, f->within, f->edge, f->beyond};
    html_open_row(page, step->agree ? "" : " class=\"differ\"", step->name);
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++)
        if (step->judged)
            file_writer_print(page, "<td>%llu</td>", (unsigned long long)counts[i]);
        else
            file_writer_print(page, "<td>&ndash;</td>");
    if (step->judged)
        file_writer_print(page, "<td>%.3g</td><td>%s</td></tr>\n", f->max_abs,
                          step->agree ? "agrees" : "differs");
    else
        file_writer_print(page, "<td>&ndash;</td><td>%s</td></tr>\n",
                          step->agree ? "not compared" : "differs");
}

/* What does not fit into a row: notes, and the worst pixels of what differs. */
static void put_remarks(FileWriter *page, const CheckReport *report)
{
    char worst[512], line[640];
    file_writer_print(page, "<ul>\n");
    for (size_t i = 0; i < report->step_count; i++) {
        const CheckStep *step = &report->steps[i];
        if (step->note[0]) {
            snprintf(line, sizeof line, "%s: %s", step->name, step->note);
            html_item(page, line);
        }
        if (step->agree || !step->judged || !step->figures.worst.is)
            continue;
        check_describe_worst(step, worst, sizeof worst);
        snprintf(line, sizeof line, "%s: worst %s", step->name, worst);
        html_item(page, line);
    }
    file_writer_print(page, "</ul>\n");
}

static void put_table(FileWriter *page, const CheckReport *report)
{
    static const char *const columns[] = {"Step", "Equal",  "Stored",  "Within",
                                          "Edge", "Beyond", "Max abs", "Verdict"};
    file_writer_print(page, "<section aria-labelledby=\"steps\">\n<h2 id=\"steps\">Step by step"
                            "</h2>\n");
    html_open_table(page, "Pixels of each buffer, in the order of the algorithm", columns,
                    sizeof columns / sizeof columns[0]);
    for (size_t i = 0; i < report->step_count; i++)
        put_step(page, &report->steps[i]);
    html_close_table(page);
    put_remarks(page, report);
    file_writer_print(
        page, "<p>Equal: the same bits. Stored: what storing the right value in their format "
              "explains. Within: the tolerance, or with --bound what single precision may do, "
              "beyond that. Edge: between the values of the reference around the pixel, an "
              "outline that lies a little elsewhere. Beyond: none of these.</p>\n</section>\n");
}

static void put_verdict(FileWriter *page, const CheckReport *report)
{
    char line[640], worst[512];
    html_open_verdict(page, report->agree,
                      report->agree ? "Theirs agrees with the reference"
                                    : "Theirs differs from the reference");
    if (report->reading[0]) {
        snprintf(line, sizeof line, "Their image: %s.", report->reading);
        html_item(page, line);
    }
    if (report->first >= 0) {
        const CheckStep *first = &report->steps[report->first];
        if (first->judged)
            check_describe_worst(first, worst, sizeof worst);
        else
            snprintf(worst, sizeof worst, "%s", first->note);
        snprintf(line, sizeof line, "First step that differs: %s: %s", first->name, worst);
        html_item(page, line);
    }
    report_check_hint(report, line, sizeof line);
    html_item(page, line);
    html_close_verdict(page);
}

static Result put_page(FileWriter *page, const void *what)
{
    const Page *it = what;
    const CheckReport *report = it->report;
    Threeway head = {.scene_name = report->scene_name, .scene_path = report->scene_path};
    html_open(page, "Check of another renderer", &head);
    if (report->theirs) {
        file_writer_print(page, "<p class=\"path\">theirs: ");
        html_text(page, report->theirs);
        file_writer_print(page, "</p>\n");
    }
    html_open_main(page);
    put_verdict(page, report);
    put_pictures(page, report);
    put_table(page, report);
    html_command(page, it->command);
    return html_close(page);
}

Result report_check_html(const CheckReport *report, const char *command, const char *dir)
{
    Page page = {report, command};
    Result result = write_pictures(report, dir);
    return result == RESULT_OK ? html_write(dir, put_page, &page) : result;
}
