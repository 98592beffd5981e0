/* The WebAssembly module's frames beside the program's, of every built-in scene: all buffers have
 * the same bits.
 *
 * node test_engine.js PEEL WEB_FRAME SOURCE_DIR */
"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const zlib = require("node:zlib");
const { execFileSync } = require("node:child_process");
const { frame } = require("./pages.js");

const [peel, program, source] = process.argv.slice(2).map((one) => path.resolve(one));
const { Engine } = require(path.join(source, "src/web/engine.js"));

const SIZE = [96, 54];
const SETTINGS = [
    {},
    { passes: 3, depth: 2, accum: 1, gbuffer: 1 },
    { method: 2, ggx: 1, "depth-range": 2, time: 1.5 },
];

const unpack = (text) => new Uint8Array(zlib.inflateSync(Buffer.from(text, "base64")));

/* What a page of the scene carries. */
function carried(scene, folder) {
    execFileSync(peel, ["explain", scene, "--size", SIZE.join("x"), "-o", folder]);
    const html = fs.readFileSync(path.join(folder, "index.html"), "utf8");
    return JSON.parse(html.match(/id="data">(.*?)<\/script>/s)[1]);
}

function compare(ours, theirs, where) {
    for (const name of ["peels", "geometry_passes", "max_layers", "fragments", "lost_to_ties",
                        "lost_to_pass_limit"])
        assert.equal(ours[name], theirs[name], `${where}: ${name}`);
    const names = new Set(ours.buffers.map(({ name }) => name));
    assert.deepEqual([...names].sort(), [...theirs.buffers.keys()].sort(), `${where}: buffers`);
    for (const { name, format, data } of ours.buffers) {
        const other = theirs.buffers.get(name);
        assert.equal(format, other.format, `${where}: ${name}`);
        const bytes = (array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength);
        assert.equal(Buffer.compare(bytes(data), bytes(other.data)), 0, `${where}: ${name}: bits`);
    }
}

async function main() {
    const scenes = execFileSync(peel, ["scenes"], { encoding: "utf8" }).split("\n").filter(Boolean)
        .map((line) => line.split(" ")[0]);
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "peel-engine-"));
    assert.ok(scenes.length >= 7);
    for (const scene of scenes) {
        const data = carried(scene, folder);
        for (const given of SETTINGS) {
            const engine = await Engine.open(unpack(data.wasm), unpack(data.scene));
            const settings = { ...Object.fromEntries(data.program.settings), ...given };
            for (const [name, value] of Object.entries(settings))
                engine.set(name, value);
            const ours = engine.render(...SIZE, true);
            const where = `${scene} ${JSON.stringify(given)}`;
            compare(ours, frame(program, "ref", scene, SIZE, settings, folder), where);
            console.log(`${where}: ${ours.buffers.length} buffers, the same bits`);
        }
    }
    fs.rmSync(folder, { recursive: true });
}

main().catch((error) => {
    console.error(error.message);
    process.exit(1);
});
