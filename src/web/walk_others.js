/* The steps of the methods that do not peel layer by layer from the front. */
"use strict";

/* ---- dual depth peeling ---- */

walk.BAVOIL = "L. Bavoil, K. Myers, Order Independent Transparency with Dual Depth Peeling, " +
              "NVIDIA, 2008";

walk.DUAL_CODE = [
    "draw the opaque surfaces into a G-buffer",
    "find the nearest and the farthest fragment",
    "for k = 0, 1, 2, \u2026 while there is one",
    "  for each fragment that the opaque depth leaves",
    "    if it is the nearest: keep it in front",
    "    if it is the farthest: keep it behind",
    "    if it is between: nearest, farthest of the next peel",
    "  front: accum \u2190 accum + T \u00b7 source, T \u2190 T \u00b7 (1 \u2212 \u03b1)",
    "  back: behind \u2190 source + (1 \u2212 \u03b1) \u00b7 behind",
    "blend what is behind under the front",
    "light the opaque surfaces, blend them likewise",
    "final \u2190 accum + T \u00b7 background",
    "display \u2190 (final / (final + 1)) ^ (1/2.2)",
];

/* The min-max depths that peel k takes: found by the pass before. */
walk.limits = (k) => {
    return app.frame.buffer(`${app.choice("method")}.${k === 0 ? "first" : k - 1}.depth`);
};

/* One of the two as depths: channel 0 holds minus the nearest distance, 1 the farthest; −2 where
 * there is none. */
walk.limit = (k, channel) => {
    const both = walk.limits(k), { width, height } = both;
    const reversed = draw.reversed();
    const data = new Float32Array(width * height).map((_, i) => {
        const stored = both.data[2 * i + channel], distance = channel === 0 ? -stored : stored;
        return stored === -2 ? NaN : reversed ? -distance : distance;
    });
    return { name: `${both.name}.${channel === 0 ? "nearest" : "farthest"}`, format: "r32f",
             channels: 1, width, height, data,
             ids: { data: Array.from(data, (d) => Number.isNaN(d) ? 0xffffffff : 0) } };
};

walk.dualFronts = (k) => ({
    title: "Two fronts, one from each side",
    text: "Dual depth peeling takes two layers at once: the nearest and the farthest of those " +
        "left. In one buffer with two channels (\u2212nearest, farthest), drawn with the " +
        "maximum, both are found in one pass. Peel by peel the two fronts move towards each " +
        "other until they meet: n layers take about n/2 passes.",
    code: [5, 6, 7],
    buffers: [walk.limits(k).name],
    pictures: () => [
        { title: "Nearest left", picture: draw.depth(walk.limit(k, 0)) },
        { title: "Farthest left", picture: draw.depth(walk.limit(k, 1)) },
        ...draw.slice(walk.dualSlice(k))],
    equation: (pixel) => {
        const at = pixel[1] * app.frame.width + pixel[0];
        const [near, far] = [0, 1].map((channel) => walk.limit(k, channel).data[at]);
        return Number.isNaN(near) ? walk.says("No layer is left at this pixel.") : walk.lines(
            walk.formula`nearest = ${
                app.numberElement(near, "r32f", `${walk.limits(k).name}.nearest`)}`,
            walk.formula`farthest = ${
                app.numberElement(far, "r32f", `${walk.limits(k).name}.farthest`)}`,
            walk.formula`${near === far ? "the same fragment: the fronts have met"
                                        : "two fragments are taken"}`);
    },
    source: walk.BAVOIL,
});

/* The fronts of all peels so far in the pixel's row. */
walk.dualSlice = (k) => {
    const rows = [];
    for (let peel = 0; peel <= k; peel++)
        rows.push({ buffer: walk.limit(peel, 0),
                    color: peel === k ? [222, 143, 5] : [214, 190, 150],
                    text: peel === k ? "the front from the eye" : "" },
                  { buffer: walk.limit(peel, 1),
                    color: peel === k ? [1, 115, 178] : [140, 175, 205],
                    text: peel === k ? "the front from behind" : "" });
    return rows;
};

walk.dualLayers = (k) => {
    const method = app.choice("method");
    const names = ["front_diffuse", "back_diffuse", "front_normal", "back_normal", "front_material",
                   "back_material", "front", "back"].map((what) => `${method}.${k}.${what}`)
        .filter((name) => app.frame.buffer(name));
    const how = (name) => name.endsWith("normal") ? draw.octahedrals
        : name.endsWith("diffuse") ? draw.base
        : name.endsWith("material") ? draw.material : draw.source;
    return {
        title: "The two layers",
        text: method === "dual"
            ? "Of both layers a G-buffer is stored. It has no position: that follows from the " +
              "depth."
            : "Both layers are lit as they are drawn: the front one is added to the light " +
              "gathered so far, the back one waits to be blended over what is behind.",
        code: [5, 6], buffers: names,
        pictures: () => names.flatMap((name) => walk.show(name, name, how(name))),
        source: walk.BAVOIL };
};

