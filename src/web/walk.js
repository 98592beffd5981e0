/* The steps of a frame in their order: of the methods that take layer after layer from front to
 * back. What all methods begin and end with is here too; the others are in walk_others.js. */
"use strict";

const walk = {};

/* A step: {id, title, group, kind, peel, part, buffers, lines, code, text, pictures, equation,
 * source}. kind: "naive", "opaque", "peel", "light", "background", "display", "truth". lines: the
 * pseudo-code, code: the lines of it that are lit, from 1. pictures(): list of {title, picture} or
 * elements. equation(pixel): an element, or null where there is nothing to say. */
walk.step = (given) => ({
    peel: null, part: given.id, buffers: [], lines: walk.peelCode(), code: [], text: "",
    pictures: () => [], equation: () => null, source: "", ...given });

walk.RAPETTA = "L. Rapetta, OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling";
walk.EVERITT = "C. Everitt, Interactive Order-Independent Transparency, NVIDIA, 2001";

walk.PEEL_CODE = [
    "draw the opaque surfaces into a G-buffer",
    "accum \u2190 (0, 0, 0), T \u2190 1",
    "for k = 0, 1, 2, \u2026",
    "  for each fragment of the transparent surfaces",
    "    discard if depth \u2265 opaque depth",
    "    discard if k > 0 and depth \u2264 previous depth",
    "    keep the nearest, store its G-buffer",
    "  stop if nothing was kept",
    "  light the layer: source \u2190 (colour \u00b7 \u03b1, \u03b1)",
    "  accum \u2190 accum + T \u00b7 source.rgb",
    "  T \u2190 T \u00b7 (1 \u2212 \u03b1)",
    "  swap depth and previous depth",
    "light the opaque surfaces, blend them likewise",
    "final \u2190 accum + T \u00b7 background",
    "display \u2190 (final / (final + 1)) ^ (1/2.2)",
];

/* Of the method forward, with the same steps in the same lines. */
walk.FORWARD_CODE = walk.PEEL_CODE.map((line, i) => ({
    0: "draw the opaque surfaces, lit",
    6: "    light it; keep the nearest, store its colour",
    8: "  the layer: source \u2190 (stored colour, \u03b1)",
    12: "blend the lit opaque surfaces likewise",
})[i] ?? line);

walk.isForward = () => app.choice("method") === "forward";
walk.peelCode = () => walk.isForward() ? walk.FORWARD_CODE : walk.PEEL_CODE;

/* ---- numbers in equations ---- */

walk.number = (name, [x, y], channel = 0) => {
    const buffer = app.frame.buffer(name);
    const at = (y * buffer.width + x) * buffer.channels + channel;
    return app.numberElement(buffer.data[at], buffer.format, draw.what(buffer, channel));
};

/* A line of an equation: formula`T = ${node}`. */
walk.formula = (texts, ...nodes) => {
    const line = app.element("p", { className: "formula" });
    texts.forEach((text, i) =>
        line.append(text, ...(nodes[i] === undefined ? [] : [nodes[i]].flat())));
    return line;
};

walk.lines = (...lines) => app.element("div", {}, ...lines.filter(Boolean));
walk.says = (text) => app.element("p", { className: "note", textContent: text });

walk.hasFragment = (base, [x, y]) => {
    const ids = app.frame.buffer(`${base}.primitive`);
    return !ids || ids.data[y * ids.width + x] !== 0xffffffff;
};

/* "name = value" for these channels of a buffer. */
walk.list = (name, labels) => (pixel) => {
    const base = name.replace(/\.[^.]*$/, "");
    if (!walk.hasFragment(base, pixel))
        return walk.says("Nothing was drawn at this pixel.");
    return walk.lines(...labels.map((label, i) =>
        walk.formula`${label} = ${walk.number(name, pixel, i)}`));
};

/* ---- pictures ---- */

walk.show = (name, title, how = draw.buffer) => {
    const buffer = app.frame.buffer(name);
    return buffer ? [{ title: title ?? name, picture: how(buffer) }] : [];
};

/* An accumulation before anything was blended. */
walk.cleared = () => {
    const { width, height } = app.frame, data = new Float32Array(4 * width * height);
    for (let i = 3; i < data.length; i += 4)
        data[i] = 1;
    return { name: "accum.cleared", format: "rgba32f", channels: 4, width, height, data };
};

