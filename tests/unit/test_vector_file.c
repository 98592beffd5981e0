/* blend/vector_file.h: what is written reads back, and nothing malformed does. */
#include "testing.h"

#include "base/file.h"
#include "base/random.h"
#include "blend/sequence.h"
#include "blend/vector_results.h"
#include "scratch.h"
#include "vector_damages.h"

#include <inttypes.h>
#include <math.h>

enum {
    TEXT = 1 << 20
};

static char text[TEXT], work[TEXT];
static float source[VECTOR_BLOCK][4];
static unsigned char destination[VECTOR_BLOCK * 16], results[VECTOR_BLOCK * 16];
static bool given[SEQUENCE_LAYERS_MAX];
static const Arithmetic exact;

static const PixelFormat formats[] = {FORMAT_RGBA8,   FORMAT_RGBA16, FORMAT_RGBA16F,
                                      FORMAT_RGBA32F, FORMAT_RG32F,  FORMAT_R32F};

static VectorHeader header_of(VectorSet set, PixelFormat format, uint64_t first, uint64_t count)
{
    VectorHeader header = {.spec = {set, format, 1, first + count}, .first = first, .count = count};
    header.equation = equation_info(EQUATION_UNDER)->equation;
    strcpy(header.arithmetic, "exact");
    return header;
}

static const char *write_set(VectorForm form, const VectorHeader *header)
{
    const char *path = scratch_path("vectors");
    ck_assert_msg(vector_results_write(path, form, header, &exact) == RESULT_OK, "%s",
                  result_message());
    return path;
}

/* Reads all of a file; RESULT_OK and how many, or the failure. */
static Result read_file(const char *path, VectorHeader *header, uint64_t *count)
{
    VectorReader *reader = NULL;
    *count = 0;
    Result result = vector_reader_open(path, header, &reader);
    size_t some = 1;
    while (result == RESULT_OK && some) {
        int layers = 0;
        if (header->spec.set == VECTORS_SEQUENCES) {
            result = vector_reader_next_sequence(reader, &layers, source, results, given);
            some = layers > 0;
        } else {
            result = vector_reader_next(reader, source, destination, results, &some);
        }
        *count += some;
    }
    vector_reader_close(reader);
    return result;
}

static Result read_text(const char *bytes, size_t size, uint64_t *count)
{
    VectorHeader header;
    const char *path = scratch_path("changed");
    ck_assert_int_eq(file_write(path, bytes, size), RESULT_OK);
    return read_file(path, &header, count);
}

/* ---- round trips ---- */

static void check_results(const VectorHeader *header, size_t count, uint64_t at)
{
    static float expected_source[VECTOR_BLOCK][4];
    static unsigned char expected[VECTOR_BLOCK * 16];
    PixelFormat format = header->spec.format;
    size_t size = format_pixel_bytes(format);
    vectors_make(&header->spec, header->first + at, count, expected_source, expected);
    ck_assert_int_eq(memcmp(source, expected_source, count * sizeof *source), 0);
    ck_assert_int_eq(memcmp(destination, expected, count * size), 0);
    arithmetic_blend(&exact, &header->equation, format, count, (const float(*)[4])source, expected);
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < format_info(format)->channels; c++)
            ck_assert_uint_eq(format_ulp(format_info(format)->kind,
                                         format_bits(format, expected + i * size, c),
                                         format_bits(format, results + i * size, c)),
                              0);
}

START_TEST(test_vectors_round_trip)
{
    for (int form = 0; form < VECTOR_FORM_COUNT; form++)
        for (int set = VECTORS_DIRECTED; set <= VECTORS_RANDOM; set++) {
            VectorHeader header = header_of((VectorSet)set, formats[_i], 259001, 9001), found;
            const char *path = write_set((VectorForm)form, &header);
            VectorReader *reader;
            size_t count;
            uint64_t at = 0;
            ck_assert_int_eq(vector_reader_open(path, &found, &reader), RESULT_OK);
            ck_assert_int_eq(memcmp(&found.equation, &header.equation, sizeof found.equation), 0);
            ck_assert_str_eq(found.arithmetic, "exact");
            ck_assert_uint_eq(found.first, 259001);
            do {
                ck_assert_msg(vector_reader_next(reader, source, destination, results, &count) ==
                                  RESULT_OK,
                              "%s", result_message());
                check_results(&header, count, at);
                at += count;
            } while (count);
            ck_assert_uint_eq(at, 9001);
            vector_reader_close(reader);
        }
}
END_TEST

