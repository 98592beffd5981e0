#include "base/result.h"

#include "base/text.h"

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

/* Of a line that is too long the middle is left out: its end says why. Whole characters of UTF-8.
 */
static void shorten(const char *whole, char out[sizeof message])
{
    static const char gap[] = " ... ";
    size_t length = strlen(whole), head = length, tail = 0;
    if (length >= sizeof message) {
        head = sizeof message / 2;
        tail = sizeof message - head - sizeof gap;
        while (head > 0 && ((unsigned char)whole[head] & 0xc0) == 0x80)
            head--;
        while (tail > 0 && ((unsigned char)whole[length - tail] & 0xc0) == 0x80)
            tail--;
    }
    snprintf(out, sizeof message, "%.*s%s%s", (int)head, whole, tail ? gap : "",
             whole + length - tail);
}

#undef result_fail
Result result_fail(Result code, const char *format, ...)
{
    char text[RESULT_LINE]; /* the arguments may hold the previous message */
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    text_make_line(text);
    shorten(text, message);
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
    char text[RESULT_LINE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    text_make_line(text);
    if (warning_sink)
        warning_sink(warning_context, text);
    else
        fprintf(stderr, "peel: warning: %s\n", text);
}
