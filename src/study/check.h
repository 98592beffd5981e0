/* Somebody's image, or dumps of their passes, against the reference of the same scene and settings.
 */
#ifndef PEEL_STUDY_CHECK_H
#define PEEL_STUDY_CHECK_H

#include "compare/judge.h"
#include "frame/frame.h"

#include <stddef.h>

/* A file with one buffer of theirs. */
typedef struct CheckFile {
    int peel;   /* K of peel.K; −1: opaque */
    bool depth; /* the window depth; else the accumulation, or the layer's own lit colour */
    const char *path;
} CheckFile;

typedef struct CheckDesc {
    const char *scene_path;
    const char *theirs; /* an image, or a trace (compare/trace_file.h); NULL: files only */
    const CheckFile *files;
    size_t file_count;
    GivenMeaning meaning; /* of images; what is not DETECT is taken as it is */
    double tolerance;     /* negative: the method's */
} CheckDesc;

/* One buffer, or the image. */
typedef struct CheckStep {
    char name[48];
    int order;          /* trace_name_step of the name */
    PixelFormat format; /* theirs */
    JudgeFigures figures;
    char note[96]; /* "" or what else there is to say */
    bool judged;   /* false: not compared, the note says why */
    bool agree;
} CheckStep;

typedef struct CheckReport {
    const char *scene_name, *scene_path, *theirs;
    RenderDesc desc;
    double tolerance;
    Frame frame;        /* ref's */
    Image theirs_image; /* FORMAT_RGBA32F, linear: their image, or of a trace the accumulation over
                         * the background; empty where they gave none */
    char reading[128];  /* how the image was understood; "" where there is none */
    GivenMeaning meaning;
    bool sure;
    CheckStep *steps; /* in the algorithm's order; an image is the last, "image" */
    size_t step_count;
    int first; /* index of the first that differs, −1 */
    bool agree;
} CheckReport;

typedef enum CheckSizes {
    CHECK_SIZES_EQUAL = 0,
    CHECK_SIZES_DIFFER
} CheckSizes;

/* Renders with ref, and where desc asks for bounds with truth, and compares. *sizes is
 * CHECK_SIZES_DIFFER where the failure is that theirs has another size than desc (the message says
 * both; found before rendering). A step that differs is no failure. The caller frees with
 * check_free. */
Result check_run(const Scene *scene, const RenderDesc *desc, Renderer ref, Renderer truth,
                 const CheckDesc *check, CheckReport *out, CheckSizes *sizes);
void check_free(CheckReport *report); /* leaves an empty one */

/* Adds the one line that says how two values differ to text: "pixel (3, 4), R: theirs 0.5 (0x1p-1),
 * reference …". */
void check_describe_worst(const CheckStep *step, char *text, size_t size);

#endif
