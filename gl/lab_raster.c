#include "lab_draw.h"

#include "number/op.h"

#include <string.h>

static void draw(const Experiment *experiment)
{
    if (experiment->kind == EXPERIMENT_RASTER) {
        gl.Enable(GL_DEPTH_TEST);
        gl.DepthFunc(experiment->depth_func == DEPTH_LEQUAL ? GL_LEQUAL : GL_LESS);
    }
    if (experiment->kind == EXPERIMENT_OVERLAP) {
        gl.BlendFunc(GL_ONE, GL_ONE);
        gl.Enable(GL_BLEND);
    }
    gl.ClipControl(GL_LOWER_LEFT,
                   experiment->zero_to_one ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
    gl.DrawArrays(GL_TRIANGLES, 0, 3 * experiment->count);
    gl.ClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    gl.Disable(GL_DEPTH_TEST);
    gl.Disable(GL_BLEND);
}

static void clear(const LabTarget *target)
{
    static const float none[4] = {0, 0, 0, 0}, far = 1.0f;
    for (int i = 0; i < target->colors; i++)
        gl.ClearNamedFramebufferfv(target->framebuffer, GL_COLOR, i, none);
    if (target->depth)
        gl.ClearNamedFramebufferfv(target->framebuffer, GL_DEPTH, 0, &far);
}

static uint32_t far_code(PixelFormat format)
{
    return format == FORMAT_D32F ? op_bits(1.0f) : format_info(format)->unorm_max;
}

/* Everything of RASTER_FULL; of other layouts the depth. */
static void read_fields(GlLab *lab, const Experiment *experiment, const LabTarget *target,
                        uint32_t *out)
{
    uint32_t *depth = (void *)lab->pixels; /* room for either */
    memset(out, 0, experiment_values(experiment) * sizeof *out);
    lab_read_depth(target, depth);
    for (size_t i = 0; i < RASTER_PIXELS; i++)
        if (experiment->layout == RASTER_FULL || depth[i] != far_code(target->depth_format))
            out[i * RASTER_FIELDS + RASTER_DEPTH] = depth[i];
    if (experiment->layout != RASTER_FULL)
        return;
    lab_read_color(target, 1, lab->pixels);
    for (size_t i = 0; i < RASTER_PIXELS; i++)
        memcpy(&out[i * RASTER_FIELDS + RASTER_X], lab->pixels[i], 3 * sizeof(float));
    lab_read_color(target, 0, lab->pixels);
    for (size_t i = 0; i < RASTER_PIXELS; i++) {
        uint32_t *fields = &out[i * RASTER_FIELDS];
        const float *where = lab->pixels[i];
        fields[RASTER_TRIANGLE] = (uint32_t)where[0];
        fields[RASTER_FRONT] = where[1] != 0.0f;
        fields[RASTER_Z] = op_bits(where[2]);
        fields[RASTER_W] = op_bits(where[3]);
        if (fields[RASTER_TRIANGLE] == 0)
            fields[RASTER_DEPTH] = 0;
    }
}

static void read_counts(GlLab *lab, const LabTarget *target, uint32_t *out)
{
    lab_read_color(target, 0, lab->pixels);
    for (size_t i = 0; i < RASTER_PIXELS; i++)
        out[i] = (uint32_t)lab->pixels[i][0];
}

Result lab_raster(GlLab *lab, const Experiment *experiment, uint32_t *out)
{
    static const char *const defines[] = {
        "#define TRIANGLES\n#define LAYOUT 0\n", "#define TRIANGLES\n#define LAYOUT 1\n",
        "#define TRIANGLES\n#define LAYOUT 2\n", "#define TRIANGLES\n#define LAYOUT 3\n"};
    static const int colors[] = {2, 0, 4, 1};
    bool raster = experiment->kind == EXPERIMENT_RASTER;
    int layout = raster ? (int)experiment->layout : 3;
    LabTarget target;
    Result result = lab_use(lab, defines[layout]);
    if (result == RESULT_OK)
        result =
            lab_target(FORMAT_RGBA32F, colors[layout], raster ? experiment->format : FORMAT_NONE,
                       RASTER_WIDTH, RASTER_HEIGHT, &target);
    if (result != RESULT_OK)
        return result;
    clear(&target);
    lab_upload(lab, experiment, 3 * experiment->count);
    /* As in peeling, not every pass counts samples: softpipe interpolates differently where none
     * does. */
    bool counts = !raster || experiment->layout == RASTER_DISCARD;
    if (counts)
        gl.BeginQuery(GL_SAMPLES_PASSED, lab->query);
    draw(experiment);
    if (counts)
        gl.EndQuery(GL_SAMPLES_PASSED);
    if (experiment->kind == EXPERIMENT_RASTER) {
        read_fields(lab, experiment, &target, out);
    } else if (experiment->kind == EXPERIMENT_OVERLAP) {
        read_counts(lab, &target, out);
    } else {
        GLuint64 samples = 0;
        gl.GetQueryObjectui64v(lab->query, GL_QUERY_RESULT, &samples);
        out[0] = (uint32_t)samples;
    }
    lab_target_destroy(&target);
    return RESULT_OK;
}
