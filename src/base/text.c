#include "base/text.h"

#include "base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

void text_print(Text *text, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(NULL, 0, format, arguments);
    va_end(arguments);
    void *bytes = text->bytes;
    if (text->result == RESULT_OK)
        text->result = memory_grow(&bytes, &text->room, text->count + (size_t)length + 1, 1);
    if (text->result != RESULT_OK)
        return;
    text->bytes = bytes;
    va_start(arguments, format);
    vsnprintf(text->bytes + text->count, (size_t)length + 1, format, arguments);
    va_end(arguments);
    text->count += (size_t)length;
}

void text_make_line(char *string)
{
    for (char *c = string; *c; c++)
        if (*c == '\n' || *c == '\r' || *c == '\t')
            *c = ' ';
        else if ((unsigned char)*c < ' ' || *c == 0x7f)
            *c = '?';
        else if (c[0] == '\xc2' && (unsigned char)c[1] >= 0x80 && (unsigned char)c[1] < 0xa0)
            c[0] = c[1] = '?'; /* U+0080 to U+009F */
}

/* How many bytes the UTF-8 sequence at s has; 0 where it is none. Source: RFC 3629, section 4. */
static int utf8_length(const unsigned char *s)
{
    static const struct {
        unsigned char low, high, least, most; /* of the first byte, and of the second */
        int length;
    } forms[] = {{0xc2, 0xdf, 0x80, 0xbf, 2}, {0xe0, 0xe0, 0xa0, 0xbf, 3},
                 {0xe1, 0xec, 0x80, 0xbf, 3}, {0xed, 0xed, 0x80, 0x9f, 3},
                 {0xee, 0xef, 0x80, 0xbf, 3}, {0xf0, 0xf0, 0x90, 0xbf, 4},
                 {0xf1, 0xf3, 0x80, 0xbf, 4}, {0xf4, 0xf4, 0x80, 0x8f, 4}};
    if (*s < 0x80)
        return 1;
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        if (*s < forms[i].low || *s > forms[i].high || s[1] < forms[i].least ||
            s[1] > forms[i].most)
            continue;
        for (int k = 2; k < forms[i].length; k++)
            if ((s[k] & 0xc0) != 0x80)
                return 0;
        return forms[i].length;
    }
    return 0;
}

void text_make_utf8(char *string)
{
    for (unsigned char *s = (unsigned char *)string; *s; s++) {
        int length = utf8_length(s);
        if (length == 0)
            *s = '?';
        s += length > 1 ? length - 1 : 0;
    }
}

void text_json_string(Text *text, const char *string)
{
    text_print(text, "\"");
    for (const unsigned char *s = (const unsigned char *)string; *s; s++) {
        int length = utf8_length(s);
        if (*s == '"' || *s == '\\')
            text_print(text, "\\%c", *s);
        else if (*s < 0x20)
            text_print(text, "\\u%04x", *s);
        else if (length == 0)
            text_print(text, "?");
        else
            text_print(text, "%.*s", length, (const char *)s);
        s += length > 1 ? length - 1 : 0;
    }
    text_print(text, "\"");
}

void text_free(Text *text)
{
    free(text->bytes);
    *text = (Text){0};
}
