/* The course of `peel explain --course`: its lessons, and the page that leads to them. What a
 * lesson says is in src/web/lessons.js. */
#ifndef PEEL_REPORT_COURSE_H
#define PEEL_REPORT_COURSE_H

#include "base/result.h"

enum {
    COURSE_LESSONS = 6
};

typedef struct CourseLesson {
    const char *scene;   /* a built-in one */
    int lights;          /* RenderDesc.lights */
    const char *summary; /* a sentence */
} CourseLesson;

/* Static, COURSE_LESSONS of each. */
extern const CourseLesson course_lessons[COURSE_LESSONS];
extern const char *const course_titles[COURSE_LESSONS];

/* Where lesson `number`, from 1, is in the course's folder: at most 15 bytes and a zero. */
void course_file(int number, char file[16]);

/* Writes dir/index.html; dir exists. */
Result course_write_index(const char *dir, const char *command);

#endif
