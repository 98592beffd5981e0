#define LANES       8
#define TILE_RENDER tile_render_avx2
#include "ref/pipeline/tile_body.h"
