/* What generators of scenes are made of: placements, materials, cameras and lights. */
#ifndef PEEL_SCENE_PIECES_H
#define PEEL_SCENE_PIECES_H

#include "scene/builder.h"

#define PIECES_PI 3.141592653589793

/* The double nearest to x that a float can hold. */
double pieces_float(double x);

/* An instance. Placements are rounded to float, so that a file keeps them exactly whoever reads it.
 */
void pieces_place(Builder *builder, const char *name, uint32_t mesh, uint32_t material,
                  const Matrix *world);
void pieces_place_at(Builder *builder, const char *name, uint32_t mesh, uint32_t material, double x,
                     double y, double z);

/* A dielectric or metal; alpha below 1 makes it transparent and visible from both sides. */
uint32_t pieces_surface(Builder *builder, const char *name, const float color[4], float roughness,
                        float metallic);

typedef struct Gaze {
    const char *name;
    double eye[3], target[3];
    double yfov, near, far;
} Gaze;

/* A camera with y up, its matrix rounded to float. */
void pieces_look(Builder *builder, const Gaze *gaze);

/* A light whose brightness does not fall with distance: only its direction matters. */
void pieces_lamp(Builder *builder, double x, double y, double z, float r, float g, float b);

/* A quarter turn that lays a plane facing +z down, facing +y; then moved. */
Matrix pieces_lying(double x, double y, double z);

#endif
