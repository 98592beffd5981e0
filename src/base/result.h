/* What every fallible function returns, and the one-line message that goes with a failure. */
#ifndef PEEL_BASE_RESULT_H
#define PEEL_BASE_RESULT_H

#include <stdbool.h>

typedef enum Result {
    RESULT_OK = 0,
    RESULT_NO_MEMORY,   /* an allocation failed, or would exceed the caller's limit */
    RESULT_BAD_INPUT,   /* a file, scene or option is malformed or out of range */
    RESULT_IO,          /* the operating system refused to read or write */
    RESULT_UNSUPPORTED, /* well-formed, but not modelled here */
    RESULT_NO_GL,       /* no usable OpenGL context, or the driver reported an error */
    RESULT_INTERNAL,    /* a bug */
} Result;

/* Never NULL; a static string. */
const char *result_text(Result result);

/* Room for a message before it is made one line: a path may have 4,095 bytes. */
enum {
    RESULT_LINE = 8192
};

/* Records a one-line message (what, where, what was expected; no final full stop) for the calling
 * thread and returns code, so that callers write `return result_fail(RESULT_IO, "%s: ...", path)`.
 * Of more than 1,023 bytes the middle is left out. */
Result result_fail(Result code, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Static analyzers see one file at a time: to them, that code is what is returned is said here. */
#if defined __clang_analyzer__ || defined PEEL_ANALYZER
#define result_fail(code, ...)                                                                     \
    __extension__({                                                                                \
        (void)result_fail(code, __VA_ARGS__);                                                      \
        (code);                                                                                    \
    })
#endif

/* The calling thread's latest message, "" if there is none. Valid until its next result_fail. */
const char *result_message(void);

/* One line "peel: warning: ..." on stderr, once a program has enabled them: the library prints
 * nothing. */
void result_warn(const char *format, ...) __attribute__((format(printf, 1, 2)));
void result_warnings_enable(bool enable);
/* Enabled warnings go to sink, a line each, instead; NULL: to stderr again. */
void result_warnings_redirect(void (*sink)(void *context, const char *line), void *context);

#endif
