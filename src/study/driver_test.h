/* One rule under test: what the files of the driver study share. */
#ifndef PEEL_STUDY_DRIVER_TEST_H
#define PEEL_STUDY_DRIVER_TEST_H

#include "blend/equation.h"
#include "study/driver.h"
#include "study/driver_inputs.h"

typedef struct Test Test;

/* A row of the table in driver.c. */
typedef struct Rule {
    const char *id, *what, *section;
    bool relied_on;
    uint32_t allowance; /* greatest distance that does not break peeling */
    DriverValue value;
    Result (*run)(Test *test);
    Experiment experiment; /* without its operands and equation */
    EquationId equation;   /* of EXPERIMENT_BLEND */
    unsigned sets;         /* InputSet bits */
    TriangleKind triangle;
    int field, field_end; /* RASTER_… fields that are compared */
    const char *reason;   /* run NULL: why it is not tested */
} Rule;

struct Test {
    const Rule *rule;
    Lab *model, *driver;
    Renderer renderer;
    Random random;
    float (*a)[4], (*b)[4];   /* EXPERIMENT_TEXELS each */
    uint32_t *expected, *got; /* EXPERIMENT_VALUES_MAX each */
    DriverRule *out;
    int complexity; /* of the example */
};

/* Counts one sample; true when it differs. */
bool test_differs(Test *test, uint32_t expected, uint32_t got);

/* For a sample that differs: where to describe it when its inputs are simpler than those of the
 * example so far, with inputs and values filled in; else NULL. names: static, `count` of them. */
DriverExample *test_example(Test *test, const float *inputs, const char *const *names, int count,
                            uint32_t expected, uint32_t got);

/* The runners. */
Result test_values(Test *test); /* operations, stores, depths and blends, per input set */
Result test_clear(Test *test);
Result test_fetch(Test *test);
Result test_depth_fetch(Test *test);
Result test_raster(Test *test);  /* triangle by triangle, the rule's fields */
Result test_grid(Test *test);    /* shared edges */
Result test_ties(Test *test);    /* two coinciding triangles */
Result test_layouts(Test *test); /* the driver's depths in other layouts against RASTER_FULL */
Result test_samples(Test *test); /* the driver's count against its own pixels */
Result test_repeat(Test *test);  /* the driver against itself */
Result test_peels(Test *test);   /* peels are the layers, each once */

#endif
