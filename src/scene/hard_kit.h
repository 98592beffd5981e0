/* Pieces of the hard cases' scenes. Private to src/scene/hard_*.c.
 *
 * The camera is at the origin and looks along −z with a field of view of 90°: the image's edges are
 * at x, y = ±|z|, so that what is placed on pixel edges or centres is there without rounding. */
#ifndef PEEL_SCENE_HARD_KIT_H
#define PEEL_SCENE_HARD_KIT_H

#include "scene/pieces.h"

/* With light of 1 from everywhere and one lamp that is dark a surface shows its own colour, times
 * alpha. */
Builder hard_kit_begin(const char *name, double near, double far);

/* Without it, as much again from the lamps: a key light and a weaker one from the other side. */
void hard_kit_lamps(Builder *builder);

/* An upright rectangle that faces the camera; z negative. */
typedef struct HardQuad {
    double x0, y0, x1, y1, z;
} HardQuad;
typedef double HardTriangle[3][3];

/* One mesh of them all, in order, two triangles each; the index. */
uint32_t hard_kit_quads(Builder *builder, const HardQuad *quads, size_t count);
/* With normals of the triangles' own planes; (0, 0, 1) where a triangle has none. */
uint32_t hard_kit_triangles(Builder *builder, const HardTriangle *triangles, size_t count);
/* One quad from corners in counter-clockwise order, with the normals given: 3 for each corner. */
uint32_t hard_kit_patch(Builder *builder, const double corners[4][3], const double normals[4][3]);

/* Seen over the same pixels wherever it stands: x, y from −z·part to z·part. */
HardQuad hard_kit_pane(double z, double part);

/* In the list of transparent surfaces even at alpha 1; double-sided; roughness 0.5. */
uint32_t hard_kit_glass(Builder *builder, float r, float g, float b, float a);
/* The same in one of eight colours. */
uint32_t hard_kit_tint(Builder *builder, int color, float a);
uint32_t hard_kit_wall(Builder *builder, float gray); /* opaque, rough */

void hard_kit_put(Builder *builder, uint32_t mesh, uint32_t material); /* where it was made */

/* `count` panes at distances first, first + step, …, of one alpha, in up to eight colours, drawn
 * in an order that is neither front to back nor back to front. */
void hard_kit_stack(Builder *builder, int count, double first, double step, int colors, float a);

#endif
