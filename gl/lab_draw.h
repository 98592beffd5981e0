/* What the parts of lab.c share: targets and programs of one experiment. */
#ifndef PEEL_GL_LAB_DRAW_H
#define PEEL_GL_LAB_DRAW_H

#include "lab.h"

enum {
    LAB_COLORS_MAX = 4,
    LAB_PROGRAMS = 8
};

typedef struct LabProgram {
    char defines[256]; /* what it was built with */
    GLuint program;
} LabProgram;

struct GlLab {
    Lab lab;
    Context *context;
    GLuint operands[2]; /* RGBA32F textures, units 0 and 1 */
    GLuint vertex_array, query;
    LabProgram programs[LAB_PROGRAMS]; /* the latest ones, taking turns */
    int next_program;
    float (*pixels)[4]; /* room for a read-back of EXPERIMENT_TEXELS */
};

typedef struct LabTarget {
    GLuint color[LAB_COLORS_MAX], depth, framebuffer;
    PixelFormat color_format, depth_format; /* FORMAT_NONE: without depth */
    int colors, width, height;
} LabTarget;

/* A framebuffer of those formats and that size, bound and viewed. The caller destroys it. */
Result lab_target(PixelFormat color_format, int colors, PixelFormat depth_format, int width,
                  int height, LabTarget *out);
void lab_target_destroy(LabTarget *target);
/* The codes of a depth target as the format has them. out: width·height. */
void lab_read_depth(const LabTarget *target, uint32_t *out);
/* Pixels of colour target i in their format. */
void lab_read_color(const LabTarget *target, int i, void *out);
/* A colour texture of the format, for nearest fetches. */
GLuint lab_texture(PixelFormat format, int width, int height);

/* Makes the program of experiment.*.glsl with these defines current. */
Result lab_use(GlLab *lab, const char *defines);

/* The first `texels` texels of the operands. */
void lab_upload(GlLab *lab, const Experiment *experiment, int texels);

/* EXPERIMENT_RASTER, EXPERIMENT_OVERLAP and EXPERIMENT_SAMPLES. */
Result lab_raster(GlLab *lab, const Experiment *experiment, uint32_t *out);

#endif
