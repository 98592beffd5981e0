#include "report/blend_example.h"

#include "number/numeral.h"

#include <math.h>
#include <string.h>

const char *blend_channel_name(int channel)
{
    static const char *const names[] = {"red", "green", "blue", "alpha"};
    return names[channel];
}

const char *blend_text_bits(PixelFormat format, uint32_t bits, char out[BLEND_TEXT])
{
    if (format_info(format)->unorm_max)
        snprintf(out, BLEND_TEXT, "%u", bits);
    else
        numeral_both(blend_case_value(format, bits), out);
    return out;
}

static bool is_code(PixelFormat format, float x)
{
    uint32_t most = format_info(format)->unorm_max;
    return most && x >= 0.0f && x <= 1.0f && x == (float)(nearbyint((double)x * most) / most);
}

const char *blend_text_source(PixelFormat format, float x, char out[BLEND_TEXT])
{
    if (is_code(format, x))
        snprintf(out, BLEND_TEXT, "%.0f", nearbyint((double)x * format_info(format)->unorm_max));
    else
        numeral_both((double)x, out);
    return out;
}

const char *blend_text_ulp(PixelFormat format, uint32_t ulp, char out[BLEND_TEXT])
{
    const char *unit = format_info(format)->unorm_max ? ulp == 1 ? "code" : "codes" : "ULP";
    if (ulp == UINT32_MAX)
        snprintf(out, BLEND_TEXT, "NaN");
    else
        snprintf(out, BLEND_TEXT, ulp < 10000000 ? "%.0f %s" : "%.1e %s", (double)ulp, unit);
    return out;
}

/* Shorter than blend_text_source and blend_text_bits. */
static const char *brief(PixelFormat format, bool bits, uint32_t stored, float source,
                         char out[BLEND_TEXT])
{
    bool code = format_info(format)->unorm_max != 0;
    if (bits && code)
        return blend_text_bits(format, stored, out);
    double number = bits ? blend_case_value(format, stored) : (double)source;
    if (code && is_code(format, source))
        blend_text_source(format, source, out);
    else
        numeral_float(number, out);
    return out;
}

void blend_print_operands(const BlendEquation *equation, PixelFormat format,
                          const BlendExample *example, bool whole, FILE *out)
{
    char text[BLEND_TEXT];
    BlendCase one = {equation, format, example->channel, example->source, example->pixel, whole};
    BlendOperands used = blend_case_operands(&one);
    fprintf(out, "source %s", brief(format, false, 0, example->source[example->channel], text));
    if (used.source_alpha)
        fprintf(out, ", source alpha %s", brief(format, false, 0, example->source[3], text));
    uint32_t before = format_bits(format, example->pixel, example->channel);
    fprintf(out, ", before %s", brief(format, true, before, 0.0f, text));
    if (used.destination_alpha)
        fprintf(out, ", alpha before %s",
                brief(format, true, format_bits(format, example->pixel, 3), 0.0f, text));
}

static void print_hex(PixelFormat format, uint32_t bits, FILE *out)
{
    fprintf(out, "0x%0*x", 2 * format_info(format)->channel_bytes, bits);
}

/* Of exact arithmetic some numbers are none of double: NaN, though nothing else is. */
static const char *number(const BlendSteps *steps, double x, char out[BLEND_TEXT])
{
    if (isnan(x) && !isnan(steps->source) && !isnan(steps->destination))
        snprintf(out, BLEND_TEXT, "(no double)");
    else if (steps->codes)
        snprintf(out, BLEND_TEXT, "%.0f", x);
    else
        numeral_both(x, out);
    return out;
}