walk.later = (promise, show) => {
    const place = app.element("div", { className: "later" }, walk.says("Rendering\u2026"));
    promise.then((value) => {
        place.replaceWith(...show(value));
        figure.update();
    }, (error) => place.replaceChildren(walk.says(error.message)));
    return place;
};

/* The frame by another method, rendered once for each frame. */
walk.other = (method) => {
    app.frame.others ??= {};
    return app.frame.others[method] ??=
        app.renderWith({ method: app.settings.method.choices.indexOf(method) });
};

/* ---- the beginning ---- */

walk.naive = () => walk.step({
    id: "naive", kind: "naive", group: "Before we start", buffers: ["display"],
    title: "The naive way: sort the objects and blend",
    text: "A transparent surface lets some of the light from behind it through, so what is " +
        "behind must be known first. The obvious plan, the painter's, is to sort the objects by " +
        "distance and to blend each over those behind it. But an object has one place in the " +
        "order, and its surfaces do not: where objects cross or surround each other, or show two " +
        "of their own sides, no order of objects is right for every pixel. Depth peeling decides " +
        "for every pixel by itself.",
    lines: ["sort the objects, far to near", "for each object", "  for each of its fragments",
            "    colour \u2190 source.rgb + (1 \u2212 \u03b1) \u00b7 colour"],
    code: [1, 4],
    pictures: () => [walk.later(walk.other("painter"), ({ display }) => {
        const other = draw.differing(display, app.frame.buffer("display"));
        return [figure.make("Painter: objects sorted", draw.bytes({ ...display,
                    name: "painter.display" })),
                figure.make("Each pixel's fragments in order",
                            draw.bytes(app.frame.buffer("display"))),
                figure.make("Where they differ", other),
                ...(other.count === 0 ? [walk.says("Of this scene, seen from here, the painter's " +
                    "image is right.")] : [])];
    })],
    source: "M. Newell, R. Newell, T. Sancha, A Solution to the Hidden Surface Problem, ACM 1972",
});

walk.OPAQUE = [
    ["depth", "Depth of the nearest opaque surface",
     "The opaque surfaces come first, with the usual depth test: in every pixel the nearest one " +
     "stays. This opaque depth is kept to the end, for no transparent surface behind it can be " +
     "seen.", (pixel) => walk.depths([["opaque depth", "opaque.depth"]], pixel)],
    ["normal", "Normal of the opaque surface",
     "Nothing is lit yet. What lighting will need is stored in a set of buffers, the G-buffer. " +
     "The normal is the direction that the surface faces, a vector of length 1.",
     walk.list("opaque.normal", ["x", "y", "z"])],
    ["position", "Position of the opaque surface",
     "Where the surface is, seen from the eye: x to the right, y up, and z towards the viewer, " +
     "so that what is ahead has a negative z.", walk.list("opaque.position", ["x", "y", "z"])],
    ["diffuse", "Base colour of the opaque surface", "The surface's own colour.",
     walk.list("opaque.diffuse", ["red", "green", "blue"])],
    ["color", "Lit colour of the opaque surface",
     "The method forward lights a surface when it is drawn and stores the result.",
     walk.list("opaque.color", ["red", "green", "blue"])],
    ["material", "Material of the opaque surface",
     "How rough and how metallic it is, and how much ambient light reaches it.",
     walk.list("opaque.material", ["roughness", "metallic", "occlusion"])],
    ["primitive", "Which triangle it is",
     "For reference only, no renderer needs it: the number of the triangle that each pixel shows.",
     walk.list("opaque.primitive", ["triangle"])],
];

walk.opaque = (lines) => walk.OPAQUE.filter(([what]) => app.frame.buffer(`opaque.${what}`)).map(
    ([what, title, text, equation]) => walk.step({
        id: `opaque-${what}`, kind: "opaque", group: "Opaque geometry pass", title, text, equation,
        lines, code: [1], buffers: [`opaque.${what}`], source: walk.RAPETTA,
        pictures: () => walk.show(`opaque.${what}`, `opaque.${what}`) }));

