/* The page of `peel explain -o`: one file with the pipeline as WebAssembly, the scene, and what gl
 * and the truth say of the same frame. */
#ifndef PEEL_REPORT_EXPLAIN_H
#define PEEL_REPORT_EXPLAIN_H

#include "compare/store.h"
#include "frame/frame.h"

/* One renderer's frame. */
typedef struct ExplainSide {
    const Frame *frame;      /* NULL: it has none */
    const TraceStore *trace; /* NULL of the truth */
    const char *missing;     /* without a frame: why, in one line */
} ExplainSide;

/* A page that is a lesson: what src/web/lessons.js says stands beside it. */
typedef struct ExplainLesson {
    int number;                /* from 1 */
    const char *const *titles; /* of all lessons */
    int count;
} ExplainLesson;

typedef struct ExplainDesc {
    const char *name, *command; /* of the scene; what makes the page again */
    const Scene *scene;
    RenderDesc desc;
    ExplainSide ref, gl, truth;
    size_t max_bytes;            /* of the page; 0: EXPLAIN_MAX_BYTES */
    const ExplainLesson *lesson; /* NULL: none */
} ExplainDesc;

#define EXPLAIN_MAX_BYTES       ((size_t)15000000)
#define EXPLAIN_MAX_TRACE_BYTES ((size_t)1000000000)

/* Passes a frame's buffers on, and ends the rendering with UNSUPPORTED once they are more than a
 * page can keep, which it does twice: in the pipeline's memory and in its own. */
typedef struct ExplainSink {
    TraceSink sink;
    TraceSink *next;
    const char *name; /* of the scene */
    size_t bytes;
    bool full; /* ended the rendering */
} ExplainSink;

/* next and name stay the caller's; sink.details is on. */
ExplainSink report_explain_sink(TraceSink *next, const char *name);

/* Writes dir/file; dir exists; ref has a frame and its trace. *bytes, which may be NULL: the page's
 * size. UNSUPPORTED where the page would be larger than it may be: the message says what takes the
 * room. Else NO_MEMORY and IO.
 */
Result report_explain_write(const ExplainDesc *explain, const char *dir, const char *file,
                            size_t *bytes);

#endif
