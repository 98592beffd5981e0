/* The history of a pixel as JSON: the keys of peel explain --json and of the page. */
#include "frame/history.h"
#include "frame/method.h"

static void put_number(Text *out, const char *key, double value)
{
    text_print(out, "\"%s\":\"%a\",", key, value);
}

static void put_numbers(Text *out, const char *key, const double *values, int count)
{
    text_print(out, "\"%s\":[", key);
    for (int i = 0; i < count; i++)
        text_print(out, "%s\"%a\"", i ? "," : "", values[i]);
    text_print(out, "],");
}

static void put_name(Text *out, const char *key, const char *name)
{
    text_print(out, "\"%s\":", key);
    text_json_string(out, name ? name : "");
    text_print(out, ",");
}

/* Objects and arrays are printed with a comma behind each member; this takes the last one away. */
static void close(Text *out, const char *bracket)
{
    if (out->result == RESULT_OK && out->count > 0 && out->bytes[out->count - 1] == ',')
        out->bytes[--out->count] = '\0';
    text_print(out, "%s", bracket);
}

static void put_terms(Text *out, const History *history, const HistorySurface *surface)
{
    text_print(out, "\"lights\":[");
    for (size_t i = 0; i < surface->term_count; i++) {
        const HistoryTerm *term = &history->terms[surface->first_term + i];
        text_print(out, "{");
        put_number(out, "n_dot_l", term->n_dot_l);
        put_number(out, "n_dot_h", term->n_dot_h);
        put_number(out, "h_dot_v", term->h_dot_v);
        put_number(out, "distance", term->distance);
        put_number(out, "distribution", term->distribution);
        put_number(out, "geometry", term->geometry);
        put_numbers(out, "fresnel", term->fresnel, 3);
        put_number(out, "specular", term->specular);
        put_number(out, "attenuation", term->attenuation);
        put_numbers(out, "contribution", term->term, 3);
        put_numbers(out, "sum", term->sum, 3);
        close(out, "},");
    }
    close(out, "],");
}

static void put_surface(Text *out, const History *history, const HistorySurface *surface)
{
    text_print(out, "\"surface\":{");
    put_numbers(out, "position", surface->position, 3);
    put_numbers(out, "normal", surface->normal, 3);
    put_numbers(out, "base", surface->base, 4);
    put_number(out, "roughness", surface->roughness);
    put_number(out, "metallic", surface->metallic);
    put_number(out, "occlusion", surface->occlusion);
    close(out, "},");
    if (!surface->lit)
        return;
    text_print(out, "\"shading\":{");
    put_terms(out, history, surface);
    put_numbers(out, "ambient", surface->ambient, 3);
    put_numbers(out, "source", surface->source, 4);
    close(out, "},");
}

static void put_edges(Text *out, const HistoryFragment *fragment)
{
    text_print(out, "\"edges\":[");
    for (int i = 0; i < 3; i++) {
        bool through = fragment->edge[i] == 0;
        text_print(out, "{\"value\":%lld,\"fill_rule\":%s},", (long long)fragment->edge[i],
                   !through             ? "null"
                   : fragment->owned[i] ? "\"inside\""
                                        : "\"outside\"");
    }
    close(out, "],");
}

static void put_fragment(Text *out, const History *history, const Scene *scene, size_t index)
{
    const HistoryFragment *fragment = &history->fragments[index];
    text_print(out, "{\"primitive\":%u,", fragment->primitive);
    put_number(out, "depth", fragment->depth);
    put_name(out, "fate", history_fate_name(fragment->fate));
    if (fragment->peel == HISTORY_NONE)
        text_print(out, "\"peel\":null,");
    else
        text_print(out, "\"peel\":%d,\"side\":\"%s\",", fragment->peel,
                   fragment->back ? "back" : "front");
    text_print(out, "\"instance\":%u,\"mesh\":%u,\"material\":%u,", fragment->instance,
               fragment->mesh, fragment->material);
    put_name(out, "instance_name", scene->instances[fragment->instance].name);
    put_name(out, "material_name", scene->materials[fragment->material].name);
    text_print(out, "\"list\":\"%s\",\"facing\":\"%s\",",
               fragment->transparent ? "transparent" : "opaque",
               fragment->front ? "front" : "back");
    if (fragment->has_edges)
        put_edges(out, fragment);
    put_number(out, "z", fragment->z);
    text_print(out, "\"depth_code\":%u,", fragment->code);
    put_number(out, "distance", fragment->distance);
    text_print(out, "\"tests\":[");
    for (int i = 0; i < fragment->passes; i++)
        text_print(out, "\"%s\",", history_test_name(history_test(history, index, i)));
    close(out, "],");
    put_surface(out, history, &fragment->surface);
    close(out, "},");
}

static void put_step(Text *out, const HistoryStep *step)
{
    text_print(out, "{");
    put_name(out, "step", step->step);
    put_name(out, "target", step->target);
    put_name(out, "equation", step->equation);
    put_name(out, "format", step->format);
    if (step->fragment == HISTORY_NONE)
        text_print(out, "\"fragment\":null,");
    else
        text_print(out, "\"fragment\":%d,", step->fragment);
    put_numbers(out, "source", step->source, 4);
    put_numbers(out, "before", step->before, step->channels);
    put_numbers(out, "after", step->after, step->channels);
    text_print(out, "\"stored\":%s},", step->stored ? "true" : "false");
}

void history_json(const History *history, const Scene *scene, Text *out)
{
    text_print(out, "{\"pixel\":[%d,%d],", history->x, history->y);
    put_name(out, "renderer", history->renderer);
    put_name(out, "method", method_info(history->method)->name);
    put_name(out, "accum_format", history->accum_format);
    put_name(out, "depth_format", history->depth_format);
    text_print(out, "\"fragments\":[");
    for (size_t i = 0; i < history->fragment_count; i++)
        put_fragment(out, history, scene, i);
    close(out, "],\"blend\":[");
    for (size_t i = 0; i < history->step_count; i++)
        put_step(out, &history->steps[i]);
    close(out, "],");
    put_numbers(out, "accum", history->accum, 4);
    put_number(out, "transmittance", history->transmittance);
    put_numbers(out, "final", history->final, 4);
    text_print(out, "\"display\":[%d,%d,%d,%d],", history->display[0], history->display[1],
               history->display[2], history->display[3]);
    text_print(out, "\"source_of\":\"%s\",", history->source_of_ref ? "ref" : history->renderer);
    text_print(out, "\"summary\":\"");
    history_summary(history, out);
    text_print(out, "\",");
    if (history->note)
        put_name(out, "note", history->note);
    close(out, "}");
}
