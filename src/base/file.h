/* Files that appear whole or not at all: written to a temporary name in the target's directory,
 * renamed into place when complete, removed otherwise. */
#ifndef PEEL_BASE_FILE_H
#define PEEL_BASE_FILE_H

#include "base/result.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Owned by the caller between file_writer_open and file_writer_close; fields are private. */
typedef struct FileWriter {
    FILE *stream;
    char *path;      /* the target, symbolic links followed */
    char *temporary; /* NULL for a device or pipe, which is written directly */
    bool shared;     /* with the standard output or standard error, whose file it is */
    int error;       /* errno of the first failure; 0 while all is well */
} FileWriter;

/* Starts writing path. IO with a message naming path when its directory is missing or refuses, or
 * when path is a directory or a file that may not be written; BAD_INPUT when it is kept
 * (file_keep); *out then needs no close. A file that the standard output or standard error goes to
 * is appended to, in order with what they print. */
Result file_writer_open(const char *path, FileWriter *out);

/* The same to the standard output, which stays open. */
Result file_writer_standard(FileWriter *out);

/* Appends. Failures stick: later calls do nothing, and file_writer_close reports the first one. */
Result file_writer_put(FileWriter *writer, const void *data, size_t size);
Result file_writer_print(FileWriter *writer, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* Writes at a byte offset instead; not to be mixed with the appending calls. */
Result file_writer_put_at(FileWriter *writer, const void *data, size_t size, uint64_t offset);

/* Renames into place if commit is true and nothing failed, else removes the temporary. Frees the
 * writer either way. The failure that decided is the result; OK when commit is false. */
Result file_writer_close(FileWriter *writer, bool commit);

/* size bytes as one file. */
Result file_write(const char *path, const void *data, size_t size);

/* The regular file at path, if there is one, is read by the program: file_writer_open refuses it
 * from now on. Not while other threads write files. */
void file_keep(const char *path);

/* From now on a regular file that was written is kept, too: two outputs must not be one file. */
void file_write_once(void);

/* BAD_INPUT when path is a file that is kept. */
Result file_check_kept(const char *path);

/* The whole of a regular file below 4 GiB. The caller frees *bytes, which has a 0 behind its end.
 * IO when it cannot be read, BAD_INPUT when it is no regular file or too large. */
Result file_load(const char *path, unsigned char **bytes, size_t *count);

/* The first bytes of a regular file, at most size of them, to bytes; *count says how many there
 * are. Failures as above. */
Result file_head(const char *path, void *bytes, size_t size, size_t *count);

/* Unlinks the temporary files of all open writers. For a handler of a signal that ends the
 * program: async-signal-safe. */
void file_remove_temporaries(void);

/* Those signals: sent to end it, by a limit, or, SIGABRT, by libraries that find no memory. 0 is
 * behind the last. */
extern const int file_ending_signals[];

/* Makes a directory and its parents where they are missing. */
Result file_make_directories(const char *path);

#endif
