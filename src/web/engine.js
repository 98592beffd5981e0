/* Peel's pipeline in a page: engine.c as WebAssembly, and what calls it.
 *
 * Engine runs where it is made: in a worker of the page, or in a test under Node. EngineClient is
 * the page's end of that worker: the same methods, each giving a promise. */
"use strict";

class Engine {
    /* wasm, scene: Uint8Array; scene as blob_write makes it. Throws an Error, Peel's message. */
    static async open(wasm, scene) {
        const engine = new Engine();
        const refuse = new Proxy({}, { get: () => () => 52 /* ENOSYS */ });
        const wasi = new Proxy(
            { clock_time_get: (id, precision, at) => engine.putTime(at) },
            { get: (known, name) => known[name] ?? refuse[name] });
        const module = await WebAssembly.instantiate(wasm, { wasi_snapshot_preview1: wasi });
        engine.exports = module.instance.exports;
        engine.exports._initialize();
        engine.withBytes(scene, (at) => engine.check(engine.exports.engine_open(at, scene.length)));
        return engine;
    }

    /* ---- what the page asks for ---- */

    scene() { return this.json(this.exports.engine_scene()); }
    settings() { return this.json(this.exports.engine_settings()); }
    set(name, value) {
        const bytes = new TextEncoder().encode(name + "\0");
        this.withBytes(bytes, (at) => this.check(this.exports.engine_set(at, value)));
    }
    setMaterial(material, field, value) {
        this.check(this.exports.engine_set_material(material, field, value));
    }
    setAmbient(red, green, blue) { this.check(this.exports.engine_set_ambient(red, green, blue)); }
    /* world: 16 numbers, column-major; far: Infinity for none. */
    setCamera(camera, world, yfov, near, far) {
        const bytes = new Uint8Array(new Float64Array(world).buffer);
        this.withBytes(bytes, (at) =>
            this.check(this.exports.engine_set_camera(camera, at, yfov, near, far)));
    }
    /* The frame of engine_frame; each buffer has `data` of its own: Float32Array, Uint32Array,
     * Uint16Array (halves are bits) or Uint8Array, all channels of a pixel together, top row
     * first. */
    render(width, height, trace) {
        this.check(this.exports.engine_render(width, height, trace));
        const frame = this.json(this.exports.engine_frame());
        for (const buffer of frame.buffers) {
            const { type, channels } = Engine.FORMATS[buffer.format];
            const count = buffer.width * buffer.height * channels;
            buffer.channels = channels;
            buffer.data = new type(this.exports.memory.buffer, buffer.at, count).slice();
            delete buffer.at;
        }
        return frame;
    }

    /* What pixel (x, y), from the top left, went through: frame/history.h's JSON as an object. */
    history(x, y) {
        const at = this.exports.engine_history(x, y);
        if (at === 0)
            throw new Error(this.string(this.exports.engine_message()));
        return this.json(at);
    }

    /* ---- memory ---- */

    check(result) {
        if (result !== 0)
            throw new Error(this.string(this.exports.engine_message()));
    }
    string(at) {
        const bytes = new Uint8Array(this.exports.memory.buffer);
        return new TextDecoder().decode(bytes.slice(at, bytes.indexOf(0, at)));
    }
    json(at) {
        if (at === 0)
            throw new Error("out of memory");
        return JSON.parse(this.string(at));
    }
    withBytes(bytes, use) {
        const at = this.exports.engine_room(bytes.length);
        if (at === 0)
            throw new Error("out of memory");
        new Uint8Array(this.exports.memory.buffer).set(bytes, at);
        try {
            use(at);
        } finally {
            this.exports.engine_free(at);
        }
    }
    putTime(at) {
        const nanoseconds = BigInt(Math.round(performance.now() * 1e6));
        new DataView(this.exports.memory.buffer).setBigUint64(at, nanoseconds, true);
        return 0;
    }
}

Engine.FORMATS = {
    rgba32f: { type: Float32Array, channels: 4 },
    rgba16f: { type: Uint16Array, channels: 4 },
    rgba16: { type: Uint16Array, channels: 4 },
    rgba8: { type: Uint8Array, channels: 4 },
    rg16: { type: Uint16Array, channels: 2 },
    rg32f: { type: Float32Array, channels: 2 },
    r32f: { type: Float32Array, channels: 1 },
    d32f: { type: Float32Array, channels: 1 },
    d24: { type: Uint32Array, channels: 1 },
    d16: { type: Uint32Array, channels: 1 },
    r32ui: { type: Uint32Array, channels: 1 },
};

/* In the worker: {id, call, values} comes, {id, value} or {id, error} goes back. */
function serveEngine() {
    let engine = null;
    self.onmessage = async ({ data: { id, call, values } }) => {
        try {
            const value = call === "open" ? void (engine = await Engine.open(...values))
                                          : engine[call](...values);
            const room = call === "render" ? value.buffers.map((buffer) => buffer.data.buffer) : [];
            self.postMessage({ id, value }, room);
        } catch (error) {
            self.postMessage({ id, error: error.message });
        }
    };
}

/* The page's end: calls are answered in their order. */
class EngineClient {
    static async open(wasm, scene) {
        const client = new EngineClient();
        const source = `${Engine}\nEngine.FORMATS = {${Object.entries(Engine.FORMATS).map(
            ([name, { type, channels }]) =>
                `${name}: {type: ${type.name}, channels: ${channels}}`)}};\n` +
            `(${serveEngine})();`;
        const url = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
        client.worker = new Worker(url);
        client.waiting = new Map();
        client.next = 0;
        client.worker.onmessage = ({ data: { id, value, error } }) => {
            const { resolve, reject } = client.waiting.get(id);
            client.waiting.delete(id);
            error === undefined ? resolve(value) : reject(new Error(error));
        };
        await client.call("open", wasm, scene);
        return client;
    }
    call(call, ...values) {
        const id = this.next++;
        this.worker.postMessage({ id, call, values });
        return new Promise((resolve, reject) => this.waiting.set(id, { resolve, reject }));
    }
    scene() { return this.call("scene"); }
    settings() { return this.call("settings"); }
    set(name, value) { return this.call("set", name, value); }
    setMaterial(...values) { return this.call("setMaterial", ...values); }
    setAmbient(...values) { return this.call("setAmbient", ...values); }
    setCamera(...values) { return this.call("setCamera", ...values); }
    render(...values) { return this.call("render", ...values); }
    history(...values) { return this.call("history", ...values); }
}

if (typeof module !== "undefined")
    module.exports = { Engine };
