#define LANES       4
#define TILE_RENDER tile_render_sse2
#include "ref/pipeline/tile_body.h"
