/* Images with a known mistake, as somebody's file would hold them, and a renderer that remembers:
 * the hypotheses of one scene are the same for every image of it. */
#ifndef PEEL_TESTS_PLANTED_H
#define PEEL_TESTS_PLANTED_H

#include "testing.h"

#include "ref/pipeline/pipeline.h"
#include "scene/generate.h"
#include "scene/hard_scenes.h"
#include "study/diagnose.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum PlantedFile {
    PLANTED_PNG = 0, /* 8 bits, the display transform */
    PLANTED_EXR,     /* floats, linear, alpha is coverage */
    PLANTED_FILES
} PlantedFile;

static inline void planted_ok(Result result)
{
    ck_assert_msg(result == RESULT_OK, "%s", result_message());
}

/* ---- a renderer that remembers ---- */

static struct {
    RenderDesc desc;
    Frame frame;
} planted_memory[2048];
static size_t planted_count;

static inline void planted_forget(void)
{
    while (planted_count > 0)
        frame_free(&planted_memory[--planted_count].frame);
}

static inline const Frame *planted_frame(const Scene *scene, const RenderDesc *desc)
{
    for (size_t i = 0; i < planted_count; i++)
        if (memcmp(&planted_memory[i].desc, desc, sizeof *desc) == 0)
            return &planted_memory[i].frame;
    ck_assert_uint_lt(planted_count, sizeof planted_memory / sizeof *planted_memory);
    planted_memory[planted_count].desc = *desc;
    planted_ok(pipeline_render(scene, desc, NULL, &planted_memory[planted_count].frame));
    return &planted_memory[planted_count++].frame;
}

static inline void planted_copy(const Image *image, Image *out)
{
    size_t pixels = (size_t)image->width * (size_t)image->height;
    planted_ok(image_create(image->width, image->height, image->format, out));
    memcpy(out->pixels, image->pixels, pixels * format_pixel_bytes(image->format));
}

/* The Renderer. */
static inline Result planted_render(const Scene *scene, const RenderDesc *desc, TraceSink *trace,
                                    Frame *out)
{
    const Frame *frame = planted_frame(scene, desc);
    (void)trace;
    *out = (Frame){.peels = frame->peels};
    planted_copy(&frame->final, &out->final);
    return RESULT_OK;
}

/* ---- files ---- */

static inline GivenImage planted_given(const Frame *frame, PlantedFile file)
{
    GivenImage given = {.kind = file == PLANTED_PNG ? "PNG" : "EXR",
                        .has_alpha = file == PLANTED_EXR};
    planted_copy(file == PLANTED_PNG ? &frame->display : &frame->final, &given.stored);
    return given;
}

/* Of a rendering with these mistakes. */
static inline GivenImage planted_mistake(const Scene *scene, const RenderDesc *desc,
                                         uint64_t mutations, PlantedFile file)
{
    RenderDesc asked = *desc, applied;
    asked.mutations = mutations;
    mutation_apply(&asked, &applied);
    return planted_given(planted_frame(scene, &applied), file);
}

static inline void planted_diagnose(const Scene *scene, const RenderDesc *desc,
                                    const GivenImage *given, Diagnosis *out)
{
    static const GivenMeaning detect;
    planted_ok(diagnose_run(scene, desc, given, &detect, planted_render, out));
}

/* Whether one of the best, and the only one. */
static inline bool planted_first(const Diagnosis *diagnosis, uint64_t mutations, bool *only)
{
    bool found = false;
    for (size_t i = 0; i < diagnosis->equals; i++)
        found |= diagnosis->rows[i].mutations == mutations;
    *only = found && diagnosis->equals == 1;
    return found;
}

/* A built-in scene or a hard case, with what makes mistakes visible. */
static inline void planted_scene(const char *name, Scene *out)
{
    const BuiltinScene *builtin = generate_find(name);
    const HardScene *hard = hard_scenes_find(name);
    static const float background[3] = {0.2f, 0.3f, 0.4f};
    ck_assert_msg(builtin || hard, "no scene %s", name);
    planted_ok(builtin ? builtin->generate(out) : hard->generate(out));
    memcpy(out->background, background, sizeof background);
    planted_forget();
}

#endif
