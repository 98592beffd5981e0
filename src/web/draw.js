/* Buffers as pictures: {width, height, rgba, legend, describe(x, y)}. legend: text; describe: what
 * is stored at a pixel, as a list of [label, stored, format, channel name]. Pixels that hold
 * nothing are left transparent: the page shows a hatching there. */
"use strict";

const draw = {};

/* ---- colours ---- */

draw.mix = (a, b, t) => a.map((v, i) => v + (b[i] - v) * t);

/* Near to far, least to most: light to dark, one way in brightness too. */
draw.RAMP = [[253, 240, 196], [240, 178, 104], [205, 96, 92], [122, 52, 118], [38, 30, 84]];

draw.ramp = (t) => {
    const at = Math.max(0, Math.min(1, t)) * (draw.RAMP.length - 1);
    const i = Math.min(draw.RAMP.length - 2, Math.floor(at));
    return draw.mix(draw.RAMP[i], draw.RAMP[i + 1], at - i);
};

/* A linear colour as a program without tone mapping would show it. */
draw.gamma = (value) => 255 * Math.max(0, Math.min(1, value)) ** (1 / 2.2);
/* The frame's display transform (frame/shading.h). */
draw.display = (value) => {
    const c = Math.max(0, value);
    return 255 * (c / (c + 1)) ** (1 / 2.2);
};

/* Names' colours, far from each other; the same name has the same one. */
draw.category = (id) => {
    const hue = Math.imul(id + 1, 0x9e3779b1) >>> 0;
    return draw.hsl(hue / 2 ** 32, 0.45 + 0.2 * (id % 2), 0.42 + 0.12 * (id % 3));
};

draw.hsl = (h, s, l) => {
    const a = s * Math.min(l, 1 - l);
    return [0, 8, 4].map((n) => {
        const k = (n + h * 12) % 12;
        return 255 * (l - a * Math.max(-1, Math.min(k - 3, 9 - k, 1)));
    });
};

/* ---- pictures ---- */

/* color(at): [r, g, b] of the pixel whose first channel is at `at`, or null for nothing. */
draw.picture = (buffer, legend, color, describe) => {
    const { width, height, channels } = buffer;
    const rgba = new Uint8ClampedArray(4 * width * height);
    for (let i = 0; i < width * height; i++) {
        const c = color(i * channels, i);
        if (c)
            rgba.set([c[0], c[1], c[2], 255], 4 * i);
    }
    return { width, height, rgba, legend, describe };
};

/* The first channels of a pixel, with these labels. */
draw.describe = (buffer, labels) => (x, y) => {
    const at = (y * buffer.width + x) * buffer.channels;
    return [...labels].map((label, i) => [label, buffer.data[at + i], buffer.format,
                                          draw.what(buffer, i)]);
};

/* "peel.2.accum.r"; of a buffer with one channel "peel.2.depth". */
draw.what = (buffer, channel) => buffer.channels === 1 ? buffer.name
                                                       : `${buffer.name}.${"rgba"[channel]}`;

/* What a texel fetch would give of a channel. */
draw.value = (buffer, at) => {
    const stored = buffer.data[at];
    const isFloat = buffer.format === "rgba32f" || buffer.format === "d32f";
    return isFloat ? stored : app.stored(stored, buffer.format);
};

/* Whether the pass that made the buffer drew nothing at pixel i. */
draw.isEmpty = (buffer, i) => {
    buffer.ids ??= app.frame.buffer(buffer.name.replace(/[^.]*$/, "primitive")) ?? { data: [] };
    return buffer.ids.data[i] === 0xffffffff;
};

/* Distance from the eye along the view axis, of a window depth. */
draw.distance = (depth) => {
    const { near, far } = app.scene.cameras[app.settings.camera];
    const d = draw.reversed() ? 1 - depth : depth;
    return far === null ? near / (1 - d) : near * far / (far - d * (far - near));
};

draw.reversed = () => app.choice("depth-range") === "reversed";

/* Least and greatest distance of all that the frame's depth buffers hold. */
draw.distances = () => {
    if (draw.distances.frame === app.frame)
        return draw.distances.range;
    const drawn = app.frame.buffers.filter((one) => /^(opaque|peel\.\d+)\.depth$/.test(one.name));
    if (app.frame.buffer("peel.0.depth") === undefined && walk.limits(0))
        drawn.push(walk.limit(0, 0), walk.limit(0, 1));
    const ends = drawn.map((buffer) => draw.extremes(Array.from(buffer.data, (_, i) =>
        draw.isEmpty(buffer, i) ? NaN : draw.value(buffer, i)), null)).filter(Boolean).flat();
    draw.distances.frame = app.frame;
    draw.distances.range = draw.extremes(ends.map(draw.distance));
    return draw.distances.range;
};

