#include "scene/gltf_graph.h"

#include "base/memory.h"
#include "scene/gltf_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Deeper graphs are refused: Assimp recurses through them. */
enum {
    DEPTH_LIMIT = 512
};
#define NO_PARENT SIZE_MAX
#define ROOT      (SIZE_MAX - 1) /* in place of a parent */

/* ---- cameras and lights --------------------------------------------------------------------- */

static Result check_camera(const GltfCheck *check, size_t index)
{
    const json_t *camera = gltf_json_element(check->json, "cameras", index);
    const char *type = json_string_value(json_object_get(camera, "type"));
    if (type && strcmp(type, "orthographic") == 0) {
        gltf_note(check, NOTE_ORTHOGRAPHIC);
        return RESULT_OK;
    }
    const json_t *perspective = json_object_get(camera, "perspective");
    const json_t *far = json_object_get(perspective, "zfar");
    if (!type || strcmp(type, "perspective") != 0 ||
        !json_is_number(json_object_get(perspective, "yfov")) ||
        !json_is_number(json_object_get(perspective, "znear")) || (far && !json_is_number(far)))
        return gltf_fail(check, "camera", index, "perspective with numbers for yfov and znear");
    return RESULT_OK;
}

static const json_t *lights_of(const GltfCheck *check)
{
    return json_object_get(json_object_get(gltf_array(check, "extensions"), "KHR_lights_punctual"),
                           "lights");
}

/* Absent, or a number that a float holds and does not take for 0. */
static bool valid_range(const json_t *range)
{
    float value = (float)json_number_value(range);
    return !range || (json_is_number(range) && value > 0.0f && isfinite(value));
}

static Result check_light(const GltfCheck *check, size_t index)
{
    const json_t *light = json_array_get(lights_of(check), index);
    const char *type = json_string_value(json_object_get(light, "type"));
    const json_t *intensity = json_object_get(light, "intensity");
    if (!type)
        return gltf_fail(check, "light", index, "a type");
    if (!gltf_valid_numbers(json_object_get(light, "color"), 3) ||
        (intensity && !json_is_number(intensity)))
        return gltf_fail(check, "light", index,
                         "three numbers as its color and one as its intensity");
    if (strcmp(type, "directional") == 0)
        gltf_note(check, NOTE_DIRECTIONAL);
    else if (strcmp(type, "spot") == 0)
        gltf_note(check, NOTE_SPOT);
    else if (strcmp(type, "point") != 0)
        return gltf_fail(check, "light", index, "a type of point, spot or directional");
    else if (!valid_range(json_object_get(light, "range")))
        return gltf_fail(check, "light", index,
                         "a finite number above 0, in single precision, as its range");
    return RESULT_OK;
}

/* ---- nodes ---------------------------------------------------------------------------------- */

/* Other ones would scale and shear. The tolerance is of what exporters round.
 * Source: glTF 2.0, 3.5.3 (rotation is a unit quaternion). */
static bool is_unit(const json_t *rotation)
{
    double sum = 0.0;
    for (size_t i = 0; i < 4; i++) {
        double value = json_number_value(json_array_get(rotation, i));
        sum += value * value;
    }
    return !rotation || fabs(sum - 1.0) <= 0.01;
}

static Result check_placement(const GltfCheck *check, size_t index, const json_t *node)
{
    if (!gltf_valid_numbers(json_object_get(node, "matrix"), 16) ||
        !gltf_valid_numbers(json_object_get(node, "translation"), 3) ||
        !gltf_valid_numbers(json_object_get(node, "rotation"), 4) ||
        !gltf_valid_numbers(json_object_get(node, "scale"), 3))
        return gltf_fail(check, "node", index,
                         "16 numbers as its matrix, 3 as translation and scale, 4 as rotation");
    if (!is_unit(json_object_get(node, "rotation")))
        return gltf_fail(check, "node", index, "a unit quaternion as its rotation");
    return RESULT_OK;
}

