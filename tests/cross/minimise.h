/* A scene on which something fails, reduced to the few triangles, lights, passes and settings that
 * it takes. */
#ifndef PEEL_TESTS_MINIMISE_H
#define PEEL_TESTS_MINIMISE_H

#include "frame/render_desc.h"
#include "scene/scene.h"

/* Whether the failure shows; called some hundreds of times. */
typedef bool (*MinimiseFails)(const Scene *scene, const RenderDesc *desc);

typedef struct Minimal {
    Scene scene; /* one mesh per instance; materials, lights and cameras are the caller's scene's */
    RenderDesc desc;
    uint32_t triangles;
} Minimal;

/* fails(scene, desc) holds; so it does for what is found, of which no single triangle, light or
 * setting can be left out. scene must outlive *out, which the caller frees with minimise_free.
 * NO_MEMORY on failure.
 * Source: Zeller, Hildebrandt, "Simplifying and Isolating Failure-Inducing Input", IEEE TSE 28(2),
 * 2002 (ddmin, reduction to complements). */
Result minimise(const Scene *scene, const RenderDesc *desc, MinimiseFails fails, Minimal *out);
void minimise_free(Minimal *minimal);

typedef struct MinimisedFile {
    uint32_t triangles;
    size_t lights;
    bool shown;         /* the file, read again, still fails */
    char command[1800]; /* that shows it, from the source folder */
} MinimisedFile;

/* The same as a glTF file at path, relative to the working directory. Fails as writing and reading
 * it do. */
Result minimise_to_file(const Scene *scene, const RenderDesc *desc, MinimiseFails fails,
                        const char *path, MinimisedFile *out);

/* The options of `peel` that ask for desc; one that has none of its own comes with the profile. */
void minimise_options(const RenderDesc *desc, char *text, size_t size);

#endif