/* Depths at a pixel, with the distance that each stands for. */
walk.depths = (rows, pixel) => {
    const [x, y] = pixel;
    return walk.lines(...rows.map(([label, name]) => {
        const buffer = app.frame.buffer(name), i = y * buffer.width + x;
        const z = draw.distance(draw.value(buffer, i));
        const far = draw.isEmpty(buffer, i) ? " (nothing drawn)"
                                            : ` (${app.rounded(z)} from the eye)`;
        return walk.formula`${label} = ${walk.number(name, pixel)}${far}`;
    }));
};

/* ---- a peel ---- */

/* Which of the two depth buffers peel k writes. */
walk.side = (k) => "AB"[k % 2];

walk.previousDepth = (k) => k === 0 ? []
    : walk.show(`peel.${k - 1}.depth`, `Previous depth (buffer ${walk.side(k - 1)})`);

walk.peelCompare = (k) => ({
    title: k === 0 ? "What this peel may take" : "What this peel may take: behind the last layer",
    text: k === 0
        ? "A peel takes one transparent layer: in each pixel the nearest surface that was not " +
          "taken yet. The first one only has to be in front of the opaque depth."
        : "To find the next layer, every fragment is compared with two depths: it must be behind " +
          "the previous depth, which is that of the layer taken last, and in front of the opaque " +
          "depth. Without the previous depth every peel would find the first layer again.",
    code: k === 0 ? [4, 5] : [4, 5, 6],
    buffers: ["opaque.depth", ...(k > 0 ? [`peel.${k - 1}.depth`] : [])],
    pictures: () => [
        ...walk.previousDepth(k),
        ...walk.show("opaque.depth", "Opaque depth")],
    equation: (pixel) => walk.lines(
        walk.depths([...(k > 0 ? [["previous depth", `peel.${k - 1}.depth`]] : []),
                     ["opaque depth", "opaque.depth"]], pixel),
        walk.formula`${k > 0 ? "previous depth < depth < opaque depth" : "depth < opaque depth"}`),
    source: walk.EVERITT,
});

walk.peelDiscard = (k) => app.frame.buffer(`peel.${k}.hidden`) && ({
    title: "What is thrown away, and by which test",
    text: "All transparent surfaces are drawn again in every peel. Most of their fragments are " +
        "discarded: at or before the previous depth (taken already), at or behind the opaque " +
        "depth (never seen), or because another fragment of this peel is nearer (they wait for a " +
        "later peel).",
    code: [5, 6, 7],
    buffers: [],
    pictures: () => [{ title: "Discarded by", picture: draw.rejected(k) }],
    equation: (pixel) => walk.lines(
        ...draw.TESTS.map(({ what, text }) =>
            walk.formula`${walk.number(`peel.${k}.${what}`, pixel)} discarded by ${text}`),
        walk.formula`${walk.hasFragment(`peel.${k}`, pixel) ? "1 kept: this peel's layer"
                                                              : "none kept: no layer here"}`),
    source: walk.EVERITT,
});

walk.peelDepth = (k) => ({
    title: "The new depth",
    text: `The depth of the layer that this peel took, in depth buffer ${walk.side(k)}. ` +
        (k === 0 ? "Hatched pixels have no transparent layer."
                 : "It is farther than the previous one in every pixel; hatched pixels have no " +
                   "more layers."),
    code: [7],
    buffers: [`peel.${k}.depth`],
    pictures: () => [
        ...walk.previousDepth(k),
        ...walk.show(`peel.${k}.depth`, `New depth (buffer ${walk.side(k)})`),
        ...draw.slice(walk.peelSlice(k))],
    equation: (pixel) => walk.hasFragment(`peel.${k}`, pixel)
        ? walk.depths([...(k > 0 ? [["previous depth", `peel.${k - 1}.depth`]] : []),
                       ["depth", `peel.${k}.depth`], ["opaque depth", "opaque.depth"]], pixel)
        : walk.says("This peel found nothing at this pixel."),
    source: walk.EVERITT,
});

