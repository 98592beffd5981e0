/* base/file: whole files or none. */
#include "base/file.h"

#include "scratch.h"
#include "testing.h"

#include <fcntl.h>
#include <sys/stat.h>

START_TEST(test_write_and_replace)
{
    char text[64];
    const char *path = scratch_path("a.txt");
    ck_assert_int_eq(file_write(path, "first", 5), RESULT_OK);
    ck_assert_int_eq(file_write(path, "second", 6), RESULT_OK);
    scratch_read(path, text, sizeof text);
    ck_assert_str_eq(text, "second");
    ck_assert_int_eq(scratch_entries(), 1);
    struct stat status;
    ck_assert_int_eq(stat(path, &status), 0);
    mode_t mask = umask(0);
    umask(mask);
    ck_assert_int_eq(status.st_mode & 0777, 0666 & ~mask);
}
END_TEST

START_TEST(test_abort_keeps_the_old_file)
{
    char text[64];
    const char *path = scratch_path("a.txt");
    ck_assert_int_eq(file_write(path, "old", 3), RESULT_OK);
    FileWriter writer;
    ck_assert_int_eq(file_writer_open(path, &writer), RESULT_OK);
    ck_assert_int_eq(file_writer_print(&writer, "%d", 42), RESULT_OK);
    ck_assert_int_eq(file_writer_close(&writer, false), RESULT_OK);
    scratch_read(path, text, sizeof text);
    ck_assert_str_eq(text, "old");
    ck_assert_int_eq(scratch_entries(), 1);
}
END_TEST

START_TEST(test_put_at)
{
    char text[64];
    const char *path = scratch_path("a.txt");
    FileWriter writer;
    ck_assert_int_eq(file_writer_open(path, &writer), RESULT_OK);
    ck_assert_int_eq(file_writer_put_at(&writer, "cd", 2, 2), RESULT_OK);
    ck_assert_int_eq(file_writer_put_at(&writer, "ab", 2, 0), RESULT_OK);
    ck_assert_int_eq(file_writer_close(&writer, true), RESULT_OK);
    scratch_read(path, text, sizeof text);
    ck_assert_str_eq(text, "abcd");
}
END_TEST

START_TEST(test_bad_targets)
{
    FileWriter writer;
    const char *paths[] = {scratch_path("no/such/directory/a.txt"), scratch_directory, ""};
    for (int i = 0; i < 3; i++) {
        ck_assert_int_eq(file_writer_open(paths[i], &writer), RESULT_IO);
        ck_assert_msg(strstr(result_message(), paths[i]) != NULL, "no path in: %s",
                      result_message());
    }
    ck_assert_int_eq(scratch_entries(), 0);
}
END_TEST

START_TEST(test_full_disk)
{
    static char bytes[20000];
    const char *path = scratch_path("a.txt");
    char expected[256];
    scratch_limit(1000);
    Result result = file_write(path, bytes, sizeof bytes);
    scratch_limit(RLIM_INFINITY);
    ck_assert_int_eq(result, RESULT_IO);
    snprintf(expected, sizeof expected, "%s: cannot write this file: File too large", path);
    ck_assert_str_eq(result_message(), expected);
    FileWriter writer;
    ck_assert_int_eq(file_writer_open(path, &writer), RESULT_OK);
    scratch_limit(1000);
    Result at = file_writer_put_at(&writer, bytes, 10, 2000);
    scratch_limit(RLIM_INFINITY);
    ck_assert_int_eq(at, RESULT_IO);
    ck_assert_int_eq(file_writer_print(&writer, "more"), RESULT_IO);
    ck_assert_int_eq(file_writer_close(&writer, true), RESULT_IO);
    ck_assert_int_eq(scratch_entries(), 0);
}
END_TEST

/* A device or pipe is written, not replaced by a regular file. */
START_TEST(test_pipe)
{
    const char *path = scratch_path("pipe");
    char text[16] = "";
    ck_assert_int_eq(mkfifo(path, 0600), 0);
    int reader = open(path, O_RDONLY | O_NONBLOCK);
    ck_assert_int_ge(reader, 0);
    ck_assert_int_eq(file_write(path, "through", 7), RESULT_OK);
    ck_assert_int_eq(read(reader, text, sizeof text), 7);
    ck_assert_str_eq(text, "through");
    close(reader);
    struct stat status;
    ck_assert_int_eq(stat(path, &status), 0);
    ck_assert_msg(S_ISFIFO(status.st_mode), "the pipe was replaced");
    ck_assert_int_eq(scratch_entries(), 1);
}
END_TEST

START_TEST(test_symbolic_link_stays)
{
    char text[64];
    const char *link_path = scratch_path("link"), *path = scratch_path("a.txt");
    ck_assert_int_eq(file_write(path, "old", 3), RESULT_OK);
    ck_assert_int_eq(symlink(path, link_path), 0);
    ck_assert_int_eq(file_write(link_path, "new", 3), RESULT_OK);
    struct stat status;
    ck_assert_int_eq(lstat(link_path, &status), 0);
    ck_assert_msg(S_ISLNK(status.st_mode), "the link was replaced");
    scratch_read(path, text, sizeof text);
    ck_assert_str_eq(text, "new");
}
END_TEST

