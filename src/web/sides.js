/* What gl and the truth have to say of the frame that the program rendered: the page carries it as
 * differences from ref. */
"use strict";

const sides = { gl: new Map(), final: null, truthFinal: null };

/* After the first frame, which is the program's. */
sides.open = async () => {
    const { gl, truth } = app.data;
    sides.final = app.frame.buffer("final");
    for (const { name, differing, difference } of gl.buffers ?? [])
        sides.gl.set(name, { differing, difference: difference && await app.unpack(difference) });
    if (truth.missing === undefined)
        sides.truthFinal = sides.unpackTruth(await app.unpack(truth.final));
};

sides.unpackTruth = (planes) => {
    const count = planes.length / 4, bits = new Uint32Array(sides.final.data.slice().buffer);
    for (let k = 0; k < 4; k++)
        for (let i = 0; i < count; i++)
            bits[i] ^= planes[k * count + i] << 8 * k;
    return new Float32Array(bits.buffer);
};

/* gl's stored values of a buffer, as ref's are stored; null where they are not known: another
 * frame than the carried one, no gl, or a buffer that gl does not have. */
sides.glData = (name) => {
    const ours = app.frame.buffer(name), theirs = sides.gl.get(name);
    if (!ours || !theirs || !app.asCarried())
        return null;
    if (theirs.differing === 0)
        return ours.data;
    const bytes = new Uint8Array(ours.data.slice().buffer);
    theirs.difference.forEach((difference, i) => {
        bytes[i] ^= difference;
    });
    return new ours.data.constructor(bytes.buffer);
};

/* The truth's final image, FORMAT_RGBA32F, or null. It does not depend on the method. */
sides.truth = () => app.asCarried(["method"]) ? sides.truthFinal : null;

/* Where gl stored other bits in a step's buffers. */
sides.pictures = (step) => step.buffers.flatMap((name) => {
    const theirs = sides.gl.get(name)?.differing > 0 && sides.glData(name);
    const ours = app.frame.buffer(name);
    return theirs ? [{ title: `${name}: where gl differs`,
                       picture: draw.differing({ ...ours, data: theirs }, ours) }] : [];
});

/* ---- in words ---- */

/* About a step's buffers: a list of nodes and texts. */
sides.line = (step) => {
    if (app.data.gl.missing !== undefined)
        return [`OpenGL: not compared, ${app.data.gl.missing}.`];
    if (!app.asCarried())
        return step.buffers.length > 0
            ? ["OpenGL: compared as the program rendered the frame; this one has other settings."]
            : [];
    const known = step.buffers.filter((name) => sides.gl.has(name));
    const other = known.filter((name) => sides.gl.get(name).differing > 0);
    if (known.length === 0)
        return [];
    if (other.length === 0)
        return [app.element("span", { className: "same", textContent: "\u2713 gl: same bits" }),
                ` in ${known.join(", ")} (${app.data.gl.renderer}).`];
    const counts = other.map((name) => `${name} (${sides.gl.get(name).differing} bytes)`);
    return [app.element("span", { className: "differs", textContent: "\u2717 gl: other bits" }),
            ` in ${counts.join(", ")}.`];
};
