/* What one pixel of a frame went through, by one renderer: its fragments, what became of each, and
 * every blend step down to the bits.
 *
 * Numbers are doubles that hold the renderer's own values exactly: floats, halves, codes of unorm
 * formats as code / maximum rounded to float. Pixels count from the top left. */
#ifndef PEEL_FRAME_HISTORY_H
#define PEEL_FRAME_HISTORY_H

#include "base/text.h"
#include "frame/frame.h"

#include <stdint.h>

typedef enum HistoryFate {
    HISTORY_PEELED = 0, /* a layer of its own: HistoryFragment.peel */
    HISTORY_BLENDED,    /* of methods that do not peel */
    HISTORY_SEEN,       /* the opaque surface behind all layers */
    HISTORY_HIDDEN,     /* an opaque surface is in front of it, or where it is */
    HISTORY_TIE,        /* at the depth of a fragment that was kept */
    HISTORY_SKIPPED,    /* nearer behind a layer than the bias, or than the raw test tells apart; or
                         * at the far plane */
    HISTORY_PASS_LIMIT, /* further passes would have come to it */
    HISTORY_OVERFLOW,   /* its list had no room */
    HISTORY_INVISIBLE,  /* its alpha is at most SHADING_ALPHA_TEST, so that it is not blended */
    HISTORY_MASKED,     /* by the alpha of its texture */
    HISTORY_FILL_RULE,  /* an edge through the pixel's centre belongs to the neighbour */
    HISTORY_CULLED,
    HISTORY_CLIPPED, /* before the near plane or behind the far one */
    HISTORY_FATES
} HistoryFate;

/* What a pass over the geometry did with a fragment. */
typedef enum HistoryTest {
    HISTORY_KEPT = 0,
    HISTORY_OPAQUE_DEPTH,   /* rejected by: the opaque depth */
    HISTORY_PREVIOUS_DEPTH, /* a layer in front took it, or one at its depth */
    HISTORY_BETWEEN,        /* of dual peeling: behind the front layer, before the back one */
    HISTORY_DEPTH_TEST,     /* another fragment is nearer */
    HISTORY_ALPHA_TEST,     /* the alpha mask */
    HISTORY_TESTS
} HistoryTest;

/* One light's term of frame/shading.h's sum. */
typedef struct HistoryTerm {
    double n_dot_l, n_dot_h, h_dot_v, distance;
    double distribution, geometry, fresnel[3], specular, attenuation;
    double term[3], sum[3];
} HistoryTerm;

/* As the lighting pass has it, or as the fragment shader gives it where nothing is lit. */
typedef struct HistorySurface {
    double position[3], normal[3]; /* view space */
    double base[4], roughness, metallic, occlusion;
    bool lit;          /* what follows is there */
    double ambient[3]; /* comes after the lights' sum */
    double source[4];  /* premultiplied colour and alpha */
    size_t first_term; /* in History.terms */
    size_t term_count; /* 0 with Phong, and of truth */
} HistorySurface;

enum {
    HISTORY_NONE = -1
};

typedef struct HistoryFragment {
    uint32_t primitive, instance, mesh, material;
    bool transparent, front;
    bool has_edges; /* edge functions at the pixel's centre, in 1/65536 pixel²: > 0 inside, 0 on */
    int64_t edge[3]; /* the edge, where the fill rule gives it an edge through the centre */
    bool owned[3];   /* the fill rule gives the edge to this triangle */
    double z;        /* window depth as computed */
    double depth;    /* as stored and fetched; z where nothing stores it */
    uint32_t code;   /* as stored: an integer whose order is the depth's; of pipelines */
    double distance; /* along the view axis */
    HistoryFate fate;
    int peel;    /* HISTORY_NONE unless peeled */
    bool back;   /* dual peeling took it from behind */
    bool masked; /* the alpha mask discards it */
    int passes;  /* that it met: the opaque list's one, or each peel's; history_test */
    HistorySurface surface;
} HistoryFragment;

enum {
    HISTORY_NAME = 24
};

/* One blend. */
typedef struct HistoryStep {
    char step[HISTORY_NAME]; /* peel.K, opaque, fragment.N, front, back, sum */
    const char *target;      /* static: accum; back, sum, count, product */
    const char *equation;    /* static: number/blend.h's name */
    const char *format;      /* static: of the target; "double" of truth */
    int channels;
    int fragment;     /* index in History.fragments, or HISTORY_NONE */
    double source[4]; /* premultiplied colour and alpha, as blended */
    double before[4], after[4];
    bool stored; /* before and after were read back; else they are recomputed */
} HistoryStep;

typedef struct History {
    const char *renderer; /* static */
    int x, y;
    MethodId method;
    const char *accum_format, *depth_format; /* static */
    HistoryFragment *fragments; /* in draw order: the opaque list's, the transparent list's, then
                                 * what was clipped; of truth from front to back */
    size_t fragment_count, fragment_room;
    uint8_t *tests; /* HistoryTest: a row of fragment_count for each pass */
    size_t test_count, test_room;
    HistoryTerm *terms;
    size_t term_count, term_room;
    HistoryStep *steps; /* in the order of blending */
    size_t step_count, step_room;
    double accum[4];      /* as stored at the end; all of it but the background */
    double transmittance; /* of the layers, in front of the opaque surface */
    double final[4];
    uint8_t display[4];
    bool source_of_ref; /* sources are recomputed by ref's formula: they cannot be read back */
    const char *note;   /* static: what this history has not; NULL */
} History;

void history_free(History *history); /* leaves an empty one */

/* Static strings: JSON's and the terminal's. */
const char *history_fate_name(HistoryFate fate);
const char *history_test_name(HistoryTest test);

/* Room for one more at the end, zeroed and counted; NULL without memory. */
HistoryFragment *history_add_fragment(History *history);
HistoryStep *history_add_step(History *history);
HistoryTerm *history_add_terms(History *history, size_t count);

/* What pass number `pass` did with a fragment; put when all fragments are there, passes in order.
 * NO_MEMORY is possible. */
Result history_put_test(History *history, size_t fragment, int pass, HistoryTest test);
HistoryTest history_test(const History *history, size_t fragment, int pass);

/* A stored pixel's channels as doubles; 0 for those that the format has not. */
void history_values(PixelFormat format, const void *pixel, double out[4]);

/* How many fragments have this fate. */
size_t history_count(const History *history, HistoryFate fate);

/* "7 layers, 1 hidden, 1 lost to a tie": one line. */
void history_summary(const History *history, Text *out);

/* {"pixel": [x, y], "fragments": […], "blend": […], "accum": […], …}; scene: for names. Numbers
 * that are not counts are hexadecimal floats as strings. */
void history_json(const History *history, const Scene *scene, Text *out);

#endif
