/* Reads the folder of `peel scenes NAME --export DIR` for foreign.c. */
#ifndef FOREIGN_CONTRACT_H
#define FOREIGN_CONTRACT_H

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static json_t *contract;

/* A file of the folder, with a 0 behind its end. The caller frees it. */
static void *load(const char *folder, const char *name, size_t *size)
{
    char path[4096];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    if (!file || fseek(file, 0, SEEK_END) != 0) {
        perror(path);
        exit(1);
    }
    *size = (size_t)ftell(file);
    char *bytes = calloc(*size + 1, 1);
    rewind(file);
    if (!bytes || fread(bytes, 1, *size, file) != *size)
        exit(1);
    fclose(file);
    return bytes;
}

/* The floats of an array of strings, or of one string. */
static const float *floats(json_t *object, const char *key)
{
    static float values[4][16];
    static int next;
    json_t *value = json_object_get(object, key);
    float *out = values[next++ % 4];
    for (size_t i = 0; i < json_array_size(value); i++)
        out[i] = strtof(json_string_value(json_array_get(value, i)), NULL);
    if (json_is_string(value))
        out[0] = strtof(json_string_value(value), NULL);
    return out;
}

/* Vertices, indices and lights to buffers of OpenGL. */
static void load_scene(const char *folder)
{
    size_t size, lights = json_array_size(json_object_get(contract, "lights"));
    void *vertices = load(folder, "vertices.bin", &size);
    GLuint names[4];
    glGenVertexArrays(1, names);
    glBindVertexArray(names[0]);
    glGenBuffers(3, names + 1);
    glBindBuffer(GL_ARRAY_BUFFER, names[1]);
    glBufferData(GL_ARRAY_BUFFER, (GLsizeiptr)size, vertices, GL_STATIC_DRAW);
    for (GLuint i = 0; i < 2; i++) {
        glVertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, 32, (void *)(12 * (size_t)i));
        glEnableVertexAttribArray(i);
    }
    void *indices = load(folder, "indices.bin", &size);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, names[2]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, (GLsizeiptr)size, indices, GL_STATIC_DRAW);
    float(*packed)[12] = calloc(lights + 1, sizeof *packed);
    for (size_t i = 0; i < lights; i++) {
        json_t *light = json_array_get(json_object_get(contract, "lights"), i);
        memcpy(packed[i], floats(light, "position"), 12);
        memcpy(packed[i] + 4, floats(light, "color"), 12);
        memcpy(packed[i] + 8, floats(light, "attenuation"), 12);
        packed[i][11] = *floats(light, "inverse_range2");
    }
    glBindBuffer(GL_UNIFORM_BUFFER, names[3]);
    glBufferData(GL_UNIFORM_BUFFER, (GLsizeiptr)((lights + 1) * sizeof *packed), packed,
                 GL_STATIC_DRAW);
    glBindBufferBase(GL_UNIFORM_BUFFER, 0, names[3]);
    free(vertices);
    free(indices);
    free(packed);
}

#endif
