// Per-pixel lists of G-buffer nodes (src/frame/node.h). All behind octahedral.glsl.
//
// PASS_LIST      geometry: opaque fragments to the G-buffer, transparent ones to the lists; behind
//                surface.glsl and gbuffer.glsl
// PASS_VISIBLE   full screen: drops hidden nodes from each pixel's list; behind peel_test.glsl
// PASS_SORT      full screen: sorts each pixel's list, front to back; behind peel_test.glsl
// PASS_FIRST     full screen: puts each pixel's front node at the head of its list; behind
//                peel_test.glsl
// PASS_EXTRACT   full screen: takes the head of each list to a layer; behind peel_test.glsl
// OUT_ID         its draw buffer for primitive ids
// GREATER_FIRST  of equal depths, the greater id is in front
// TEXTURED       nodes hold colour and material; else these follow from the primitive

#define NONE 0xffffffffu
#define NEXT 0
#define DEPTH 1
#define NORMAL 2
#define PRIMITIVE 3
#define BASE 4
#define SURFACE 5
#ifdef TEXTURED
#define WORDS 6u
#else
#define WORDS 4u
#endif

layout(std430, binding = 1) buffer Heads
{
    uint asked;   // for nodes
    uint visible; // nodes that are not hidden
    uint deepest; // most of those in one pixel
    uint unused;
    uint heads[];
};
layout(std430, binding = 2) buffer Nodes
{
    uint nodes[];
};

layout(location = 12) uniform uint width;

uint pixel_index()
{
    return uint(gl_FragCoord.y) * width + uint(gl_FragCoord.x);
}

uint word(uint node, int what)
{
    return nodes[node * WORDS + uint(what)];
}

uint pack8(vec4 value)
{
    precise vec4 scaled = clamp(value, 0.0, 1.0) * 255.0;
    uvec4 code = uvec4(roundEven(scaled));
    return code.x | code.y << 8 | code.z << 16 | code.w << 24;
}

uint pack16(vec2 value)
{
    precise vec2 scaled = clamp(value, 0.0, 1.0) * 65535.0;
    uvec2 code = uvec2(roundEven(scaled));
    return code.x | code.y << 16;
}

// What is stored as the same integers.
vec4 unpack8(uint code)
{
    return vec4(uvec4(code, code >> 8, code >> 16, code >> 24) & 0xffu) / 255.0;
}

vec2 unpack16(uint code)
{
    return vec2(uvec2(code, code >> 16) & 0xffffu) / 65535.0;
}

#ifdef PASS_LIST
layout(location = 10) uniform uint first_primitive; // of the draw
layout(location = 11) uniform bool transparent;
layout(location = 13) uniform uint capacity; // nodes

void append(Surface surface)
{
    // A counter this high is past every buffer, and must not come round to 0.
    if (asked > 0xf0000000u)
        return;
    uint node = atomicAdd(asked, 1u);
    if (node >= capacity)
        return;
    nodes[node * WORDS + DEPTH] = floatBitsToUint(gl_FragCoord.z);
    nodes[node * WORDS + NORMAL] = pack16(encode_octahedral(surface.normal));
    nodes[node * WORDS + PRIMITIVE] = first_primitive + uint(gl_PrimitiveID);
#ifdef TEXTURED
    nodes[node * WORDS + BASE] = pack8(surface.base);
    nodes[node * WORDS + SURFACE] = pack8(vec4(surface.material, 1.0));
#endif
    nodes[node * WORDS + NEXT] = atomicExchange(heads[pixel_index()], node);
}

void main()
{
    if (is_culled())
        discard;
    Surface surface = surface_at();
    if (transparent) {
        append(surface);
        discard;
    }
    write_surface(surface, 1.0);
}
#endif

#ifdef PASS_VISIBLE
void main()
{
    uint pixel = pixel_index(), kept = NONE, count = 0u;
    for (uint node = heads[pixel]; node != NONE;) {
        uint rest = word(node, NEXT);
        if (!is_hidden(uintBitsToFloat(word(node, DEPTH)))) {
            nodes[node * WORDS + NEXT] = kept;
            kept = node;
            count++;
        }
        node = rest;
    }
    heads[pixel] = kept;
    if (count > 0u) {
        atomicAdd(visible, count);
        atomicMax(deepest, count);
    }
}
#endif