START_TEST(test_sequences_round_trip)
{
    static float layers[SEQUENCE_LAYERS_MAX][4];
    static unsigned char pixels[SEQUENCE_LAYERS_MAX * 16];
    PixelFormat format = formats[_i];
    size_t size = format_pixel_bytes(format);
    for (int form = 0; form < VECTOR_FORM_COUNT; form++) {
        VectorHeader header = header_of(VECTORS_SEQUENCES, format, 95, 30), found;
        const char *path = write_set((VectorForm)form, &header);
        VectorReader *reader;
        ck_assert_int_eq(vector_reader_open(path, &found, &reader), RESULT_OK);
        for (uint64_t i = 0; i <= 30; i++) {
            int count, expected = i < 30 ? sequence_make(&header.spec, 95 + i, layers) : 0;
            ck_assert_msg(vector_reader_next_sequence(reader, &count, source, results, given) ==
                              RESULT_OK,
                          "%s", result_message());
            ck_assert_int_eq(count, expected);
            if (count == 0)
                break;
            ck_assert_int_eq(memcmp(source, layers, (size_t)count * sizeof *layers), 0);
            sequence_blend(&exact, format, count, (const float(*)[4])layers, pixels);
            ck_assert_int_eq(memcmp(results, pixels, (size_t)count * size), 0);
            for (int k = 0; k < count; k++)
                ck_assert(given[k]);
        }
        vector_reader_close(reader);
    }
}
END_TEST

/* ---- what people may do to a file ---- */

static size_t load(VectorForm form, VectorSet set, PixelFormat format, uint64_t count)
{
    VectorHeader header = header_of(set, format, 0, count);
    size_t size = scratch_read(write_set(form, &header), text, TEXT);
    ck_assert_uint_lt(size, TEXT - 1);
    return size;
}

/* Every `from` of text becomes `to`, in work; returns the size. */
static size_t replace(const char *from, const char *to, int most)
{
    char *out = work;
    const char *at = text;
    for (const char *next; most && (next = strstr(at, from)); most--) {
        memcpy(out, at, (size_t)(next - at));
        out = stpcpy(out + (next - at), to);
        at = next + strlen(from);
    }
    strcpy(out, at);
    return strlen(work);
}

static void reads(const char *what, size_t size, uint64_t expected)
{
    uint64_t count;
    ck_assert_msg(read_text(work, size, &count) == RESULT_OK, "%s: %s", what, result_message());
    ck_assert_uint_eq(count, expected);
}

START_TEST(test_accepted)
{
    for (int form = 0; form < VECTOR_BINARY; form++) {
        load((VectorForm)form, VECTORS_DIRECTED, FORMAT_RGBA16F, 200);
        reads("CRLF", replace("\n", "\r\n", -1), 200);
        reads("no final newline", replace("\n", "\n", -1) - 1, 200);
        strcat(strcpy(work, text), "\r\n \n");
        reads("blank lines behind", strlen(work), 200);
        reads("blanks", replace(",", " , ", -1), 200);
        reads("no note",
              replace(form ? ",\"arithmetic\":\"exact\"" : "# arithmetic: exact\n", "", 1), 200);
        reads("NaN in other words", replace("nan", "-NaN", -1), 200);
    }
    load(VECTOR_CSV, VECTORS_DIRECTED, FORMAT_RGBA8, 5);
    reads("a comment", replace("# set", "# made by: me\n#\n# nothing\n# set", 1), 5);
    load(VECTOR_JSON_LINES, VECTORS_RANDOM, FORMAT_RGBA32F, 5);
    reads("numbers", replace("\"0x1p+0\"", "1.0", -1), 5);
}
END_TEST

/* Whatever somebody wrote: what is read can be written in every form. */
START_TEST(test_note)
{
    VectorHeader header;
    uint64_t count;
    const char *path = scratch_path("changed");
    load(VECTOR_CSV, VECTORS_RANDOM, FORMAT_RGBA8, 2);
    size_t size = replace("arithmetic: exact", "arithmetic:  my \"own\"\\\xe4\033 one ", 1);
    ck_assert_int_eq(file_write(path, work, size), RESULT_OK);
    ck_assert_int_eq(read_file(path, &header, &count), RESULT_OK);
    ck_assert_str_eq(header.arithmetic, "my ?own???? one");
}
END_TEST

