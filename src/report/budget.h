/* The error budget and the classes of pixels as text and as a picture. */
#ifndef PEEL_REPORT_BUDGET_H
#define PEEL_REPORT_BUDGET_H

#include "image/image.h"
#include "study/budget.h"

#include <stdio.h>

/* A row per term that was measured, their sum, the total and what is left; then a row per class
 * that has pixels, with its colour. */
void report_budget_print(const Budget *budget, FILE *out);

/* Red, green, blue. */
const uint8_t *report_class_color(PixelClass class);

/* Each pixel in the colour of its class: *out FORMAT_RGBA8, the caller frees. */
Result report_classes_image(const Budget *budget, Image *out);

#endif
