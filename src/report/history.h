/* The history of a pixel as text, for a terminal. */
#ifndef PEEL_REPORT_HISTORY_H
#define PEEL_REPORT_HISTORY_H

#include "frame/history.h"

#include <stdio.h>

/* One pixel by the renderers that were asked; NULL: not asked, or missing. */
typedef struct HistorySides {
    const char *scene_name;
    const Scene *scene;
    int width, height; /* of the frame */
    const History *ref, *gl, *truth;
    const char *missing; /* why gl is not there; NULL */
} HistorySides;

typedef struct HistoryStyle {
    int columns; /* at least 80 are used */
    bool color;
} HistoryStyle;

/* Failures: memory. */
Result report_history(const HistorySides *sides, HistoryStyle style, FILE *out);

#endif
