/* The chosen pixel's history: every fragment and what became of it, the ray through them, every
 * blend step, and what ref, gl and the truth end with. What it says is the engine's
 * (frame/history.h); the numbers are the stored ones. */
"use strict";

const pixel = { history: null, asked: 0, open: new Set() };

pixel.FATES = {
    peeled: "peeled", blended: "blended", seen: "opaque surface, seen",
    hidden: "hidden by the opaque surface", tie: "lost to a tie",
    skipped: "skipped: too near behind a layer", pass_limit: "lost to the pass limit",
    overflow: "lost: its list had no room", invisible: "alpha test: invisible",
    masked: "masked by its texture", fill_rule: "the neighbour's, by the fill rule",
    culled: "culled: its back is not drawn", clipped: "clipped: outside near and far",
};

pixel.LETTERS = {
    "kept": "K", "opaque depth": "o", "previous depth": "p", "between": "b", "depth test": "d",
    "alpha test": "a",
};

/* ---- numbers ---- */

/* A number as C's "%a" prints it. */
pixel.parse = (text) => {
    const parts = /^(-?)0x([01])(?:\.([0-9a-f]+))?p([+-]\d+)$/.exec(text);
    if (!parts)
        return { inf: Infinity, "-inf": -Infinity }[text] ?? NaN;
    const [, sign, whole, rest = "", power] = parts;
    const size = (Number(whole) + (rest ? parseInt(rest, 16) / 16 ** rest.length : 0));
    return (sign ? -1 : 1) * size * 2 ** Number(power);
};

/* text: a hexadecimal float of the history. */
pixel.number = (text, what) => app.numberElement(pixel.parse(text), "r32f", `history.${what}`);

pixel.numbers = (texts, what) => texts.flatMap((text, i) =>
    [i ? ", " : "", pixel.number(text, `${what}.${"rgba"[i]}`)]);

/* Representable floats between two. */
pixel.ulp = (a, b) => {
    const order = (value) => {
        const view = new DataView(new ArrayBuffer(4));
        view.setFloat32(0, value);
        const bits = view.getUint32(0);
        return bits & 0x80000000 ? -(bits & 0x7fffffff) - 1 : bits;
    };
    return Math.abs(order(a) - order(b));
};

/* ---- the table of fragments ---- */

pixel.nearToFar = () => pixel.history.fragments.map((fragment, index) => ({ fragment, index }))
    .sort((a, b) => pixel.parse(a.fragment.distance) - pixel.parse(b.fragment.distance) ||
                    a.fragment.primitive - b.fragment.primitive);

pixel.fate = ({ fate, peel, side }) => fate === "peeled"
    ? `peel ${peel}${side === "back" ? ", from behind" : ""}` : pixel.FATES[fate];

pixel.isKept = ({ fate }) => ["peeled", "blended", "seen"].includes(fate);

pixel.tests = (tests) => {
    const text = tests.map((test) => pixel.LETTERS[test]).join("");
    const element = app.element("code", { textContent: text });
    element.title = tests.map((test, k) =>
        `pass ${k}: ${test === "kept" ? "kept" : `rejected by ${test}`}`).join("\n");
    return element;
};

/* A row, and the one below it that is folded. */
pixel.rows = ({ fragment, index }) => {
    const row = app.element("tr", { className: pixel.isKept(fragment) ? "" : "lost" });
    const what = `fragment.${index}`, cell = (...inside) =>
        row.append(app.element("td", {}, ...inside));
    const primitive = app.element("data", { textContent: String(fragment.primitive) });
    const more = app.element("tr", { hidden: true, className: "more" });
    primitive.dataset.value = String(fragment.primitive);
    primitive.dataset.what = `history.${what}.primitive`;
    row.append(app.element("th", { scope: "row" }, pixel.unfold(fragment, index, more)));
    cell(primitive);
    cell(`${fragment.instance_name || fragment.instance} / ` +
         `${fragment.material_name || fragment.material}, ${fragment.facing}`);
    cell(pixel.number(fragment.depth, `${what}.depth`));
    cell(pixel.number(fragment.distance, `${what}.distance`));
    cell(pixel.number(fragment.surface.base[3], `${what}.alpha`));
    cell(fragment.tests.length > 0 ? pixel.tests(fragment.tests) : "");
    return [row, more];
};