static Result check_node(const GltfCheck *check, size_t index, const json_t *node)
{
    const json_t *camera = json_object_get(node, "camera");
    const json_t *extensions = json_object_get(node, "extensions");
    const json_t *lit = json_object_get(extensions, "KHR_lights_punctual");
    const json_t *light = json_object_get(lit, "light");
    Result result = check_placement(check, index, node);
    if (result)
        return result;
    if (!gltf_valid_index(json_object_get(node, "mesh"), gltf_count(check, "meshes")))
        return gltf_fail(check, "node", index, "a mesh that exists");
    if (!gltf_valid_index(camera, gltf_count(check, "cameras")))
        return gltf_fail(check, "node", index, "a camera that exists");
    if (lit && !gltf_required_index(lit, "light", json_array_size(lights_of(check))))
        return gltf_fail(check, "node", index, "a light that exists");
    if (json_object_get(node, "skin"))
        gltf_note(check, NOTE_SKINS);
    if (camera)
        result = check_camera(check, (size_t)json_integer_value(camera));
    if (!result && light)
        result = check_light(check, (size_t)json_integer_value(light));
    return result;
}

/* Records node `parent` (from 1; 0 is none) over all of `children`. */
static Result adopt(const GltfCheck *check, const json_t *children, size_t parent, size_t *parents,
                    size_t count)
{
    const json_t *child;
    size_t i;
    if (children && !json_is_array(children))
        return gltf_fail(check, "node", parent, "an array as its children");
    json_array_foreach(children, i, child)
    {
        size_t node = (size_t)json_integer_value(child);
        if (!gltf_valid_index(child, count))
            return gltf_fail(check, "node", parent, "children that exist");
        if (parents[node] != NO_PARENT)
            return gltf_fail(check, "node", node, "one parent at most: nodes form a tree");
        parents[node] = parent;
    }
    return RESULT_OK;
}

static Result check_depth(const GltfCheck *check, const size_t *parents, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        size_t node = i, depth = 0;
        while (parents[node] < ROOT && depth <= DEPTH_LIMIT) {
            node = parents[node];
            depth++;
        }
        if (depth > DEPTH_LIMIT)
            return gltf_fail(check, "node", i, "a depth below 512, and no cycle");
    }
    return RESULT_OK;
}

static Result check_tree(const GltfCheck *check, size_t *parents, size_t count)
{
    const json_t *node, *root;
    size_t i;
    Result result = RESULT_OK;
    for (i = 0; i < count; i++)
        parents[i] = NO_PARENT;
    json_array_foreach(gltf_array(check, "nodes"), i, node)
    {
        result = check_node(check, i, node);
        if (!result)
            result = adopt(check, json_object_get(node, "children"), i, parents, count);
        if (result)
            return result;
    }
    const json_t *roots =
        json_object_get(gltf_json_element(check->json, "scenes", check->json->scene), "nodes");
    if (roots && !json_is_array(roots))
        return gltf_fail(check, "scene", check->json->scene, "an array as its nodes");
    json_array_foreach(roots, i, root)
    {
        if (!gltf_valid_index(root, count))
            return gltf_fail(check, "scene", check->json->scene, "nodes that exist");
        if (parents[json_integer_value(root)] != NO_PARENT)
            return gltf_fail(check, "scene", check->json->scene,
                             "root nodes without a parent, each once");
        parents[json_integer_value(root)] = ROOT;
    }
    return check_depth(check, parents, count);
}

Result gltf_graph_check(const char *path, GltfJson *json)
{
    const GltfCheck check = {path, json};
    const json_t *chosen = gltf_array(&check, "scene");
    size_t scenes = gltf_count(&check, "scenes"), nodes = gltf_count(&check, "nodes");
    if (scenes == 0 || !gltf_valid_index(chosen, scenes))
        return result_fail(RESULT_BAD_INPUT, "%s: no scene to draw, expected one in \"scenes\"",
                           path);
    json->scene = chosen ? (size_t)json_integer_value(chosen) : 0;
    if (scenes > 1)
        gltf_note(&check, NOTE_SCENES);
    if (gltf_count(&check, "animations"))
        gltf_note(&check, NOTE_ANIMATIONS);
    size_t *parents = memory_array(nodes, sizeof *parents);
    if (!parents)
        return RESULT_NO_MEMORY;
    Result result = check_tree(&check, parents, nodes);
    free(parents);
    return result;
}
