/* The document of `peel diagnose --json`: its keys are a contract, as those of json.c. */
#include "report/diagnose.h"
#include "report/document.h"
#include "study/fit.h"

static json_t *names(Document *json, uint64_t mutations)
{
    json_t *array = json_array();
    for (int id = 0; id < MUTATION_COUNT; id++)
        if (mutations & mutation_bit((MutationId)id))
            document_append(json, array, json_string(mutation_info((MutationId)id)->name));
    return array;
}

/* The causes or the cures of one mistake or two, in one line. */
static json_t *sentences(uint64_t mutations, bool cures)
{
    char text[1024];
    size_t length = 0;
    for (int id = 0; id < MUTATION_COUNT; id++) {
        const MutationInfo *info = mutation_info((MutationId)id);
        if ((mutations & mutation_bit((MutationId)id)) && length < sizeof text)
            length += (size_t)snprintf(text + length, sizeof text - length, "%s%s",
                                       length ? "; and " : "", cures ? info->cure : info->cause);
    }
    return json_string(text);
}

/* The names of the rows with the same rank, but for this one. */
static json_t *equals(Document *json, const Diagnosis *diagnosis, const DiagnoseRow *row)
{
    json_t *array = json_array();
    char name[DIAGNOSE_NAME];
    for (size_t i = 0; i < diagnosis->count; i++)
        if (&diagnosis->rows[i] != row && diagnosis->rows[i].rank == row->rank)
            document_append(json, array,
                            json_string(diagnose_name(diagnosis->rows[i].mutations, name)));
    return array;
}

static json_t *ranked(Document *json, const Diagnosis *diagnosis, const DiagnoseRow *row)
{
    json_t *object = json_object();
    char name[DIAGNOSE_NAME];
    document_put(json, object, "name", json_string(diagnose_name(row->mutations, name)));
    document_put(json, object, "explains", document_real(row->explains));
    document_put(json, object, "cause", sentences(row->mutations, false));
    document_put(json, object, "cure", sentences(row->mutations, true));
    document_put(json, object, "rank", json_integer(row->rank));
    document_put(json, object, "exact", json_boolean(row->beyond == 0));
    document_put(json, object, "pixels_left", document_count(row->beyond));
    document_put(json, object, "equals", equals(json, diagnosis, row));
    return object;
}

static json_t *value(Document *json, const Diagnosis *diagnosis, const float values[4])
{
    json_t *array = json_array();
    for (int c = 0; c < fit_channels(&diagnosis->form); c++)
        document_append(json, array, document_real((double)values[c]));
    return array;
}

static json_t *pixel(Document *json, const Diagnosis *diagnosis)
{
    const DiagnosePixel *at = &diagnosis->pixel;
    char name[DIAGNOSE_NAME];
    if (!diagnosis->has_pixel)
        return json_null();
    json_t *object = json_object();
    document_put(json, object, "x", json_integer(at->x));
    document_put(json, object, "y", json_integer(at->y));
    document_put(json, object, "theirs", value(json, diagnosis, at->theirs));
    document_put(json, object, "reference", value(json, diagnosis, at->reference));
    json_t *first = json_object();
    document_put(json, first, "name",
                 json_string(diagnose_name(diagnosis->rows[0].mutations, name)));
    document_put(json, first, "value", value(json, diagnosis, at->first));
    document_put(json, object, "first", first);
    if (!diagnosis->has_second)
        return object;
    json_t *second = json_object();
    document_put(json, second, "name",
                 json_string(diagnose_name(diagnosis->rows[diagnosis->second].mutations, name)));
    document_put(json, second, "value", value(json, diagnosis, at->second));
    document_put(json, object, "second", second);
    return object;
}

static json_t *image(Document *json, const DiagnoseSubject *subject, const Diagnosis *diagnosis)
{
    const GivenMeaning *form = &diagnosis->form;
    json_t *object = json_object();
    document_put(json, object, "path", document_string(subject->image_path));
    document_put(json, object, "format", json_string(format_info(diagnosis->format)->name));
    document_put(json, object, "encoding", json_string(given_encoding_name(form->encoding)));
    document_put(json, object, "bottom_up", json_boolean(form->rows == GIVEN_BOTTOM_UP));
    document_put(json, object, "alpha", json_string(given_alpha_name(form->alpha)));
    document_put(json, object, "description", json_string(diagnosis->described));
    return object;
}

Result report_diagnose_json(const DiagnoseSubject *subject, const Diagnosis *diagnosis,
                            const char *path)
{
    Document json = {0};
    json_t *root = json_object(), *ranking = json_array();
    char line[DIAGNOSE_LINE];
    if (diagnosis->verdict != DIAGNOSE_AGREES)
        for (size_t i = 0; i < diagnosis->count; i++)
            document_append(&json, ranking, ranked(&json, diagnosis, &diagnosis->rows[i]));
    document_put(&json, root, "verdict", json_string(diagnose_verdict_name(diagnosis->verdict)));
    report_diagnose_why(diagnosis, line);
    document_put(&json, root, "reason", json_string(line));
    document_put(&json, root, "ranking", ranking);
    document_put(&json, root, "pixel", pixel(&json, diagnosis));
    document_put(&json, root, "invisible", names(&json, diagnosis->invisible));
    document_put(&json, root, "pixels", document_count(diagnosis->pixels));
    document_put(&json, root, "pixels_beyond_quantisation", document_count(diagnosis->beyond));
    document_put(&json, root, "pixels_beyond_tolerance", document_count(diagnosis->over));
    document_put(&json, root, "pixels_nonfinite", document_count(diagnosis->nonfinite));
    document_put(&json, root, "scene", document_string(subject->scene_path));
    document_put(&json, root, "image", image(&json, subject, diagnosis));
    return document_write(&json, root, path);
}