walk.dualBlend = (k) => {
    const method = app.choice("method");
    const names = [`peel.${k}.accum`, `${method}.${k}.back_accum`].filter((name) =>
        app.frame.buffer(name));
    return {
        title: "Blend one layer under the front, one over the back",
        text: "The front's accumulation grows backwards, as in depth peeling. What is behind has " +
            "an accumulation of its own, which grows forwards: a layer in front of it hides " +
            "\u03b1 of it.",
        code: [8, 9], buffers: names,
        pictures: () => names.flatMap((name) => [
            ...walk.show(name, name, (buffer) => draw.light(buffer)),
            ...walk.show(name, `${name}: transmittance`, (buffer) =>
                draw.grey(buffer, 3, "White: all light comes through; black: none."))]),
        equation: (pixel) => walk.lines(...names.map((name) => walk.formula`${name} T = ${
            walk.number(name, pixel, 3)}`)),
        source: walk.BAVOIL };
};

walk.dual = () => {
    const { peels } = app.frame, method = app.choice("method");
    return [walk.naive(), ...walk.opaque(walk.DUAL_CODE),
            ...walk.peels([["fronts", walk.dualFronts], ["layers", walk.dualLayers],
                           ["blend", walk.dualBlend]], walk.DUAL_CODE),
            ...walk.endingUnseen(walk.DUAL_CODE, [[10, 11], [12], [13]], peels === 0 ? [] : [
                `peel.${peels - 1}.accum`, `${method}.${peels - 1}.front`,
                `${method}.${peels - 1}.back_accum`])];
};

/* Where the trace does not have the accumulation before the opaque surfaces. */
walk.endingUnseen = (lines, code, names) => {
    const [light, ...rest] = walk.ending(null, lines, code);
    return [{ ...light,
        pictures: () => [...names.filter((name) => app.frame.buffer(name)).flatMap((name) =>
                             walk.show(name, name, (buffer) => draw.light(buffer))),
                         ...walk.show("opaque.source", "Opaque surfaces, lit", draw.source),
                         ...walk.show("accum", "Accumulated after")],
        equation: walk.list("accum", ["red", "green", "blue", "T"]) }, ...rest];
};

/* ---- linked lists ---- */

walk.LIST_CODE = [
    "draw the opaque surfaces into a G-buffer",
    "for each fragment of the transparent surfaces",
    "  put it into the list of its pixel",
    "sort each list by depth; leave out what is hidden",
    "for each node, front to back",
    "  light it: source \u2190 (colour \u00b7 \u03b1, \u03b1)",
    "  accum \u2190 accum + T \u00b7 source.rgb",
    "  T \u2190 T \u00b7 (1 \u2212 \u03b1)",
    "light the opaque surfaces, blend them likewise",
    "final \u2190 accum + T \u00b7 background",
    "display \u2190 (final / (final + 1)) ^ (1/2.2)",
];

walk.nodes = () => walk.step({
    id: "nodes", kind: "list", group: "Lists", lines: walk.LIST_CODE, code: [2, 3, 4],
    title: "A list of fragments in every pixel",
    text: "The transparent surfaces are drawn once, and every fragment is kept: a node with its " +
        "depth and a packed G-buffer goes into the list of its pixel. Then each list is sorted. " +
        "That takes one pass, but as much memory as there are fragments.",
    pictures: () => [{ title: "Nodes in each pixel", picture: walk.layerCounts() }],
    equation: (pixel) => {
        const lines = [];
        for (let k = 0; k < app.frame.peels && walk.hasFragment(`peel.${k}`, pixel); k++)
            lines.push(walk.formula`node ${String(k)}: depth ${walk.number(`peel.${k}.depth`, pixel)
                }, triangle ${walk.number(`peel.${k}.primitive`, pixel)}`);
        return lines.length > 0 ? walk.lines(...lines) : walk.says("The list is empty here.");
    },
    source: "J. Yang et al., Real-Time Concurrent Linked List Construction on the GPU, 2010; " +
            "J. Breust, Deep Deferred Renderer" });

walk.linkedList = () => {
    const { peels } = app.frame;
    const lit = (make, code) => (k) => ({ ...make(k), code });
    return [walk.naive(), ...walk.opaque(walk.LIST_CODE), walk.nodes(),
            ...walk.peels([["gbuffer", lit(walk.peelGBuffer, [5])],
                           ["light", lit(walk.peelLight, [6])],
                           ["blend", lit(walk.peelBlend, [7, 8])]], walk.LIST_CODE).map((step) => ({
                ...step, group: step.group.replace("Peel", "Node") })),
            ...walk.ending(peels > 0 ? `peel.${peels - 1}.accum` : null, walk.LIST_CODE,
                           [[9], [10], [11]])];
};

/* ---- one pass, no order ---- */

