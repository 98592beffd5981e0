/* The program without memory: every allocation of our own fails in turn, in a process of its own.
 *
 * faulty RUNS ARGUMENT...: runs `peel ARGUMENT...` in the folder `run`, emptied before each run:
 * first whole, twice, then RUNS times with an allocation failing, spread over all of them, by turns
 * alone and with all that follow (RUNS 0: each of them, both ways). A run must end as the whole
 * one, with the same output and files, or with exit code 4, one line that says memory and no file
 * that the whole run has not written. Prints what it counted; exit code 1 with the first ten that
 * went wrong. faulty at N|N+ ARGUMENT...: one run, here, whose Nth allocation fails (+: and all
 * that follow).
 */
#define _GNU_SOURCE /* nftw */
#include "wrap.h"

#include <ctype.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <ftw.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum {
    FILES_MAX = 512,
    NAME_MAX_BYTES = 256,
    SECONDS_MAX = 120, /* of one run */
    SHOWN_MAX = 10,
    MESSAGE_BYTES = 512,
    EXIT_REFUSED = 4
};

/* How much of a file is the same in two whole runs. */
typedef enum Sameness {
    SAME_BYTES,
    SAME_BUT_NUMBERS, /* times */
    SAME_NAME         /* plots of times */
} Sameness;

typedef struct File {
    char name[NAME_MAX_BYTES];
    uint64_t bytes, words; /* hashes: of all, and of all but numbers */
    Sameness sameness;
} File;

/* What a run leaves: its standard output, which is the first, and its files, as nftw finds them. */
typedef struct Outcome {
    int status; /* waitpid's */
    int file_count;
    File files[FILES_MAX];
    int lines;                   /* on standard error, without warnings */
    char message[MESSAGE_BYTES]; /* the last of them */
} Outcome;

int __real_main(int argc, char **argv);
int __wrap_main(int argc, char **argv);

/* ---- what a run left ---- */

static Outcome *listing; /* where nftw's callback puts files */

static void hash_file(const char *path, File *file)
{
    FILE *in = fopen(path, "rb");
    bool in_number = false;
    file->bytes = file->words = 0xcbf29ce484222325u;
    if (!in)
        return;
    for (int c; (c = getc(in)) != EOF;) {
        file->bytes = (file->bytes ^ (uint64_t)c) * 0x100000001b3u;
        bool number = isdigit(c) || c == '.' || (in_number && strchr("e+-", c));
        /* Padding grows and shrinks with the numbers. */
        if (!number && c != ' ')
            file->words = (file->words ^ (uint64_t)c) * 0x100000001b3u;
        in_number = number;
    }
    fclose(in);
}

static int list_file(const char *path, const struct stat *status, int type, struct FTW *at)
{
    (void)at, (void)status;
    if (type != FTW_F)
        return 0;
    if (listing->file_count == FILES_MAX) {
        fprintf(stderr, "faulty: more than %d files\n", FILES_MAX);
        exit(2);
    }
    File *file = &listing->files[listing->file_count++];
    *file = (File){.sameness = SAME_BYTES};
    snprintf(file->name, sizeof file->name, "%s", path);
    hash_file(path, file);
    return 0;
}

static int remove_file(const char *path, const struct stat *status, int type, struct FTW *at)
{
    (void)status, (void)type, (void)at;
    return remove(path);
}

static void read_errors(Outcome *out)
{
    char line[4096];
    FILE *in = fopen("stderr", "r");
    out->lines = 0;
    out->message[0] = 0;
    while (in && fgets(line, sizeof line, in)) {
        if (strncmp(line, "peel: warning: ", 15) == 0)
            continue;
        out->lines++;
        snprintf(out->message, sizeof out->message, "%.*s", (int)strcspn(line, "\n"), line);
    }
    if (in)
        fclose(in);
}

/* ---- runs ---- */

static _Noreturn void be_child(int argc, char **argv)
{
    int out = open("stdout", O_WRONLY | O_CREAT | O_TRUNC, 0666);
    int err = open("stderr", O_WRONLY | O_CREAT | O_TRUNC, 0666);
    if (out < 0 || err < 0 || dup2(out, STDOUT_FILENO) < 0 || dup2(err, STDERR_FILENO) < 0 ||
        chdir("run") != 0)
        _exit(3);
    alarm(SECONDS_MAX);
    exit(__real_main(argc, argv));
}

static void run(int argc, char **argv, long fails_at, bool for_good, Outcome *out)
{
    nftw("run", remove_file, 16, FTW_DEPTH | FTW_PHYS);
    mkdir("run", 0777);
    WrapPlan *plan = wrap_plan();
    atomic_store(&plan->for_good, for_good);
    atomic_store(&plan->failed, 0);
    atomic_store(&plan->counted, 0);
    atomic_store(&plan->fails_at, fails_at);
    fflush(NULL);
    pid_t child = fork();
    if (child == 0)
        be_child(argc, argv);
    out->status = -1;
    if (child > 0)
        waitpid(child, &out->status, 0);
    atomic_store(&plan->fails_at, 0);
    out->file_count = 0;
    listing = out;
    nftw("stdout", list_file, 16, FTW_PHYS);
    nftw("run", list_file, 16, FTW_PHYS);
    read_errors(out);
}

/* ---- judging ---- */

static const File *find(const Outcome *outcome, const char *name)
{
    for (int i = 0; i < outcome->file_count; i++)
        if (strcmp(outcome->files[i].name, name) == 0)
            return &outcome->files[i];
    return NULL;
}

static bool is_same(const File *whole, const File *got)
{
    return whole->sameness == SAME_NAME ||
           (whole->sameness == SAME_BYTES ? whole->bytes == got->bytes
                                          : whole->words == got->words);
}

