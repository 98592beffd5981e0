#include "report/course.h"

#include "report/html_parts.h"
#include "report/pictures.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const char report_style_css[], page_css[], page_course_css[];

const char *const course_titles[COURSE_LESSONS] = {
    "Alpha and premultiplication",
    "Why sorting objects fails",
    "Peeling, layer by layer",
    "Blending under",
    "Lighting later",
    "Numbers: ties and formats",
};

const CourseLesson course_lessons[COURSE_LESSONS] = {
    {"alpha_ladder", 0, "How much light a surface keeps, and how much it lets through."},
    {"crossing_planes", 0, "Objects have one order; their fragments have one at every pixel."},
    {"crossing_planes", 0, "How a depth test, used again and again, finds all layers in order."},
    {"alpha_ladder", 0, "How layers that come from front to back are put together."},
    {"teapot_hall", 16, "Why surfaces are stored first and lit once."},
    {"tutorial", 0, "What is lost when two depths become the same number."},
};

void course_file(int number, char file[16])
{
    snprintf(file, 16, "lesson-%d.html", number);
}

static void put(FileWriter *page, const char *text)
{
    file_writer_put(page, text, strlen(text));
}

static void put_lesson(FileWriter *page, int i)
{
    char file[16];
    course_file(i + 1, file);
    put(page, "<li><a href=\"");
    put(page, file);
    put(page, "\">");
    html_text(page, course_titles[i]);
    put(page, "</a><br>");
    html_text(page, course_lessons[i].summary);
    put(page, "</li>\n");
}

static void put_page(FileWriter *page, const char *command)
{
    put(page, "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
              "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
              "<title>Transparency by depth peeling: a course</title>\n<style>\n");
    put(page, report_style_css);
    put(page, page_css);
    put(page, page_course_css);
    put(page, "</style>\n</head>\n<body>\n<header>\n<p class=\"kicker\">Peel, explained</p>\n"
              "<h1>Transparency by depth peeling</h1>\n"
              "<p>Six short lessons, ten minutes each at most. You need to know what a pixel and "
              "a triangle are. Beside each text a renderer runs in the page: links in the text "
              "lead to the steps that it is about, and a question at the end is answered by "
              "moving something.</p>\n</header>\n<main>\n"
              "<ol class=\"lessons\">\n");
    for (int i = 0; i < COURSE_LESSONS; i++)
        put_lesson(page, i);
    put(page, "</ol>\n<p class=\"note\">Made by <code>");
    html_text(page, command);
    put(page, "</code>.</p>\n</main>\n</body>\n</html>\n");
}

Result course_write_index(const char *dir, const char *command)
{
    FileWriter page;
    char *path = pictures_path(dir, "index.html");
    Result result = path ? file_writer_open(path, &page) : RESULT_NO_MEMORY;
    free(path);
    if (result != RESULT_OK)
        return result;
    put_page(&page, command);
    return file_writer_close(&page, true);
}