walk.SUMS = {
    "weighted-average": {
        text: "All fragments of a pixel are added up, in any order, and counted. Then each " +
            "counts as much as any other: the pixel is taken for a stack of equal layers of the " +
            "average colour and the average \u03b1. Which one is in front does not matter, and " +
            "that is what is wrong.",
        combine: ["C \u2190 sum.rgb / sum.\u03b1", "A \u2190 sum.\u03b1 / count",
                  "\u03b1 \u2190 1 \u2212 (1 \u2212 A)^count",
                  "source \u2190 (C \u00b7 \u03b1, \u03b1)"],
        source: walk.BAVOIL },
    "weighted-sum": {
        text: "Only those terms of the blending are computed that do not depend on the order. " +
            "Where the \u03b1s sum to more than 1, what is left for the background becomes " +
            "negative.",
        combine: ["source \u2190 sum"],
        source: "H. Meshkin, Sort-Independent Alpha Blending, GDC 2007" },
    "weighted-blended": {
        text: "An average again, but near fragments weigh more than far ones; the transmittance " +
            "is the exact product of all 1 \u2212 \u03b1. Near the truth where the weights fit " +
            "the scene.",
        combine: ["C \u2190 sum.rgb / sum.\u03b1", "\u03b1 \u2190 1 \u2212 product",
                  "source \u2190 (C \u00b7 \u03b1, \u03b1)"],
        source: "M. McGuire, L. Bavoil, Weighted Blended Order-Independent Transparency, " +
            "JCGT 2013" },
};

walk.sums = (method) => {
    const { text, combine, source } = walk.SUMS[method];
    const lines = ["draw the opaque surfaces into a G-buffer",
                   "for each fragment that is not hidden: add it up", ...combine,
                   "accum \u2190 source, T \u2190 1 \u2212 \u03b1",
                   "light the opaque surfaces, blend them under",
                   "final \u2190 accum + T \u00b7 background",
                   "display \u2190 (final / (final + 1)) ^ (1/2.2)"];
    const last = lines.length, second = ["count", "product"].map((what) => `${method}.${what}`)
        .find((name) => app.frame.buffer(name));
    const names = [`${method}.sum`, ...(second ? [second] : [])];
    const list = walk.list(`${method}.sum`, ["sum red", "sum green", "sum blue", "sum \u03b1"]);
    return [walk.naive(), ...walk.opaque(lines), walk.step({
        id: "sums", kind: "sums", group: method, lines, source, text, buffers: names,
        code: lines.map((_, i) => i + 1).filter((i) => i >= 2 && i <= last - 3),
        title: "Add up all fragments",
        pictures: () => [
            ...walk.show(`${method}.sum`, "Sum of colours", (buffer) => draw.light(buffer,
                "As the display would show it.")),
            ...(second ? walk.show(second, second, (buffer) => second.endsWith("count")
                ? draw.counts(buffer, buffer.data, second, "count")
                : draw.grey(buffer, 0, "White: all light comes through; black: none.")) : [])],
        equation: (pixel) => walk.lines(list(pixel), second &&
            walk.formula`${second.replace(/.*\./, "")} = ${walk.number(second, pixel)}`) }),
    ...walk.endingUnseen(lines, [[last - 2], [last - 1], [last]], [])];
};

/* ---- the painter ---- */

walk.PAINTER_CODE = ["draw the opaque surfaces into a G-buffer",
    "sort the objects (or triangles), far to near", "for each fragment that is not hidden",
    "  accum \u2190 source.rgb + (1 \u2212 \u03b1) \u00b7 accum",
    "  T \u2190 T \u00b7 (1 \u2212 \u03b1)",
    "light the opaque surfaces, blend them under", "final \u2190 accum + T \u00b7 background",
    "display \u2190 (final / (final + 1)) ^ (1/2.2)"];

walk.painter = () => [...walk.opaque(walk.PAINTER_CODE), walk.step({
    id: "painter", kind: "painter", group: "Painter", lines: walk.PAINTER_CODE, code: [2, 3, 4, 5],
    title: "Blend far to near, in the objects' order", buffers: ["painter.layers"],
    text: "The objects are sorted by the distance of their centres, and their fragments are " +
        "blended over what is there, in that order. Where the order is wrong for a pixel, a far " +
        "surface covers a near one.",
    pictures: () => [...walk.show("painter.layers", "Blended so far",
                                  (buffer) => draw.light(buffer)),
                     ...walk.show("painter.layers", "Transmittance left, T", (buffer) =>
                         draw.grey(buffer, 3, "White: all light comes through; black: none.")),
                     walk.later(walk.other("peel"), ({ display }) => [
                         figure.make("Where peeling gives another image",
                                     draw.differing(display, app.frame.buffer("display")))])],
    equation: walk.list("painter.layers", ["red", "green", "blue", "T"]),
    source: "M. Newell, R. Newell, T. Sancha, A Solution to the Hidden Surface Problem, " +
        "ACM 1972" }),
    ...walk.ending("painter.layers", walk.PAINTER_CODE, [[6], [7], [8]])];

Object.assign(walk.METHODS, {
    "dual": walk.dual, "forward-dual": walk.dual, "linked-list": walk.linkedList,
    "weighted-average": () => walk.sums("weighted-average"),
    "weighted-sum": () => walk.sums("weighted-sum"),
    "weighted-blended": () => walk.sums("weighted-blended"), "painter": walk.painter,
});