/* The button that shows the folded row, which is filled when it is first seen. */
pixel.unfold = (fragment, index, more) => {
    const button = app.element("button", { type: "button", className: "fold",
                                           textContent: pixel.fate(fragment) });
    button.title = "Edges, surface and shading";
    const show = (open) => {
        more.hidden = !open;
        button.setAttribute("aria-expanded", String(open));
        open ? pixel.open.add(fragment.primitive) : pixel.open.delete(fragment.primitive);
        if (open && more.children.length === 0)
            more.append(app.element("td", { colSpan: pixel.HEADS.length },
                app.element("div", { className: "inside" }, ...pixel.edges(fragment, index),
                            pixel.surface(fragment, index), ...pixel.shading(fragment, index))));
    };
    button.addEventListener("click", () => show(more.hidden));
    show(pixel.open.has(fragment.primitive));
    return button;
};

pixel.HEADS = ["Fate", "Triangle", "Surface", "Depth", "Distance", "Alpha", "Passes"];

pixel.table = (className, heads, rows, label) => {
    const head = app.element("tr", {}, ...heads.map((text) =>
        app.element("th", { scope: "col", textContent: text })));
    const table = app.element("table", {}, app.element("thead", {}, head),
                              app.element("tbody", {}, ...rows));
    const box = app.element("div", { className: `table history ${className}`, tabIndex: 0 }, table);
    box.setAttribute("role", "region");
    box.setAttribute("aria-label", label);
    return box;
};

pixel.fragments = () => {
    const part = app.element("div", {},
        app.element("h3", { textContent: "Fragments, near to far" }));
    if (pixel.history.fragments.length === 0) {
        part.append(app.element("p", { textContent: "No triangle at this pixel." }));
        return part;
    }
    part.append(pixel.table("fragments",
        pixel.HEADS, pixel.nearToFar().flatMap(pixel.rows), "Fragments, near to far"));
    part.append(app.element("p", { className: "note", textContent:
        "Passes, one letter each: K kept; rejected by the o opaque depth, p previous depth, " +
        "d depth test, a alpha test; b between the two depths of dual peeling. A fate opens the " +
        "triangle's edges, surface and shading." }));
    return part;
};

/* ---- what is folded: edges, surface, shading ---- */

pixel.edges = (fragment, index) => (fragment.edges ?? []).map(({ value, fill_rule }, i) => {
    const number = app.element("data", { className: "number", textContent: String(value) });
    number.dataset.value = String(value);
    number.dataset.what = `history.fragment.${index}.edge.${i}`;
    const whose = fill_rule === "inside" ? "this triangle" : "the neighbour";
    const rule = fill_rule === null ? " > 0: inside"
        : ` = 0, through the centre: the fill rule gives it to ${whose}`;
    return app.element("p", { className: "formula" }, `edge ${i}: `, number, rule);
});

pixel.surface = ({ surface }, index) => {
    const what = `fragment.${index}`;
    return app.element("div", {},
        app.element("p", { className: "formula" }, "position ",
                    ...pixel.numbers(surface.position, `${what}.position`)),
        app.element("p", { className: "formula" }, "normal ",
                    ...pixel.numbers(surface.normal, `${what}.normal`)),
        app.element("p", { className: "formula" }, "base colour ",
                    ...pixel.numbers(surface.base, `${what}.base`)),
        app.element("p", { className: "formula" }, "roughness ",
                    pixel.number(surface.roughness, `${what}.roughness`), ", metallic ",
                    pixel.number(surface.metallic, `${what}.metallic`), ", occlusion ",
                    pixel.number(surface.occlusion, `${what}.occlusion`)));
};

pixel.LIGHT = [["N\u00b7L", "n_dot_l"], ["N\u00b7H", "n_dot_h"], ["H\u00b7V", "h_dot_v"],
               ["D", "distribution"], ["G", "geometry"], ["F", "fresnel"], ["specular", "specular"],
               ["attenuation", "attenuation"], ["adds", "contribution"], ["sum so far", "sum"]];

