#include "report/diagnose.h"

#include "report/summary.h"
#include "study/fit.h"

#include <math.h>
#include <string.h>

enum {
    SHOWN_LEAST = 5,
    SHOWN_MOST = 12
};

void report_diagnose_list(FILE *out)
{
    for (int id = 0; id < MUTATION_COUNT; id++) {
        const MutationInfo *info = mutation_info((MutationId)id);
        fprintf(out, "%s\n    cause: %s\n    cure:  %s\n", info->name, info->cause, info->cure);
    }
}

/* ---- sentences ------------------------------------------------------------------------------- */

/* As many names as there is room for. */
static void describe_equals(const Diagnosis *diagnosis, char out[DIAGNOSE_LINE])
{
    char name[DIAGNOSE_NAME];
    int length =
        snprintf(out, DIAGNOSE_LINE, "One of %zu mistakes that this image cannot tell apart",
                 diagnosis->equals);
    for (size_t i = 0; i < diagnosis->equals && length < DIAGNOSE_LINE - DIAGNOSE_NAME; i++)
        length += snprintf(out + length, (size_t)(DIAGNOSE_LINE - length), "%s%s", i ? ", " : ": ",
                           diagnose_name(diagnosis->rows[i].mutations, name));
}

void report_diagnose_verdict(const Diagnosis *diagnosis, char out[DIAGNOSE_LINE])
{
    char name[DIAGNOSE_NAME];
    const char *best = diagnosis->count ? diagnose_name(diagnosis->rows[0].mutations, name) : "";
    double percent = diagnosis->count ? 100.0 * diagnosis->rows[0].explains : 0.0;
    switch (diagnosis->verdict) {
    case DIAGNOSE_AGREES:
        snprintf(out, DIAGNOSE_LINE, "The image agrees with the reference");
        break;
    case DIAGNOSE_MISTAKE:
        if (diagnosis->equals > 1)
            describe_equals(diagnosis, out);
        else
            snprintf(out, DIAGNOSE_LINE, "The mistake is %s", best);
        break;
    case DIAGNOSE_UNKNOWN:
        if (percent > 0.0)
            snprintf(out, DIAGNOSE_LINE,
                     "Unknown: no mistake of the catalogue explains the image; the nearest, %s, "
                     "explains %.1f %%",
                     best, percent);
        else
            snprintf(out, DIAGNOSE_LINE,
                     "Unknown: no mistake of the catalogue explains anything of the image");
        break;
    }
}

void report_diagnose_why(const Diagnosis *diagnosis, char out[DIAGNOSE_LINE])
{
    char beyond[SUMMARY_NUMBER], over[SUMMARY_NUMBER], far[SUMMARY_NUMBER], pixels[SUMMARY_NUMBER];
    summary_count(diagnosis->beyond, beyond);
    summary_count(diagnosis->over, over);
    summary_count(diagnosis->far, far);
    summary_count(diagnosis->pixels, pixels);
    switch (diagnosis->reason) {
    case DIAGNOSE_QUANTISED:
        snprintf(out, DIAGNOSE_LINE, "No pixel of %s differs by more than storing it may change.",
                 pixels);
        break;
    case DIAGNOSE_TOLERATED:
        snprintf(out, DIAGNOSE_LINE,
                 "Of %s pixels %s differ by more than storing may change, %s by more than the "
                 "tolerance (one in %d may), %s by more than %g (one in %d).",
                 pixels, beyond, over, FIT_FEW, far, FIT_FAR, FIT_FEW_FAR);
        break;
    case DIAGNOSE_COLORS:
        snprintf(out, DIAGNOSE_LINE,
                 "Its colours do; its alpha is neither coverage nor transmittance.");
        break;
    case DIAGNOSE_EXACT:
        snprintf(out, DIAGNOSE_LINE,
                 "%s of %s pixels differ from the reference by more than storing may change; with "
                 "the mistake none does.",
                 beyond, pixels);
        break;
    case DIAGNOSE_NEARLY:
        snprintf(out, DIAGNOSE_LINE,
                 "%s of %s pixels differ from the reference; the mistake explains %.1f %% of it, "
                 "not all.",
                 over, pixels, 100.0 * diagnosis->rows[0].explains);
        break;
    case DIAGNOSE_NOTHING:
        if (diagnosis->nonfinite == diagnosis->pixels)
            snprintf(out, DIAGNOSE_LINE, "Every pixel is NaN or infinite.");
        else if (diagnosis->nonfinite)
            snprintf(out, DIAGNOSE_LINE, "%s of %s pixels are NaN or infinite, %s differ.",
                     summary_count(diagnosis->nonfinite, beyond), pixels, over);
        else
            snprintf(
                out, DIAGNOSE_LINE,
                "%s of %s pixels differ from the reference; a mistake is named from %.0f %% on.",
                over, pixels, 100.0 * DIAGNOSE_EXPLAINS);
        break;
    }
}

