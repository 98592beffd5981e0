/* Meshes made by arithmetic: indexed triangles, counter-clockwise seen from outside, unit normals.
 *
 * Every function allocates *out (free as a Scene's mesh), or returns NO_MEMORY and leaves it empty.
 * Sizes are finite and positive. Nothing here reads a file or calls libm. */
#ifndef PEEL_SCENE_SHAPES_H
#define PEEL_SCENE_SHAPES_H

#include "scene/scene.h"

/* A mesh with room for this many vertices (no uv) and triangles, its counts set, all zero. */
Result shapes_allocate(uint32_t vertex_count, uint32_t triangle_count, Mesh *out);
void shapes_free(Mesh *mesh); /* leaves an empty mesh */

/* width × height in the plane z = 0 around the origin, facing +z, in columns × rows quads. */
Result shapes_plane(double width, double height, uint32_t columns, uint32_t rows, Mesh *out);

/* Poles on the y axis; segments ≥ 3 around, rings ≥ 2 from pole to pole. */
Result shapes_sphere(double radius, uint32_t segments, uint32_t rings, Mesh *out);

/* A ring around the y axis: a circle of radius minor swept along one of radius major > minor;
 * segments ≥ 3 along the ring, sides ≥ 3 around its tube. */
Result shapes_torus(double major, double minor, uint32_t segments, uint32_t sides, Mesh *out);

/* The inside of a cube of half-size `half` whose edges and corners are cut at 45° by `bevel`, flat
 * normals inward. */
Result shapes_room(double half, double bevel, Mesh *out);

#endif
