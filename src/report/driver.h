/* What a driver keeps of the rules, as aligned text of at most 100 columns and as JSON. */
#ifndef PEEL_REPORT_DRIVER_H
#define PEEL_REPORT_DRIVER_H

#include "study/driver.h"

#include <stdio.h>

/* The driver, as it names itself. */
typedef struct DriverName {
    const char *vendor, *renderer, *version, *glsl;
    const char *mode; /* "fused", "unfused" or "neither" */
} DriverName;

/* A row per rule, an example for each that differs, the untested ones with the reason, and a line
 * that sums up. */
void report_driver_print(const DriverName *name, const DriverReport *report, FILE *out);

/* The JSON document of `peel driver --json`, written to a temporary name and renamed. */
Result report_driver_json(const DriverName *name, const DriverReport *report, const char *path);

#endif
