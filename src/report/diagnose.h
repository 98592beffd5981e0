/* A diagnosis as text, JSON and a page. */
#ifndef PEEL_REPORT_DIAGNOSE_H
#define PEEL_REPORT_DIAGNOSE_H

#include "study/diagnose.h"

#include <stdio.h>

/* What was diagnosed. */
typedef struct DiagnoseSubject {
    const char *scene_name, *scene_path, *image_path;
    const RenderDesc *desc;
    const char *command; /* what repeats it */
} DiagnoseSubject;

/* The catalogue: name, cause and cure. */
void report_diagnose_list(FILE *out);

/* The verdict, its evidence, the ranking. */
void report_diagnose_print(const DiagnoseSubject *subject, const Diagnosis *diagnosis, FILE *out);

/* The document of `peel diagnose --json`, written to a temporary name and renamed. */
Result report_diagnose_json(const DiagnoseSubject *subject, const Diagnosis *diagnosis,
                            const char *path);

/* Makes dir if it is missing and writes index.html, style.css and pictures. */
Result report_diagnose_html(const DiagnoseSubject *subject, const Diagnosis *diagnosis,
                            const char *dir);

/* What text and page say in the same words. Private to src/report. */
enum {
    DIAGNOSE_LINE = 400
};
void report_diagnose_verdict(const Diagnosis *diagnosis, char out[DIAGNOSE_LINE]);
void report_diagnose_why(const Diagnosis *diagnosis, char out[DIAGNOSE_LINE]);
/* "(0.25, 0.5, 1)", as integers of 8 and 16 bits; alpha where it means something. */
void report_diagnose_value(const Diagnosis *diagnosis, const float value[4],
                           char out[DIAGNOSE_LINE]);
/* How many rows are worth showing: equals of the first, and those that explain anything. */
size_t report_diagnose_shown(const Diagnosis *diagnosis);

#endif
