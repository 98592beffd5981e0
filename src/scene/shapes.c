#include "scene/shapes.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.141592653589793

Result shapes_allocate(uint32_t vertex_count, uint32_t triangle_count, Mesh *out)
{
    *out = (Mesh){.vertex_count = vertex_count, .triangle_count = triangle_count};
    out->position = memory_array((size_t)vertex_count * 3, sizeof(float));
    out->normal = memory_array((size_t)vertex_count * 3, sizeof(float));
    out->index = memory_array((size_t)triangle_count * 3, sizeof(uint32_t));
    if (out->position && out->normal && out->index)
        return RESULT_OK;
    shapes_free(out);
    return RESULT_NO_MEMORY;
}

void shapes_free(Mesh *mesh)
{
    free(mesh->position);
    free(mesh->normal);
    free(mesh->uv);
    free(mesh->index);
    *mesh = (Mesh){0};
}

static void set_vertex(Mesh *mesh, uint32_t vertex, const double position[3],
                       const double normal[3])
{
    for (int i = 0; i < 3; i++) {
        mesh->position[3 * (size_t)vertex + i] = (float)position[i];
        mesh->normal[3 * (size_t)vertex + i] = (float)normal[i];
    }
}

static void set_triangle(Mesh *mesh, uint32_t triangle, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *index = mesh->index + 3 * (size_t)triangle;
    index[0] = a;
    index[1] = b;
    index[2] = c;
}

Result shapes_plane(double width, double height, uint32_t columns, uint32_t rows, Mesh *out)
{
    Result result = shapes_allocate((columns + 1) * (rows + 1), 2 * columns * rows, out);
    if (result)
        return result;
    const double normal[3] = {0.0, 0.0, 1.0};
    for (uint32_t y = 0; y <= rows; y++)
        for (uint32_t x = 0; x <= columns; x++) {
            const double position[3] = {width * ((double)x / columns - 0.5),
                                        height * ((double)y / rows - 0.5), 0.0};
            set_vertex(out, y * (columns + 1) + x, position, normal);
        }
    uint32_t triangle = 0;
    for (uint32_t y = 0; y < rows; y++)
        for (uint32_t x = 0; x < columns; x++) {
            uint32_t a = y * (columns + 1) + x, b = a + columns + 1;
            set_triangle(out, triangle++, a, a + 1, b + 1);
            set_triangle(out, triangle++, a, b + 1, b);
        }
    return RESULT_OK;
}

/* One vertex at each pole, so that no triangle is degenerate. */
Result shapes_sphere(double radius, uint32_t segments, uint32_t rings, Mesh *out)
{
    Result result = shapes_allocate(2 + segments * (rings - 1), 2 * segments * (rings - 1), out);
    if (result)
        return result;
    uint32_t south = out->vertex_count - 1;
    set_vertex(out, 0, (double[3]){0.0, radius, 0.0}, (double[3]){0.0, 1.0, 0.0});
    set_vertex(out, south, (double[3]){0.0, -radius, 0.0}, (double[3]){0.0, -1.0, 0.0});
    for (uint32_t r = 1; r < rings; r++)
        for (uint32_t s = 0; s < segments; s++) {
            double polar = PI * r / rings, around = 2.0 * PI * s / segments;
            const double normal[3] = {matrix_sin(polar) * matrix_sin(around), matrix_cos(polar),
                                      matrix_sin(polar) * matrix_cos(around)};
            const double position[3] = {radius * normal[0], radius * normal[1], radius * normal[2]};
            set_vertex(out, 1 + (r - 1) * segments + s, position, normal);
        }
    uint32_t triangle = 0;
    for (uint32_t s = 0; s < segments; s++) {
        uint32_t next = (s + 1) % segments;
        set_triangle(out, triangle++, 0, 1 + s, 1 + next);
        for (uint32_t r = 0; r + 2 < rings; r++) {
            uint32_t upper = 1 + r * segments, lower = upper + segments;
            set_triangle(out, triangle++, upper + s, lower + s, lower + next);
            set_triangle(out, triangle++, upper + s, lower + next, upper + next);
        }
        uint32_t last = 1 + (rings - 2) * segments;
        set_triangle(out, triangle++, last + s, south, last + next);
    }
    return RESULT_OK;
}

