/* A temporary directory for tests that write files. */
#ifndef PEEL_TESTS_SCRATCH_H
#define PEEL_TESTS_SCRATCH_H

#include <check.h>
#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static char scratch_directory[64];

/* For tcase_add_checked_fixture. */
static inline void scratch_make(void)
{
    strcpy(scratch_directory, "/tmp/peel-test-XXXXXX");
    ck_assert_ptr_nonnull(mkdtemp(scratch_directory));
}

static inline void scratch_remove(void)
{
    char command[128];
    snprintf(command, sizeof command, "rm -rf %s", scratch_directory);
    ck_assert_int_eq(system(command), 0);
}

/* A path in the directory; valid until the fourth next call. */
static inline const char *scratch_path(const char *name)
{
    static char paths[4][128];
    static int next;
    next = (next + 1) % 4;
    snprintf(paths[next], sizeof paths[next], "%s/%s", scratch_directory, name);
    return paths[next];
}

/* Entries of the directory, so that a test can tell that nothing was left behind. */
static inline int scratch_entries(void)
{
    DIR *directory = opendir(scratch_directory);
    ck_assert_ptr_nonnull(directory);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(directory));)
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    closedir(directory);
    return count;
}

/* Makes every write beyond so many bytes of a file fail, as a full disk does (with "File too
 * large"); RLIM_INFINITY ends it. No assertion may stand between the two: check writes files. */
static inline void scratch_limit(rlim_t bytes)
{
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &(struct rlimit){bytes, RLIM_INFINITY});
}

/* The file's text, at most size − 1 bytes; returns their number. */
static inline size_t scratch_read(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "rb");
    ck_assert_msg(file != NULL, "%s cannot be opened", path);
    size_t length = fread(text, 1, size - 1, file);
    text[length] = 0;
    fclose(file);
    return length;
}

/* What a command prints on stdout and stderr together, at most size − 1 bytes; returns its exit
 * status. */
static inline int scratch_run(const char *command, char *text, size_t size)
{
    FILE *pipe = popen(command, "r");
    ck_assert_ptr_nonnull(pipe);
    size_t length = fread(text, 1, size - 1, pipe);
    text[length] = 0;
    while (fgetc(pipe) != EOF)
        continue;
    return pclose(pipe);
}

#endif