/* The layers so far in the pixel's row. */
walk.peelSlice = (k) => {
    const layer = (peel, color, text) =>
        ({ buffer: app.frame.buffer(`peel.${peel}.depth`), color, text });
    const rows = [{ buffer: app.frame.buffer("opaque.depth"), color: [1, 115, 178],
                    text: "opaque depth, where it is not far behind" }];
    for (let peel = 0; peel < k; peel++)
        rows.push(layer(peel, peel === k - 1 ? [120, 126, 136] : [188, 192, 198],
                        peel === k - 1 ? "previous depth" : ""));
    return [...rows, layer(k, [222, 143, 5], "new depth")].filter(({ buffer }) => buffer);
};

walk.GBUFFER = { normal: "Normal", position: "Position", diffuse: "Base colour",
                 color: "Lit, premultiplied colour", material: "Material", primitive: "Triangle" };

walk.peelGBuffer = (k) => {
    const has = Object.keys(walk.GBUFFER).filter((what) => app.frame.buffer(`peel.${k}.${what}`));
    return {
        title: walk.isForward() ? "The layer's colour, lit as it was drawn"
                                : "The layer's G-buffer",
        text: walk.isForward()
            ? "A fragment is lit when it is drawn, before it is known whether it stays. Of those " +
              "that stay only the colour is stored, multiplied by \u03b1, and \u03b1 as its " +
              "fourth channel."
            : "Of the fragments that stay, the same properties are stored as of the opaque " +
            "surfaces. The fourth channel of the base colour is the opacity, \u03b1: the part of " +
            "the light from behind that the surface keeps from us.",
        code: [7],
        buffers: has.filter((what) => what !== "primitive").map((what) => `peel.${k}.${what}`),
        pictures: () => has.flatMap((what) => walk.show(`peel.${k}.${what}`, walk.GBUFFER[what])),
        equation: (pixel) => !walk.hasFragment(`peel.${k}`, pixel)
            ? walk.says("This peel found nothing at this pixel.")
            : walk.formula`\u03b1 = ${walk.number(`peel.${k}.${has.includes("diffuse")
                ? "diffuse" : "color"}`, pixel, 3)}`,
        source: walk.RAPETTA,
    };
};

walk.peelLight = (k) => app.frame.buffer(`peel.${k}.source`) && ({
    title: "The lit layer, premultiplied",
    text: walk.isForward()
        ? "The stored colour is what will be blended. It was multiplied by \u03b1: a " +
          "premultiplied colour is the light that the surface itself sends to the eye."
        : "One pass over the picture lights the layer from its G-buffer, once for each pixel. " +
        "What will be blended is the colour multiplied by \u03b1, and \u03b1 beside it: a " +
        "premultiplied colour is the light that the surface itself sends to the eye.",
    code: [9],
    buffers: [],
    pictures: () => [
        ...walk.show(`peel.${k}.source`, "Lit colour", draw.unmultiplied),
        ...walk.show(`peel.${k}.source`, "Source: colour \u00b7 \u03b1",
                     (buffer) => draw.source(buffer)),
        ...walk.show(`peel.${k}.source`, "Source: \u03b1", (buffer) =>
            draw.grey(buffer, 3, "Black is 0, white is 1."))],
    equation: (pixel) => walk.lines(...["red", "green", "blue"].map((label, i) =>
        walk.formula`source ${label} = ${walk.number(`peel.${k}.source`, pixel, i)}`),
        walk.formula`source \u03b1 = ${walk.number(`peel.${k}.source`, pixel, 3)}`),
    source: walk.RAPETTA,
});

/* Whether the opaque pass blends as the original program does: T is 2T after it and not used. */
walk.seedBlend = (source) => source === "opaque.source" && app.settings["opaque-blend"] === 1;

/* Blending a source under what the accumulation held: before and after are names of buffers;
 * before is null where it was just cleared. */
