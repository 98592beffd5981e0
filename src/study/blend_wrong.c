#include "study/blend_wrong.h"

#include "base/memory.h"
#include "study/blend_probe.h"

#include <stdlib.h>

/* The right arithmetics' results, the exact ones first. */
typedef struct Right {
    unsigned char **pixels;
    size_t count;
} Right;

static void free_right(Right *right)
{
    for (size_t i = 0; i < right->count; i++)
        free(right->pixels[i]);
    free(right->pixels);
}

static Result make_right(const BlendProbe *probe, Right *out)
{
    *out = (Right){memory_array(arithmetic_count(), sizeof *out->pixels), 0};
    for (size_t i = 0; i < arithmetic_count() && out->pixels; i++) {
        const ArithmeticInfo *info = arithmetic_info(i);
        if (arithmetic_is_wrong(info, probe->format) ||
            arithmetic_refuses(&info->arithmetic, &probe->equation, probe->format))
            continue;
        unsigned char *pixels = blend_probe_blend(probe, &info->arithmetic);
        if (!pixels)
            return RESULT_NO_MEMORY;
        out->pixels[out->count++] = pixels;
    }
    return out->pixels ? RESULT_OK : RESULT_NO_MEMORY;
}

static Result show(const BlendProbe *probe, const Right *right, BlendWrong *row)
{
    const unsigned char *const *others = (const unsigned char *const *)right->pixels;
    unsigned char *pixels = blend_probe_blend(probe, &row->info->arithmetic);
    if (!pixels)
        return RESULT_NO_MEMORY;
    row->alone = blend_probe_apart(probe, pixels, right->count, others, &row->example);
    row->shown = row->alone || blend_probe_apart(probe, pixels, 1, others, &row->example);
    for (size_t i = 1; i < right->count && row->shown && !row->alone; i++) {
        BlendExample ignored;
        row->shown = blend_probe_apart(probe, pixels, 1, &others[i], &ignored);
    }
    free(pixels);
    return RESULT_OK;
}

/* Rows of one format and equation, behind those that there are. */
static Result add_pair(PixelFormat format, EquationId equation, size_t effort, BlendWrongList *out)
{
    BlendProbe probe;
    Right right = {0};
    Result result = blend_probe_make(&equation_info(equation)->equation, format, effort, &probe);
    if (result == RESULT_OK)
        result = make_right(&probe, &right);
    for (size_t i = 0; i < arithmetic_count() && result == RESULT_OK; i++) {
        const ArithmeticInfo *info = arithmetic_info(i);
        if (!arithmetic_is_wrong(info, format) ||
            arithmetic_refuses(&info->arithmetic, &probe.equation, format))
            continue;
        BlendWrong *row = &out->rows[out->count++];
        *row = (BlendWrong){.info = info, .format = format, .equation = equation};
        result = show(&probe, &right, row);
    }
    free_right(&right);
    blend_probe_free(&probe);
    return result;
}

static int by_arithmetic(const void *a, const void *b)
{
    const BlendWrong *x = a, *y = b;
    if (x->info != y->info)
        return x->info < y->info ? -1 : 1;
    for (int i = 0; x->format != y->format && i < ARITHMETIC_FORMATS; i++)
        if (arithmetic_formats[i] == x->format || arithmetic_formats[i] == y->format)
            return arithmetic_formats[i] == x->format ? -1 : 1;
    return (int)x->equation - (int)y->equation;
}

Result blend_wrong_list(unsigned formats, EquationId equation, size_t effort, BlendWrongList *out)
{
    *out = (BlendWrongList){
        memory_array(arithmetic_count() * ARITHMETIC_FORMATS * EQUATION_COUNT, sizeof *out->rows),
        0};
    Result result = out->rows ? RESULT_OK : RESULT_NO_MEMORY;
    for (int i = 0; i < ARITHMETIC_FORMATS; i++)
        for (int k = 0; k < EQUATION_COUNT && result == RESULT_OK; k++)
            if ((!formats || formats >> i & 1) &&
                (equation == EQUATION_COUNT || (int)equation == k))
                result = add_pair(arithmetic_formats[i], (EquationId)k, effort, out);
    if (result == RESULT_OK)
        qsort(out->rows, out->count, sizeof *out->rows, by_arithmetic);
    else
        blend_wrong_free(out);
    return result;
}

void blend_wrong_free(BlendWrongList *list)
{
    free(list->rows);
    *list = (BlendWrongList){0};
}

const BlendWrong *blend_wrong_simplest(const BlendWrongList *list, const ArithmeticInfo *info,
                                       PixelFormat format, int *shown, int *all)
{
    const BlendWrong *found = NULL;
    *shown = *all = 0;
    for (size_t i = 0; i < list->count; i++) {
        const BlendWrong *row = &list->rows[i];
        if (row->info != info || row->format != format)
            continue;
        ++*all;
        *shown += row->shown;
        if (row->shown &&
            (!found || (row->alone && !found->alone) ||
             (row->alone == found->alone && row->example.complexity < found->example.complexity)))
            found = row;
    }
    return found;
}
