/* exp2, log2 and pow of op.h on LANES floats at once, with the same bits: see there for their
 * errors. Define LANES before including. */
#ifndef PEEL_NUMBER_LANES_POW_H
#define PEEL_NUMBER_LANES_POW_H

#include "number/lanes.h"

/* Zero or denormal, by the bits: compilers take x·1 for x. */
static inline LanesMask lanes_flushes(Lanes x)
{
    return lanes_int_equal(lanes_int_and(lanes_bits(x), lanes_int_all(0x7f800000)),
                           lanes_int_all(0));
}

/* fused: see op_muladd. */
static inline Lanes lanes_exp2(bool fused, Lanes x)
{
    Lanes bounded = lanes_max(lanes_min(x, lanes_all(128.0f)), lanes_all(-126.99999f));
    LanesInt whole = lanes_truncate_to_int(bounded);
    LanesMask rounded_up = lanes_less(bounded, lanes_from_int(whole));
    whole = lanes_int_select(rounded_up, lanes_int_sub(whole, lanes_int_all(1)), whole);
    Lanes f = lanes_sub(bounded, lanes_from_int(whole));
    Lanes f2 = lanes_mul(f, f);
    Lanes even = lanes_muladd(fused, f2, lanes_all(0.00898934009049466391101f),
                              lanes_all(0.240153617044375388211f));
    even = lanes_muladd(fused, f2, even, lanes_all(1.0f));
    Lanes odd = lanes_muladd(fused, f2, lanes_all(0.00187757667519147912699f),
                             lanes_all(0.0558263180532956664775f));
    odd = lanes_muladd(fused, f2, odd, lanes_all(0.693153073200168932794f));
    LanesInt power =
        lanes_int_mul(lanes_int_add(whole, lanes_int_all(127)), lanes_int_all(1 << 23));
    Lanes result = lanes_mul(lanes_from_bits(power), lanes_muladd(fused, odd, f, even));
    return lanes_select(lanes_is_nan(x), x, result);
}

static inline Lanes lanes_log2(bool fused, Lanes x)
{
    Lanes one = lanes_all(1.0f), zero = lanes_all(0.0f), infinity = lanes_all(INFINITY);
    LanesInt bits = lanes_bits(x);
    /* The exponent's bits as a number are exponent · 2^23: no operation here rounds. */
    Lanes exponent = lanes_from_int(lanes_int_and(bits, lanes_int_all(0x7f800000)));
    exponent = lanes_sub(lanes_mul(exponent, lanes_all(0x1p-23f)), lanes_all(127.0f));
    Lanes mantissa = lanes_from_bits(
        lanes_int_or(lanes_int_and(bits, lanes_int_all(0x007fffff)), lanes_int_all(0x3f800000)));
    Lanes y = lanes_div(lanes_sub(mantissa, one), lanes_add(mantissa, one));
    Lanes z = lanes_mul(y, y);
    Lanes w = lanes_mul(z, z);
    Lanes even = lanes_muladd(fused, w, lanes_all(0.406718052498846252698f),
                              lanes_all(0.577440339438736392009f));
    even = lanes_muladd(fused, w, even, lanes_all(2.88539009343309178325f));
    Lanes odd = lanes_muladd(fused, w, lanes_all(0.403343858251329912514f),
                             lanes_all(0.961791550404184197881f));
    Lanes result = lanes_muladd(fused, y, lanes_muladd(fused, odd, z, even), exponent);

    result = lanes_select(lanes_less(x, infinity), result, x); /* NaN and infinity */
    result = lanes_select(lanes_less(x, zero), lanes_from_bits(lanes_int_all(0x7fc00000)), result);
    return lanes_select(lanes_flushes(x), LANES_NEG(infinity), result);
}

static inline Lanes lanes_pow(bool fused, Lanes x, Lanes y)
{
    Lanes zero = lanes_all(0.0f);
    Lanes result = lanes_exp2(fused, lanes_mul(lanes_log2(fused, x), y));
    return lanes_select(lanes_flushes(x), zero, lanes_select(lanes_is_nan(x), zero, result));
}

#endif