/* Why the files are not the whole run's, or NULL. all: none of them may lack. */
static const char *judge_files(const Outcome *whole, const Outcome *got, bool all)
{
    for (int i = !all; i < got->file_count; i++) {
        const File *file = find(whole, got->files[i].name);
        if (!file)
            return "a file that the whole run does not leave";
        if (!is_same(file, &got->files[i]))
            return "another output than the whole run's";
    }
    return all && got->file_count != whole->file_count ? "a file lacks" : NULL;
}

static const char *judge(const Outcome *whole, const Outcome *got)
{
    if (WIFSIGNALED(got->status))
        return WTERMSIG(got->status) == SIGALRM ? "it hangs" : "killed by a signal";
    int code = WEXITSTATUS(got->status);
    if (code == WEXITSTATUS(whole->status))
        return got->lines ? "success with a message" : judge_files(whole, got, true);
    if (code != EXIT_REFUSED)
        return "another exit code";
    if (got->lines != 1 || strncmp(got->message, "peel: ", 6) != 0)
        return "expected one line";
    if (!strstr(got->message, "memory"))
        return "a line that does not say memory";
    return judge_files(whole, got, false);
}

static void say(const char *why, long number, bool for_good, const Outcome *got)
{
    int code = WIFSIGNALED(got->status) ? 128 + WTERMSIG(got->status) : WEXITSTATUS(got->status);
    printf("FAIL at %ld%s: %s: exit %d, %d lines: %s\n", number, for_good ? "+" : "", why, code,
           got->lines, got->message);
    char line[4096];
    int shown = 0;
    FILE *in = got->lines > 1 ? fopen("stderr", "r") : NULL;
    while (in && shown < 25 && fgets(line, sizeof line, in))
        if (strstr(line, " in ") || strstr(line, "ERROR") || strstr(line, "SUMMARY"))
            shown += printf("    %s", line) > 0;
    if (in)
        fclose(in);
}

/* ---- the sweep ---- */

/* Of the whole run's files, what stays in another; false where one is not there. */
static bool note_sameness(Outcome *whole, const Outcome *again)
{
    for (int i = 0; i < whole->file_count; i++) {
        File *file = &whole->files[i];
        const File *other = find(again, file->name);
        if (!other)
            return false;
        Sameness same = file->bytes == other->bytes   ? SAME_BYTES
                        : file->words == other->words ? SAME_BUT_NUMBERS
                                                      : SAME_NAME;
        file->sameness = same > file->sameness ? same : file->sameness;
    }
    return true;
}

/* The whole run, twice. */
static bool measure(int argc, char **argv, Outcome *whole, Outcome *again, long *allocations)
{
    run(argc, argv, 0, false, whole);
    *allocations = atomic_load(&wrap_plan()->counted);
    run(argc, argv, 0, false, again);
    if (!WIFEXITED(whole->status) || WEXITSTATUS(whole->status) >= EXIT_REFUSED || whole->lines ||
        whole->file_count != again->file_count) {
        say("the whole run", 0, false, whole);
        return false;
    }
    return note_sameness(whole, again);
}

typedef struct Sweep {
    int argc;
    char **argv;
    Outcome whole, got, again;
    long runs, refused, wrong;
} Sweep;

static void try_one(Sweep *sweep, long fails_at, bool for_good)
{
    run(sweep->argc, sweep->argv, fails_at, for_good, &sweep->got);
    sweep->runs++;
    const char *why = judge(&sweep->whole, &sweep->got);
    if (why && sweep->got.status == sweep->whole.status) { /* two times may be equal by chance */
        run(sweep->argc, sweep->argv, 0, false, &sweep->again);
        note_sameness(&sweep->whole, &sweep->again);
        why = judge(&sweep->whole, &sweep->got);
    }
    sweep->refused += !why && WEXITSTATUS(sweep->got.status) == EXIT_REFUSED;
    if (why && sweep->wrong++ < SHOWN_MAX)
        say(why, fails_at, for_good, &sweep->got);
}

static int sweep_all(long most, int argc, char **argv)
{
    static Sweep sweep;
    long count;
    sweep.argc = argc;
    sweep.argv = argv;
    if (!measure(argc, argv, &sweep.whole, &sweep.got, &count))
        return EXIT_FAILURE;
    for (long i = 1; !most && i <= count; i++) {
        try_one(&sweep, i, false);
        try_one(&sweep, i, true);
    }
    for (long i = 0; i < most && i < count; i++)
        try_one(&sweep, most < count ? 1 + (2 * i + 1) * count / (2 * most) : i + 1, i % 2);
    printf("%ld allocations, %ld runs: %ld refused, %ld done without, %ld wrong:", count,
           sweep.runs, sweep.refused, sweep.runs - sweep.refused - sweep.wrong, sweep.wrong);
    for (int i = 1; i < argc; i++)
        printf(" %s", argv[i]);
    printf("\n");
    return sweep.wrong ? EXIT_FAILURE : EXIT_SUCCESS;
}

int __wrap_main(int argc, char **argv)
{
    if (argc < 3 || !wrap_begin()) {
        fprintf(stderr, "Usage: faulty RUNS ARGUMENT... | faulty at N[+] ARGUMENT...\n");
        return 2;
    }
    if (strcmp(argv[1], "at") == 0) {
        char *end;
        atomic_store(&wrap_plan()->fails_at, strtol(argv[2], &end, 10));
        atomic_store(&wrap_plan()->for_good, *end == '+');
        return __real_main(argc - 2, argv + 2);
    }
    dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL); /* once, not in every run */
    return sweep_all(strtol(argv[1], NULL, 10), argc - 1, argv + 1);
}
