/* A renderer that is none of Peel's: depth peeling in plain OpenGL on OSMesa, from what `peel
 * scenes NAME --export DIR` writes (contract.json, vertices.bin, indices.bin, shade.glsl) and
 * peel_dump.h. It lights fragments as it draws them; textures are left out.
 *
 *     foreign DIR image.png trace.peel
 *
 * -DMISTAKE_... builds it with a mistake that people make. */
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>

#include <GL/glext.h>
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb_image_write.h>

#include "contract.h"
#include "peel_dump.h"
#include "shaders.h"

enum {
    OPAQUE,
    EVEN,
    ODD,
    ACCUM,
    SHOWN,
    TARGETS
};
static GLuint framebuffers[TARGETS], colors[TARGETS], depths[TARGETS];
static int width, height;

static GLuint program(const char *vertex, int count, const char *const *fragment)
{
    char log[1024] = "";
    GLuint out = glCreateProgram(),
           stages[2] = {glCreateShader(GL_VERTEX_SHADER), glCreateShader(GL_FRAGMENT_SHADER)};
    glShaderSource(stages[0], 1, &vertex, NULL);
    glShaderSource(stages[1], count, fragment, NULL);
    for (int i = 0; i < 2; i++) {
        glCompileShader(stages[i]);
        glGetShaderInfoLog(stages[i], sizeof log, NULL, log);
        fputs(log, stderr);
        glAttachShader(out, stages[i]);
    }
    glLinkProgram(out);
    return out;
}

static void make_targets(void)
{
    glGenFramebuffers(TARGETS, framebuffers);
    glGenTextures(TARGETS, colors);
    glGenTextures(TARGETS, depths);
    for (int i = 0; i < TARGETS; i++) {
        glBindTexture(GL_TEXTURE_2D, colors[i]);
        glTexStorage2D(GL_TEXTURE_2D, 1, i == SHOWN ? GL_RGBA8 : GL_RGBA32F, width, height);
        glBindTexture(GL_TEXTURE_2D, depths[i]);
        glTexStorage2D(GL_TEXTURE_2D, 1, GL_DEPTH_COMPONENT32F, width, height);
        glBindFramebuffer(GL_FRAMEBUFFER, framebuffers[i]);
        glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, colors[i], 0);
        glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, depths[i], 0);
    }
}

static void bind(GLuint unit, GLuint texture)
{
    glActiveTexture(GL_TEXTURE0 + unit);
    glBindTexture(GL_TEXTURE_2D, texture);
}

/* Peel -1: the opaque surfaces. Returns whether there was a fragment. */
static int draw(int target, int peel, GLuint surface)
{
    GLuint query, any = 0;
    json_t *object;
    size_t i;
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers[target]);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    bind(0, depths[OPAQUE]);
    bind(1, depths[target == EVEN ? ODD : EVEN]);
    glUseProgram(surface);
    glUniformMatrix4fv(2, 1, GL_FALSE, floats(json_object_get(contract, "camera"), "projection"));
    glUniform3fv(16, 1, floats(contract, "ambient"));
    glUniform1i(6, peel);
    glEnable(GL_DEPTH_TEST);
    glGenQueries(1, &query);
    glBeginQuery(GL_ANY_SAMPLES_PASSED, query);
    json_array_foreach(json_object_get(contract, "draws"), i, object)
    {
        json_t *material =
            json_array_get(json_object_get(contract, "materials"),
                           (size_t)json_integer_value(json_object_get(object, "material")));
        float base[4], factors[3] = {*floats(material, "roughness"), *floats(material, "metallic"),
                                     *floats(material, "occlusion")};
        if (json_is_true(json_object_get(object, "transparent")) != (peel >= 0))
            continue;
        memcpy(base, floats(material, "base_color"), sizeof base);
        base[3] = peel < 0 ? 1.0f : base[3];
        glUniformMatrix4fv(0, 1, GL_FALSE, floats(object, "model_view"));
        glUniformMatrix3fv(1, 1, GL_FALSE, floats(object, "normal_matrix"));
        glUniform4fv(3, 1, base);
        glUniform3fv(4, 1, factors);
        glUniform2i(5, json_is_true(json_object_get(object, "flipped")),
                    json_is_true(json_object_get(object, "cull_back")));
        glDrawElementsBaseVertex(
            GL_TRIANGLES, (int)json_integer_value(json_object_get(object, "index_count")),
            GL_UNSIGNED_INT,
            (void *)(4 * (size_t)json_integer_value(json_object_get(object, "first_index"))),
            (int)json_integer_value(json_object_get(object, "base_vertex")));
    }
    glEndQuery(GL_ANY_SAMPLES_PASSED);
    glGetQueryObjectuiv(query, GL_QUERY_RESULT, &any);
    glDeleteQueries(1, &query);
    glDisable(GL_DEPTH_TEST);
    return any != 0;
}

