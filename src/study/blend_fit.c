#include "study/blend_fit.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

typedef struct FitList {
    Arithmetic *items;
    size_t count, capacity;
    const BlendEquation *equation;
    PixelFormat format;
    Result result;
} FitList;

static bool equal(const Arithmetic *a, const Arithmetic *b)
{
    return a->kind == b->kind && a->precision == b->precision && a->rounding == b->rounding &&
           a->store == b->store && a->product == b->product && a->fused == b->fused &&
           a->flush == b->flush && a->source_stored == b->source_stored &&
           a->mistakes == b->mistakes;
}

const ArithmeticInfo *blend_fit_name(const Arithmetic *arithmetic)
{
    for (size_t i = 0; i < arithmetic_count(); i++)
        if (equal(&arithmetic_info(i)->arithmetic, arithmetic))
            return arithmetic_info(i);
    return NULL;
}

static void add(FitList *list, Arithmetic arithmetic)
{
    if (list->result != RESULT_OK || blend_fit_name(&arithmetic) ||
        arithmetic_refuses(&arithmetic, list->equation, list->format))
        return;
    void *items = list->items;
    list->result = memory_grow(&items, &list->capacity, list->count + 1, sizeof *list->items);
    list->items = items;
    if (list->result == RESULT_OK)
        list->items[list->count++] = arithmetic;
}

/* Codes are exact but for their products and the stored source. */
static void add_codes(FitList *list)
{
    for (int product = CODES_NEAREST; product <= CODES_RECIPROCAL; product++)
        for (int store = BLEND_NEAREST_EVEN; store <= BLEND_UPWARD; store++)
            add(list, (Arithmetic){.kind = ARITHMETIC_STEPS,
                                   .precision = PRECISION_CODES,
                                   .product = (CodeProduct)product,
                                   .store = (BlendRounding)store});
}

static void add_numbers(FitList *list, BlendPrecision precision, BlendRounding rounding)
{
    for (int store = BLEND_NEAREST_EVEN; store <= BLEND_UPWARD; store++)
        for (int bits = 0; bits < 8; bits++)
            add(list, (Arithmetic){.kind = ARITHMETIC_STEPS,
                                   .precision = precision,
                                   .rounding = rounding,
                                   .store = (BlendRounding)store,
                                   .fused = bits & 1,
                                   .flush = bits >> 1 & 1,
                                   .source_stored = bits >> 2 & 1});
}

static void add_mistakes(FitList *list)
{
    for (size_t i = 0; i < arithmetic_count(); i++)
        for (int mistake = 0; mistake < MISTAKE_COUNT; mistake++) {
            const ArithmeticInfo *info = arithmetic_info(i);
            Arithmetic arithmetic = info->arithmetic;
            arithmetic.mistakes |= 1u << mistake;
            if (!info->wrong && info->arithmetic.kind == ARITHMETIC_STEPS)
                add(list, arithmetic);
        }
}

static int distance(const Arithmetic *a)
{
    return (a->precision != PRECISION_FLOAT) + (a->rounding != BLEND_NEAREST_EVEN) +
           (a->store != BLEND_NEAREST_EVEN) + (a->product != CODES_NEAREST) + a->fused + a->flush +
           a->source_stored + 8 * __builtin_popcount(a->mistakes);
}

/* A stable sort by distance: it has few values. */
static void sort(FitList *list, Arithmetic *out)
{
    size_t at = 0;
    for (int wanted = 0; at < list->count; wanted++)
        for (size_t i = 0; i < list->count; i++)
            if (distance(&list->items[i]) == wanted)
                out[at++] = list->items[i];
}

Result blend_fit_list(const BlendEquation *equation, PixelFormat format, Arithmetic **out,
                      size_t *count)
{
    FitList list = {.equation = equation, .format = format};
    add_codes(&list);
    for (int rounding = BLEND_NEAREST_EVEN; rounding <= BLEND_UPWARD; rounding++) {
        add_numbers(&list, PRECISION_FLOAT, (BlendRounding)rounding);
        add_numbers(&list, PRECISION_HALF, (BlendRounding)rounding);
    }
    add_numbers(&list, PRECISION_DOUBLE, BLEND_NEAREST_EVEN);
    add_mistakes(&list);
    *out = list.result == RESULT_OK ? memory_array(list.count, sizeof **out) : NULL;
    if (*out)
        sort(&list, *out);
    *count = list.count;
    free(list.items);
    return *out ? RESULT_OK : RESULT_NO_MEMORY;
}
