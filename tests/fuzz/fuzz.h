/* What the fuzz targets share. A target is one function in tests/fuzz/fuzz_NAME.c that gives any
 * bytes to a reader of ours and checks what comes back. libFuzzer calls it (preset fuzz, fuzz.sh),
 * and replay.c in every build. */
#ifndef PEEL_TESTS_FUZZ_H
#define PEEL_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* libFuzzer's interface; returns 0. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Aborts with a line on stderr, in every build. */
_Noreturn void fuzz_fail(const char *file, int line, const char *what, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* FUZZ_CHECK(condition, "how: %d", …): the condition must hold. */
#define FUZZ_CHECK(condition, ...)                                                                 \
    do {                                                                                           \
        if (!(condition))                                                                          \
            fuzz_fail(__FILE__, __LINE__, #condition, __VA_ARGS__);                                \
    } while (0)

/* The bytes as a regular file that is in no folder. The path stays valid; the next call with the
 * same slot, 0 or 1, changes the file. */
const char *fuzz_file(int slot, const void *data, size_t size);

/* A path that a writer may make a file at, in a folder that is removed at the program's end. */
const char *fuzz_output(void);

/* A result that is no success must have a message of one line. */
void fuzz_check_message(void);

/* An input as numbers: bytes behind the end read as 0. */
typedef struct FuzzBytes {
    const uint8_t *at;
    size_t left;
} FuzzBytes;

/* The next `count` bytes, at most 8, as a little-endian number. */
static inline uint64_t fuzz_take(FuzzBytes *bytes, size_t count)
{
    uint64_t value = 0;
    size_t taken = count < bytes->left ? count : bytes->left;
    for (size_t i = 0; i < taken; i++)
        value |= (uint64_t)bytes->at[i] << 8 * i;
    bytes->at += taken;
    bytes->left -= taken;
    return value;
}

/* The next 8 bytes as a double of any bits. */
static inline double fuzz_take_double(FuzzBytes *bytes)
{
    uint64_t bits = fuzz_take(bytes, sizeof bits);
    double value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

#endif
