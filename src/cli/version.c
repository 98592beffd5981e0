#include "cli/version.h"

#include "base/text.h"
#include "cli/options.h"
#include "gl/context.h"
#include "ref/pipeline/pipeline.h"
#include "report/document.h"

#include <assimp/version.h>
#include <build_facts.h>
#include <gmp.h>
#include <gnu/libc-version.h>
#include <jansson.h>
#include <nettle/version.h>
#include <openexr.h>
#include <png.h>
#include <source_commit.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* A library's two versions, each "" where it does not tell. */
typedef struct Library {
    const char *name;
    char built[32], runs[160];
} Library;

enum {
    LIBRARIES = 10
};

static void add(Library *library, const char *name, const char *built, const char *runs)
{
    library->name = name;
    snprintf(library->built, sizeof library->built, "%s", built);
    snprintf(library->runs, sizeof library->runs, "%s", runs);
}

static void find_libraries(Library out[LIBRARIES])
{
    char text[64], headers[32];
    const char *extra = "";
    int major, minor, patch;
    snprintf(text, sizeof text, "%u.%u.%u", aiGetVersionMajor(), aiGetVersionMinor(),
             aiGetVersionPatch());
    add(&out[0], "Assimp", FACT_ASSIMP, text);
    exr_get_library_version(&major, &minor, &patch, &extra);
    snprintf(text, sizeof text, "%d.%d.%d", major, minor, patch);
    add(&out[1], "OpenEXR", FACT_OPENEXR, text);
    add(&out[2], "jansson", JANSSON_VERSION, jansson_version_str());
    add(&out[3], "zlib", ZLIB_VERSION, zlibVersion());
    snprintf(headers, sizeof headers, "%d.%d.%d", __GNU_MP_VERSION, __GNU_MP_VERSION_MINOR,
             __GNU_MP_VERSION_PATCHLEVEL);
    add(&out[4], "GMP", headers, gmp_version);
    snprintf(headers, sizeof headers, "%d.%d", NETTLE_VERSION_MAJOR, NETTLE_VERSION_MINOR);
    snprintf(text, sizeof text, "%d.%d", nettle_version_major(), nettle_version_minor());
    add(&out[5], "nettle", headers, text);
    snprintf(headers, sizeof headers, "%d.%d", __GLIBC__, __GLIBC_MINOR__);
    add(&out[6], "glibc", headers, gnu_get_libc_version());
    add(&out[7], "libjpeg-turbo", FACT_JPEG, "");
    add(&out[8], "libpng", PNG_LIBPNG_VER_STRING, png_get_libpng_ver(NULL));
    add(&out[9], "OSMesa", FACT_OSMESA, "");
    context_library(out[9].runs, sizeof out[9].runs);
}

/* Names of what is true of each instruction set, with spaces between. */
static void list_simd(bool (*of)(SimdChoice), Text *out)
{
    for (int simd = SIMD_SCALAR; simd < SIMD_COUNT; simd++)
        if (of((SimdChoice)simd))
            text_print(out, "%s%s", out->count ? " " : "", simd_name((SimdChoice)simd));
}

static SimdChoice widest(void)
{
    SimdChoice simd = SIMD_COUNT - 1;
    while (simd > SIMD_SCALAR && !pipeline_simd_runs(simd))
        simd--;
    return simd;
}

static const char *or_none(const char *text)
{
    return *text ? text : "none";
}

static void print_text(const Library libraries[LIBRARIES], const char *built)
{
    printf("compiler    %s\nbuild       %s\nflags       %s\nsanitizers  %s\n", FACT_COMPILER,
           FACT_BUILD_TYPE, or_none(FACT_FLAGS), or_none(FACT_SANITIZERS));
    printf("simd        %s; here %s\n", built, simd_name(widest()));
    printf("flushing    %s\n", pipeline_flushes_in_hardware() ? "hardware" : "software");
    printf("source      %s\n", *SOURCE_COMMIT ? SOURCE_COMMIT : "unknown");
    for (int i = 0; i < LIBRARIES; i++) {
        bool mesa = i == LIBRARIES - 1;
        printf("%-11s built with %s, %s %s\n", libraries[i].name, libraries[i].built,
               mesa ? "found" : "runs", or_none(libraries[i].runs));
    }
}

static json_t *word_list(const char *words)
{
    json_t *list = json_array();
    while (list && *words) {
        size_t length = strcspn(words, " ");
        json_array_append_new(list, json_stringn(words, length));
        words += length + (words[length] == ' ');
    }
    return list;
}

static Result print_json(const Library libraries[LIBRARIES], const char *built)
{
    Document json = {0};
    json_t *root = json_object(), *list = json_object();
    document_put(&json, root, "version", document_string(PEEL_VERSION));
    document_put(&json, root, "compiler", document_string(FACT_COMPILER));
    document_put(&json, root, "build", document_string(FACT_BUILD_TYPE));
    document_put(&json, root, "flags", document_string(FACT_FLAGS));
    document_put(&json, root, "sanitizers", document_string(FACT_SANITIZERS));
    document_put(&json, root, "simd", word_list(built));
    document_put(&json, root, "simd_here", document_string(simd_name(widest())));
    document_put(&json, root, "flushing",
                 document_string(pipeline_flushes_in_hardware() ? "hardware" : "software"));
    document_put(&json, root, "source",
                 *SOURCE_COMMIT ? document_string(SOURCE_COMMIT) : json_null());
    for (int i = 0; i < LIBRARIES; i++) {
        json_t *library = json_object();
        document_put(&json, library, "built", document_string(libraries[i].built));
        document_put(&json, library, i == LIBRARIES - 1 ? "found" : "runs",
                     document_string(libraries[i].runs));
        document_put(&json, list, libraries[i].name, library);
    }
    document_put(&json, root, "libraries", list);
    char *text = json.failed ? NULL : json_dumps(root, JSON_INDENT(1));
    json_decref(root);
    if (!text)
        return RESULT_NO_MEMORY;
    puts(text);
    free(text);
    return RESULT_OK;
}

int version_print(int argc, char **argv)
{
    bool json = argc == 1 && strcmp(argv[0], "--json") == 0;
    Library libraries[LIBRARIES];
    Text built = {0};
    if (argc > 0 && !json)
        return options_fail(result_fail(
            RESULT_BAD_INPUT, "--version %s: expected nothing or --json", argv[argc - 1]));
    find_libraries(libraries);
    list_simd(pipeline_simd_built, &built);
    Result result = built.result;
    if (result == RESULT_OK && json)
        result = print_json(libraries, built.bytes);
    else if (result == RESULT_OK) {
        printf("peel %s\n", PEEL_VERSION);
        print_text(libraries, built.bytes);
    }
    text_free(&built);
    return result == RESULT_OK ? EXIT_AGREE : options_fail(result);
}