void report_diagnose_value(const Diagnosis *diagnosis, const float value[4],
                           char out[DIAGNOSE_LINE])
{
    const FormatInfo *format = format_info(diagnosis->format);
    int channels = fit_channels(&diagnosis->form), length = 0;
    for (int c = 0; c < channels; c++) {
        double v = (double)value[c];
        const char *before = c ? ", " : "(";
        if (format->kind == KIND_UNORM)
            length += snprintf(out + length, (size_t)(DIAGNOSE_LINE - length), "%s%.1f", before,
                               v * (double)format->unorm_max);
        else
            length += snprintf(out + length, (size_t)(DIAGNOSE_LINE - length), "%s%.7g", before, v);
    }
    snprintf(out + length, (size_t)(DIAGNOSE_LINE - length), ")");
}

size_t report_diagnose_shown(const Diagnosis *diagnosis)
{
    size_t shown = diagnosis->equals;
    while (shown < diagnosis->count && shown < SHOWN_MOST &&
           (diagnosis->rows[shown].explains >= 0.5 ||
            (shown < SHOWN_LEAST && diagnosis->rows[shown].explains > 0.0)))
        shown++;
    return diagnosis->verdict == DIAGNOSE_AGREES ? 0 : shown;
}

/* ---- the text -------------------------------------------------------------------------------- */

static void print_causes(uint64_t mutations, const char *indent, FILE *out)
{
    for (int id = 0; id < MUTATION_COUNT; id++) {
        const MutationInfo *info = mutation_info((MutationId)id);
        if (mutations & mutation_bit((MutationId)id))
            fprintf(out, "%scause: %s\n%scure:  %s\n", indent, info->cause, indent, info->cure);
    }
}

static void print_ranking(const Diagnosis *diagnosis, FILE *out)
{
    size_t shown = report_diagnose_shown(diagnosis);
    if (!shown)
        return;
    fprintf(out, "\n%4s %9s %12s  %s\n", "rank", "explains", "pixels left", "mistake");
    for (size_t i = 0; i < shown; i++) {
        const DiagnoseRow *row = &diagnosis->rows[i];
        char name[DIAGNOSE_NAME], left[SUMMARY_NUMBER];
        bool equal = (i > 0 && row[-1].rank == row->rank) ||
                     (i + 1 < diagnosis->count && row[1].rank == row->rank);
        fprintf(out, "%3d%c %8.2f%% %12s  %s\n", row->rank, equal ? '=' : ' ',
                100.0 * row->explains, summary_count(row->beyond, left),
                diagnose_name(row->mutations, name));
        if (row->rank == 1)
            print_causes(row->mutations, "                             ", out);
    }
    if (diagnosis->equals > 1)
        fprintf(out,
                "\nThe first %zu are equals: here they make the same file, or all explain it "
                "exactly.\n",
                diagnosis->equals);
}

static void print_pixel(const Diagnosis *diagnosis, FILE *out)
{
    const DiagnosePixel *pixel = &diagnosis->pixel;
    char value[DIAGNOSE_LINE], name[DIAGNOSE_NAME];
    if (!diagnosis->has_pixel)
        return;
    fprintf(out, "\npixel %d,%d tells the best from the next:\n", pixel->x, pixel->y);
    fprintf(out, "  %-40s %s\n", "theirs",
            (report_diagnose_value(diagnosis, pixel->theirs, value), value));
    fprintf(out, "  %-40s %s\n", diagnose_name(diagnosis->rows[0].mutations, name),
            (report_diagnose_value(diagnosis, pixel->first, value), value));
    if (diagnosis->has_second)
        fprintf(out, "  %-40s %s\n",
                diagnose_name(diagnosis->rows[diagnosis->second].mutations, name),
                (report_diagnose_value(diagnosis, pixel->second, value), value));
    fprintf(out, "  %-40s %s\n", "the reference",
            (report_diagnose_value(diagnosis, pixel->reference, value), value));
}

static void print_invisible(const Diagnosis *diagnosis, FILE *out)
{
    int column = 0;
    if (!diagnosis->invisible)
        return;
    fprintf(out, "\n%d of %d mistakes would not show in this image:\n",
            __builtin_popcountll(diagnosis->invisible), MUTATION_COUNT);
    for (int id = 0; id < MUTATION_COUNT; id++) {
        const char *name = mutation_info((MutationId)id)->name;
        if (!(diagnosis->invisible & mutation_bit((MutationId)id)))
            continue;
        if (column && column + strlen(name) > 96) {
            fputc('\n', out);
            column = 0;
        }
        column += fprintf(out, "%s%s", column ? " " : "  ", name);
    }
    fputc('\n', out);
}

void report_diagnose_print(const DiagnoseSubject *subject, const Diagnosis *diagnosis, FILE *out)
{
    static const char *const words[] = {"AGREES", "MISTAKE", "UNKNOWN"};
    char line[DIAGNOSE_LINE];
    fprintf(out, "%s: %s\n", subject->image_path, diagnosis->described);
    fprintf(out, "%s at %dx%d: %zu renderings, %.1f s\n", subject->scene_name, subject->desc->width,
            subject->desc->height, diagnosis->rendered, diagnosis->time_ms / 1000.0);
    print_ranking(diagnosis, out);
    print_pixel(diagnosis, out);
    print_invisible(diagnosis, out);
    report_diagnose_verdict(diagnosis, line);
    fprintf(out, "\n%s.\n", line);
    report_diagnose_why(diagnosis, line);
    fprintf(out, "%s\n%s\n", line, words[diagnosis->verdict]);
}
