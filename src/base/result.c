#include "base/result.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static _Thread_local char message[1024];
static bool warnings;
static void (*warning_sink)(void *context, const char *line);
static void *warning_context;

const char *result_text(Result result)
{
    switch (result) {
    case RESULT_OK:
        return "done";
    case RESULT_NO_MEMORY:
        return "out of memory";
    case RESULT_BAD_INPUT:
        return "bad input";
    case RESULT_IO:
        return "input or output failed";
    case RESULT_UNSUPPORTED:
        return "not supported";
    case RESULT_NO_GL:
        return "OpenGL failed";
    case RESULT_INTERNAL:
        return "internal error";
    }
    return "unknown result";
}

/* The contract is one line whatever a file name or a library's text contains, and nothing that a
 * terminal takes for a command. */
static void make_one_line(char *text)
{
    for (char *c = text; *c; c++)
        if (*c == '\n' || *c == '\r' || *c == '\t')
            *c = ' ';
        else if ((unsigned char)*c < ' ' || *c == 0x7f)
            *c = '?';
}

#undef result_fail
Result result_fail(Result code, const char *format, ...)
{
    char text[sizeof message]; /* the arguments may hold the previous message */
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    make_one_line(text);
    memcpy(message, text, sizeof message);
    return code;
}

const char *result_message(void)
{
    return message;
}

void result_warnings_enable(bool enable)
{
    warnings = enable;
}

void result_warnings_redirect(void (*sink)(void *context, const char *line), void *context)
{
    warning_sink = sink;
    warning_context = context;
}

void result_warn(const char *format, ...)
{
    if (!warnings)
        return;
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    make_one_line(text);
    if (warning_sink)
        warning_sink(warning_context, text);
    else
        fprintf(stderr, "peel: warning: %s\n", text);
}
