/* The steps that a frame ends with, by any method. */
"use strict";

walk.stop = () => {
    const { peels, geometry_passes: passes, lost_to_pass_limit: lost, residual_max: residual } =
        app.frame;
    const limited = lost > 0;
    const count = (value, what) => app.numberElement(value, "count", `frame.${what}`);
    return walk.step({
        id: "stop", kind: "peel", group: "Peels", code: [8],
        title: limited ? "The number of peels was limited" : "Nothing is left to peel",
        text: limited
            ? ["After ", count(peels, "peels"), peels === 1 ? " peel" : " peels",
               " the limit was reached, and ",
               count(lost, "lost_to_pass_limit"), lost === 1 ? " fragment was" : " fragments were",
               " never taken. The light they would have added is at most what still came through " +
               "in front of them: a " +
               "transmittance of up to ",
               app.numberElement(residual, "double", "frame.residual_max"),
               "."]
            : ["One more geometry pass would keep no fragment: every transparent surface was " +
               "taken by one of the ", count(peels, "peels"),
               peels === 1 ? " peel, in " : " peels, in ",
               count(passes, "geometry_passes"), " geometry passes."],
        pictures: () => [{ title: "Layers in each pixel", picture: walk.layerCounts() }],
        equation: ([x, y]) => walk.formula`layers here: ${app.numberElement(
            walk.layers().data[y * app.frame.width + x], "count", "frame.layers")}`,
        source: walk.EVERITT });
};

/* How many layers were taken in each pixel. */
walk.layers = () => {
    if (app.frame.layers)
        return app.frame.layers;
    const { width, height } = app.frame, data = new Uint16Array(width * height);
    for (const { name, data: ids } of app.frame.buffers)
        if (/^peel\.\d+\.primitive$/.test(name))
            ids.forEach((id, i) => data[i] += id !== 0xffffffff);
    return app.frame.layers = { name: "frame.layers", width, height, channels: 1, data };
};

walk.layerCounts = () => draw.counts(walk.layers(), walk.layers().data, "frame.layers", "layers");

/* before: the accumulation's name before the opaque surfaces, null: cleared. */
walk.light = (before, lines, code) => walk.step({
    id: "light", kind: "light", group: "Opaque lighting pass", lines, code,
    title: walk.isForward() ? "Blend the opaque surfaces under"
                            : "Light the opaque surfaces and blend them under",
    text: walk.isForward()
        ? "The opaque surfaces were lit as they were drawn. Now they are blended behind all " +
          "layers like one more layer, with an \u03b1 of 1: after it nothing comes through any " +
          "more."
        : "The opaque surfaces were waiting in their G-buffer. Now they are lit, once, and " +
          "blended " +
        "behind all layers like one more layer, with an \u03b1 of 1: after it nothing comes " +
        "through any more.",
    buffers: ["accum"],
    pictures: () => walk.accums(before, "accum", "opaque.source"),
    equation: walk.under("opaque.source", before, "accum"),
    source: walk.RAPETTA });

walk.background = (lines, code) => walk.step({
    id: "background", kind: "background", group: "Resolve", lines, code,
    title: "The background, where light still comes through",
    text: "What is left of T shows the background. The fourth channel of the final image is the " +
        "coverage, 1 \u2212 T.",
    buffers: ["accum"],
    pictures: () => [...walk.show("accum", "Accumulated"),
                     ...walk.show("final", "Final, linear light")],
    equation: (pixel) => walk.lines(...["red", "green", "blue"].map((label, i) =>
        walk.formula`${label}: ${walk.number("accum", pixel, i)} + ${walk.throughAll(pixel)
            } \u00b7 ${app.numberElement(app.scene.background[i], "r32f",
                                         `scene.background.${"rgb"[i]}`)
            } = ${walk.number("final", pixel, i)}`),
        walk.formula`coverage: 1 \u2212 ${walk.throughAll(pixel)} = ${
            walk.number("final", pixel, 3)}`),
    source: walk.RAPETTA });

/* The transmittance towards the background. */
walk.throughAll = (pixel) => walk.seedBlend("opaque.source") && walk.hasFragment("opaque", pixel)
    ? app.numberElement(0, "r32f", "accum.through") : walk.number("accum", pixel, 3);