/* Least and greatest of those that are finite. */
draw.extremes = (values, none = [0, 1]) => {
    let low = Infinity, high = -Infinity;
    for (const value of values)
        if (Number.isFinite(value)) {
            low = Math.min(low, value);
            high = Math.max(high, value);
        }
    return low <= high ? [low, high] : none;
};

draw.depth = (buffer) => {
    const [low, high] = draw.distances();
    const span = Math.max(high - low, 1e-9);
    const color = (at, i) => draw.isEmpty(buffer, i) ? null
        : draw.ramp((draw.distance(draw.value(buffer, at)) - low) / span);
    return draw.picture(buffer, `Light is near (${low.toPrecision(3)}), dark is far ` +
        `(${high.toPrecision(3)}); hatched: nothing was drawn.`, color,
        draw.describe(buffer, ["depth"]));
};

/* Undoes the octahedral form (frame/shading.h). */
draw.octahedral = (u, v) => {
    let [x, y] = [2 * u - 1, 2 * v - 1];
    const z = 1 - Math.abs(x) - Math.abs(y);
    if (z < 0)
        [x, y] = [(1 - Math.abs(y)) * (x < 0 ? -1 : 1), (1 - Math.abs(x)) * (y < 0 ? -1 : 1)];
    const scale = 1 / Math.hypot(x, y, z);
    return [x * scale, y * scale, z * scale];
};

draw.normal = (buffer) => draw.picture(buffer,
    "Red to the right, green up, blue towards the eye; grey is 0.",
    (at, i) => {
        if (draw.isEmpty(buffer, i))
            return null;
        const n = [0, 1, 2].map((k) => k < buffer.channels ? draw.value(buffer, at + k) : 0);
        const normal = buffer.channels === 2 ? draw.octahedral(n[0], n[1]) : n;
        return normal.map((v) => 127.5 * v + 127.5);
    }, draw.describe(buffer, buffer.channels === 2 ? "uv" : "xyz"));

/* Of the dual methods: the direction in two channels, then opacity and a mask. */
draw.octahedrals = (buffer) => draw.picture(buffer, "Red to the right, green up, blue to the eye.",
    (at) => draw.value(buffer, at + 3) === 0 ? null
        : draw.octahedral(draw.value(buffer, at), draw.value(buffer, at + 1)).map((v) =>
            127.5 * v + 127.5),
    draw.describe(buffer, ["u", "v", "\u03b1", "mask"]));

draw.position = (buffer) => {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let i = 0; i < buffer.width * buffer.height; i++)
        for (let k = 0; k < 3 && !draw.isEmpty(buffer, i); k++) {
            low[k] = Math.min(low[k], draw.value(buffer, 4 * i + k));
            high[k] = Math.max(high[k], draw.value(buffer, 4 * i + k));
        }
    const text = ["x", "y", "z"].map((name, k) =>
        `${name} from ${low[k].toPrecision(3)} to ${high[k].toPrecision(3)}`).join(", ");
    const caption = low[0] > high[0] ? "Nothing is stored."
        : `Place in the eye's space: ${text}, as red, green and blue.`;
    return draw.picture(buffer, caption,
        (at, i) => draw.isEmpty(buffer, i) ? null : [0, 1, 2].map((k) =>
            255 * (draw.value(buffer, at + k) - low[k]) / Math.max(high[k] - low[k], 1e-9)),
        draw.describe(buffer, "xyz"));
};

draw.base = (buffer) => draw.picture(buffer, "The surface's own colour, before any light.",
    (at, i) => draw.isEmpty(buffer, i) ? null
        : [0, 1, 2].map((k) => draw.gamma(draw.value(buffer, at + k))),
    draw.describe(buffer, "rgba"));

draw.material = (buffer) => draw.picture(buffer,
    "Roughness as red, metallic as green, occlusion as blue.",
    (at, i) => draw.isEmpty(buffer, i) ? null : [0, 1, 2].map((k) =>
        255 * draw.value(buffer, at + k)),
    draw.describe(buffer, ["roughness", "metallic", "occlusion"]));