/* Of sequences only the last pixel need be there. */
START_TEST(test_last_only)
{
    uint64_t count;
    load(VECTOR_CSV, VECTORS_SEQUENCES, FORMAT_RGBA8, 1);
    char *row = strstr(text, "\n0,2,0,") + 1, *at = row;
    for (int commas = 0; commas < 7; at++)
        commas += *at == ',';
    char *rest = strstr(at, ",,,,,,,,,,,,,,,,\n");
    memmove(at + 3, rest, strlen(rest) + 1);
    memcpy(at, ",,,", 3);
    ck_assert_msg(read_text(text, strlen(text), &count) == RESULT_OK, "%s", result_message());
    ck_assert(!given[0] && given[1]);
    size_t size = load(VECTOR_BINARY, VECTORS_SEQUENCES, FORMAT_RGBA8, 1);
    text[12] = 1; /* two layers, of which the first's pixel goes */
    memmove(text + 296 + 4 + 32, text + 296 + 4 + 36, size - (296 + 4 + 36));
    ck_assert_msg(read_text(text, size - 4, &count) == RESULT_OK, "%s", result_message());
    ck_assert(!given[0] && given[1]);
}
END_TEST

/* ---- malformed files ---- */

static void check_damage(const Damage *damage, const char *form)
{
    char message[600];
    uint64_t count;
    ck_assert_msg(strstr(text, damage->from) != NULL, "%s: '%s' is not there", form, damage->from);
    size_t size = replace(damage->from, damage->to, 1);
    Result result = read_text(work, size, &count);
    snprintf(message, sizeof message, "%s%s", scratch_path("changed"), damage->message);
    ck_assert_msg(result == RESULT_BAD_INPUT &&
                      strncmp(result_message(), message, strlen(message)) == 0 &&
                      !strchr(result_message(), '\n'),
                  "%s, '%s' to '%s':\n got      %s\n expected %s", form, damage->from, damage->to,
                  result == RESULT_OK ? "no failure" : result_message(), message);
}

START_TEST(test_malformed_text)
{
    load(VECTOR_CSV, VECTORS_DIRECTED, FORMAT_RGBA16F, 9);
    for (size_t i = 0; i < sizeof csv_damages / sizeof *csv_damages; i++)
        check_damage(&csv_damages[i], "CSV");
    load(VECTOR_JSON_LINES, VECTORS_DIRECTED, FORMAT_RGBA16F, 9);
    for (size_t i = 0; i < sizeof json_damages / sizeof *json_damages; i++)
        check_damage(&json_damages[i], "JSON");
}
END_TEST

static void refused(const char *bytes, size_t size, const char *message)
{
    uint64_t count;
    Result result = read_text(bytes, size, &count);
    ck_assert_msg(result == RESULT_BAD_INPUT && strstr(result_message(), message),
                  "got '%s', expected '%s'", result == RESULT_OK ? "" : result_message(), message);
}

START_TEST(test_malformed_bytes)
{
    static char line[(1 << 22) + 100];
    refused("", 0,
            "changed:1: no file of 'peel blend vectors': expected '# peel-blend-vectors: 1'");
    refused("\x89PNG", 4, "changed:1: no file of 'peel blend vectors'");
    refused("# peel-blend-vectors: 1\n# \0\n", 28, "changed:2: a zero byte, expected text");
    memset(line, 'x', sizeof line);
    memcpy(line, "# peel-blend-vectors: 1\n", 24);
    refused(line, sizeof line, "changed:2: a line of more than 4194304 bytes");
    memset(line, '[', sizeof line);
    line[0] = '{';
    refused(line, 1 << 20, "changed:1: column");
    size_t size = load(VECTOR_BINARY, VECTORS_RANDOM, FORMAT_RGBA8, 3);
    text[8] = 9;
    refused(text, size, "changed: byte 296: vectors of version '9', expected 1");
    text[8] = 1;
    text[12] = 2;
    refused(text, size, "flags 2, expected 0 or 1");
    text[12] = 0;
    text[296 + 17] ^= 1;
    refused(text, size, "changed: byte 320: destination_g is");
    text[296 + 17] ^= 1;
    text[size] = 0;
    refused(text, size + 1, "expected the file's end");
    text[size - 1] ^= 1;
    refused(text, size, "checksum of the operands");
    memset(text + 56, 'x', 16);
    refused(text, size, "a text of the head without its final zero byte");
}
END_TEST

