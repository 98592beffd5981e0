#define _GNU_SOURCE /* memfd_create */
#include "fuzz.h"

#include "base/result.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

static void print_failure(const char *file, int line, const char *what, const char *format,
                          va_list arguments)
{
    fprintf(stderr, "%s:%d: %s: ", file, line, what);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    abort();
}

void fuzz_fail(const char *file, int line, const char *what, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_failure(file, line, what, format, arguments);
    abort();
}

/* What libcheck's assertions call: targets use the other tests' headers without libcheck. */
_Noreturn void _ck_assert_failed(const char *file, int line, const char *expression,
                                 const char *format, ...) __attribute__((format(printf, 4, 5)));
void _ck_assert_failed(const char *file, int line, const char *expression, const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    print_failure(file, line, expression, format ? format : "", arguments);
    abort();
}

void _mark_point(const char *file, int line);
void _mark_point(const char *file, int line)
{
    (void)file;
    (void)line;
}

const char *fuzz_file(int slot, const void *data, size_t size)
{
    static int descriptors[2] = {-1, -1};
    static char paths[2][32];
    int *descriptor = &descriptors[slot];
    if (*descriptor < 0) {
        *descriptor = memfd_create("fuzz", MFD_CLOEXEC);
        FUZZ_CHECK(*descriptor >= 0, "no file in memory");
        snprintf(paths[slot], sizeof paths[slot], "/proc/self/fd/%d", *descriptor);
    }
    FUZZ_CHECK(ftruncate(*descriptor, 0) == 0 &&
                   pwrite(*descriptor, data, size, 0) == (ssize_t)size,
               "a file of %zu bytes in memory", size);
    return paths[slot];
}

static char folder[64], output[80];

static void remove_folder(void)
{
    unlink(output);
    rmdir(folder);
}

const char *fuzz_output(void)
{
    if (!*folder) {
        strcpy(folder, "/tmp/peel-fuzz-XXXXXX");
        FUZZ_CHECK(mkdtemp(folder), "no temporary folder");
        snprintf(output, sizeof output, "%s/output", folder);
        atexit(remove_folder);
    }
    return output;
}

void fuzz_check_message(void)
{
    const char *message = result_message();
    FUZZ_CHECK(*message && !strchr(message, '\n'), "'%s'", message);
}
