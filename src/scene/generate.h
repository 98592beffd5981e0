/* The built-in scenes: made by arithmetic and a seeded generator, the same bytes everywhere. */
#ifndef PEEL_SCENE_GENERATE_H
#define PEEL_SCENE_GENERATE_H

#include "scene/scene.h"

typedef struct BuiltinScene {
    const char *name;
    const char *summary; /* one line */
    Result (*generate)(Scene *out);
} BuiltinScene;

/* Static table, in the order of the documentation; *count rows. */
const BuiltinScene *generate_table(size_t *count);
/* NULL when there is no such scene. */
const BuiltinScene *generate_find(const char *name);

#endif