/* Cut anywhere, it is refused. */
START_TEST(test_truncated)
{
    static const VectorSet sets[] = {VECTORS_RANDOM, VECTORS_SEQUENCES};
    for (int i = 0; i < 2; i++) {
        size_t size = load((VectorForm)_i, sets[i], FORMAT_RGBA16F, 2);
        size_t least = _i == VECTOR_BINARY ? size : size - 1; /* a final newline may miss */
        for (size_t cut = 0; cut < least; cut++) {
            uint64_t count;
            ck_assert_msg(read_text(text, cut, &count) == RESULT_BAD_INPUT, "cut at %zu of %zu",
                          cut, size);
            ck_assert_msg(strncmp(result_message(), scratch_path("changed"), 20) == 0, "%s",
                          result_message());
        }
    }
}
END_TEST

/* Bytes changed, put in, taken out, at random: read or refused in one line, never more. */
START_TEST(test_fuzz)
{
    const char *wanted = getenv("PEEL_TEST_COUNT");
    int runs = wanted ? atoi(wanted) : testing_samples(3000);
    static const VectorSet sets[] = {VECTORS_DIRECTED, VECTORS_RANDOM, VECTORS_SEQUENCES};
    Random random = random_seed(1234 + (uint64_t)_i);
    size_t size = 0;
    for (int run = 0; run < runs; run++) {
        uint64_t pick = random_bits(&random), count;
        if (run % 50 == 0)
            size = load((VectorForm)_i, sets[pick % 3], formats[pick / 3 % 4], 1 + pick / 64 % 4);
        memcpy(work, text, size);
        size_t now = size;
        for (int changes = 1 + (int)(pick >> 60) % 4; changes > 0; changes--) {
            size_t at = random_bits(&random) % now, length = 1 + random_bits(&random) % 8;
            pick = random_bits(&random);
            length = at + length > now ? now - at : length;
            if (pick % 4 == 0) {
                memmove(work + at, work + at + length, now - at - length);
                now -= length;
            } else if (pick % 4 == 1) {
                memmove(work + at + length, work + at, now - at);
                now += length;
            } else {
                char other = "0123456789abcdefpx.,-+\n\"[]{}:# "[(pick >> 8) % 32];
                work[at] = pick % 4 == 2 ? (char)(pick >> 8) : other;
            }
        }
        Result result = read_text(work, now, &count);
        ck_assert(result == RESULT_OK || result == RESULT_BAD_INPUT);
        ck_assert(result == RESULT_OK || !strchr(result_message(), '\n'));
    }
}
END_TEST

/* ---- failing writes ---- */

START_TEST(test_failing_writes)
{
    VectorHeader header = header_of(VECTORS_RANDOM, FORMAT_RGBA32F, 0, 20000);
    for (int form = 0; form < VECTOR_FORM_COUNT; form++) {
        ck_assert_int_eq(vector_results_write("/dev/full", (VectorForm)form, &header, &exact),
                         RESULT_IO);
        ck_assert_str_eq(result_message(),
                         "/dev/full: cannot write this file: No space left on device");
        ck_assert_int_eq(vector_results_write("/no/such/place", (VectorForm)form, &header, &exact),
                         RESULT_IO);
        const char *path = scratch_path("limited");
        scratch_limit(100000);
        Result result = vector_results_write(path, (VectorForm)form, &header, &exact);
        scratch_limit(RLIM_INFINITY);
        ck_assert_int_eq(result, RESULT_IO);
        ck_assert_int_eq(scratch_entries(), 0);
    }
}
END_TEST

START_TEST(test_unreadable)
{
    VectorHeader header;
    uint64_t count;
    ck_assert_int_eq(read_file("/no/such/file", &header, &count), RESULT_IO);
    ck_assert_str_eq(result_message(), "/no/such/file: cannot read: No such file or directory");
    ck_assert_int_eq(read_file("/tmp", &header, &count), RESULT_IO);
    ck_assert_str_eq(result_message(), "/tmp: cannot read: Is a directory");
}
END_TEST

