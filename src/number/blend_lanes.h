/* The blends of blend.h on 32-bit floats, LANES pixels at a time: source and stored are channels.
 * Define LANES before including, as for lanes.h. Flushing mode. */
#ifndef PEEL_NUMBER_BLEND_LANES_H
#define PEEL_NUMBER_BLEND_LANES_H

#include "number/lanes.h"

/* rgb = source·T + rgb; a = source.a·0 + T·(1 − source.a), T the stored alpha. */
static inline void blend_lanes_under(const Lanes source[4], Lanes stored[4])
{
    Lanes transmittance = stored[3];
    for (int i = 0; i < 3; i++)
        stored[i] = lanes_canonical(lanes_add(lanes_mul(source[i], transmittance), stored[i]));
    /* The factor ZERO is a multiplication by 0 in the driver too. */
    stored[3] =
        lanes_canonical(lanes_add(lanes_mul(source[3], lanes_all(0.0f)),
                                  lanes_mul(transmittance, lanes_sub(lanes_all(1.0f), source[3]))));
}

/* rgba = source·T + rgba. */
static inline void blend_lanes_seed(const Lanes source[4], Lanes stored[4])
{
    Lanes transmittance = stored[3];
    for (int i = 0; i < 4; i++)
        stored[i] = lanes_canonical(lanes_add(lanes_mul(source[i], transmittance), stored[i]));
}

#endif