/* Draws one target's colour into another by a program that covers the screen. */
static void pass(GLuint screen, int from, int to, int blend)
{
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers[to]);
    bind(0, colors[from]);
    glUseProgram(screen);
    if (blend)
        glEnable(GL_BLEND);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_BLEND);
}

static void blend_under(void)
{
    glBlendFuncSeparate(GL_DST_ALPHA, GL_ONE, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
}

static void render(GLuint surface, GLuint layer, GLuint display, PeelDump *dump)
{
    static const float clear[4] = {0.0f, 0.0f, 0.0f, 1.0f};
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers[ACCUM]);
    glClearBufferfv(GL_COLOR, 0, clear);
    draw(OPAQUE, -1, surface);
    peel_dump_depth(dump, "opaque.depth", framebuffers[OPAQUE], PEEL_DUMP_D32F, width, height);
    blend_under();
#if defined(MISTAKE_OVER_FRONT_TO_BACK) || defined(MISTAKE_LAYERS_REVERSED)
    glBlendFuncSeparate(GL_ONE, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE_MINUS_SRC_ALPHA);
#endif
    for (int peel = 0; draw(peel % 2 ? ODD : EVEN, peel, surface); peel++) {
        char name[32];
        int target = peel % 2 ? ODD : EVEN;
        pass(layer, target, ACCUM, 1);
        snprintf(name, sizeof name, "peel.%d.depth", peel);
        peel_dump_depth(dump, name, framebuffers[target], PEEL_DUMP_D32F, width, height);
        snprintf(name, sizeof name, "peel.%d.accum", peel);
        peel_dump_color(dump, name, framebuffers[ACCUM], GL_COLOR_ATTACHMENT0, PEEL_DUMP_RGBA32F,
                        width, height);
    }
#ifdef MISTAKE_LAYERS_REVERSED
    blend_under();
#endif
    pass(layer, OPAQUE, ACCUM, 1);
    peel_dump_color(dump, "accum", framebuffers[ACCUM], GL_COLOR_ATTACHMENT0, PEEL_DUMP_RGBA32F,
                    width, height);
    glUseProgram(display);
    glUniform3fv(0, 1, floats(contract, "background"));
    pass(display, ACCUM, SHOWN, 0);
    peel_dump_color(dump, "display", framebuffers[SHOWN], GL_COLOR_ATTACHMENT0, PEEL_DUMP_RGBA8,
                    width, height);
}

int main(int argc, char **argv)
{
    static const int attributes[] = {OSMESA_PROFILE,
                                     OSMESA_CORE_PROFILE,
                                     OSMESA_CONTEXT_MAJOR_VERSION,
                                     4,
                                     OSMESA_CONTEXT_MINOR_VERSION,
                                     5,
                                     0};
    static unsigned char window[16 * 16 * 4];
    OSMesaContext context = OSMesaCreateContextAttribs(attributes, NULL);
    PeelDump dump;
    size_t size;
    if (argc != 4 || !OSMesaMakeCurrent(context, window, GL_UNSIGNED_BYTE, 16, 16))
        return 1;
    char *text = load(argv[1], "contract.json", &size), *shade = load(argv[1], "shade.glsl", &size);
    contract = json_loads(text, 0, NULL);
    width = (int)json_integer_value(json_object_get(contract, "width"));
    height = (int)json_integer_value(json_object_get(contract, "height"));
    make_targets();
    load_scene(argv[1]);
    glViewport(0, 0, width, height);
    const char *surface[3] = {"#version 450 core\n", shade, surface_text};
    peel_dump_open(&dump, argv[3], (PeelDumpLoad)OSMesaGetProcAddress);
    render(program(vertex_text, 3, surface), program(screen_text, 1, &layer_text),
           program(screen_text, 1, &display_text), &dump);
    unsigned char *pixels = malloc(4 * (size_t)width * (size_t)height);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffers[SHOWN]);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels);
    stbi_flip_vertically_on_write(1);
    int failed = !stbi_write_png(argv[2], width, height, 4, pixels, 4 * width);
    if (peel_dump_close(&dump) != 0)
        fprintf(stderr, "%s\n", dump.error);
    free(pixels);
    free(text);
    free(shade);
    json_decref(contract);
    OSMesaDestroyContext(context);
    return failed || dump.error != NULL;
}
