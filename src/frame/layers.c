#include "frame/layers.h"

#include <stdlib.h>

void layers_free(LayerCounts *counts)
{
    free(counts->histogram);
    free(counts->peel_histogram);
    *counts = (LayerCounts){0};
}

int layers_passes(const LayerCount *most, MethodId method)
{
    switch (method) {
    case METHOD_PEEL:
    case METHOD_FORWARD:
        return (int)most->peels + 1;
    case METHOD_PEEL_ID:
        return 3 * (int)most->ids + 1;
    case METHOD_DUAL:
    case METHOD_FORWARD_DUAL:
        return ((int)most->depths + 1) / 2 + 1;
    default:
        return 1;
    }
}
