// Whether a transparent fragment is behind the opaque depth or was peeled before.
//
// NEXT_PEEL      compare with the previous peel's depth as well
// TEST_RAW       compare gl_FragCoord.z itself instead of its stored value
// REVERSED       depth is 1 near and 0 far: comparisons are mirrored
// BIAS           added to the previous peel's depth, away from the eye
// DEPTH_24       depth is stored in 24 bits
// DEPTH_16       in 16 bits

// The fetched values of the two greatest 24-bit depths are both 1, so the integers are compared
// where these can meet: at the far end, or reversed near the eye.
#if defined(DEPTH_24) && !defined(TEST_RAW)
#define OPAQUE_CODE
#if defined(REVERSED) && !defined(BIAS)
#define PREVIOUS_CODE
#endif
#endif
#ifdef OPAQUE_CODE
layout(binding = 1) uniform usampler2D opaque_depth;
#else
layout(binding = 1) uniform sampler2D opaque_depth;
#endif
#ifdef PREVIOUS_CODE
layout(binding = 0) uniform usampler2D previous_depth;
#else
layout(binding = 0) uniform sampler2D previous_depth;
#endif

#ifdef REVERSED
#define AT_OR_BEHIND(a, b) ((a) <= (b))
#else
#define AT_OR_BEHIND(a, b) ((a) >= (b))
#endif

// A window depth as the depth buffer stores it, NaN as 1: what a fetch of it gives, and the stored
// integer, or bits, whose order is the depth's.
float stored_depth(float window, out uint key)
{
    precise float z = window;
    z = z < 1.0 ? z : 1.0;
    z = z > 0.0 ? z : 0.0;
    key = floatBitsToUint(z);
#ifdef DEPTH_24
    precise float scaled = z * 16777215.0;
    precise float code = roundEven(scaled);
    key = uint(code);
    z = code * (1.0 / 16777215.0);
#endif
#ifdef DEPTH_16
    precise float scaled = z * (65535.0 / 65536.0);
    precise float shifted = scaled + 128.0; // the low bits of the mantissa are the code
    key = floatBitsToUint(shifted) & 0xffffu;
    z = float(key) * (1.0 / 65535.0);
#endif
    return z;
}

// Of a transparent fragment at window depth `window`.
bool is_hidden(float window)
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    uint code;
    precise float z = stored_depth(window, code);
#if defined(OPAQUE_CODE)
    return AT_OR_BEHIND(code, texelFetch(opaque_depth, pixel, 0).r);
#elif defined(TEST_RAW)
    return AT_OR_BEHIND(window, texelFetch(opaque_depth, pixel, 0).r);
#else
    return AT_OR_BEHIND(z, texelFetch(opaque_depth, pixel, 0).r);
#endif
}

bool is_peeled_or_hidden()
{
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    precise float z = gl_FragCoord.z;
    if (is_hidden(z))
        return true;
#ifndef TEST_RAW
    uint code;
    z = stored_depth(z, code);
#if defined(NEXT_PEEL) && defined(PREVIOUS_CODE)
    if (AT_OR_BEHIND(texelFetch(previous_depth, pixel, 0).r, code))
        return true;
#endif
#endif
#if defined(NEXT_PEEL) && !defined(PREVIOUS_CODE)
    precise float previous = texelFetch(previous_depth, pixel, 0).r;
#ifdef BIAS
#ifdef REVERSED
    previous = previous - BIAS;
#else
    previous = previous + BIAS;
#endif
#endif
    if (AT_OR_BEHIND(previous, z))
        return true;
#endif
    return false;
}
