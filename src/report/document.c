#include "report/document.h"

#include "base/file.h"
#include "base/json_memory.h"
#include "number/numeral.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

json_t *document_real(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *document_count(uint64_t value)
{
    return json_integer((json_int_t)value);
}

void document_put(Document *json, json_t *object, const char *key, json_t *value)
{
    if (json_object_set_new(object, key, value))
        json->failed = true;
}

void document_append(Document *json, json_t *array, json_t *value)
{
    if (json_array_append_new(array, value))
        json->failed = true;
}

json_t *document_string(const char *text)
{
    if (!text)
        return NULL;
    json_memory_begin();
    json_t *value = json_string(text);
    if (value || json_memory_check("", RESULT_OK) != RESULT_OK)
        return value;
    char *ascii = strdup(text);
    for (char *c = ascii; c && *c; c++)
        if ((unsigned char)*c > 126)
            *c = '?';
    value = ascii ? json_string(ascii) : NULL;
    free(ascii);
    return value;
}

json_t *document_hex(double value)
{
    char text[NUMERAL_MAX];
    return json_string(numeral_hex(value, text));
}

static int write_text(const char *text, size_t size, void *writer)
{
    return file_writer_put(writer, text, size) == RESULT_OK ? 0 : -1;
}

Result document_write(const Document *json, json_t *root, const char *path)
{
    FileWriter writer;
    Result result = file_writer_open(path, &writer);
    if (result == RESULT_OK) {
        int dumped =
            json->failed ? -1 : json_dump_callback(root, write_text, &writer, JSON_INDENT(1));
        file_writer_put(&writer, "\n", 1);
        bool failed = dumped != 0 && !writer.error;
        result = file_writer_close(&writer, !failed);
        if (failed)
            result = result_fail(RESULT_NO_MEMORY, "%s: out of memory for the document", path);
    }
    json_decref(root);
    return result;
}
