/* The catalogue of hard cases: what ought to happen, in which configuration, and what does.
 *
 * In every case and configuration ref and gl must store the same bits, and nothing that is stored
 * or shown may be NaN or infinite. Beyond that each configuration has an expectation of its own. */
#ifndef PEEL_STUDY_HARD_H
#define PEEL_STUDY_HARD_H

#include "scene/hard_scenes.h"
#include "study/threeway.h"

/* How often something may happen; zero-initialised: never. */
typedef struct HardCount {
    uint64_t least, most;
} HardCount;

#define HARD_EXACTLY(n)                                                                            \
    {                                                                                              \
        (n), (n)                                                                                   \
    }
#define HARD_FROM(n)                                                                               \
    {                                                                                              \
        (n), UINT64_MAX                                                                            \
    }
#define HARD_ANY HARD_FROM(0)

/* A pixel whose value is known by hand. */
typedef struct HardPixel {
    int x, y; /* from the top left */
    double value[4];
    double tolerance; /* of ref, relative to max(1, value); 0: there is no such pixel */
    bool format_only; /* what the stored format makes of it; else truth has it, too, within 1e-6 */
} HardPixel;

enum {
    HARD_PIXELS = 3
};

/* Zero-initialised: no fragment is lost or out of place, and the error is within the bound that
 * hard_error_bound derives from method and formats. */
typedef struct HardExpect {
    HardCount ties;       /* fragments never peeled because of equal depths */
    HardCount limit;      /* because passes ended */
    HardCount overflow;   /* because a list had no room */
    HardCount repeated;   /* peeled twice */
    HardCount inversions; /* neighbours in the other order than truth's */
    HardCount sets;       /* fragments that only one side has, ties and limit apart */
    HardCount flips;      /* pixels with another opaque triangle */
    /* Greatest error of a pixel in which ref and truth see the same fragments in the same order,
     * relative to max(1, value). 0: the derived bound; INFINITY: any. */
    double error;
    double error_from; /* and this at least: the case shows what it is there for */
    HardPixel pixels[HARD_PIXELS];
    bool gl_apart; /* gl's bits need not be ref's, for the reason that the note gives */
    /* Name of an earlier configuration of the case with the same image, bit for bit (or, after a
     * '!', with another image); NULL: nothing is expected. */
    const char *image;
} HardExpect;

typedef struct HardConfig {
    const char *name;
    RenderDesc desc; /* without width and height */
    HardExpect expect;
    const char *note; /* why this is expected, where it is not the case's rule; NULL */
} HardConfig;

enum {
    HARD_OWN = 12,    /* most configurations of a case's own */
    HARD_CONFIGS = 40 /* most configurations */
};

typedef struct HardCase {
    const char *name;  /* of its scene */
    const char *ought; /* what ought to happen: one or two sentences */
    int size;          /* of the image's sides */
    bool slow;         /* seconds each: only what shows something, and a pass limit in the slice */
    bool bright;       /* colours beyond 1, which unorm formats cannot hold: no bound for them */
    double error;      /* greatest error in single precision; 0: 1e-4 */
    HardCount fragments; /* transparent ones that truth sees; {0, 0}: any number */
    HardCount deepest;   /* layers of the deepest pixel; {0, 0}: any number */
    /* What depends on the depth format: the default's, which all peeling methods share, and those
     * of d24, d16 and reversed depth. */
    HardExpect d32f, d24, d16, reversed;
    HardConfig own[HARD_OWN]; /* after the default; a standard one of the same name is left out */
} HardCase;

/* What happened. */
typedef struct HardRow {
    HardConfig config; /* desc complete */
    bool structure;    /* the counts below are known */
    LayerStats layers;
    uint64_t inversions, sets, flips;
    uint64_t ref_gl; /* differing values in all buffers and the image */
    uint64_t nonfinite;
    double max_abs, rmse, error; /* ref against truth; error as in HardExpect */
    double bound;                /* what error may be */
    uint32_t max_ulp_gl, max_ulp_truth;
    float pixels[HARD_PIXELS][2][4]; /* of ref and truth, where one is expected */
    int image_like;                  /* 1 + the row whose image is to be compared; 0: none */
    bool image_same;
    double time_ms; /* of all the renderings */
    bool pass;
    char failure[200]; /* the first expectation that was missed; "" */
} HardRow;

typedef struct HardReport {
    const HardCase *hard;
    const HardScene *scene;
    HardRow rows[HARD_CONFIGS];
    size_t row_count, failed;
    Image finals[HARD_CONFIGS]; /* ref's linear images, FORMAT_RGBA32F */
    Image truth;                /* truth's, of the first configuration */
    Image displays[2];          /* of ref and truth, of the first configuration: FORMAT_RGBA8 */
} HardReport;

/* Static table in the order of the scenes. */
const HardCase *hard_cases(size_t *count);
const HardCase *hard_find(const char *name); /* NULL when there is none */

/* The configurations of a case: the default, its own, the standard ones; of the slice for CI the
 * first three at most. Returns how many. */
size_t hard_configs(const HardCase *hard, bool slice, HardConfig out[HARD_CONFIGS]);

/* How far ref may be from truth: what a method or the case allows in single precision, and two
 * roundings of the accumulation's format for every layer, the opaque one included (the text at the
 * function derives it). INFINITY where there is no bound. */
double hard_error_bound(const HardCase *hard, const RenderDesc *desc, uint32_t layers);

/* Fills pass and failure from the rest of the row. */
void hard_judge(const HardCase *hard, HardRow *row);

/* Renders one case in all its configurations. The caller frees with hard_free, also after a
 * failure. */
Result hard_run(const HardCase *hard, bool slice, const Renderer renderers[RENDERER_COUNT],
                HardReport *out);
void hard_free(HardReport *report);

#endif
