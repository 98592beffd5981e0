/* A fuzz target as a test, in every build: all files of some folders, then mutations of them that
 * are the same on every machine.
 *
 *   fuzz_NAME MUTATIONS PATH…       files, and folders of files
 *   fuzz_NAME @N PATH…              the N-th of the mutations alone, from 0: to standard output,
 * too
 *
 * Where an input ends the program, the last line says which it was. */
#include "fuzz.h"

#include "base/file.h"
#include "base/memory.h"
#include "base/random.h"

#include <dirent.h>
#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

enum {
    MUTATED_MAX = 1 << 16, /* bytes */
    SECONDS_MAX = 100      /* of one input, before it counts as endless */
};

typedef struct Input {
    char *path;
    unsigned char *bytes;
    size_t count;
} Input;

typedef struct Corpus {
    Input *inputs;
    size_t count, capacity;
} Corpus;

/* ---- which input is running ------------------------------------------------------------------ */

static char running[512]; /* a line */

static void say_running(void)
{
    if (write(STDERR_FILENO, running, strlen(running)) < 0) {
        /* nothing more to do */
    }
}

static void on_signal(int number)
{
    say_running();
    raise(number); /* SA_RESETHAND */
}

/* AddressSanitizer's, where the program is linked with it. */
void __sanitizer_set_death_callback(void (*callback)(void)) __attribute__((weak));

static void watch(void)
{
    static const int numbers[] = {SIGABRT, SIGALRM, SIGBUS, SIGFPE, SIGILL, SIGSEGV};
    struct sigaction action = {.sa_handler = on_signal, .sa_flags = SA_RESETHAND | SA_NODEFER};
    sigemptyset(&action.sa_mask);
    if (__sanitizer_set_death_callback)
        __sanitizer_set_death_callback(say_running);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        struct sigaction now;
        if (sigaction(numbers[i], NULL, &now) == 0 && now.sa_handler == SIG_DFL)
            sigaction(numbers[i], &action, NULL);
    }
}

/* A copy of exactly `count` bytes, so that reading behind them is found. */
static void run(const unsigned char *bytes, size_t count)
{
    unsigned char *copy = malloc(count ? count : 1);
    FUZZ_CHECK(copy, "out of memory");
    memcpy(copy, bytes, count);
    alarm(SECONDS_MAX);
    LLVMFuzzerTestOneInput(copy, count);
    alarm(0);
    free(copy);
}

/* ---- the files ------------------------------------------------------------------------------- */

static _Noreturn void fail(const char *message)
{
    fprintf(stderr, "fuzz: %s\n", message);
    exit(EXIT_FAILURE);
}

static void add_file(Corpus *corpus, const char *path)
{
    Input input = {.path = strdup(path)};
    if (!input.path || memory_grow((void **)&corpus->inputs, &corpus->capacity, corpus->count + 1,
                                   sizeof *corpus->inputs) != RESULT_OK)
        fail("out of memory");
    if (file_load(path, &input.bytes, &input.count) != RESULT_OK)
        fail(result_message());
    corpus->inputs[corpus->count++] = input;
}

static void add_path(Corpus *corpus, const char *path)
{
    struct dirent **entries;
    struct stat status;
    if (stat(path, &status) == 0 && !S_ISDIR(status.st_mode)) {
        add_file(corpus, path);
        return;
    }
    int count = scandir(path, &entries, NULL, alphasort);
    if (count < 0) {
        fprintf(stderr, "fuzz: %s: expected a file or a folder\n", path);
        exit(EXIT_FAILURE);
    }
    for (int i = 0; i < count; i++) {
        char file[1024];
        snprintf(file, sizeof file, "%s/%s", path, entries[i]->d_name);
        if (entries[i]->d_name[0] != '.')
            add_file(corpus, file);
        free(entries[i]);
    }
    free(entries);
}

static void free_corpus(Corpus *corpus)
{
    for (size_t i = 0; i < corpus->count; i++) {
        free(corpus->inputs[i].path);
        free(corpus->inputs[i].bytes);
    }
    free(corpus->inputs);
}

/* ---- mutations ------------------------------------------------------------------------------- */

