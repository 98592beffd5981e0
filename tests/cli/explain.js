/* A page of `peel explain`, without a browser: its pipeline, run here, gives the bits that the page
 * says the program's have, and the truth is as far from them as it says.
 * Usage: node explain.js SOURCE_DIR PAGE: prints one line, exits 1 where something is wrong. */
"use strict";

const fs = require("fs");
const zlib = require("zlib");
const [source, path] = process.argv.slice(2);
const { Engine } = require(`${source}/src/web/engine.js`);

const page = fs.readFileSync(path, "utf8");
const data = JSON.parse(page.match(/<script type="application\/json" id="data">([^<]*)</)[1]);
const unpack = (text) => new Uint8Array(zlib.inflateSync(Buffer.from(text, "base64")));

function fail(text) {
    console.log(`${path}: ${text}`);
    process.exit(1);
}

function checksum(array) {
    let sum = 0x811c9dc5;
    for (const byte of new Uint8Array(array.buffer, array.byteOffset, array.byteLength))
        sum = Math.imul(sum ^ byte, 0x01000193);
    return (sum >>> 0).toString(16).padStart(8, "0");
}

async function render() {
    const engine = await Engine.open(unpack(data.wasm), unpack(data.scene));
    for (const [name, value] of data.program.settings)
        engine.set(name, value);
    const frame = engine.render(...data.program.size, true);
    return new Map(frame.buffers.map((buffer) => [buffer.name, buffer.data]));
}

function checkTruth(final) {
    const planes = unpack(data.truth.final), count = final.length;
    const bits = new Uint32Array(final.slice().buffer);
    let greatest = 0, squares = 0;
    for (let k = 0; k < 4; k++)
        for (let i = 0; i < count; i++)
            bits[i] ^= planes[k * count + i] << 8 * k;
    new Float32Array(bits.buffer).forEach((value, i) => {
        greatest = Math.max(greatest, Math.abs(value - final[i]));
        squares += (value - final[i]) ** 2;
    });
    const rmse = Math.sqrt(squares / count);
    if (Math.abs(greatest - data.truth.max_abs) > 1e-8 * greatest ||
        Math.abs(rmse - data.truth.rmse) > 1e-6 * rmse)
        fail(`truth: ${greatest} and ${rmse}, expected ${data.truth.max_abs}, ${data.truth.rmse}`);
}

(async () => {
    const buffers = await render();
    const sums = data.ref.checksums;
    const wrong = sums.filter(([name, sum]) => checksum(buffers.get(name)) !== sum);
    if (sums.length < 2 || wrong.length > 0)
        fail(`${wrong.length} of ${sums.length} buffers differ: ${wrong.map(([name]) => name)}`);
    if (data.truth.missing === undefined)
        checkTruth(buffers.get("final"));
    const gl = data.gl.missing ?? data.gl.buffers.filter(({ differing }) => differing > 0).length;
    console.log(`buffers ${sums.length}, gl ${gl}, truth ${data.truth.missing ?? data.truth.max_abs}`);
})();
