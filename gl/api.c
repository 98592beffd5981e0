#include "api.h"

#include <string.h>

Api gl;

/* Function pointers have one representation on every POSIX system; the copy keeps the compiler
 * from having to accept a cast between incompatible function types. */
_Static_assert(sizeof(ApiFunction) == sizeof gl.Enable, "function pointers differ in size");

Result api_load(ApiFunction (*lookup)(const char *name))
{
    static const struct {
        const char *name;
        void *slot;
    } entries[] = {
#define API_ENTRY(upper, name) {"gl" #name, &gl.name},
        API_FUNCTIONS(API_ENTRY)
#undef API_ENTRY
    };
    for (size_t i = 0; i < sizeof entries / sizeof *entries; i++) {
        ApiFunction function = lookup(entries[i].name);
        if (!function)
            return result_fail(RESULT_NO_GL, "OpenGL: the driver has no %s", entries[i].name);
        memcpy(entries[i].slot, &function, sizeof function);
    }
    return RESULT_OK;
}