draw.ids = (buffer) => draw.picture(buffer, "Each triangle has a colour of its own.",
    (at) => buffer.data[at] === 0xffffffff ? null : draw.category(buffer.data[at]),
    draw.describe(buffer, ["triangle"]));

draw.light = (buffer, legend = "Light gathered so far, as the display would show it.") =>
    draw.picture(buffer, legend,
        (at) => [0, 1, 2].map((k) => draw.display(draw.value(buffer, at + k))),
        draw.describe(buffer, /accum|layers/.test(buffer.name) ? "rgbT" : "rgba"));

/* The same where nothing was blended left out. */
draw.source = (buffer) => draw.picture(buffer, "As the display would show it on black.",
    (at) => buffer.data[at + 3] === 0 ? null
        : [0, 1, 2].map((k) => draw.display(draw.value(buffer, at + k))),
    draw.describe(buffer, "rgba"));

/* A premultiplied colour without its alpha: to be looked at only. */
draw.unmultiplied = (buffer) => draw.picture(buffer, "The colour before it was multiplied.",
    (at) => buffer.data[at + 3] === 0 ? null
        : [0, 1, 2].map((k) =>
            draw.display(draw.value(buffer, at + k) / draw.value(buffer, at + 3))),
    () => []);

draw.linear = (buffer) => draw.picture(buffer, "Without tone mapping.",
    (at) => [0, 1, 2].map((k) => draw.gamma(draw.value(buffer, at + k))),
    draw.describe(buffer, "rgba"));

/* One channel in grey. */
draw.grey = (buffer, channel, legend) => draw.picture(buffer, legend,
    (at) => Array(3).fill(255 * draw.value(buffer, at + channel)),
    (x, y) => [draw.describe(buffer, buffer.channels < 4 ? ["value"]
        : /source/.test(buffer.name) ? "rgb\u03b1" : "rgbT")(x, y)[channel]]);

draw.bytes = (buffer) => draw.picture(buffer, "The image.",
    (at) => [0, 1, 2].map((k) => buffer.data[at + k]), draw.describe(buffer, "rgba"));

draw.any = (buffer) => draw.picture(buffer, "Values from 0 to 1.",
    (at) => [0, 1, 2].map((k) => k < buffer.channels ? 255 * draw.value(buffer, at + k) : 0),
    draw.describe(buffer, "rgba".slice(0, buffer.channels)));

/* By what the buffer's name says. */
draw.buffer = (buffer) => {
    const kinds = { depth: draw.depth, normal: draw.normal, position: draw.position,
                    diffuse: draw.base, material: draw.material, primitive: draw.ids, id: draw.ids,
                    accum: draw.light, final: draw.light, color: draw.light, display: draw.bytes };
    return (kinds[buffer.name.split(".").pop()] ?? draw.any)(buffer);
};

/* ---- pictures made of two or more buffers ---- */

draw.TESTS = [
    { what: "peeled", color: [222, 143, 5], pattern: "slant", text: "the previous depth" },
    { what: "hidden", color: [1, 115, 178], pattern: "plain", text: "the opaque depth" },
    { what: "farther", color: [2, 158, 115], pattern: "level",
      text: "the depth test: another is nearer" },
];

/* Which tests threw fragments away in a peel: a colour and a pattern each; where several did, they
 * stand in columns. */
draw.rejected = (peel) => {
    const tests = draw.TESTS.map((test) => ({
        ...test, buffer: app.frame.buffer(`peel.${peel}.${test.what}`), count: 0 }));
    for (const test of tests)
        test.count = test.buffer.data.reduce((sum, n) => sum + n, 0);
    const { width } = tests[0].buffer;
    const color = (at) => {
        const [x, y] = [at % width, Math.floor(at / width)];
        const some = tests.filter((test) => test.buffer.data[at] > 0);
        return some.length === 0 ? null : draw.pattern(some[(x >> 2) % some.length], x, y);
    };
    const legend = tests.map((test) => ({ ...test, text: [`${test.text}: `,
        app.numberElement(test.count, "count", `peel.${peel}.${test.what}.count`)] }));
    return draw.picture(tests[0].buffer, legend, color, (x, y) => tests.map((test) =>
        [test.text.split(":")[0], test.buffer.data[y * width + x], "count",
         `peel.${peel}.${test.what}`]));
};