walk.under = (source, before, after) => (pixel) => {
    const [x, y] = pixel, buffer = app.frame.buffer(source);
    if (buffer && buffer.data[4 * (y * buffer.width + x) + 3] === 0)
        return walk.says("Nothing is blended at this pixel.");
    const was = (i) => before ? walk.number(before, pixel, i)
        : app.numberElement(i === 3 ? 1 : 0, "r32f", `${after}.cleared.${"rgba"[i]}`);
    const color = (i) => buffer ? walk.number(source, pixel, i) : "source";
    return walk.lines(...["red", "green", "blue"].map((label, i) =>
        walk.formula`${label}: ${was(i)} + ${was(3)} \u00b7 ${color(i)} = ${
            walk.number(after, pixel, i)}`),
        walk.seedBlend(source)
            ? walk.formula`T: ${was(3)} + ${was(3)} \u00b7 ${color(3)} = ${
                walk.number(after, pixel, 3)} (not used: nothing comes through)`
            : walk.formula`T: ${was(3)} \u00b7 (1 \u2212 ${color(3)}) = ${
                walk.number(after, pixel, 3)}`);
};

walk.accums = (before, after, source) => [
    ...(before ? walk.show(before, "Accumulated before")
               : [{ title: "Accumulated before: nothing", picture: draw.light(walk.cleared()) }]),
    ...walk.show(source, "Source: colour \u00b7 \u03b1", (buffer) => draw.source(buffer)),
    ...walk.show(after, "Accumulated after"),
    ...walk.show(after, "Transmittance left, T", (buffer) =>
        draw.grey(buffer, 3, "White: all light from behind still comes through; black: none."))];

walk.peelBlend = (k) => {
    const before = k > 0 ? `peel.${k - 1}.accum` : null, after = `peel.${k}.accum`;
    return app.frame.buffer(after) && {
        title: "Blend the layer under what is there",
        text: "The accumulation holds the light gathered so far and, as a fourth channel, the " +
            "transmittance T: the part of the light from behind that the layers so far let " +
            "through. The new layer is behind them, so it counts T times, and T becomes smaller.",
        code: [10, 11],
        buffers: [after],
        pictures: () => walk.accums(before, after, `peel.${k}.source`),
        equation: walk.under(`peel.${k}.source`, before, after),
        source: `${walk.EVERITT}; L. Bavoil, K. Myers, Order Independent Transparency with Dual ` +
                "Depth Peeling, NVIDIA, 2008 (blending from front to back)",
    };
};

walk.peelSwap = (k) => ({
    title: "The depth buffers change places",
    text: "Two depth buffers are enough, however many layers there are. The one just written is " +
        "the previous depth of the next peel; the other is cleared and written next.",
    code: [12],
    buffers: [],
    pictures: () => [walk.swap(k)],
    equation: (pixel) => walk.depths([[`buffer ${walk.side(k)}`, `peel.${k}.depth`]], pixel),
    source: walk.EVERITT,
});

/* Both buffers under their names, and over each its role, which comes from the other. */
walk.swap = (k) => {
    const shown = [k, k - 1].sort((a, b) => (a + 2) % 2 - (b + 2) % 2).map((peel) => peel < 0
        ? app.element("figure", { className: "picture" }, app.element("figcaption", {},
            app.element("strong", { textContent: `Buffer ${walk.side(peel + 2)}: not used yet` })),
            app.element("div", { className: "frame empty" }))
        : figure.make(`Buffer ${walk.side(peel)}: layer ${peel + 1}`,
                      draw.depth(app.frame.buffer(`peel.${peel}.depth`))));
    shown.forEach((picture, i) => {
        const side = i === 0 ? "left" : "right", written = i === k % 2;
        picture.prepend(app.element("div", { className: `role ${side}${written ? "" : " next"}` },
            app.element("span", {
                textContent: written ? "previous depth" : "cleared and written next" })));
    });
    return app.element("div", { className: "swap" },
        app.element("div", { className: "pictures" }, ...shown));
};

walk.PARTS = [["compare", walk.peelCompare], ["discard", walk.peelDiscard],
              ["depth", walk.peelDepth], ["gbuffer", walk.peelGBuffer],
              ["light", walk.peelLight], ["blend", walk.peelBlend], ["swap", walk.peelSwap]];

walk.peels = (parts = walk.PARTS, lines = walk.peelCode()) => {
    const all = [];
    for (let k = 0; k < app.frame.peels; k++)
        for (const [part, make] of parts) {
            const made = make(k);
            const group = `Peel ${k} (${k + 1} of ${app.frame.peels})`;
            if (made)
                all.push(walk.step({ kind: "peel", group, peel: k, part, id: `peel-${k}-${part}`,
                                     lines, ...made }));
        }
    return all;
};