Result shapes_torus(double major, double minor, uint32_t segments, uint32_t sides, Mesh *out)
{
    Result result = shapes_allocate(segments * sides, 2 * segments * sides, out);
    if (result)
        return result;
    for (uint32_t s = 0; s < segments; s++)
        for (uint32_t t = 0; t < sides; t++) {
            double along = 2.0 * PI * s / segments, around = 2.0 * PI * t / sides;
            double outward = matrix_cos(around), radius = major + minor * outward;
            const double normal[3] = {outward * matrix_sin(along), matrix_sin(around),
                                      outward * matrix_cos(along)};
            const double position[3] = {radius * matrix_sin(along), minor * normal[1],
                                        radius * matrix_cos(along)};
            set_vertex(out, s * sides + t, position, normal);
        }
    uint32_t triangle = 0;
    for (uint32_t s = 0; s < segments; s++)
        for (uint32_t t = 0; t < sides; t++) {
            uint32_t here = s * sides, there = (s + 1) % segments * sides;
            uint32_t next = (t + 1) % sides;
            set_triangle(out, triangle++, here + t, there + t, there + next);
            set_triangle(out, triangle++, here + t, there + next, here + next);
        }
    return RESULT_OK;
}

/* A convex polygon seen from the side that `normal` points to, as a fan with its own vertices;
 * the corners may come in either order. */
static void room_face(Mesh *mesh, const double (*corners)[3], uint32_t count,
                      const double facing[3], uint32_t *vertex, uint32_t *triangle)
{
    double length = sqrt(facing[0] * facing[0] + facing[1] * facing[1] + facing[2] * facing[2]);
    const double normal[3] = {facing[0] / length, facing[1] / length, facing[2] / length};
    double u[3], v[3];
    for (int i = 0; i < 3; i++) {
        u[i] = corners[1][i] - corners[0][i];
        v[i] = corners[2][i] - corners[0][i];
    }
    double side = (u[1] * v[2] - u[2] * v[1]) * normal[0] +
                  (u[2] * v[0] - u[0] * v[2]) * normal[1] + (u[0] * v[1] - u[1] * v[0]) * normal[2];
    for (uint32_t i = 0; i < count; i++)
        set_vertex(mesh, *vertex + i, corners[side > 0.0 ? i : count - 1 - i], normal);
    for (uint32_t i = 1; i + 1 < count; i++)
        set_triangle(mesh, (*triangle)++, *vertex, *vertex + i, *vertex + i + 1);
    *vertex += count;
}

/* Walls are squares of the full size less the bevel, edges rectangles, corners triangles. */
Result shapes_room(double half, double bevel, Mesh *out)
{
    enum {
        VERTICES = 6 * 4 + 12 * 4 + 8 * 3,
        TRIANGLES = 6 * 2 + 12 * 2 + 8
    };
    Result result = shapes_allocate(VERTICES, TRIANGLES, out);
    if (result)
        return result;
    uint32_t vertex = 0, triangle = 0;
    double cut = half - bevel;
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2) {
            int b = (axis + 1) % 3, c = (axis + 2) % 3;
            double corners[4][3], facing[3] = {0.0};
            facing[axis] = -sign;
            for (int i = 0; i < 4; i++) {
                corners[i][axis] = sign * half;
                corners[i][b] = i == 0 || i == 3 ? -cut : cut;
                corners[i][c] = i < 2 ? -cut : cut;
            }
            room_face(out, (const double(*)[3])corners, 4, facing, &vertex, &triangle);
            for (int other = -1; other <= 1; other += 2) { /* the edge with the next axis' wall */
                double strip[4][3], inward[3] = {0.0};
                inward[axis] = -sign;
                inward[b] = -other;
                for (int i = 0; i < 4; i++) {
                    strip[i][axis] = sign * (i < 2 ? half : cut);
                    strip[i][b] = other * (i < 2 ? cut : half);
                    strip[i][c] = i == 0 || i == 3 ? -cut : cut;
                }
                room_face(out, (const double(*)[3])strip, 4, inward, &vertex, &triangle);
            }
        }
    for (int corner = 0; corner < 8; corner++) {
        double corners[3][3], facing[3];
        for (int axis = 0; axis < 3; axis++) {
            double sign = corner >> axis & 1 ? 1.0 : -1.0;
            facing[axis] = -sign;
            for (int i = 0; i < 3; i++)
                corners[i][axis] = sign * (i == axis ? half : cut);
        }
        room_face(out, (const double(*)[3])corners, 3, facing, &vertex, &triangle);
    }
    return RESULT_OK;
}
