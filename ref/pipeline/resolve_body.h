/* Resolve and display of LANES pixels: shade_final and shade_display of shade.h with the same bits,
 * one body for every width. Define LANES before including. */
#ifndef PEEL_REF_RESOLVE_BODY_H
#define PEEL_REF_RESOLVE_BODY_H

#include "frame/shading.h"
#include "frame/view.h"
#include "number/lanes_pow.h"

/* unorm8_from_float, as integers. */
static inline LanesInt resolve_unorm8(Lanes x)
{
    /* NaN, −0 and below give 0. */
    Lanes clamped = lanes_min(lanes_max(x, lanes_all(0.0f)), lanes_all(1.0f));
    return lanes_round_to_int(lanes_mul(clamped, lanes_all(255.0f)));
}

/* The display transform of one channel. */
static inline LanesInt resolve_display(bool fused, Lanes final)
{
    Lanes c = lanes_max(final, lanes_all(0.0f));
    Lanes mapped = lanes_div(c, lanes_add(c, lanes_all(1.0f)));
    return resolve_unorm8(lanes_pow(fused, mapped, lanes_all(SHADING_DISPLAY_POWER)));
}

/* From accumulated pixels, channel by channel, to their final colours over the background and
 * their display as RGBA8. weight: the transmittance to the background; fused: see op_pow. Flushing
 * mode. */
static inline void resolve_batch(const View *view, bool fused, const float accum[4][LANES],
                                 const float weight[LANES], float final[4][LANES],
                                 uint8_t display[LANES][4])
{
    Lanes transmittance = lanes_load(weight);
    for (int i = 0; i < 3; i++) {
        Lanes background = lanes_mul(lanes_all(view->background[i]), transmittance);
        Lanes color = lanes_canonical(lanes_add(lanes_load(accum[i]), background));
        lanes_store(final[i], color);
        int32_t value[LANES];
        lanes_int_store(value, resolve_display(fused, color));
        for (int lane = 0; lane < LANES; lane++)
            display[lane][i] = (uint8_t)value[lane];
    }
    lanes_store(final[3], lanes_canonical(lanes_sub(lanes_all(1.0f), transmittance)));
    for (int lane = 0; lane < LANES; lane++)
        display[lane][3] = 255;
}

#endif
