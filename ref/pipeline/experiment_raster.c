#include "ref/pipeline/experiment.h"

#include "ref/pipeline/fragment.h"

/* One experiment's triangles on their way to pixels. */
typedef struct Drawing {
    const Experiment *experiment;
    Viewport viewport;
    Pass pass; /* for its arithmetic mode */
    uint32_t triangle;
    uint32_t *out;
} Drawing;

static void count_pixel(void *context, const Setup *setup, int x, int y)
{
    (void)setup;
    const Drawing *drawing = context;
    if (drawing->experiment->kind == EXPERIMENT_SAMPLES)
        drawing->out[0]++;
    else
        drawing->out[y * RASTER_WIDTH + x]++;
}

static void field_pixel(void *context, const Setup *setup, int x, int y)
{
    const Drawing *drawing = context;
    const Experiment *experiment = drawing->experiment;
    uint32_t *fields = &drawing->out[(y * RASTER_WIDTH + x) * RASTER_FIELDS];
    float z = setup_depth_at(drawing->pass.fused, setup, x, y);
    uint32_t key = depth_key(experiment->format, z);
    uint32_t stored = fields[RASTER_TRIANGLE] ? fields[RASTER_DEPTH]
                                              : depth_key_far(experiment->format, DEPTH_RANGE_GL);
    if (!(experiment->depth_func == DEPTH_LEQUAL ? key <= stored : key < stored))
        return;
    const Vertex *const *v = setup->corner;
    Plane w_plane = setup_plane(setup, v[0]->window[3], v[1]->window[3], v[2]->window[3]);
    float w = plane_at(drawing->pass.fused, &w_plane, x, y);
    float inverse_w = fragment_inverse_w(&drawing->pass, setup, x, y);
    fields[RASTER_TRIANGLE] = drawing->triangle + 1;
    fields[RASTER_FRONT] = setup->front;
    fields[RASTER_Z] = op_bits(z);
    fields[RASTER_W] = op_bits(w);
    for (int i = 0; i < 3; i++)
        fields[RASTER_X + i] = op_bits(fragment_varying(
            &drawing->pass, setup,
            (float[3]){v[0]->position[i], v[1]->position[i], v[2]->position[i]}, inverse_w, x, y));
    fields[RASTER_DEPTH] = key;
}

static void draw_piece(Drawing *drawing, const Vertex *const corners[3])
{
    static const PixelRect all = {0, 0, RASTER_WIDTH - 1, RASTER_HEIGHT - 1};
    Setup setup;
    if (setup_facing(corners, false) == FACING_NONE)
        return;
    setup_triangle(corners, false, RASTER_WIDTH, RASTER_HEIGHT, &setup);
    if (drawing->experiment->kind == EXPERIMENT_RASTER)
        setup_visit(&setup, all, field_pixel, drawing);
    else
        setup_visit(&setup, all, count_pixel, drawing);
}

static void draw_triangle(Drawing *drawing)
{
    Vertex vertices[3];
    const Vertex *corners[3];
    unsigned any = 0, all = ~0u;
    for (uint32_t i = 0; i < 3; i++) {
        size_t at = 3 * (size_t)drawing->triangle + i;
        vertices[i] = (Vertex){0};
        memcpy(vertices[i].clip, drawing->experiment->a[at], sizeof vertices[i].clip);
        memcpy(vertices[i].position, drawing->experiment->b[at], sizeof vertices[i].position);
        viewport_transform(&drawing->viewport, false, &vertices[i]);
        corners[i] = &vertices[i];
        unsigned outcode = clip_outcode(&drawing->viewport, corners[i]);
        any |= outcode;
        all &= outcode;
    }
    if (all)
        return;
    if (!any) {
        draw_piece(drawing, corners);
        return;
    }
    ClipVertex polygon[CLIP_VERTICES_MAX];
    const Vertex *vertex[CLIP_VERTICES_MAX];
    int count = clip_triangle(&drawing->viewport, corners, any, polygon);
    for (int i = 0; i < count; i++)
        vertex[i] = polygon[i].source < 0 ? &polygon[i].fresh : corners[polygon[i].source];
    for (int i = 2; i < count; i++)
        draw_piece(drawing, (const Vertex *const[3]){vertex[i - 1], vertex[i], vertex[0]});
}

void experiment_raster(bool fused, const Experiment *experiment, uint32_t *out)
{
    DepthRange range = experiment->zero_to_one ? DEPTH_RANGE_ZERO_ONE : DEPTH_RANGE_GL;
    Drawing drawing = {
        .experiment = experiment,
        .viewport = viewport_make(RASTER_WIDTH, RASTER_HEIGHT, range, fused),
        .pass = {.fused = fused},
        .out = out,
    };
    memset(out, 0, experiment_values(experiment) * sizeof *out);
    for (int i = 0; i < experiment->count; i++) {
        drawing.triangle = (uint32_t)i;
        draw_triangle(&drawing);
    }
    if (experiment->kind != EXPERIMENT_RASTER || experiment->layout == RASTER_FULL)
        return;
    for (size_t i = 0; i < RASTER_PIXELS; i++) /* see RasterLayout */
        memset(&out[i * RASTER_FIELDS], 0, RASTER_DEPTH * sizeof *out);
}