pixel.light = (light, at, index) => {
    const row = app.element("tr", {}, app.element("th", { scope: "row", textContent: String(at) }));
    for (const [, key] of pixel.LIGHT) {
        const what = `fragment.${index}.light.${at}.${key}`;
        row.append(app.element("td", {}, ...Array.isArray(light[key])
            ? pixel.numbers(light[key], what) : [pixel.number(light[key], what)]));
    }
    return row;
};

pixel.shading = ({ shading }, index) => {
    if (!shading)
        return [];
    const parts = [];
    if (shading.lights.length > 0)
        parts.push(pixel.table("lights", ["Light", ...pixel.LIGHT.map(([name]) => name)],
            shading.lights.map((light, i) => pixel.light(light, i, index)), "Terms of each light"));
    parts.push(app.element("p", { className: "formula" }, "ambient ",
                           ...pixel.numbers(shading.ambient, `fragment.${index}.ambient`)));
    parts.push(app.element("p", { className: "formula" },
                           "source = ((sum + ambient) \u00b7 \u03b1, \u03b1) = ",
                           ...pixel.numbers(shading.source, `fragment.${index}.source`)));
    return parts;
};

/* ---- blend steps ---- */

pixel.EQUATIONS = {
    under: "C + T\u00b7source, T\u00b7(1 \u2212 \u03b1)",
    over: "source + (1 \u2212 \u03b1)\u00b7C, T\u00b7(1 \u2212 \u03b1)",
    opaque_seed: "all channels + T\u00b7source", add: "sum + source",
    product: "product \u00b7 (1 \u2212 source)",
};

/* What gl stored after a step, as numbers; null where it is not known. */
pixel.glAfter = ({ step, target }) => {
    const name = target !== "accum" ? null : step === "opaque" ? "accum" : `${step}.accum`;
    const buffer = name && app.frame.buffer(name), data = buffer && sides.glData(name);
    if (!data)
        return null;
    const [x, y] = app.pixel, at = 4 * (y * buffer.width + x);
    return [0, 1, 2, 3].map((i) => app.stored(data[at + i], buffer.format));
};

pixel.sameAsGl = (step) => {
    const theirs = pixel.glAfter(step);
    if (!theirs)
        return "";
    const apart = theirs.map((value, i) => pixel.ulp(value, pixel.parse(step.after[i])));
    return Math.max(...apart) === 0 ? "\u2713 same bits" : `\u2717 ${apart.join(", ")} ULP`;
};

pixel.values = (texts, what) => {
    const cell = app.element("td", {}, ...pixel.numbers(texts, what));
    cell.append(app.element("div", { className: "hex", textContent: texts.join(" ") }));
    return cell;
};

/* Where a target is new, what it holds; then the step. */
pixel.stepRows = (step, i, all) => {
    const rows = [], first = all.findIndex(({ target }) => target === step.target) === i;
    if (first)
        rows.push(app.element("tr", {},
            app.element("th", { scope: "row", textContent: `${step.target}, cleared` }),
            app.element("td", {}), pixel.values(step.before, `blend.${i}.before`),
            app.element("td", {})));
    const equation = pixel.EQUATIONS[step.equation] ?? step.equation;
    rows.push(app.element("tr", {},
        app.element("th", { scope: "row" }, step.target === "accum" ? step.step
                                            : `${step.step}, ${step.target}`,
                    app.element("div", { className: "hex", textContent: equation })),
        pixel.values(step.source, `blend.${i}.source`),
        pixel.values(step.after, `blend.${i}.after`),
        app.element("td", { textContent: pixel.sameAsGl(step) })));
    return rows;
};

pixel.steps = () => {
    const { blend, accum_format: format } = pixel.history;
    const part = app.element("div", {}, app.element("h3", {}, "Blend steps ",
        app.element("span", { textContent: `into ${format}, numbers as stored` })));
    part.append(blend.length === 0
        ? app.element("p", { textContent: "Nothing was blended: the background is seen." })
        : pixel.table("blend", ["Step", "Source r, g, b, \u03b1", "After r, g, b, T", "gl"],
                      blend.flatMap(pixel.stepRows), "Blend steps"));
    if (pixel.history.note)
        part.append(app.element("p", { className: "note", textContent: pixel.history.note }));
    return part;
};

