#include "report/roofline.h"

#include "report/document.h"

/* ---- text ------------------------------------------------------------------------------------ */

static void print_rate(RooflineRate rate, FILE *out)
{
    char text[40] = "-";
    if (rate.one > 0.0)
        snprintf(text, sizeof text, "%.1f / %.1f", 1e-9 * rate.one, 1e-9 * rate.all);
    fprintf(out, " %16s", text);
}

static void print_peaks(const RooflineReport *report, FILE *out)
{
    fprintf(out, "Single precision, 10^9 per second of processor time: one thread / %d at once\n",
            report->threads);
    fprintf(out, "%-8s %5s %16s %16s %16s %16s\n", "simd", "lanes", "mul, add", "fused mul-add x2",
            "divisions", "square roots");
    for (size_t i = 0; i < report->count; i++) {
        const RooflineWidth *width = &report->widths[i];
        fprintf(out, "%-8s %5d", simd_name(width->simd), width->lanes);
        print_rate(width->muladd, out);
        print_rate(width->fma, out);
        print_rate(width->divide, out);
        print_rate(width->root, out);
        fprintf(out, "\n");
    }
    fprintf(out, "\nMemory, 10^9 bytes per second:\nread ");
    print_rate(report->read, out);
    fprintf(out, "\nwrite");
    print_rate(report->write, out);
    fprintf(out, "\ncopy ");
    print_rate(report->copy, out);
    fprintf(out, " read and written\n");
}

void report_roofline_print(const RooflineReport *report, FILE *out)
{
    print_peaks(report, out);
    fprintf(out,
            "\nLighting loop, %d lights on %d resident fragments, one thread. Operations per "
            "fragment and\nlight: %d sums, %d products, %d minima and maxima, %d divisions, %d "
            "roots.\n",
            ROOFLINE_LIGHTS, ROOFLINE_FRAGMENTS, ROOFLINE_ADDS, ROOFLINE_MULS, ROOFLINE_CLAMPS,
            ROOFLINE_DIVS, ROOFLINE_SQRTS);
    fprintf(out, "%-8s %10s %10s %10s   %s\n", "simd", "ns", "Gflop/s", "of peak",
            "at least, ns: arithmetic, divider");
    for (size_t i = 0; i < report->count; i++) {
        RooflineLoop loop = roofline_loop(&report->widths[i]);
        fprintf(out, "%-8s %10.2f %10.1f %9.0f%%   %24.2f %8.2f\n",
                simd_name(report->widths[i].simd), loop.ns, 1e-9 * loop.flops, 100.0 * loop.share,
                loop.arithmetic, loop.divider);
    }
}

/* ---- JSON ------------------------------------------------------------------------------------ */

static void put_rate(Document *json, json_t *object, const char *key, RooflineRate rate)
{
    json_t *pair = json_object();
    document_put(json, pair, "one_thread", json_real(rate.one));
    document_put(json, pair, "all_threads", json_real(rate.all));
    document_put(json, object, key, rate.one > 0.0 ? pair : json_null());
    if (!(rate.one > 0.0))
        json_decref(pair);
}

static json_t *width_object(Document *json, const RooflineWidth *width)
{
    RooflineLoop loop = roofline_loop(width);
    json_t *object = json_object(), *light = json_object();
    document_put(json, object, "simd", json_string(simd_name(width->simd)));
    document_put(json, object, "lanes", json_integer(width->lanes));
    put_rate(json, object, "muladd_flops", width->muladd);
    put_rate(json, object, "fma_flops", width->fma);
    put_rate(json, object, "divisions", width->divide);
    put_rate(json, object, "square_roots", width->root);
    put_rate(json, object, "fragment_lights", width->light);
    document_put(json, light, "ns_per_fragment_light", json_real(loop.ns));
    document_put(json, light, "flops", json_real(loop.flops));
    document_put(json, light, "share_of_muladd_peak", json_real(loop.share));
    document_put(json, light, "arithmetic_bound_ns", json_real(loop.arithmetic));
    document_put(json, light, "divider_bound_ns", json_real(loop.divider));
    document_put(json, object, "lighting", light);
    return object;
}

Result report_roofline_json(const RooflineReport *report, const char *path)
{
    static const struct {
        const char *key;
        int count;
    } operations[] = {{"adds", ROOFLINE_ADDS},
                      {"muls", ROOFLINE_MULS},
                      {"min_max", ROOFLINE_CLAMPS},
                      {"divisions", ROOFLINE_DIVS},
                      {"square_roots", ROOFLINE_SQRTS}};
    Document json = {0};
    json_t *root = json_object(), *widths = json_array(), *formula = json_object();
    json_t *memory = json_object();
    for (size_t i = 0; i < sizeof operations / sizeof *operations; i++)
        document_put(&json, formula, operations[i].key, json_integer(operations[i].count));
    for (size_t i = 0; i < report->count; i++)
        document_append(&json, widths, width_object(&json, &report->widths[i]));
    put_rate(&json, memory, "read", report->read);
    put_rate(&json, memory, "write", report->write);
    put_rate(&json, memory, "copy", report->copy);
    document_put(&json, root, "threads", json_integer(report->threads));
    document_put(&json, root, "operations_per_fragment_light", formula);
    document_put(&json, root, "widths", widths);
    document_put(&json, root, "bytes_per_second", memory);
    return document_write(&json, root, path);
}