draw.pattern = ({ color, pattern }, x, y) => {
    const line = pattern === "slant" ? (x + y) % 4 === 0 : pattern === "level" && y % 3 === 0;
    return line ? draw.mix(color, [255, 255, 255], 0.45) : color;
};

/* Where two buffers of one format have other bits. */
draw.differing = (a, b, channels = a.channels) => {
    let count = 0;
    const color = (at) => {
        for (let k = 0; k < channels; k++)
            if (a.data[at + k] !== b.data[at + k]) {
                count++;
                return [205, 60, 80];
            }
        return [128, 132, 140];
    };
    const picture = draw.picture(a, "", color, (x, y) => {
        const at = (y * a.width + x) * a.channels;
        return [...Array(channels).keys()].map((k) =>
            [`${"rgba"[k]} difference`, a.data[at + k] - b.data[at + k], "count",
             `difference.${"rgba"[k]}`]);
    });
    picture.count = count;
    picture.legend = `Red: pixels that differ, ${count} of ${a.width * a.height}.`;
    return picture;
};

/* The greatest difference of a pixel's channels, on a logarithmic scale from 1e-8 to 1. */
draw.error = (a, data, what) => {
    const most = (at) => Math.max(
        ...[0, 1, 2, 3].map((k) => Math.abs(a.data[at + k] - data[at + k])));
    let greatest = 0, squares = 0;
    const picture = draw.picture(a, "", (at) => {
        const error = most(at);
        greatest = Math.max(greatest, error);
        squares += [0, 1, 2, 3].reduce((sum, k) => sum + (a.data[at + k] - data[at + k]) ** 2, 0);
        return error === 0 ? [0, 0, 0] : draw.ramp(1 - (Math.log10(error) + 8) / 8);
    }, (x, y) => [["difference", most(4 * (y * a.width + x)), "double", `${what}.at`]]);
    picture.greatest = greatest;
    picture.rmse = Math.sqrt(squares / (4 * a.width * a.height));
    picture.legend = "Greatest difference of a pixel's channels, from dark (1e-8) to light (1); " +
                     "black: equal.";
    return picture;
};

/* Counts per pixel. */
draw.counts = (buffer, data, what, label) => {
    const most = data.reduce((a, b) => Math.max(a, b), 0);
    return draw.picture({ ...buffer, channels: 1 }, `None (hatched) to ${most} (dark).`,
        (at) => data[at] === 0 ? null : draw.ramp(data[at] / Math.max(most, 1)),
        (x, y) => [[label, data[y * buffer.width + x], "count", what]]);
};

/* A row of the picture seen from above: distance upwards. rows: {buffer, color, text} of depths;
 * text "" is not in the legend. A list of one, or of none without a pixel. */
draw.slice = (rows) => {
    if (!app.pixel)
        return [];
    const { width } = app.frame, height = Math.ceil(width * 0.45);
    const distances = rows.map(({ buffer }) => [...Array(width).keys()].map((x) => {
        const i = app.pixel[1] * width + x;
        return draw.isEmpty(buffer, i) ? NaN : draw.distance(draw.value(buffer, i));
    }));
    /* Opaque surfaces may be far away: they are seen where they are near what is shown. */
    const layers = distances.filter((_, row) => rows[row].buffer.name !== "opaque.depth");
    const [low, high] = draw.extremes(layers.flat(), draw.distances());
    const rgba = new Uint8ClampedArray(4 * width * height);
    const put = (x, y, end, color) => {
        for (; y <= end; y++)
            if (y >= 0 && y < height)
                rgba.set([...color, 255], 4 * (y * width + x));
    };
    for (let y = 0; y < height; y += 4)
        put(app.pixel[0], y, y + 1, [150, 150, 150]);
    const place = (z) => Math.round((height - 6) * (high - z) / Math.max(high - low, 1e-9)) + 2;
    rows.forEach(({ color }, row) => distances[row].forEach((z, x, all) => {
        if (!(z <= high && z >= low))
            return;
        const y = place(z), last = x > 0 ? place(all[x - 1]) : NaN; /* a steep surface is a line */
        const from = Math.abs(last - y) < height / 16 ? last + Math.sign(y - last) : y;
        put(x, Math.min(from, y), Math.max(from, y) + 1, color);
    }));
    const legend = rows.filter(({ text }) => text).map((row) => ({ ...row, pattern: "plain" }));
    return [{ title: `The pixel's row, from above; the eye is below`, picture: {
        width, height, rgba, legend, plain: true, describe: () => [] } }];
};
