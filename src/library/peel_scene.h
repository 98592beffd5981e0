/* What a PeelScene is. */
#ifndef PEEL_LIBRARY_PEEL_SCENE_H
#define PEEL_LIBRARY_PEEL_SCENE_H

#include "peel.h"
#include "scene/scene.h"

struct PeelScene {
    Scene scene;
};

#endif