walk.display = (lines, code) => walk.step({
    id: "display", kind: "display", group: "Resolve", lines, code,
    title: "To the display",
    text: "Light can be brighter than any display. Each channel c becomes (c / (c + 1)) to the " +
        "power 1/2.2, which keeps bright parts apart, and is rounded to one of 256 steps.",
    buffers: ["display"],
    pictures: () => [...walk.show("final", "Final, linear light, cut off at 1", draw.linear),
                     ...walk.show("display", "Display")],
    equation: (pixel) => walk.lines(...["red", "green", "blue"].map((label, i) =>
        walk.formula`${label}: 255 \u00b7 (${walk.number("final", pixel, i)} / (${
            walk.number("final", pixel, i)} + 1))^(1/2.2) \u2192 ${
            walk.code("display", pixel, i)}`)),
    source: `${walk.RAPETTA} (Reinhard's tone mapping, display gamma)` });

/* The integer that is stored of a unorm channel. */
walk.code = (name, [x, y], channel) => {
    const buffer = app.frame.buffer(name);
    return app.numberElement(buffer.data[(y * buffer.width + x) * buffer.channels + channel],
                             "count", `${draw.what(buffer, channel)}.code`);
};

/* ---- how right it is ---- */

walk.LINEAR = "Linear light, as the display would show it.";

walk.truth = () => walk.step({
    id: "truth", kind: "truth", group: "How right is it?", lines: [], code: [],
    title: "Beside the truth",
    text: walk.truthText(),
    buffers: ["accum", "display"],
    pictures: () => sides.truth()
        ? [...walk.show("final", "This frame", (buffer) => draw.light(buffer, walk.LINEAR)),
           { title: "Truth", picture: draw.light(walk.truthBuffer(), walk.LINEAR) },
           { title: "Difference of this frame", picture: draw.error(app.frame.buffer("final"),
                                                                    sides.truth(), "truth.error") }]
        : walk.show("display", "Display"),
    equation: (pixel) => sides.truth() && walk.lines(...["red", "green", "blue", "coverage"].map(
        (label, i) => walk.formula`${label}: ${walk.number("final", pixel, i)} here, ${
            app.numberElement(sides.truth()[4 * (pixel[1] * app.frame.width + pixel[0]) + i],
                              "r32f", `truth.final.${"rgba"[i]}`)} in truth`)),
    source: "" });

walk.truthBuffer = () => ({
    ...app.frame.buffer("final"), name: "truth.final", data: sides.truth() });

walk.truthText = () => {
    const { truth } = app.data, what = "The truth is a renderer of its own: it sorts every " +
        "pixel's fragments exactly and computes in double precision. ";
    if (truth.missing !== undefined)
        return `${what}It has nothing to say here: ${truth.missing}.`;
    if (!sides.truth())
        return `${what}The page carries its image of the frame as the program rendered it; this ` +
               "frame has other settings.";
    const { greatest, rmse } = draw.error(app.frame.buffer("final"), sides.truth(), "truth.error");
    const number = (value, name, format = "count") =>
        app.numberElement(value, format, `truth.${name}`);
    return [`${what}It counts `, number(truth.figures.fragments, "fragments"),
            " transparent fragments in front of the opaque depth, at most ",
            number(truth.figures.max_layers, "max_layers"), " in one pixel, and ",
            number(truth.figures.ties, "ties"), " at exactly the depth of another. This frame's " +
            "greatest difference from it is ", number(greatest, "max_abs", "double"),
            ", the root of the mean square ", number(rmse, "rmse", "double"), "."];
};

walk.ending = (before, lines, [light, background, display]) => [
    walk.light(before, lines, light), walk.background(lines, background),
    walk.display(lines, display), walk.truth()];

/* ---- the whole walk ---- */

walk.peeling = () => {
    const { peels } = app.frame;
    const lines = walk.peelCode();
    return [walk.naive(), ...walk.opaque(lines), ...walk.peels(),
            ...(peels > 0 ? [walk.stop()] : []),
            ...walk.ending(peels > 0 ? `peel.${peels - 1}.accum` : null, lines,
                           [[13], [14], [15]])];
};

walk.METHODS = { "peel": walk.peeling, "peel-id": walk.peeling, "forward": walk.peeling };

app.makeSteps = () => {
    return (walk.METHODS[app.choice("method")] ?? walk.peeling)();
};
