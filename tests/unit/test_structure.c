/* compare/structure.h on buffers made by hand: each kind of difference, alone and together. */
#include "testing.h"

#include "compare/structure.h"

#define NONE UINT32_MAX

enum {
    WIDTH = 70,
    HEIGHT = 3,
    LAYERS = 5
};

/* One side: ids from front to back at every pixel, and the opaque one. */
typedef struct Side {
    uint32_t opaque[HEIGHT][WIDTH];
    uint32_t peel[LAYERS][HEIGHT][WIDTH];
} Side;

static Side a, b;
static uint8_t same[HEIGHT][WIDTH];

static void fill(void)
{
    memset(&a, 0xff, sizeof a);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            a.opaque[y][x] = 100;
            for (uint32_t k = 0; k < 4; k++)
                a.peel[k][y][x] = 10 + k;
        }
    b = a;
}

static void set(Side *side, int x, int y, const uint32_t ids[LAYERS])
{
    for (int k = 0; k < LAYERS; k++)
        side->peel[k][y][x] = ids[k];
}

static TraceStore *make(const Side *side)
{
    TraceStore *store;
    ck_assert_int_eq(store_create(0, &store), RESULT_OK);
    trace_put(store_sink(store), "opaque.primitive", 0, FORMAT_R32UI, WIDTH, HEIGHT, side->opaque);
    for (int k = 0; k < LAYERS; k++)
        trace_put_peel(store_sink(store), k, "primitive", FORMAT_R32UI, WIDTH, HEIGHT,
                       side->peel[k]);
    return store;
}

static StructureCounts compare(void)
{
    StructureCounts counts;
    TraceStore *store_a = make(&a), *store_b = make(&b);
    memset(same, 7, sizeof same);
    ck_assert_int_eq(structure_compare(store_a, store_b, WIDTH, HEIGHT, same[0], &counts),
                     RESULT_OK);
    store_destroy(store_a);
    store_destroy(store_b);
    return counts;
}

/* All pixels agree but (x, y). */
static void check_same_but(int x, int y)
{
    for (int j = 0; j < HEIGHT; j++)
        for (int i = 0; i < WIDTH; i++)
            if (same[j][i] != !(i == x && j == y))
                ck_abort_msg("(%d, %d): %d", i, j, same[j][i]);
}

static void check_counts(StructureCounts got, uint64_t inversions, uint64_t flips, uint64_t only_a,
                         uint64_t only_b)
{
    ck_assert_uint_eq(got.order_inversions, inversions);
    ck_assert_uint_eq(got.opaque_flips, flips);
    ck_assert_uint_eq(got.only_a, only_a);
    ck_assert_uint_eq(got.only_b, only_b);
}

START_TEST(test_equal)
{
    fill();
    check_counts(compare(), 0, 0, 0, 0);
    check_same_but(-1, -1);
}
END_TEST

START_TEST(test_each_difference)
{
    static const struct {
        uint32_t b[LAYERS];
        uint64_t inversions, only_a, only_b;
    } rows[] = {
        {{10, 12, 11, 13, NONE}, 1, 0, 0},   /* two change places */
        {{13, 12, 11, 10, NONE}, 3, 0, 0},   /* all reversed */
        {{13, 10, 11, 12, NONE}, 1, 0, 0},   /* the last comes first */
        {{10, 11, 13, NONE, NONE}, 0, 1, 0}, /* one missing in b */
        {{10, 11, 12, 14, 13}, 0, 0, 1},     /* one more in b */
        {{20, 11, 12, 13, NONE}, 0, 1, 1},   /* another one */
        {{NONE, NONE, NONE, NONE, NONE}, 0, 4, 0}, {{12, 20, 10, 21, NONE}, 1, 2, 2},
    };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        fill();
        set(&b, 66, 1, rows[i].b); /* in the second, partial tile */
        check_counts(compare(), rows[i].inversions, 0, rows[i].only_a, rows[i].only_b);
        check_same_but(66, 1);
    }
}
END_TEST

/* Which peel a fragment came in does not matter, only the order: an empty peel is passed over. */
START_TEST(test_gaps)
{
    fill();
    set(&b, 3, 2, (const uint32_t[LAYERS]){10, NONE, 11, 12, 13});
    check_counts(compare(), 0, 0, 0, 0);
    check_same_but(-1, -1);
}
END_TEST

/* The raw peel test can repeat a layer: the second is not in truth's list. */
START_TEST(test_repeated)
{
    fill();
    set(&a, 5, 0, (const uint32_t[LAYERS]){10, 11, 11, 12, 13});
    StructureCounts counts = compare();
    ck_assert_uint_eq(counts.opaque_flips, 0);
    ck_assert_uint_eq(counts.only_b, 0);
    check_same_but(5, 0);
}
END_TEST

/* Rounding can fold a triangle, whose other piece lies behind another layer: no order is wrong. */
START_TEST(test_folded)
{
    fill();
    set(&a, 5, 0, (const uint32_t[LAYERS]){10, 11, 12, 11, 13});
    check_counts(compare(), 0, 0, 0, 0);
    check_same_but(5, 0);
}
END_TEST

START_TEST(test_opaque_flip)
{
    fill();
    b.opaque[2][69] = 101;
    b.opaque[2][0] = NONE;
    b.peel[0][2][0] = 55;
    check_counts(compare(), 0, 2, 1, 1);
    ck_assert_int_eq(same[2][69], 0);
    ck_assert_int_eq(same[2][0], 0);
    ck_assert_int_eq(same[1][69], 1);
}
END_TEST

/* A side without any buffer has no fragment anywhere. */
START_TEST(test_empty_store)
{
    fill();
    StructureCounts counts;
    TraceStore *store = make(&a), *empty;
    ck_assert_int_eq(store_create(0, &empty), RESULT_OK);
    ck_assert_int_eq(structure_compare(store, empty, WIDTH, HEIGHT, same[0], &counts), RESULT_OK);
    check_counts(counts, 0, WIDTH * HEIGHT, 4 * WIDTH * HEIGHT, 0);
    ck_assert_int_eq(structure_compare(empty, empty, WIDTH, HEIGHT, same[0], &counts), RESULT_OK);
    check_counts(counts, 0, 0, 0, 0);
    ck_assert_int_eq(same[1][1], STRUCTURE_EMPTY);
    store_destroy(store);
    store_destroy(empty);
}
END_TEST

int main(void)
{
    Suite *suite = suite_create("structure");
    TCase *tcase = tcase_create("structure");
    tcase_add_test(tcase, test_equal);
    tcase_add_test(tcase, test_each_difference);
    tcase_add_test(tcase, test_gaps);
    tcase_add_test(tcase, test_repeated);
    tcase_add_test(tcase, test_folded);
    tcase_add_test(tcase, test_opaque_flip);
    tcase_add_test(tcase, test_empty_store);
    suite_add_tcase(suite, tcase);
    return testing_run(suite);
}
