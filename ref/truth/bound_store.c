#include "ref/truth/bound_store.h"

#define U BOUNDED_SINGLE

static Bounded widen(Bounded x, double error)
{
    x.single = bounded_limit((x.single + error) * BOUNDED_SLACK);
    return x;
}

/* What clamping to [low, high] does to the single-precision number about x.value, which the truth
 * does not clamp. */
static Bounded clamped(Bounded x, double low, double high)
{
    double over = x.value - high, under = low - x.value;
    return widen(x, over > 0.0 ? over : under > 0.0 ? under : 0.0);
}

/* Stored as an integer of at most `most`. A number that is known to the bit is stored as the
 * format does. */
static Bounded store_unorm(Bounded x, double most)
{
    float known = (float)x.value;
    if (x.single == 0.0 && (double)known == x.value && known >= 0.0f && known <= 1.0f) {
        float code = rintf(known * (float)most), fetched = code * (float)(1.0 / most);
        return widen(x, fabs((double)fetched - x.value));
    }
    x = clamped(x, 0.0, 1.0);
    return widen(x, 0.5 / most * (1.0 + 4.0 * U) + 4.0 * U);
}

/* Truncated toward zero; what overflows ends at 65504. */
static Bounded store_half(Bounded x)
{
    double size = fabs(x.value) + x.single;
    float known = (float)x.value;
    if (x.single == 0.0 && (double)known == x.value && fmodf(known, 0x1p-10f) == 0.0f &&
        fabs(x.value) <= 1.0)
        return x;
    double over = size > 65504.0 ? size - 65504.0 : 0.0;
    return widen(x, size * 0x1p-10 + 0x1p-24 + over);
}

Bounded bound_store(PixelFormat format, Bounded x)
{
    const FormatInfo *info = format_info(format);
    if (info->kind == KIND_UNORM)
        return store_unorm(x, info->unorm_max);
    if (info->kind == KIND_HALF)
        return store_half(x);
    return x.single > 0.0 ? widen(x, BOUNDED_TINY) : x;
}

Bounded bound_store_depth(PixelFormat format, Bounded depth)
{
    depth = clamped(depth, 0.0, 1.0);
    if (format == FORMAT_D32F)
        return widen(depth, BOUNDED_TINY);
    double most = format == FORMAT_D24 ? 16777215.0 : 65535.0;
    return widen(depth, 0.5 / most * (1.0 + 4.0 * U) + 6.0 * U);
}

/* Rounding either channel moves the point of the octahedron by (1, 1, 2)/65535 at most, which from
 * 1/√3, its least distance, is an angle of √18/65535; then the coding's own roundings. The sphere
 * is continuous where the octahedron is folded. A normal whose length is not 1 (none at all) gets
 * a length, and a direction. */
void bound_store_octahedral(Bounded normal[3])
{
    double length2 = 0.0, error = 0.0;
    for (int i = 0; i < 3; i++) {
        length2 += normal[i].value * normal[i].value;
        error = fmax(error, normal[i].single);
    }
    double angle = 4.2426407 / 65535.0 + 64.0 * U, off = fabs(sqrt(length2) - 1.0);
    for (int i = 0; i < 3; i++)
        normal[i] = widen(normal[i], off < 0x1p-10 ? angle + 4.0 * off + 4.0 * error : 2.0);
}

void bound_unproject(const Unprojection *from, Bounded depth, int x, int y, Bounded position[3])
{
    Bounded t = bounded_max(bounded_add(bounded_mul(depth, bounded_of(from->depth_scale)),
                                        bounded_of(from->depth_offset)),
                            bounded_of(from->inverse_far));
    Bounded z = bounded_div(bounded_of(1.0), t);
    const int pixel[2] = {x, y};
    for (int i = 0; i < 2; i++) {
        Bounded ray = bounded_add(bounded_mul(bounded_of(pixel[i]), bounded_of(from->ray_scale[i])),
                                  bounded_of(from->ray_offset[i]));
        position[i] = bounded_about(position[i], bounded_mul(ray, z));
    }
    position[2] = bounded_about(position[2], bounded_neg(z));
}

/* Integers: the source is stored first; a product is within 1 of the correctly rounded one. */
static void under_unorm(PixelFormat format, const Bounded source[4], Bounded rgba[4])
{
    double step = 1.5 / format_info(format)->unorm_max;
    Bounded T = rgba[3], stored[4];
    for (int i = 0; i < 4; i++)
        stored[i] = bound_store(format, source[i]);
    bool gone = T.value == 0.0 && T.single == 0.0; /* 0 times a code is 0 */
    for (int i = 0; i < 3; i++) {
        Bounded product = bounded_mul(stored[i], T);
        rgba[i] = bounded_add(gone ? product : widen(product, step), rgba[i]);
        rgba[i] = clamped(rgba[i], 0.0, 1.0);
    }
    Bounded keep = bounded_sub(bounded_of(1.0), stored[3]);
    gone = gone || (keep.value == 0.0 && keep.single == 0.0);
    rgba[3] = bounded_mul(T, keep);
    rgba[3] = gone ? rgba[3] : clamped(widen(rgba[3], step), 0.0, 1.0);
}

void bound_blend_under(PixelFormat format, const Bounded source[4], Bounded rgba[4])
{
    if (format_info(format)->kind == KIND_UNORM) {
        under_unorm(format, source, rgba);
        return;
    }
    Bounded T = rgba[3];
    for (int i = 0; i < 3; i++)
        rgba[i] = bound_store(format, bounded_add(bounded_mul(source[i], T), rgba[i]));
    /* The product of the source's alpha and 0 is 0. */
    rgba[3] = bound_store(format, bounded_mul(T, bounded_sub(bounded_of(1.0), source[3])));
}