/* A link to nothing: what it names is made, through links of links, relative and absolute. */
START_TEST(test_dangling_link)
{
    char text[64];
    ck_assert_int_eq(file_make_directories(scratch_path("links")), RESULT_OK);
    ck_assert_int_eq(symlink("links/second", scratch_path("first")), 0);
    ck_assert_int_eq(symlink("../third", scratch_path("links/second")), 0);
    ck_assert_int_eq(symlink(scratch_path("a.txt"), scratch_path("third")), 0);
    ck_assert_int_eq(file_write(scratch_path("first"), "new", 3), RESULT_OK);
    static const char *const links[] = {"first", "links/second", "third"};
    for (int i = 0; i < 3; i++) {
        struct stat status;
        ck_assert_int_eq(lstat(scratch_path(links[i]), &status), 0);
        ck_assert_msg(S_ISLNK(status.st_mode), "the link %s was replaced", links[i]);
    }
    scratch_read(scratch_path("a.txt"), text, sizeof text);
    ck_assert_str_eq(text, "new");
    ck_assert_int_eq(scratch_entries(), 4);
    ck_assert_int_eq(symlink("none/b.txt", scratch_path("astray")), 0);
    ck_assert_int_eq(file_write(scratch_path("astray"), "x", 1), RESULT_IO);
    ck_assert_int_eq(symlink("circle", scratch_path("circle")), 0);
    ck_assert_int_eq(file_write(scratch_path("circle"), "x", 1), RESULT_IO);
    ck_assert_int_eq(scratch_entries(), 6);
}
END_TEST

/* The temporary name fits wherever the file's own does. */
START_TEST(test_longest_name)
{
    char path[512], text[64];
    int folder = snprintf(path, sizeof path, "%s/", scratch_directory);
    memset(path + folder, 'n', 256);
    path[folder + 255] = 0;
    for (int i = 0; i < 2; i++)
        ck_assert_msg(file_write(path, "whole", 5) == RESULT_OK, "%s", result_message());
    scratch_read(path, text, sizeof text);
    ck_assert_str_eq(text, "whole");
    path[folder + 255] = 'n';
    path[folder + 256] = 0;
    ck_assert_int_eq(file_write(path, "whole", 5), RESULT_IO);
    ck_assert_int_eq(scratch_entries(), 1);
}
END_TEST

/* Several writers in one folder do not share a temporary file. */
START_TEST(test_writers_side_by_side)
{
    enum {
        WRITERS = 5
    };
    FileWriter writers[WRITERS];
    char name[16], text[16];
    for (int i = 0; i < WRITERS; i++) {
        snprintf(name, sizeof name, "%d.txt", i);
        ck_assert_int_eq(file_writer_open(scratch_path(name), &writers[i]), RESULT_OK);
    }
    for (int i = 0; i < WRITERS; i++) {
        ck_assert_int_eq(file_writer_print(&writers[i], "%d", i), RESULT_OK);
        ck_assert_int_eq(file_writer_close(&writers[i], true), RESULT_OK);
    }
    for (int i = 0; i < WRITERS; i++) {
        snprintf(name, sizeof name, "%d.txt", i);
        scratch_read(scratch_path(name), text, sizeof text);
        ck_assert_int_eq(atoi(text), i);
    }
    ck_assert_int_eq(scratch_entries(), WRITERS);
}
END_TEST

START_TEST(test_directories)
{
    const char *path = scratch_path("a//b/c/");
    ck_assert_int_eq(file_make_directories(path), RESULT_OK);
    ck_assert_int_eq(file_make_directories(path), RESULT_OK);
    ck_assert_int_eq(file_write(scratch_path("a/b/c/file"), "x", 1), RESULT_OK);
    ck_assert_int_eq(file_make_directories(scratch_path("a/b/c/file/d")), RESULT_IO);
    ck_assert_int_eq(file_make_directories(scratch_path("a/b/c/file")), RESULT_IO);
    ck_assert_int_eq(file_make_directories(""), RESULT_IO);
    ck_assert_int_eq(file_make_directories("/proc/peel"), RESULT_IO);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("file");
    TCase *tests = tcase_create("file");
    tcase_add_checked_fixture(tests, scratch_make, scratch_remove);
    tcase_add_test(tests, test_write_and_replace);
    tcase_add_test(tests, test_abort_keeps_the_old_file);
    tcase_add_test(tests, test_put_at);
    tcase_add_test(tests, test_bad_targets);
    tcase_add_test(tests, test_full_disk);
    tcase_add_test(tests, test_pipe);
    tcase_add_test(tests, test_symbolic_link_stays);
    tcase_add_test(tests, test_dangling_link);
    tcase_add_test(tests, test_longest_name);
    tcase_add_test(tests, test_writers_side_by_side);
    tcase_add_test(tests, test_directories);
    suite_add_tcase(suite, tests);
    return testing_run(suite);
}
