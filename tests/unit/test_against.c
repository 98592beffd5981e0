/* compare/against.h: buffers that match, differ, are missing, are too many or come in pieces. */
#include "testing.h"

#include "compare/against.h"

enum {
    WIDTH = 130,
    HEIGHT = 70
};

static TraceStore *reference;
static Against against;
static float values[HEIGHT][WIDTH][4];

static void setup(void)
{
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 4; c++)
                values[y][x][c] = (float)((y * WIDTH + x) * 4 + c);
    ck_assert_int_eq(store_create(0, &reference), RESULT_OK);
    TraceSink *sink = store_sink(reference);
    trace_put(sink, "opaque.normal", 0, FORMAT_RGBA32F, WIDTH, HEIGHT, values);
    trace_put(sink, "opaque.primitive", 0, FORMAT_R32UI, WIDTH, HEIGHT, values);
    trace_put(sink, "accum", 1, FORMAT_RGBA32F, WIDTH, HEIGHT, values);
    against = against_of(reference);
}

static void teardown(void)
{
    against_free(&against);
    store_destroy(reference);
}

static void put(const char *name)
{
    ck_assert_int_eq(trace_put(&against.sink, name, 0, FORMAT_RGBA32F, WIDTH, HEIGHT, values),
                     RESULT_OK);
}

static void put_rectangle(const char *name, int x, int y)
{
    TraceBuffer buffer = {.name = name,
                          .format = FORMAT_RGBA32F,
                          .image_width = WIDTH,
                          .image_height = HEIGHT,
                          .x = x,
                          .y = y,
                          .width = x + TRACE_TILE > WIDTH ? WIDTH - x : TRACE_TILE,
                          .height = y + TRACE_TILE > HEIGHT ? HEIGHT - y : TRACE_TILE,
                          .pixels = values[y][x],
                          .row_bytes = sizeof values[0]};
    ck_assert_int_eq(against.sink.put(&against.sink, &buffer), RESULT_OK);
}

static void check_row(size_t row, const char *name, uint64_t differing)
{
    ck_assert_uint_lt(row, against.count);
    ck_assert_str_eq(against.buffers[row].name, name);
    ck_assert_uint_eq(against.buffers[row].values, WIDTH * HEIGHT * 4);
    ck_assert_uint_eq(against.buffers[row].differing, differing);
    ck_assert(against.buffers[row].has_first == (differing > 0));
}

START_TEST(test_equal)
{
    put("opaque.normal");
    put("accum");
    ck_assert_int_eq(against_finish(&against), RESULT_OK);
    ck_assert_uint_eq(against.count, 2); /* the diagnostic buffer is no row */
    check_row(0, "opaque.normal", 0);
    check_row(1, "accum", 0);
}
END_TEST

START_TEST(test_differs)
{
    values[69][129][3] += 1024.0f;
    values[0][64][0] = -1.0f;
    put("accum");
    put("opaque.primitive"); /* left out, whatever it holds */
    ck_assert_int_eq(against_finish(&against), RESULT_OK);
    ck_assert_uint_eq(against.count, 2);
    check_row(0, "accum", 2);
    ck_assert_int_eq(against.buffers[0].first[0], 64);
    ck_assert_int_eq(against.buffers[0].first[1], 0);
    ck_assert_double_eq(against.buffers[0].max_abs, 1024.0);
    check_row(1, "opaque.normal", WIDTH * HEIGHT * 4); /* never came */
}
END_TEST

START_TEST(test_unknown)
{
    put("opaque.normal");
    put("accum");
    put("peel.0.accum");
    ck_assert_int_eq(against_finish(&against), RESULT_OK);
    ck_assert_uint_eq(against.count, 3);
    check_row(2, "peel.0.accum", WIDTH * HEIGHT * 4);
}
END_TEST

START_TEST(test_other_size_or_format)
{
    trace_put(&against.sink, "accum", 0, FORMAT_RGBA32F, HEIGHT, WIDTH, values);
    trace_put(&against.sink, "opaque.normal", 0, FORMAT_RGBA16, WIDTH, HEIGHT, values);
    ck_assert_int_eq(against_finish(&against), RESULT_OK);
    ck_assert_uint_eq(against.count, 2);
    check_row(0, "accum", WIDTH * HEIGHT * 4);
    check_row(1, "opaque.normal", WIDTH * HEIGHT * 4);
}
END_TEST

/* Rectangles make one row; those that never come count as differing. */
START_TEST(test_rectangles)
{
    for (int y = 0; y < HEIGHT; y += TRACE_TILE)
        for (int x = 0; x < WIDTH; x += TRACE_TILE) {
            put_rectangle("accum", x, y);
            if (x + y > 0)
                put_rectangle("opaque.normal", x, y);
        }
    ck_assert_int_eq(against_finish(&against), RESULT_OK);
    ck_assert_uint_eq(against.count, 2);
    check_row(0, "accum", 0);
    check_row(1, "opaque.normal", TRACE_TILE * TRACE_TILE * 4);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("against");
    TCase *tcase = tcase_create("against");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_add_test(tcase, test_equal);
    tcase_add_test(tcase, test_differs);
    tcase_add_test(tcase, test_unknown);
    tcase_add_test(tcase, test_other_size_or_format);
    tcase_add_test(tcase, test_rectangles);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