/* ---- ref, gl and the truth ---- */

pixel.sideRow = (name, values, ref) => app.element("tr", {},
    app.element("th", { scope: "row", textContent: name }),
    ...values.map((value, i) => app.element("td", {},
        app.numberElement(value, "r32f", `side.${name}.${"rgba"[i]}`),
        app.element("div", { className: "hex", textContent: app.hexFloat(value) }))),
    app.element("td", { textContent: ref === values ? "" :
        values.map((value, i) => pixel.ulp(value, ref[i])).join(", ") }));

pixel.finalOf = (data) => {
    const at = 4 * (app.pixel[1] * app.frame.width + app.pixel[0]);
    return Array.from(data.subarray(at, at + 4));
};

/* The final colour of an accumulation (frame/shading.h, Resolve): gl's is not traced. null where
 * the formula does not lead from ref's accumulation to ref's final, as of opaque-blend seed. */
pixel.resolved = (accum, ref) => {
    /* Codes are fetched as products with the rounded 1/most, not as quotients. */
    const most = { rgba8: 255, rgba16: 65535 }[pixel.history.accum_format];
    const fetch = (value) => most ? Math.fround(Math.round(value * most) * Math.fround(1 / most))
                                  : value;
    const resolve = (stored) => {
        const [r, g, b, t] = stored.map(fetch);
        return [...[r, g, b].map((value, i) =>
            Math.fround(value + Math.fround(app.scene.background[i] * t))), Math.fround(1 - t)];
    };
    const ours = resolve(pixel.history.accum.map(pixel.parse));
    return ours.every((value, i) => Object.is(value, ref[i])) ? resolve(accum) : null;
};

pixel.sides = () => {
    const part = app.element("div", {}, app.element("h3", {}, "ref, gl and the truth ",
        app.element("span", { textContent: "final colour, linear, and coverage" })));
    const ref = pixel.history.final.map(pixel.parse);
    const accum = sides.glData("accum"), truth = sides.truth();
    const gl = accum && pixel.glAfter({ step: "opaque", target: "accum" });
    const glFinal = gl && pixel.resolved(gl, ref);
    const rows = [pixel.sideRow("ref", ref, ref)];
    if (glFinal)
        rows.push(pixel.sideRow("gl", glFinal, ref));
    if (truth)
        rows.push(pixel.sideRow("truth", pixel.finalOf(truth), ref));
    part.append(pixel.table("sides", ["Renderer", "R", "G", "B", "Coverage", "ULP from ref"], rows,
                            "Results beside each other"));
    const apart = gl && gl.map((value, i) => pixel.ulp(value, pixel.parse(pixel.history.accum[i])));
    part.append(app.element("p", { className: "note", textContent:
        gl ? `gl's accumulation: ${Math.max(...apart) === 0 ? "the same bits"
                                                            : `${apart.join(", ")} ULP away`}.`
           : app.data.gl.missing !== undefined ? `gl: ${app.data.gl.missing}.`
           : "gl and the truth stand beside the frame as the program rendered it; this one has " +
             "other settings." }));
    return part;
};

/* ---- the panel ---- */

pixel.panel = app.panel("pixel", "The pixel's history");
pixel.body = app.element("div", { id: "pixel-history" });
pixel.panel.append(pixel.body);

pixel.fill = () => {
    const [x, y] = app.pixel;
    pixel.panel.querySelector("h2").textContent = `Pixel ${x},${y}: ${pixel.history.summary}`;
    pixel.body.replaceChildren(ray.draw(), pixel.fragments(), pixel.steps(), pixel.sides());
};

/* The newest question's answer alone is shown. */
pixel.show = async () => {
    const asked = ++pixel.asked;
    if (!app.pixel || app.view === "live") {
        pixel.panel.hidden = true;
        return;
    }
    try {
        const history = await app.engine.history(...app.pixel);
        if (asked !== pixel.asked)
            return;
        pixel.history = history;
        pixel.panel.hidden = false;
        pixel.fill();
    } catch (error) {
        app.say(error.message);
    }
};

app.on("pixel", pixel.show);
app.on("view", pixel.show);
