#include "frame/sort.h"

#include "base/memory.h"
#include "number/op.h"

#include <stdlib.h>

typedef struct Item {
    double z; /* view space, sum over the corners divided by their number; far is small */
    uint32_t primitive;
    SortRun run;
} Item;

/* Ids are distinct, so the order is total and qsort's own does not matter. */
static int farther(const void *left, const void *right)
{
    const Item *a = left, *b = right;
    if (a->z != b->z)
        return a->z < b->z ? -1 : 1;
    return a->primitive < b->primitive ? -1 : a->primitive > b->primitive;
}

/* The mean view-space z of the corners of `count` triangles. */
static double centroid_z(const Mesh *mesh, const float model_view[16], uint32_t first,
                         uint32_t count)
{
    double sum = 0.0;
    for (size_t i = 3 * (size_t)first; i < 3 * ((size_t)first + count); i++) {
        const float *p = &mesh->position[3 * (size_t)mesh->index[i]];
        sum += (double)model_view[2] * (double)p[0] + (double)model_view[6] * (double)p[1] +
               (double)model_view[10] * (double)p[2] + (double)model_view[14];
    }
    return sum / (3.0 * (double)count);
}

static size_t item_count(const Scene *scene, const View *view, SortUnit unit)
{
    size_t count = 0;
    for (size_t i = 0; i < view->draw_count; i++)
        if (view->draws[i].transparent)
            count += unit == SORT_TRIANGLES ? scene->meshes[view->draws[i].mesh].triangle_count : 1;
    return count;
}

uint64_t sort_bytes(const Scene *scene, const View *view, SortUnit unit)
{
    return (uint64_t)item_count(scene, view, unit) * (sizeof(Item) + sizeof(SortRun));
}

static void fill(const Scene *scene, const View *view, SortUnit unit, Item *items)
{
    for (size_t i = 0; i < view->draw_count; i++) {
        const Draw *draw = &view->draws[i];
        const Mesh *mesh = &scene->meshes[draw->mesh];
        uint32_t step = unit == SORT_TRIANGLES ? 1 : mesh->triangle_count;
        for (uint32_t t = 0; draw->transparent && t < mesh->triangle_count; t += step)
            *items++ = (Item){centroid_z(mesh, draw->model_view, t, step),
                              draw->first_primitive + t,
                              {(uint32_t)i, t, step}};
    }
}

/* Puts together what follows in the order and in the mesh. */
static void join(const Item *items, size_t count, Sort *out)
{
    for (size_t i = 0; i < count; i++) {
        SortRun *last = out->count ? &out->runs[out->count - 1] : NULL;
        const SortRun *run = &items[i].run;
        if (last && last->draw == run->draw && last->first + last->count == run->first)
            last->count += run->count;
        else
            out->runs[out->count++] = *run;
    }
}

/* Not inlined: see op_suspend. */
static __attribute__((noinline)) Result sort(const Scene *scene, const View *view, SortUnit unit,
                                             Sort *out)
{
    size_t count = item_count(scene, view, unit);
    Item *items = memory_array(count, sizeof *items);
    *out = (Sort){.runs = memory_array(count, sizeof *out->runs)};
    if (!items || !out->runs) {
        free(items);
        sort_free(out);
        return RESULT_NO_MEMORY;
    }
    fill(scene, view, unit, items);
    qsort(items, count, sizeof *items, farther);
    join(items, count, out);
    free(items);
    return RESULT_OK;
}

Result sort_far_to_near(const Scene *scene, const View *view, SortUnit unit, Sort *out)
{
    /* In flushing mode a denormal float would be 0 as a double, too. */
    uint32_t saved = op_suspend();
    Result result = sort(scene, view, unit, out);
    op_leave(saved);
    return result;
}

void sort_free(Sort *sort)
{
    free(sort->runs);
    *sort = (Sort){0};
}
