#define LANES       16
#define TILE_RENDER tile_render_avx512
#include "ref/pipeline/tile_body.h"
