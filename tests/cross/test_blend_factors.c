/* number/blend.h's model against the driver: all pairs of factors, all functions, all formats. */
#include "labs.h"

#include "blend/equation.h"

static const PixelFormat formats[] = {FORMAT_RGBA8,   FORMAT_RGBA16, FORMAT_RGBA16F,
                                      FORMAT_RGBA32F, FORMAT_RG32F,  FORMAT_R32F};

START_TEST(explore)
{
    int f0 = atoi(getenv("F0")), f1 = atoi(getenv("F1")), mode = atoi(getenv("MODE"));
    labs_open();
    long bad = 0, combos = 0;
    static int runs;
    for (int k = f0; k < f1; k++) {
        PixelFormat format = formats[k];
        const FormatInfo *info = format_info(format);
        LabsDistance distance = info->kind == KIND_FLOAT ? labs_float : info->kind == KIND_HALF ? labs_half : labs_code;
        Random pick = random_seed(7);
        for (int func = 0; func < (mode ? 400 : 3); func++)
            for (int s = 0; s < (mode ? 1 : FACTOR_COUNT); s++)
                for (int d = 0; d < (mode ? 1 : FACTOR_COUNT); d++) {
                    BlendEquation e = {s, d, s, d, func, func};
                    if (mode) {
                        e = (BlendEquation){random_bits(&pick) % 11, random_bits(&pick) % 11, random_bits(&pick) % 11, random_bits(&pick) % 11, random_bits(&pick) % 5, random_bits(&pick) % 5};
                        if (random_bits(&pick) % 2) e.func_alpha = e.func;
                        if (random_bits(&pick) % 4 == 0) {e.destination = e.source; }
                        if (random_bits(&pick) % 4 == 0) {e.destination_alpha = e.source_alpha; }
                    }
                    Experiment x = {.kind = EXPERIMENT_BLEND, .format = format, .equation = e};
                    combos++;
                    for (int n = 0; n < 2; n++) {
                        int set = n == 0 ? 5 : (runs++ % 5 == 4 ? 6 : runs % 5 == 3 ? 7 : runs % 5);
                        if (format == FORMAT_RGBA8 && !model.fused && (1 << set) >= INPUT_WIDE && 1 << set != INPUT_CODES) continue;
                        labs_fill(1 << set, info->unorm_max ? info->unorm_max : 2048.0);
                        labs_run(&x);
                        long count = 0; int first = -1;
                        for (int i = 0; i < 4 * EXPERIMENT_TEXELS; i++)
                            if (expected[i] != got[i] && distance(expected[i], got[i])) { if (first < 0) first = i; count++; }
                        if (count) {
                            char t[EQUATION_TEXT]; equation_print(&e, t); bad++;
                            int i = first / 4;
                            printf("%s %s set %d: %ld, channel %d a %a a.a %a b %a b.a %a: driver %08x model %08x\n", info->name, t, set, count, first % 4, a[i][first % 4], a[i][3], b[i][first % 4], b[i][3], got[first], expected[first]);
                            break;
                        }
                    }
                }
    }
    printf("%ld combos, %ld bad\n", combos, bad);
}
END_TEST
int main(void)
{
    Suite *suite = suite_create("formats");
    TCase *tcase = tcase_create("driver");
    tcase_set_timeout(tcase, 1200);
    tcase_add_test(tcase, explore);
    suite_add_tcase(suite, tcase);
    return testing_run_here(suite);
}
