/* The pipeline for a page: ref as WebAssembly, called by engine.js.
 *
 * One scene and one frame at a time. Functions that can fail return a Result; engine_message says
 * what. Strings are JSON unless it is said otherwise, and stay valid until the next call of the
 * same function. Pointers into the frame stay valid until the next engine_render. */
#ifndef PEEL_WEB_ENGINE_H
#define PEEL_WEB_ENGINE_H

#include <stdbool.h>
#include <stddef.h>

/* Room for an input; the caller frees it with engine_free. */
void *engine_room(size_t bytes);
void engine_free(void *room);

const char *engine_message(void); /* plain text */

/* bytes: see scene/blob.h. Settings become the default ones. */
int engine_open(const unsigned char *bytes, size_t count);

/* {"name", "triangles", "lights", "ambient": [3], "background": [3],
 *  "bounds": [[3], [3]] of all instances in world space, "light_degrees_per_second",
 *  "materials": [{"name", "base_color": [4], "roughness", "metallic", "occlusion", "mode":
 *  "opaque"|"mask"|"blend", "double_sided", "textured"}],
 *  "instances": [{"name", "mesh", "material"}],
 *  "cameras": [{"name", "world": [16, column-major], "yfov", "near", "far" (null: none)}]} */
const char *engine_scene(void);

/* [{"name", "choices": ["…"], "value": index}] for methods and frame/setting.h's settings. */
const char *engine_settings(void);

/* name: of engine_settings (an index into its choices), or passes (0: auto), lights (0: all, −1:
 * none), camera, time (seconds), bias, nodes-per-pixel, unfused (0 or 1), and opaque-blend,
 * draw-order and draw-seed as RenderDesc has them. */
int engine_set(const char *name, double value);

/* field: 0 … 3 base colour, linear, and alpha; 4 roughness, 5 metallic, 6 occlusion; in [0, 1]. An
 * alpha of 1 makes the material opaque, a smaller one transparent; field 7 puts it back among the
 * opaque (0) or transparent (1) ones whatever its alpha is. Masked ones stay so. */
int engine_set_material(int material, int field, double value);
int engine_set_ambient(double red, double green, double blue);
/* world: 16 doubles, column-major, affine; yfov: radians; far: infinity for none. */
int engine_set_camera(int camera, const double world[16], double yfov, double near, double far);

/* trace: keeps every buffer of every step, by the definition path; else only the images. */
int engine_render(int width, int height, bool trace);

/* What pixel (x, y), from the top left, of a frame of engine_render's last size went through, with
 * the settings as they are now: frame/history.h's JSON. NULL on failure. */
const char *engine_history(int x, int y);

/* {"width", "height", "peels", "geometry_passes", "time_ms", "fused", "max_layers", "fragments",
 *  "lost_to_ties", "lost_to_pass_limit", "residual_max",
 *  "buffers": [{"name", "step", "format", "width", "height", "at": address}]}: final and display,
 *  then those of the trace in their order. */
const char *engine_frame(void);

#endif
