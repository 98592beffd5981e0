/* The shading formula, written once: the order of operations that ref/pipeline (single precision,
 * through op.h) and gl (GLSL, `precise`) follow to the letter, and that ref/truth evaluates in
 * double with its own code.
 *
 * Source: L. Rapetta, "OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling" and its program:
 * Cook-Torrance with GGX distribution, Schlick-GGX geometry term, Schlick's Fresnel. The clamps
 * are ours, so that no stored value is ever NaN.
 *
 * Everything is in view space; the eye is at 0. dot, cross, max, clamp, inversesqrt, mix:
 * GLSL's, as number/op.h states them; `a·b·c` is (a·b)·c.
 *
 * Geometry pass, per fragment, from smooth varyings p, n and uv:
 *   N = n · inversesqrt(max(dot(n, n), SHADING_TINY));  faced: −N on a back face
 *   base = base colour and alpha, · the sample of the base-colour texture where there is one;
 *   roughness and metallic, · green and blue of the metallic-roughness texture where there is one.
 *   MASK: discarded where base.a < cutoff.
 *   stored: depth; normal (N, 0); position (p, 1); diffuse (base.rgb, base.a; alpha 1 unless
 *   BLEND); material (roughness, metallic, occlusion, 1). Cleared to 0; depth to 1.
 *   A transparent fragment is discarded where its depth ≥ the opaque depth, and, from the second
 *   peel on, where its depth ≤ the previous peel's. With DEPTH_RANGE_REVERSED depth is cleared to 0
 *   and every comparison of depths is mirrored.
 *
 * A texture of w × h texels is sampled at uv = (u, v); u first, v alike with h:
 *   c = u − floor(u)                                      WRAP_REPEAT
 *   c = u                                                 WRAP_CLAMP
 *   m = u − 2·floor(u·0.5);  c = m > 1 ? 2 − m : m        WRAP_MIRROR
 *   x = clamp(c, 0, 1)·w  (bilinear: − 0.5);  i = floor(x);  f = x − i
 *   texels i and i + 1; one outside is taken modulo w (WRAP_REPEAT) or clamped to the edge.
 *   nearest: texel (i, j); bilinear: mix(mix(t00, t10, f), mix(t01, t11, f), g), f for u.
 *   NaN gives c = 0. Each is the glTF sampler at level 0 (OpenGL 4.6, 8.14.2 and 8.14.3).
 *
 * Octahedral normals (GBUFFER_COMPACT; Cigolle et al., "A Survey of Efficient Representations for
 * Independent Unit Vectors", JCGT 3(2), 2014), stored in two channels:
 *   p = N.xy / max((|N.x| + |N.y|) + |N.z|, SHADING_TINY);  N.z < 0: p = (1 − |p.yx|)·s(p.xy)
 *   stored: p·0.5 + 0.5, where s(a) is −1 for a < 0, else 1
 *   decoded: p = stored·2 − 1;  z = (1 − |p.x|) − |p.y|;  z < 0: p as above
 *            N = (p, z) · inversesqrt(max(dot of it with itself, SHADING_TINY))
 *   N = 0, of a vertex with a normal of length 0, has no such form and comes back as (0, 0, 1).
 * Position from the stored depth d as it is fetched, at integer pixel (x, y), y up, with the
 * view's Unprojection:
 *   t = max(d·depth_scale + depth_offset, inverse_far);  z = 1/t
 *   P = ((x·ray_scale.x + ray_offset.x)·z, (y·ray_scale.y + ray_offset.y)·z, −z)
 *
 * Lighting pass, per pixel, from the stored values P, N, diffuse, alpha, roughness, metallic, ao;
 * discarded where alpha ≤ SHADING_ALPHA_TEST:
 *   V   = (−P) · inversesqrt(max(dot(P, P), SHADING_TINY))
 *   r   = min(max(roughness, SHADING_ROUGHNESS_MIN), 1)
 *   a   = r·r;  a2 = a·a;  am = a2 − 1
 *   k1  = r + 1;  k = k1·k1·0.125;  km = 1 − k
 *   NV  = max(dot(N, V), 0);  GV = NV / (NV·km + k);  NV4 = 4·NV
 *   F0  = mix(0.04, diffuse, metallic);  Fm = 1 − F0
 *   lambert = diffuse·(1 − metallic) / SHADING_PI
 *   sum = 0, and for every light in order:
 *     D   = light.position − P;  d2 = max(dot(D, D), SHADING_DISTANCE2_MIN);  d = sqrt(d2)
 *     L   = D · (1/d)
 *     h   = V + L;  H = h · inversesqrt(max(dot(h, h), SHADING_TINY))
 *     NL  = max(dot(N, L), 0);  NH = max(dot(N, H), 0);  HV = max(dot(H, V), 0)
 *     den = NH·NH·am + 1;  dist = a2 / (SHADING_PI·den·den)
 *     GL  = NL / (NL·km + k)
 *     x   = clamp(1 − HV, 0, 1);  x2 = x·x;  x5 = x2·x2·x;  F = F0 + Fm·x5
 *     s   = dist·(GV·GL) / (NV4·NL + SHADING_SPECULAR_BIAS)
 *     att = 1 / (att.constant + att.linear·d + att.quadratic·d2)
 *     q   = min(d2·light.inverse_range2, 1);  att = att·(1 − q·q)
 *     sum = sum + ((1 − F)·lambert + F·s) · (color·att·NL)
 *   c   = sum + ambient·diffuse·ao
 *   source = (c·alpha, alpha)
 *
 * The factor 1 − q·q is the window of glTF's KHR_lights_punctual, max(min(1 − (d/range)⁴, 1), 0):
 * exactly 0 where q = 1, from the range on, and exactly 1 of a light without end, whose
 * inverse_range2 is 0, so that it may be left out.
 *
 * A light with NL = 0 or q = 1 adds exactly 0 and may be skipped: what 0 is multiplied with is
 * finite. Rounding makes NH² exceed 1 by less than 2e-6, and a2 is at least 4e-6, so that the
 * source's den, 1 − (1 − a2)·NH², stays above 0.
 *
 * With GGX_STABLE the distribution's denominator does not subtract (N·H)² from 1, which leaves few
 * right digits near a highlight:
 *     S   = cross(N, H);  S2 = dot(S, S)
 *     den = max(NH·NH·a2 + S2, a2)
 *   (cross's x is N.y·H.z − N.z·H.y.) For unit N and H and NH not clamped, S2 = 1 − NH², so in
 * exact arithmetic den is the source's, NH²·am + 1, and never below a2: max only stops what
 * rounding, or a guarded N or H shorter than 1, would make smaller, so that dist is finite. Where
 * NH is clamped, N·V or N·L is not positive and GV·GL = 0: both forms give no lobe. An N whose
 * stored length is 1 + e scales den by 1 + 2e, an error as small as e, where the source's form adds
 * about 2e to a den that may be as small as a2. ref/truth computes the source's form: in double the
 * cancellation does not matter. Measured on 20 000 highlights at roughness 0.045 to 0.3
 * (tests/unit/test_shade.c), largest relative error of the lit colour: 6.7e-5, and 0.16 in the
 * source's form.
 *
 * With back_light, in the lighting passes of peels only, a light behind the surface is mirrored to
 * the side of N and adds its specular lobe, without the Lambert term:
 *     u   = dot(N, L);  m = max(−u, 0);  L = L + 2·m·N      before h
 *     NL  = max(u, m)                                       |u|, in place of max(dot(N, L), 0)
 *     where u < 0, 0 stands for lambert
 *   A light in front has m = 0 and the same bits as without. N is the stored one: where it is
 *   turned from the viewer (NORMALS_KEPT), NV = 0 and there is no lobe, as without.
 *
 * With POST_EDGES (METHOD_LINKED_LIST), outlines in every layer and of the opaque surfaces: a
 * fragment of layer K is on an edge where one of the 4 neighbours of its pixel that are inside the
 * image has no fragment in layer K, or one with normal N' and distance z' such that
 *     dot(N, N') < SHADING_EDGE_DOT  or  |z − z'| > SHADING_EDGE_DEPTH·z
 * from the stored values, z = −P.z. A pixel without a fragment is one whose stored material has a
 * fourth channel of 0. There c = 0: source = (0, 0, 0, alpha).
 *
 * With SHADING_PHONG (after a WebGPU tutorial on depth peeling, whose light and eye are directions)
 * N, diffuse and alpha alone matter; L is SHADING_PHONG_LIGHT, the eye at +z, I the ambient light
 * SHADING_PHONG_AMBIENT, and the power 20 is three products:
 *     NL  = dot(N, L);  R = 2·NL·N − L;  RV = max(R.z, 0)
 *     x2  = RV·RV;  x4 = x2·x2;  x8 = x4·x4;  x20 = x8·x8·x4
 *     c   = (I + max(NL, 0)·diffuse) + x20
 *     source = (c·alpha, alpha)
 *
 * Under-blend into the accumulation buffer, cleared to (0, 0, 0, 1):
 *   rgb = source.rgb·dst.a + dst.rgb;  a = source.a·0 + dst.a·(1 − source.a)
 *   the opaque pass with OPAQUE_BLEND_SEED: all four channels source·dst.a + dst
 *
 * Resolve, per pixel: T = accum.a, or with OPAQUE_BLEND_SEED 0 where the opaque G-buffer's alpha
 * > SHADING_ALPHA_TEST;
 *   final = (accum.rgb + background·T, 1 − T)
 *   display = (pow(c / (c + 1), SHADING_DISPLAY_POWER) of c = max(final.rgb, 0), 1) */
#ifndef PEEL_FRAME_SHADING_H
#define PEEL_FRAME_SHADING_H

#define SHADING_TINY          1e-20f
#define SHADING_ALPHA_TEST    1e-4f
#define SHADING_ROUGHNESS_MIN 0.045f
#define SHADING_DISTANCE2_MIN 1e-4f
#define SHADING_SPECULAR_BIAS 1e-4f
#define SHADING_EDGE_DOT      0.8f
#define SHADING_EDGE_DEPTH    0.05f
#define SHADING_PI            3.14159265f
/* Towards the light, view space: of length 1, right, above and before the surface. */
#define SHADING_PHONG_LIGHT_X    0.48f
#define SHADING_PHONG_LIGHT_Y    0.6f
#define SHADING_PHONG_LIGHT_Z    0.64f
#define SHADING_PHONG_AMBIENT_R  0.15f
#define SHADING_PHONG_AMBIENT_GB 0.1f
#define SHADING_DISPLAY_POWER    0.45454547f /* 1/2.2 */

#endif