static void print_steps(const BlendReport *report, const char *name, const Arithmetic *arithmetic,
                        const BlendExample *example, FILE *out)
{
    BlendSteps all[4];
    char a[BLEND_TEXT], b[BLEND_TEXT], c[BLEND_TEXT];
    BlendCase one = {&report->equation, report->format, example->channel,
                     example->source,   example->pixel, false};
    BlendFunc func = blend_case_terms(&one).func;
    arithmetic_steps(arithmetic, &report->equation, report->format, example->source, example->pixel,
                     all);
    const BlendSteps *steps = &all[example->channel];
    fprintf(out, "    %s\n", name);
    if (func != BLEND_FUNC_MIN && func != BLEND_FUNC_MAX) {
        fprintf(out, "      %s * %s = %s\n", number(steps, steps->source, a),
                number(steps, steps->source_factor, b), number(steps, steps->source_product, c));
        fprintf(out, "      %s * %s = %s\n", number(steps, steps->destination, a),
                number(steps, steps->destination_factor, b),
                number(steps, steps->destination_product, c));
    }
    fprintf(out, "      %s: %s", equation_func_name(func), number(steps, steps->sum, a));
    fprintf(out, ", stored %s, ", blend_text_bits(report->format, steps->stored, a));
    print_hex(report->format, steps->stored, out);
    fputc('\n', out);
}

void blend_print_example(const BlendReport *report, const char *name, const Arithmetic *arithmetic,
                         const BlendExample *example, FILE *out)
{
    char text[BLEND_TEXT];
    fprintf(out, "  %s vector %llu, %s: ", vectors_set_name(example->set),
            (unsigned long long)example->index, blend_channel_name(example->channel));
    blend_print_operands(&report->equation, report->format, example, false, out);
    fprintf(out, "\n    got %s, ", blend_text_bits(report->format, example->got, text));
    print_hex(report->format, example->got, out);
    fprintf(out, "; expected %s, ", blend_text_bits(report->format, example->expected, text));
    print_hex(report->format, example->expected, out);
    fprintf(out, "; %s apart\n", blend_text_ulp(report->format, example->ulp, text));
    print_steps(report, name, arithmetic, example, out);
}

static json_t *json_number(double x)
{
    char text[NUMERAL_MAX];
    return json_string(numeral_hex(x, text));
}

json_t *blend_json_bits(PixelFormat format, uint32_t bits)
{
    return format_info(format)->unorm_max ? json_integer(bits)
                                          : json_number(blend_case_value(format, bits));
}

json_t *blend_json_operands(Document *json, PixelFormat format, VectorSet set, uint64_t index,
                            int channel, const float from[4], const void *pixel)
{
    json_t *object = json_object(), *source = json_array(), *destination = json_array();
    for (int i = 0; i < 4; i++)
        document_append(json, source, json_number((double)from[i]));
    for (int i = 0; i < format_info(format)->channels; i++)
        document_append(json, destination, blend_json_bits(format, format_bits(format, pixel, i)));
    document_put(json, object, "set", json_string(vectors_set_name(set)));
    document_put(json, object, "index", document_count(index));
    document_put(json, object, "channel", json_string(blend_channel_name(channel)));
    document_put(json, object, "source", source);
    document_put(json, object, "destination", destination);
    return object;
}

json_t *blend_json_example(Document *json, const BlendEquation *equation, PixelFormat format,
                           const Arithmetic *arithmetic, const BlendExample *example)
{
    json_t *object = blend_json_operands(json, format, example->set, example->index,
                                         example->channel, example->source, example->pixel);
    document_put(json, object, "expected", blend_json_bits(format, example->expected));
    document_put(json, object, "got", blend_json_bits(format, example->got));
    document_put(json, object, "ulp",
                 example->ulp == UINT32_MAX ? json_null() : document_count(example->ulp));
    if (!arithmetic)
        return object;
    BlendSteps all[4];
    json_t *steps = json_object();
    arithmetic_steps(arithmetic, equation, format, example->source, example->pixel, all);
    const BlendSteps *one = &all[example->channel];
    document_put(json, steps, "codes", json_boolean(one->codes));
    document_put(json, steps, "source", json_number(one->source));
    document_put(json, steps, "source_factor", json_number(one->source_factor));
    document_put(json, steps, "source_product", json_number(one->source_product));
    document_put(json, steps, "destination", json_number(one->destination));
    document_put(json, steps, "destination_factor", json_number(one->destination_factor));
    document_put(json, steps, "destination_product", json_number(one->destination_product));
    document_put(json, steps, "sum", json_number(one->sum));
    document_put(json, steps, "stored", blend_json_bits(format, one->stored));
    document_put(json, object, "steps", steps);
    return object;
}