#if defined(PASS_SORT) || defined(PASS_FIRST)
bool comes_before(uint a, uint b)
{
    uint depth_a, depth_b;
    stored_depth(uintBitsToFloat(word(a, DEPTH)), depth_a);
    stored_depth(uintBitsToFloat(word(b, DEPTH)), depth_b);
    if (depth_a != depth_b)
#ifdef REVERSED
        return depth_a > depth_b;
#else
        return depth_a < depth_b;
#endif
    uint id_a = word(a, PRIMITIVE), id_b = word(b, PRIMITIVE);
    if (id_a != id_b)
#ifdef GREATER_FIRST
        return id_a > id_b;
#else
        return id_a < id_b;
#endif
#ifdef TEXTURED
    if (word(a, NORMAL) != word(b, NORMAL))
        return word(a, NORMAL) < word(b, NORMAL);
    if (word(a, BASE) != word(b, BASE))
        return word(a, BASE) < word(b, BASE);
    return word(a, SURFACE) < word(b, SURFACE);
#else
    return word(a, NORMAL) < word(b, NORMAL);
#endif
}

#endif

#ifdef PASS_SORT
void main()
{
    uint pixel = pixel_index(), sorted = NONE;
    for (uint node = heads[pixel]; node != NONE;) {
        uint rest = word(node, NEXT), front = NONE, back = sorted;
        while (back != NONE && comes_before(back, node)) {
            front = back;
            back = word(back, NEXT);
        }
        nodes[node * WORDS + NEXT] = back;
        if (front == NONE)
            sorted = node;
        else
            nodes[front * WORDS + NEXT] = node;
        node = rest;
    }
    heads[pixel] = sorted;
}
#endif

#ifdef PASS_FIRST
void main()
{
    uint pixel = pixel_index(), head = heads[pixel];
    uint first = head, before_first = NONE, before = head;
    for (uint node = head == NONE ? NONE : word(head, NEXT); node != NONE;) {
        if (comes_before(node, first)) {
            first = node;
            before_first = before;
        }
        before = node;
        node = word(node, NEXT);
    }
    if (first != head) {
        nodes[before_first * WORDS + NEXT] = word(first, NEXT);
        nodes[first * WORDS + NEXT] = head;
        heads[pixel] = first;
    }
}
#endif

#ifdef PASS_EXTRACT
layout(location = OUT_NORMAL) out vec4 out_normal;
layout(location = OUT_DIFFUSE) out vec4 out_diffuse;
layout(location = OUT_MATERIAL) out vec4 out_material;
layout(location = OUT_ID) out uint out_id;

#ifndef TEXTURED
layout(location = 14) uniform uint material_count;
layout(std430, binding = 3) readonly buffer Materials
{
    uvec4 materials[]; // first primitive, colour, material
};

uvec4 material_of(uint primitive)
{
    uint low = 0u, high = material_count;
    while (high - low > 1u) {
        uint middle = low + (high - low) / 2u;
        if (materials[middle].x <= primitive)
            low = middle;
        else
            high = middle;
    }
    return materials[low];
}
#endif

void main()
{
    uint pixel = pixel_index(), node = heads[pixel];
    if (node == NONE)
        discard;
    heads[pixel] = word(node, NEXT);
    uint primitive = word(node, PRIMITIVE);
#ifdef TEXTURED
    uint base = word(node, BASE), material = word(node, SURFACE);
#else
    uvec4 entry = material_of(primitive);
    uint base = entry.y, material = entry.z;
#endif
    out_normal = vec4(unpack16(word(node, NORMAL)), 0.0, 0.0);
    out_diffuse = unpack8(base);
    out_material = unpack8(material);
    out_id = primitive;
    gl_FragDepth = uintBitsToFloat(word(node, DEPTH));
}
#endif
