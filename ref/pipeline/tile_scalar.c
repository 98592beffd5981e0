#define LANES       1
#define TILE_RENDER tile_render_scalar
#include "ref/pipeline/tile_body.h"
