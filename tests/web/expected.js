/* What a page has to show: for a number's name (its data-what), the program's value. Names that are
 * not known here are an error, so that no number goes unchecked. */
"use strict";

const fs = require("node:fs");
const path = require("node:path");
const { execFileSync } = require("node:child_process");
const { frame } = require("./pages.js");

const UNORM_MAX = { rgba16: 65535, rgba8: 255, rg16: 65535, d24: 16777215, d16: 65535 };
const FIELDS = ["red", "green", "blue", "alpha", "roughness", "metallic", "occlusion"];

/* As C's "%a" or plainly. */
function parseNumber(text) {
    const parts = /^(-?)0x([01])(?:\.([0-9a-f]+))?p([+-]\d+)$/.exec(text);
    if (!parts)
        return { inf: Infinity, "-inf": -Infinity, nan: NaN }[text] ?? Number(text);
    const [, sign, whole, rest = "", power] = parts;
    const size = Number(whole) + (rest ? parseInt(rest, 16) / 16 ** rest.length : 0);
    return (sign ? -1 : 1) * size * 2 ** Number(power);
}

function half(bits) {
    const exponent = (bits >> 10) & 31, mantissa = bits & 1023;
    const size = exponent === 0 ? mantissa * 2 ** -24
               : exponent === 31 ? (mantissa ? NaN : Infinity)
               : (1 + mantissa / 1024) * 2 ** (exponent - 15);
    return bits & 0x8000 ? -size : size;
}

function decode(stored, format) {
    if (format === "rgba16f")
        return half(stored);
    return UNORM_MAX[format] ? Math.fround(stored / UNORM_MAX[format]) : stored;
}

/* The program beside a page in one state of it. state: {peel, program, scene, size, settings: index
 * of each, names of methods, edits: {"material.0.alpha": 0.5}, folder, command: arguments of peel
 * for the same, truth: whether the page carries its image}. */
class Expected {
    constructor(state) {
        Object.assign(this, state, { frames: new Map(), histories: new Map(), whats: new Set() });
        this.ref = this.live = this.render("ref", {});
    }
    render(side, settings) {
        const key = side + JSON.stringify(settings);
        if (!this.frames.has(key))
            this.frames.set(key, frame(this.program, side, this.scene, this.size,
                                       { ...this.settings, ...this.edits, ...settings },
                                       this.folder));
        return this.frames.get(key);
    }
    /* The frame of another size, of which the live view has figures. */
    setLive(size) {
        this.live = frame(this.program, "plain", this.scene, size,
                          { ...this.settings, ...this.edits }, this.folder);
    }
    method(name) { return this.render("ref", { method: this.methods.indexOf(name) }); }
    history(pixel) {
        const key = pixel.join(","), file = path.join(this.folder, "history.json");
        if (!this.histories.has(key)) {
            execFileSync(this.peel, ["explain", ...this.command, "--renderers", "ref",
                                     "--pixel", key, "--json", file]);
            this.histories.set(key, JSON.parse(fs.readFileSync(file, "utf8")).ref);
        }
        return this.histories.get(key);
    }
    at(frame, name, [x, y], channel) {
        const { data, channels, format } = frame.buffers.get(name);
        return decode(data[(y * this.size[0] + x) * channels + channel], format);
    }
    channel(letter) { return "rgba".indexOf(letter); }

    /* The greatest difference and the root of the mean square. */
    error(method) {
        const a = this.method(method).buffers.get("final").data;
        const other = this.truth ? this.render("truth", {}) : this.method("peel-id");
        const b = other.buffers.get("final").data;
        let most = 0, squares = 0;
        a.forEach((value, i) => {
            most = Math.max(most, Math.abs(value - b[i]));
            squares += (value - b[i]) ** 2;
        });
        return { max_abs: most, rmse: Math.sqrt(squares / a.length), at: ([x, y]) => {
            const i = 4 * (y * this.size[0] + x);
            return Math.max(...[0, 1, 2, 3].map((k) => Math.abs(a[i + k] - b[i + k])));
        } };
    }

    value(what, pixel) {
        this.whats.add(what.replace(/\d+/g, "N"));
        for (const find of Expected.KINDS) {
            const value = find(this, what, pixel);
            if (value !== undefined)
                return value;
        }
        throw new Error(`${what}: the test does not know what this should be`);
    }
}

/* The layers of a pixel. */
function layers(expected, pixel) {
    let count = 0;
    for (const name of expected.ref.buffers.keys())
        if (/^peel\.\d+\.primitive$/.test(name))
            count += expected.at(expected.ref, name, pixel, 0) !== 0xffffffff;
    return count;
}

/* A distance of dual peeling's min-max depths. */
function front(expected, name, side, pixel) {
    const stored = expected.at(expected.ref, name, pixel, side === "nearest" ? 0 : 1);
    return side === "nearest" ? -stored : stored;
}

/* null where the history has no such fragment, step or light: the page may still show another
 * pixel's. */
function ofHistory({ fragments, blend }, path) {
    const [kind, index, ...rest] = path;
    if (kind === "blend" ? !blend[index]
        : !fragments[index] || (rest[0] === "light" && !fragments[index].shading?.lights[rest[1]]))
        return null;
    const list = (values, letter) => values["rgba".indexOf(letter)];
    if (kind === "blend")
        return list(blend[index][rest[0]], rest[1]);
    const fragment = fragments[index], [key, ...more] = rest;
    if (key === "primitive" || key === "depth" || key === "distance")
        return fragment[key];
    if (key === "alpha")
        return fragment.surface.base[3];
    if (key === "edge")
        return fragment.edges[more[0]].value;
    if (key === "light") {
        const term = fragment.shading.lights[more[0]][more[1]];
        return Array.isArray(term) ? list(term, more[2]) : term;
    }
    if (key === "ambient" || key === "source")
        return list(fragment.shading[key], more[0]);
    const value = fragment.surface[key];
    return Array.isArray(value) ? list(value, more[0]) : value;
}

