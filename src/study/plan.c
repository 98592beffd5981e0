#include "study/plan.h"

#include "base/progress.h"

static Result plan_memory(const Scene *scene, const View *view, Plan *plan)
{
    RenderDesc all = plan->desc;
    View all_view;
    Needs all_needs;
    PlanBuffers buffers;
    all.model_all = true;
    Result result = view_build(scene, &all, &all_view);
    if (result != RESULT_OK)
        return result;
    needs_derive(scene, &all_view, &all, false, &all_needs);
    result = plan_buffers(scene, &all_view, &all, &all_needs, plan->frame.nodes, &buffers);
    plan->bytes_of_all = buffers.bytes;
    view_free(&all_view);
    return result == RESULT_OK ? plan_buffers(scene, view, &plan->desc, &plan->needs,
                                              plan->frame.nodes, &plan->buffers)
                               : result;
}

static Result measure(const Scene *scene, LayerCounter counter, Renderer ref, Plan *plan)
{
    View view;
    Result result = view_build(scene, &plan->desc, &view);
    if (result != RESULT_OK)
        return result;
    needs_derive(scene, &view, &plan->desc, false, &plan->needs);
    progress_begin("layers", 0);
    result = counter(scene, &plan->desc, &plan->layers);
    progress_end();
    for (int i = 0; i < METHOD_COUNT; i++)
        plan->passes[i] = layers_passes(&plan->layers.most, (MethodId)i);
    progress_begin("ref", 0);
    if (result == RESULT_OK)
        result = ref(scene, &plan->desc, NULL, &plan->frame);
    progress_end();
    image_free(&plan->frame.final);
    image_free(&plan->frame.display);
    if (result == RESULT_OK)
        result = plan_memory(scene, &view, plan);
    view_free(&view);
    return result;
}

Result plan_run(const Scene *scene, const char *path, const RenderDesc *desc, LayerCounter counter,
                Renderer ref, Plan *out)
{
    *out = (Plan){.scene_name = scene->name, .scene_path = path, .desc = *desc};
    Result result = measure(scene, counter, ref, out);
    if (result != RESULT_OK)
        plan_free(out);
    return result;
}

void plan_free(Plan *plan)
{
    layers_free(&plan->layers);
    frame_free(&plan->frame);
    *plan = (Plan){0};
}
