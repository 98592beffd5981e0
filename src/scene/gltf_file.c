#include "scene/gltf_file.h"

#include "base/base64.h"
#include "base/file.h"
#include "base/memory.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

/* Source: glTF 2.0, 4.4 (binary glTF layout). */
#define GLB_MAGIC 0x46546c67u
#define GLB_JSON  0x4e4f534au
#define GLB_BIN   0x004e4942u

static int digit_value(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    char lower = (char)(c | 32);
    return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

Result gltf_file_beside(const char *path, const char *uri, char **out)
{
    const char *slash = strrchr(path, '/');
    size_t folder = slash ? (size_t)(slash - path) + 1 : 0;
    char *beside = memory_array(folder + strlen(uri) + 1, 1);
    if (!beside)
        return RESULT_NO_MEMORY;
    memcpy(beside, path, folder);
    char *end = beside + folder;
    for (const char *c = uri; *c; c++) {
        if (*c != '%') {
            *end++ = *c;
            continue;
        }
        int high = digit_value(c[1]), low = high < 0 ? -1 : digit_value(c[2]);
        if (low < 0 || high + low == 0) {
            free(beside);
            return result_fail(
                RESULT_BAD_INPUT,
                "%s: uri %s: expected two hexadecimal digits, not 00, after every %%", path, uri);
        }
        *end++ = (char)(16 * high + low);
        c += 2;
    }
    *out = beside;
    return RESULT_OK;
}

int gltf_file_kind(const char *path)
{
    const char *dot = strrchr(path, '.');
    if (dot && strcasecmp(dot, ".glb") == 0)
        return 1;
    return dot && strcasecmp(dot, ".gltf") == 0 ? 0 : -1;
}

static unsigned char *put_words(unsigned char *out, const uint32_t *words, int count)
{
    for (int i = 0; i < 4 * count; i++)
        *out++ = (unsigned char)(words[i / 4] >> 8 * (i % 4));
    return out;
}

static unsigned char *put_chunk(unsigned char *out, uint32_t type, const void *data, size_t count,
                                unsigned char padding)
{
    size_t padded = (count + 3) / 4 * 4;
    out = put_words(out, (const uint32_t[2]){(uint32_t)padded, type}, 2);
    memcpy(out, data, count);
    memset(out + count, padding, padded - count);
    return out + padded;
}

Result gltf_file_assemble(const char *text, const unsigned char *binary, size_t binary_count,
                          unsigned char **out, size_t *out_count)
{
    size_t length = strlen(text);
    size_t total = 12 + 8 + (length + 3) / 4 * 4;
    if (binary_count)
        total += 8 + (binary_count + 3) / 4 * 4;
    if (total > UINT32_MAX)
        return result_fail(RESULT_UNSUPPORTED, "a .glb of %zu bytes, expected below 4 GiB", total);
    *out = memory_array(total, 1);
    if (!*out)
        return RESULT_NO_MEMORY;
    *out_count = total;
    unsigned char *end = put_words(*out, (const uint32_t[3]){GLB_MAGIC, 2, (uint32_t)total}, 3);
    end = put_chunk(end, GLB_JSON, text, length, ' ');
    if (binary_count)
        put_chunk(end, GLB_BIN, binary, binary_count, 0);
    return RESULT_OK;
}

char *gltf_file_data_uri(const char *type, const unsigned char *bytes, size_t count)
{
    size_t room = sizeof "data:;base64," + strlen(type) + base64_length(count);
    char *uri = memory_array(room, 1);
    if (!uri)
        return NULL;
    int head = snprintf(uri, room, "data:%s;base64,", type);
    base64_put(bytes, count, uri + head);
    return uri;
}

static int base64_value(char c)
{
    if (c >= 'A' && c <= 'Z')
        return c - 'A';
    if (c >= 'a' && c <= 'z')
        return c - 'a' + 26;
    if (c >= '0' && c <= '9')
        return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}

Result gltf_file_from_data_uri(const char *uri, unsigned char **bytes, size_t *count)
{
    static const char mark[] = ";base64";
    const char *comma = strchr(uri, ',');
    size_t head = comma ? (size_t)(comma - uri) : 0;
    if (head < sizeof mark - 1 || strncmp(comma - (sizeof mark - 1), mark, sizeof mark - 1) != 0)
        return result_fail(RESULT_BAD_INPUT, "expected ;base64 in its data uri");
    const char *text = comma + 1;
    size_t length = strlen(text);
    if (length && length % 4 == 0) /* the padding: one or two = */
        for (int i = 0; i < 2 && text[length - 1] == '='; i++)
            length--;
    unsigned char *out = memory_array(length / 4 * 3 + 3, 1);
    if (!out)
        return RESULT_NO_MEMORY;
    uint32_t bits = 0;
    *count = 0;
    for (size_t i = 0; i < length; i++) {
        int value = base64_value(text[i]);
        if (value < 0 || length % 4 == 1) {
            free(out);
            return result_fail(RESULT_BAD_INPUT, "expected base64 digits in its data uri");
        }
        bits = bits << 6 | (uint32_t)value;
        if (i % 4 != 0)
            out[(*count)++] = (unsigned char)(bits >> (6 - 2 * (i % 4)));
    }
    *bytes = out;
    return RESULT_OK;
}

Result gltf_file_uri(const char *path, const char *what, size_t index, const char *uri,
                     unsigned char **bytes, size_t *count)
{
    struct stat info;
    char *beside = NULL;
    if (strncmp(uri, "data:", 5) == 0) {
        Result result = gltf_file_from_data_uri(uri, bytes, count);
        return result ? result_fail(result, "%s: %s %zu: %s", path, what, index, result_message())
                      : RESULT_OK;
    }
    Result result = gltf_file_beside(path, uri, &beside);
    if (!result && stat(beside, &info))
        result = result_fail(RESULT_BAD_INPUT, "%s: %s %zu: no file %s beside it", path, what,
                             index, uri);
    if (!result)
        result = file_load(beside, bytes, count);
    free(beside);
    return result;
}