/* ---- checksums ---- */

START_TEST(test_checksums)
{
    VectorHeader header = header_of(VECTORS_RANDOM, FORMAT_RGBA16, 3, 5000);
    static const Arithmetic swapped = {.kind = ARITHMETIC_STEPS,
                                       .mistakes = 1u << MISTAKE_FACTORS_SWAPPED};
    const Arithmetic *arithmetics[] = {&exact, &swapped};
    char operands[VECTOR_DIGEST_TEXT], sums[2][VECTOR_DIGEST_TEXT], end[512], own[2][80];
    ck_assert_int_eq(vector_results_checksums(&header, 2, arithmetics, 0, operands, sums),
                     RESULT_OK);
    const char *path = write_set(VECTOR_CSV, &header);
    scratch_read(path, text, TEXT);
    snprintf(end, sizeof end, "tail -n 1 %s | cut -d ' ' -f 4 | tr -d '\\n'", path);
    ck_assert_int_eq(scratch_run(end, own[0], sizeof own[0]), 0);
    ck_assert_str_eq(own[0], operands);
    path = write_set(VECTOR_BINARY, &header);
    VectorReader *reader;
    size_t some;
    FILE *raw = fopen(scratch_path("raw"), "wb");
    ck_assert_int_eq(vector_reader_open(path, &header, &reader), RESULT_OK);
    do {
        ck_assert_int_eq(vector_reader_next(reader, source, destination, results, &some),
                         RESULT_OK);
        ck_assert_uint_eq(fwrite(results, 8, some, raw), some);
    } while (some);
    vector_reader_close(reader);
    ck_assert_int_eq(fclose(raw), 0);
    snprintf(end, sizeof end, "sha256sum <%s | cut -c 1-64 | tr -d '\\n'", scratch_path("raw"));
    ck_assert_int_eq(scratch_run(end, own[1], sizeof own[1]), 0);
    ck_assert_str_eq(own[1], sums[0]);
    ck_assert_str_ne(sums[0], sums[1]);
}
END_TEST

/* Of several batches, and of sequences: any number of threads gives the same. */
START_TEST(test_checksums_threads)
{
    VectorHeader header = _i ? header_of(VECTORS_SEQUENCES, FORMAT_RGBA16F, 5, 40)
                             : header_of(VECTORS_RANDOM, FORMAT_RGBA8, 5, 140000);
    const Arithmetic driver = {.kind = ARITHMETIC_DRIVER}, steps = {.kind = ARITHMETIC_STEPS};
    const Arithmetic *arithmetics[] = {&exact, &driver, &steps};
    char operands[2][VECTOR_DIGEST_TEXT], sums[2][3][VECTOR_DIGEST_TEXT];
    for (int k = 0; k < 2; k++)
        ck_assert_int_eq(
            vector_results_checksums(&header, 3, arithmetics, k ? 3 : 1, operands[k], sums[k]),
            RESULT_OK);
    ck_assert_str_eq(operands[0], operands[1]);
    for (int k = 0; k < 3; k++)
        ck_assert_str_eq(sums[0][k], sums[1][k]);
    ck_assert_str_ne(sums[0][0], sums[0][1]);
    ck_assert_str_ne(sums[0][1], sums[0][2]);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("vector_file");
    TCase *tcase = tcase_create("vector_file");
    tcase_set_timeout(tcase, 600);
    tcase_add_checked_fixture(tcase, scratch_make, scratch_remove);
    tcase_add_loop_test(tcase, test_vectors_round_trip, 0, 6);
    tcase_add_loop_test(tcase, test_sequences_round_trip, 0, 4);
    tcase_add_test(tcase, test_accepted);
    tcase_add_test(tcase, test_note);
    tcase_add_test(tcase, test_last_only);
    tcase_add_test(tcase, test_malformed_text);
    tcase_add_test(tcase, test_malformed_bytes);
    tcase_add_loop_test(tcase, test_truncated, 0, VECTOR_FORM_COUNT);
    tcase_add_loop_test(tcase, test_fuzz, 0, VECTOR_FORM_COUNT);
    tcase_add_test(tcase, test_failing_writes);
    tcase_add_test(tcase, test_unreadable);
    tcase_add_test(tcase, test_checksums);
    tcase_add_loop_test(tcase, test_checksums_threads, 0, 2);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