/* Moves the bytes from `from` on to `to`, which makes the input longer or shorter. */
static size_t move(unsigned char *bytes, size_t count, size_t from, size_t to)
{
    if (to > from && count + (to - from) > MUTATED_MAX)
        return count;
    memmove(bytes + to, bytes + from, count - from);
    return count + to - from;
}

/* A number of 1, 2 or 4 bytes near which readers go wrong, in either byte order. */
static void put_odd(Random *random, unsigned char *bytes, size_t count)
{
    static const uint32_t odd[] = {0,      1,      2,        0x7f,       0x80,       0xff,
                                   0x7fff, 0x8000, 0xffff,   0x10000,    0x7fffffff, 0x80000000,
                                   0x4000, 0x4001, 1u << 28, 0xfffffffe, 0xffffffff, 0x7fc00000};
    uint32_t value = odd[random_bits(random) % (sizeof odd / sizeof *odd)];
    size_t width = (size_t)1 << random_bits(random) % 3;
    bool big = random_bits(random) & 1;
    for (size_t i = 0; i < width && i < count; i++)
        bytes[i] = (unsigned char)(value >> 8 * (big ? width - 1 - i : i));
}

static size_t mutate_once(Random *random, const Corpus *corpus, unsigned char *bytes, size_t count)
{
    size_t at = count ? random_bits(random) % count : 0;
    size_t length = 1 + random_bits(random) % (random_bits(random) % 4 ? 8 : 64);
    const Input *other = &corpus->inputs[random_bits(random) % corpus->count];
    length = length < count - at ? length : count - at;
    switch (random_bits(random) % 8) {
    case 0:
    case 1:
        if (count)
            bytes[at] ^= (unsigned char)(1u << random_bits(random) % 8);
        return count;
    case 2:
        if (count)
            bytes[at] = (unsigned char)random_bits(random);
        return count;
    case 3:
        put_odd(random, bytes + at, count - at);
        return count;
    case 4:
        return move(bytes, count, at + length, at);
    case 5: /* says a piece twice */
        return move(bytes, count, at, at + length);
    case 6:
        return random_bits(random) % 4 ? count : at;
    default: { /* takes a piece of another input */
        size_t from = other->count ? random_bits(random) % other->count : 0;
        size_t taken = length < other->count - from ? length : other->count - from;
        memcpy(bytes + at, other->bytes + from, taken);
        return count;
    }
    }
}

/* out: NULL, or where the mutated input goes, too. */
static void run_mutation(const Corpus *corpus, uint64_t number, FILE *out)
{
    static unsigned char bytes[MUTATED_MAX];
    Random random = random_seed(number);
    const Input *input = &corpus->inputs[random_bits(&random) % corpus->count];
    size_t count = input->count < MUTATED_MAX ? input->count : MUTATED_MAX;
    memcpy(bytes, input->bytes, count);
    for (uint64_t i = random_bits(&random) % 6 + 1; i > 0; i--)
        count = mutate_once(&random, corpus, bytes, count);
    snprintf(running, sizeof running, "fuzz: this was mutation %" PRIu64 ", of %s\n", number,
             input->path);
    if (out && (fwrite(bytes, 1, count, out) != count || fflush(out) != 0))
        fail("standard output: cannot write");
    run(bytes, count);
}

/* ---- the program ----------------------------------------------------------------------------- */

int main(int argc, char **argv)
{
    Corpus corpus = {0};
    char *end = "";
    bool one = argc > 2 && argv[1][0] == '@';
    uint64_t number = argc > 2 ? strtoull(argv[1] + one, &end, 10) : 0;
    if (argc < 3 || *end)
        fail("expected MUTATIONS PATH... or @N PATH...");
    for (int i = 2; i < argc; i++)
        add_path(&corpus, argv[i]);
    if (corpus.count == 0)
        fail("no inputs");
    watch();
    for (size_t i = 0; i < corpus.count && !one; i++) {
        snprintf(running, sizeof running, "fuzz: this was %s\n", corpus.inputs[i].path);
        run(corpus.inputs[i].bytes, corpus.inputs[i].count);
    }
    for (uint64_t i = 0; i < number && !one; i++)
        run_mutation(&corpus, i, NULL);
    if (one)
        run_mutation(&corpus, number, stdout);
    else
        printf("%zu inputs, %" PRIu64 " mutations\n", corpus.count, number);
    free_corpus(&corpus);
    return EXIT_SUCCESS;
}
