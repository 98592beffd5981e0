/* What the driver does in an experiment (see frame/experiment.h). */
#ifndef PEEL_GL_LAB_H
#define PEEL_GL_LAB_H

#include "frame/experiment.h"
#include "fuses.h"

/* The driver, as it names itself. */
typedef struct LabDriver {
    char vendor[128], renderer[128], version[128], glsl[128];
    FusesMode mode;
} LabDriver;

typedef struct GlLab GlLab;

/* Opens a context of its own; threads as in context_open. NO_GL when there is none. The caller
 * closes it, on the same thread. */
Result lab_open(int threads, LabDriver *driver, GlLab **out);
void lab_close(GlLab *lab); /* NULL is fine */

/* Its experiments, valid until lab_close; they fail with NO_GL when the driver reports an error.
 * Other contexts may be opened and closed between experiments. */
Lab *lab_experiments(GlLab *lab);

#endif
