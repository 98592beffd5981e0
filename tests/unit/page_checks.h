/* Checks of text and of HTML pages in the scratch directory. */
#ifndef PEEL_TESTS_PAGE_CHECKS_H
#define PEEL_TESTS_PAGE_CHECKS_H

#include "scratch.h"

#include <stdbool.h>

static inline void assert_contains(const char *text, const char *part)
{
    ck_assert_msg(strstr(text, part) != NULL, "no \"%s\" in:\n%s", part, text);
}

static inline void assert_lacks(const char *text, const char *part)
{
    ck_assert_msg(strstr(text, part) == NULL, "unexpected \"%s\" in:\n%s", part, text);
}

static inline void assert_file_exists(const char *name)
{
    ck_assert_msg(!name[0] || access(scratch_path(name), R_OK) == 0, "no file %s", name);
}

/* The value of an attribute inside a tag's text, "" if it has none. */
static inline void attribute(const char *tag, const char *name, char *out, size_t size)
{
    char key[16];
    snprintf(key, sizeof key, " %s=\"", name);
    const char *value = strstr(tag, key);
    out[0] = 0;
    if (value)
        snprintf(out, size, "%.*s", (int)strcspn(value + strlen(key), "\""), value + strlen(key));
}

/* A file that the page names: there, and reached from the page's folder without a network. */
static inline void check_link(const char *folder, const char *value)
{
    char path[64];
    ck_assert_msg(value[0] != '/' && !strchr(value, ':'), "not a relative link: %s", value);
    ck_assert_int_lt(snprintf(path, sizeof path, "%s/%s", folder, value), (int)sizeof path);
    if (value[0])
        assert_file_exists(path);
}

/* One start tag: the files that it names exist, pictures have a text. Whether an end tag follows.
 */
static inline bool check_tag(const char *folder, const char *tag, const char *name)
{
    char value[256];
    attribute(tag, "src", value, sizeof value);
    check_link(folder, value);
    attribute(tag, "href", value, sizeof value);
    check_link(folder, value);
    if (strcmp(name, "img") == 0) {
        attribute(tag, "alt", value, sizeof value);
        ck_assert_msg(value[0] != 0, "no alternative text: %s", tag);
    }
    static const char *const empty[] = {"!doctype", "meta", "link", "img", "br"};
    for (size_t i = 0; i < sizeof empty / sizeof empty[0]; i++)
        if (strcmp(name, empty[i]) == 0)
            return false;
    return tag[strlen(tag) - 1] != '/';
}

/* Every element of folder/index.html is closed in its order. Returns how many pictures it has. */
static inline int check_page(const char *folder)
{
    static char text[1 << 20], open[64][16];
    char path[64];
    int depth = 0, images = 0;
    snprintf(path, sizeof path, "%s/index.html", folder);
    scratch_read(scratch_path(path), text, sizeof text);
    assert_lacks(text, "<script");
    assert_lacks(text, "http");
    for (char *tag = text; (tag = strchr(tag, '<')); tag++) {
        char name[16], *end = strchr(tag, '>');
        ck_assert_ptr_nonnull(end);
        *end = 0;
        bool closes = tag[1] == '/';
        snprintf(name, sizeof name, "%.*s", (int)strcspn(tag + 1 + closes, " "), tag + 1 + closes);
        if (closes)
            ck_assert_msg(depth > 0 && strcmp(open[--depth], name) == 0, "</%s> at depth %d", name,
                          depth);
        else if (check_tag(folder, tag, name))
            strcpy(open[depth++], name);
        images += strcmp(name, "img") == 0;
        *end = '>';
    }
    ck_assert_int_eq(depth, 0);
    return images;
}

#endif
