/* What the local GL driver keeps of the number rules: each rule's experiments are carried out by
 * the driver and compared with what the rule gives, or with the driver itself where the rule only
 * says that two ways must agree. */
#ifndef PEEL_STUDY_DRIVER_H
#define PEEL_STUDY_DRIVER_H

#include "frame/experiment.h"
#include "frame/frame.h"

typedef enum DriverVerdict {
    DRIVER_EXACT,
    DRIVER_DIFFERS,
    DRIVER_BROKEN, /* differs, by more than peeling can bear */
    DRIVER_UNTESTED
} DriverVerdict;

/* How the values of a rule are read, and how far apart two of them are. */
typedef enum DriverValue {
    DRIVER_FLOAT, /* bits; ULP */
    DRIVER_HALF,
    DRIVER_CODE /* an integer; difference */
} DriverValue;

enum {
    DRIVER_INPUTS_MAX = 24
};

/* One sample that differs: of all, the one whose inputs have the fewest significant bits. */
typedef struct DriverExample {
    char place[80]; /* "channel 2", "pixel 3, 4: z", … */
    int input_count;
    float inputs[DRIVER_INPUTS_MAX];
    const char *const *input_names; /* static */
    DriverValue value;
    uint32_t expected, got;
} DriverExample;

typedef struct DriverRule {
    const char *id, *what, *section; /* static; section of the table of rules */
    bool relied_on;                  /* depth peeling goes wrong without it */
    DriverVerdict verdict;
    uint64_t samples, differing;
    uint32_t max_distance; /* UINT32_MAX: between a NaN and a number */
    DriverValue value;
    bool has_example;
    DriverExample example;
    const char *reason; /* static; of DRIVER_UNTESTED */
} DriverRule;

typedef struct DriverReport {
    DriverRule *rules;
    size_t count;
    int exact, differ, broken, untested;
} DriverReport;

/* The rules in their order, tested by driver against model. renderer: the pipeline on the same
 * driver. Takes some seconds; shows progress. The caller frees with driver_free. */
Result driver_run(Lab *model, Lab *driver, Renderer renderer, DriverReport *out);
void driver_free(DriverReport *report);

/* One of them, for a test: index below driver_rule_count. */
size_t driver_rule_count(void);
const char *driver_rule_id(size_t index); /* static */
Result driver_run_rule(size_t index, Lab *model, Lab *driver, Renderer renderer, DriverRule *out);

const char *driver_verdict_name(DriverVerdict verdict); /* "exact", "differs", … */

#endif
