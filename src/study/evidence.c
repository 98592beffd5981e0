#include "study/evidence.h"

#include "base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- names ----------------------------------------------------------------------------------- */

const char *diagnose_name(uint64_t mutations, char out[DIAGNOSE_NAME])
{
    size_t length = 0;
    *out = '\0';
    for (int id = 0; id < MUTATION_COUNT; id++)
        if (mutations & mutation_bit((MutationId)id))
            length +=
                (size_t)snprintf(out + length, length < DIAGNOSE_NAME ? DIAGNOSE_NAME - length : 0,
                                 "%s%s", length ? " + " : "", mutation_info((MutationId)id)->name);
    return out;
}

const char *diagnose_verdict_name(DiagnoseVerdict verdict)
{
    static const char *const names[] = {"agrees", "mistake", "unknown"};
    return names[verdict];
}

const char *diagnose_class_text(DiagnoseClass class)
{
    static const char *const texts[] = {"the reference fits",
                                        "the mistake fits, the reference does not",
                                        "the mistake is nearer by half", "neither is near",
                                        "the reference fits, the mistake does not"};
    return texts[class];
}

/* ---- pixels ---------------------------------------------------------------------------------- */

static Result copy_theirs(const Fit *fit, Diagnosis *out)
{
    Image *image = &out->theirs;
    Result result = image_create(fit->theirs.width, fit->theirs.height, FORMAT_RGBA32F, image);
    for (int y = 0; y < image->height && result == RESULT_OK; y++)
        for (int x = 0; x < image->width; x++) {
            float *pixel = image_pixel(image, x, y);
            memcpy(pixel, fit_theirs(fit, &out->form, x, y), 4 * sizeof *pixel);
            if (fit_channels(&out->form) == 3)
                pixel[3] = 1.0f;
        }
    return result;
}

static DiagnoseClass classify(double reference, double best)
{
    if (reference == 0.0)
        return best == 0.0 ? DIAGNOSE_PIXEL_AGREES : DIAGNOSE_PIXEL_CONTRADICTED;
    if (best == 0.0)
        return DIAGNOSE_PIXEL_EXPLAINED;
    return best <= 0.5 * reference ? DIAGNOSE_PIXEL_NEARER : DIAGNOSE_PIXEL_UNEXPLAINED;
}

static void take_pixel(Diagnosis *out, int x, int y, const Image *second)
{
    DiagnosePixel *pixel = &out->pixel;
    const Image *images[] = {&out->theirs, &out->reference, &out->best, second};
    float *values[] = {pixel->theirs, pixel->reference, pixel->first, pixel->second};
    pixel->x = x;
    pixel->y = y;
    for (int i = 0; i < 4; i++)
        memcpy(values[i], image_pixel(images[i], x, y), sizeof pixel->theirs);
    out->has_pixel = true;
}

static void compare_pixels(const Fit *fit, const Image *second, Diagnosis *out)
{
    double most = 0.0;
    uint8_t *classes = out->classes;
    for (int y = 0; y < out->theirs.height; y++)
        for (int x = 0; x < out->theirs.width; x++) {
            double none = fit_residual(fit, &out->form, &out->reference, x, y);
            double best = fit_residual(fit, &out->form, &out->best, x, y);
            double other = fit_residual(fit, &out->form, second, x, y);
            DiagnoseClass class = classify(none, best);
            *classes++ = (uint8_t) class;
            out->class_counts[class]++;
            if (isfinite(best) && isfinite(other) && other - best > most) {
                most = other - best;
                take_pixel(out, x, y, second);
            }
        }
}

Result evidence_gather(Fit *fit, const FitRendering *reference, const FitRendering *best,
                       const FitRendering *second, Diagnosis *out)
{
    Image other = {0};
    out->classes = memory_array(out->pixels, 1);
    Result result = out->classes ? copy_theirs(fit, out) : RESULT_NO_MEMORY;
    if (result == RESULT_OK)
        result = fit_predict(fit, reference, &out->form, &out->reference);
    if (result == RESULT_OK)
        result = fit_predict(fit, best, &out->form, &out->best);
    if (result == RESULT_OK)
        result = fit_predict(fit, second, &out->form, &other);
    if (result == RESULT_OK)
        compare_pixels(fit, &other, out);
    image_free(&other);
    return result;
}
