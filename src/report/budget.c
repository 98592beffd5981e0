#include "report/budget.h"

#include "report/summary.h"

/* What single precision or the method's design does is pale, what is lost or out of order strong;
 * after Okabe and Ito, "Color Universal Design", as far as that goes. */
static const uint8_t colors[CLASS_COUNT][3] = {
    [CLASS_EQUAL] = {16, 16, 20},         [CLASS_OPAQUE_FLIP] = {255, 255, 255},
    [CLASS_COVERAGE] = {86, 180, 233},    [CLASS_LOST_TIE] = {213, 94, 0},
    [CLASS_LOST_LIMIT] = {230, 159, 0},   [CLASS_LOST_BIAS] = {166, 118, 29},
    [CLASS_LOST_OVERFLOW] = {255, 0, 96}, [CLASS_REPEATED] = {240, 228, 66},
    [CLASS_INVERSION] = {204, 121, 167},  [CLASS_METHOD] = {128, 100, 190},
    [CLASS_DEPTH] = {0, 158, 115},        [CLASS_GBUFFER] = {102, 194, 120},
    [CLASS_ACCUM] = {0, 114, 178},        [CLASS_ROUNDING] = {70, 74, 84},
    [CLASS_UNEXPLAINED] = {255, 0, 255},
};

const uint8_t *report_class_color(PixelClass class)
{
    return colors[class];
}

static void print_figure(const char *key, const BudgetFigure *figure, const char *text, FILE *out)
{
    char most[SUMMARY_NUMBER], rmse[SUMMARY_NUMBER], pixels[SUMMARY_NUMBER];
    fprintf(out, "%-12s %9s %9s %11s  %s\n", key, summary_real(figure->max_abs, most),
            summary_real(figure->rmse, rmse), summary_count(figure->pixels, pixels), text);
}

void report_budget_print(const Budget *budget, FILE *out)
{
    char value[SUMMARY_NUMBER];
    fprintf(out, "\n%-12s %9s %9s %11s  %s\n", "budget", "max abs", "RMSE", "pixels",
            "what ref changes from truth");
    for (int i = 0; i < BUDGET_TERMS; i++)
        if (budget->terms[i].measured)
            print_figure(budget_term_key((BudgetTerm)i), &budget->terms[i],
                         budget_term_text((BudgetTerm)i), out);
    print_figure("sum", &budget->sum, "of all of these", out);
    print_figure("total", &budget->total, "ref - truth", out);
    print_figure("unexplained", &budget->unexplained, "total - sum", out);
    fprintf(out, "%.4f %% of the squared error is explained.\n", 100.0 * budget->explained);
    if (budget->nonfinite)
        fprintf(out, "%s pixels that are not finite are left out.\n",
                summary_count(budget->nonfinite, value));
    fprintf(out, "\n%-16s %11s  %-8s %s\n", "class", "pixels", "colour", "ref against truth");
    for (int i = 0; i < CLASS_COUNT; i++)
        if (budget->counts[i])
            fprintf(out, "%-16s %11s  #%02x%02x%02x  %s\n", class_key((PixelClass)i),
                    summary_count(budget->counts[i], value), colors[i][0], colors[i][1],
                    colors[i][2], class_text((PixelClass)i));
}

Result report_classes_image(const Budget *budget, Image *out)
{
    Result result = image_create(budget->width, budget->height, FORMAT_RGBA8, out);
    if (result != RESULT_OK)
        return result;
    uint8_t *pixel = out->pixels;
    for (size_t i = 0; i < (size_t)budget->width * (size_t)budget->height; i++, pixel += 4) {
        for (int c = 0; c < 3; c++)
            pixel[c] = colors[budget->classes[i]][c];
        pixel[3] = 255;
    }
    return RESULT_OK;
}
