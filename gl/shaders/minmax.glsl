// Dual depth peeling: distances that grow away from the eye, and (-nearest, farthest) of them.
//
// REVERSED       depth is 1 near and 0 far

const vec2 NO_LAYER = vec2(-2.0);

// The depth, clamped as a depth buffer does it; NaN becomes 1.
float fragment_distance()
{
    precise float z = gl_FragCoord.z;
    z = z < 1.0 ? z : 1.0;
    z = z > 0.0 ? z : 0.0;
#ifdef REVERSED
    return -z;
#else
    return z;
#endif
}

// The depth that a distance stands for.
float distance_depth(float distance)
{
#ifdef REVERSED
    return -distance;
#else
    return distance;
#endif
}