/* Each: (expected, what, pixel) -> the value, or undefined where it is another kind. */
Expected.KINDS = [
    /* A stored value: a buffer's name, and the channel where it has several. */
    (e, what, pixel) => {
        const name = e.ref.buffers.has(what) ? what : what.slice(0, -2);
        const channel = name === what ? 0 : e.channel(what.at(-1));
        return e.ref.buffers.has(name) && channel >= 0 ? e.at(e.ref, name, pixel, channel)
                                                       : undefined;
    },
    (e, what, [x, y]) => {
        const [, name, letter] = what.match(/^(.*)\.([rgba])\.code$/) ?? [];
        return name && e.ref.buffers.get(name).data[4 * (y * e.size[0] + x) + e.channel(letter)];
    },
    (e, what) => {
        const [, name] = what.match(/^(peel\.\d+\.(?:peeled|hidden|farther))\.count$/) ?? [];
        return name && e.ref.buffers.get(name).data.reduce((a, b) => a + b, 0);
    },
    (e, what) => {
        const [, letter] = what.match(/\.cleared\.([rgba])$/) ?? [];
        return letter && (letter === "a" ? 1 : 0);
    },
    (e, what, pixel) => {
        const [, name, side] = what.match(/^(.*\.depth)\.(nearest|farthest)$/) ?? [];
        return name && front(e, name, side, pixel);
    },
    (e, what, pixel) => {
        const [, name, letter] = what.match(/^(?:methods\.)?([\w-]+)\.display\.([rgba])$/) ?? [];
        return name && e.at(e.method(name), "display", pixel, e.channel(letter));
    },
    (e, what, pixel) => {
        const [, method, kind] = what.match(/^methods\.([\w-]+)\.(error\.at|max_abs|rmse)$/) ?? [];
        if (method)
            return kind === "error.at" ? e.error(method).at(pixel) : e.error(method)[kind];
        const own = e.methods[e.settings.method];
        return { "truth.error.at": () => e.error(own).at(pixel),
                 "truth.max_abs": () => e.error(own).max_abs,
                 "truth.rmse": () => e.error(own).rmse }[what]?.();
    },
    (e, what, [x, y]) => {
        const [, letter] = what.match(/^difference\.([rgba])$/) ?? [];
        const at = 4 * (y * e.size[0] + x) + e.channel(letter);
        const of = (frame) => frame.buffers.get("display").data[at];
        const other = e.methods[e.settings.method] === "painter" ? "peel" : "painter";
        return letter && of(e.method(other)) - of(e.ref);
    },
    (e, what, pixel) => {
        const [, letter] = what.match(/^(?:truth\.final|side\.truth)\.([rgba])$/) ?? [];
        return letter && e.at(e.render("truth", {}), "final", pixel, e.channel(letter));
    },
    (e, what, pixel) => {
        /* gl's are ref's on OSMesa: tests/cross/test_gl_ref. */
        const [, letter] = what.match(/^side\.(?:ref|gl)\.([rgba])$/) ?? [];
        return letter && e.at(e.ref, "final", pixel, e.channel(letter));
    },
    (e, what) => {
        const [, name] = what.match(/^truth\.(fragments|max_layers|ties)$/) ?? [];
        return name && e.render("truth", {})[name];
    },
    (e, what, pixel) => what === "frame.layers" ? layers(e, pixel) : undefined,
    (e, what) => {
        const [, view, name] = what.match(/^(frame|live)\.(\w+)$/) ?? [];
        return name && (view === "live" ? e.live : e.ref)[name];
    },
    (e, what) => {
        const [, name, letter] = what.match(/^scene\.(background|ambient)\.([rgb])$/) ?? [];
        return name && Math.fround(e.ref[name][e.channel(letter)]);
    },
    (e, what) => {
        const [, index, field] = what.match(/^material\.(\d+)\.(\w+)$/) ?? [];
        if (field === "mode")
            return e.ref.materials[index].mode;
        return field && Math.fround(e.ref.materials[index][field]);
    },
    (e, what) => {
        const [, index, letter] = what.match(/^material\.(\d+)\.color\.([rgb])$/) ?? [];
        return index && Math.fround(e.ref.materials[index][FIELDS[e.channel(letter)]]);
    },
    (e, what) => {
        const [yfov, near, far] = e.ref.camera;
        return { "camera.near": near, "camera.far": far < 0 ? Infinity : far,
                 "camera.yfov_degrees": yfov * 180 / Math.PI }[what];
    },
    (e, what) => what === "setting.lights"
        ? Math.max(0, Math.min(e.settings.lights || Infinity, e.ref.lights)) : undefined,
    (e, what) => what.startsWith("setting.") ? e.settings[what.slice(8)] : undefined,
    (e, what, pixel) => {
        const value = what.startsWith("history.")
            ? ofHistory(e.history(pixel), what.split(".").slice(1)) : undefined;
        return typeof value === "string" ? parseNumber(value) : value;
    },
];

module.exports = { Expected, parseNumber };
