/* Pure functions of the live view and the layers in space: cameras, edits, sizes, projection.
 *
 * node test_live.js SOURCE_DIR */
"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const path = require("node:path");
const vm = require("node:vm");

const source = process.argv[2] ?? path.join(__dirname, "../..");

/* The page's scripts, as one that stand after each other, without a page. */
function load(...names) {
    const context = vm.createContext({ app: { on() {}, permalink() {} },
                                       draw: { display: (v) => v } });
    for (const name of names) {
        const file = path.join(source, "src/web", `${name}.js`);
        vm.runInContext(fs.readFileSync(file, "utf8"), context);
    }
    return vm.runInContext("({app, camera, edits, live, space})", context);
}

const { app, camera, edits, live, space } = load("number", "camera", "edits", "live", "space");
const plain = (value) => JSON.parse(JSON.stringify(value));

const near = (got, wanted, most = 1e-6) => {
    assert.equal(got.length, wanted.length);
    got.forEach((v, i) => assert.ok(Math.abs(v - wanted[i]) <= most, `${got}: expected ${wanted}`));
};
const length = (v) => Math.hypot(...v);
const distance = (a, b) => Math.hypot(...a.map((v, i) => v - b[i]));

/* tutorial's, one that mirrors and stretches, and one whose far plane is nowhere. */
const BOUNDS = [[-2, -1, -2], [2, 1, 2]];
const CAMERAS = [
    { world: [0.936329185962677, 0, -0.3511234521865845, 0,
              -0.12483531981706619, 0.9346644282341003, -0.3328941762447357, 0,
              0.3281826078891754, 0.35553115606307983, 0.8751536011695862, 0,
              1.5, 2, 4, 1], yfov: 0.7853981633974483, near: 0.125, far: 100 },
    { world: [-2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1], yfov: 1, near: 1, far: 10 },
    { world: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -5, 1], yfov: 0.5, near: 1, far: null },
].map((one) => ({ name: "", ...one }));

const tests = {
    "a camera that is read has its matrix"() {
        for (const one of CAMERAS)
            near(camera.world(camera.read(one, BOUNDS)), one.world);
    },
    "a camera turns about what it looks at"() {
        for (const one of CAMERAS.map((each) => camera.read(each, BOUNDS))) {
            const turned = camera.orbit(one, 0.7, 0.2);
            near(camera.target(turned), camera.target(one));
            assert.ok(distance(turned.eye, one.eye) > 0.1);
            near([distance(turned.eye, camera.target(one))], [one.distance]);
            near(camera.orbit(turned, -0.7, -0.2).eye, one.eye);
        }
    },
    "to the right is to the right"() {
        const one = camera.read(CAMERAS[1], BOUNDS);
        const turned = camera.orbit(one, Math.PI / 2, 0);
        near(turned.eye, [5, 0, 0]);
        assert.ok(camera.orbit(one, 0, 0.3).eye[1] > 0.5);
        near(camera.look(one, Math.PI / 2, 0).axes[2], [1, 0, 0]);
        assert.ok(camera.look(one, 0, 0.3).axes[2][1] < -0.1, "up: back points down");
    },
    "the view never goes over the top"() {
        let one = camera.read(CAMERAS[0], BOUNDS);
        for (let i = 0; i < 100; i++)
            one = camera.orbit(one, 0.1, 0.3);
        assert.ok(one.axes[2][1] > 0.99 && one.axes[2][1] < 1);
        assert.ok(one.axes[1][1] > 0, "up is up");
    },
    "axes stay at right angles, of their hand, after many turns"() {
        for (const each of CAMERAS) {
            const first = camera.read(each, BOUNDS);
            let one = first;
            for (let i = 0; i < 1000; i++)
                one = camera.look(one, 0.37, i % 2 ? 0.2 : -0.19);
            const [x, y, z] = one.axes;
            near([length(x), length(y), length(z)], [1, 1, 1], 1e-12);
            near([camera.dot(x, y), camera.dot(y, z), camera.dot(z, x)], [0, 0, 0], 1e-12);
            const hand = (axes) => Math.sign(camera.dot(camera.cross(axes[0], axes[1]), axes[2]));
            assert.equal(hand(one.axes), hand(first.axes));
            near(one.eye, first.eye);
        }
    },
    "nearer keeps what it looks at; moving does not"() {
        const one = camera.read(CAMERAS[0], BOUNDS), half = camera.zoom(one, 0.5);
        near(camera.target(half), camera.target(one));
        near([half.distance], [one.distance / 2]);
        near([distance(camera.move(one, 3, 0, 4).eye, one.eye)], [5]);
        assert.ok(camera.zoom(one, 1e-30).distance > 0);
    },
    "the address gives the same camera, bit for bit"() {
        for (const each of CAMERAS) {
            const one = camera.orbit(camera.read(each, BOUNDS), 0.123, 0.456);
            const again = camera.parse(camera.write(one), one.size);
            assert.deepEqual(plain(camera.world(again)), plain(camera.world(one)));
            assert.equal(camera.write(again), camera.write(one));
            assert.equal(again.far, each.far ?? Infinity);
        }
    },
    "what is no camera is refused"() {
        const good = camera.write(camera.read(CAMERAS[0], BOUNDS)).split(",");
        for (const [at, value] of [[0, "x"], [3, ""], [12, "4"], [12, "0"], [13, "0"], [14, "0.01"],
                                   [15, "-1"], [9, "Infinity"]])
            assert.equal(camera.parse(good.with(at, value).join(","), 1), null, `${at}: ${value}`);
        assert.equal(camera.parse(good.slice(1).join(","), 1), null);
        assert.equal(camera.parse(good.map((v, i) => (i < 9 ? "1" : v)).join(","), 1), null);
    },
    "a picked colour comes back, and is a float"() {
        for (let code = 0; code < 256; code++) {
            assert.equal(edits.code(edits.linear(code)), code);
            assert.equal(Math.fround(edits.linear(code)), edits.linear(code));
        }
        assert.equal(edits.hexColor([0, 1, edits.linear(188)]), "#00ffbc");
        near(edits.parseColor("#00ff80"), [0, 1, 0.2158605]);
    },
    async "edits are made, said, and taken back"() {
        const scene = makeScene(), engine = new FakeEngine();
        Object.assign(edits, { original: scene });
        await edits.setMaterial(engine, 1, 3, 1);
        await edits.setMaterial(engine, 0, 0, 0.25);
        await edits.setAmbient(engine, [0.1, 0.2, 0.3]);
        await edits.setCamera(engine, 0, camera.zoom(edits.cameraNow(0), 0.5));
        assert.equal(edits.mode(1), "opaque");
        assert.ok(edits.any());
        const text = edits.write(), made = engine.state();
        assert.match(text, /^1\.alpha:1;0\.red:0\.25;ambient:0\.1,0\.2,0\.3;camera0:/);

        const fresh = new FakeEngine();
        await edits.replay(fresh);
        assert.deepEqual(fresh.state(), made);

        await edits.become(engine, "");
        assert.equal(edits.write(), "");
        assert.equal(edits.mode(1), "blend");
        assert.deepEqual(engine.state(), {
            "1.3": 0.5, "1.7": 1, "0.0": 0.9, ambient: [0.25, 0.25, 0.25],
            camera0: [plain(scene.cameras[0].world), scene.cameras[0].yfov, 0.125, 100] });

        await edits.become(engine, text);
        assert.equal(edits.write(), text);
        assert.deepEqual(engine.state(), { ...made, "1.7": 1 });
        await edits.become(engine, "");
    },
    async "an alpha of 1 in the scene goes back to its list"() {
        const scene = makeScene(), engine = new FakeEngine();
        scene.materials[1].base_color[3] = 1;
        edits.original = scene;
        await edits.setMaterial(engine, 1, 3, 0.5);
        await edits.setMaterial(engine, 1, 3, null);
        assert.deepEqual(engine.calls.at(-1), [1, 7, 1]);
        assert.ok(!edits.any());
    },
    "what is none of the scene's edits is left out"() {
        for (const text of ["2.alpha:0.5", "0.alpha:1.5", "0.alpha:", "0.alpha:x", "0.size:1",
                            "0.alpha", "ambient:1,2", "ambient:-1,0,0", "camera1:1", "camera0:1,2",
                            "constructor:1"]) {
            const { materials, ambient, cameras } = edits.parse(text, makeScene());
            assert.equal(materials.size + cameras.size, 0, text);
            assert.equal(ambient, null, text);
        }
    },
    "pictures get smaller when three are slow, and larger again"() {
        const times = (...all) => all.map((ms) => ({ ms, scale: 0.5 }));
        assert.equal(live.nextScale(0.5, times(900, 900)), 0.5);
        assert.equal(live.nextScale(0.5, times(900, 10, 900)), 0.25);
        assert.equal(live.nextScale(0.5, times(100, 900, 100)), 0.5);
        assert.equal(live.nextScale(0.5, times(10, 10, 900)), 1);
        assert.equal(live.nextScale(1, times(10, 10, 10)), 1);
    },
    "sizes on the way double, and end as shown"() {
        assert.deepEqual(plain(live.sizes([320, 180], [320, 180], 1280)),
                         [[640, 360], [1280, 720]]);
        assert.deepEqual(plain(live.sizes([320, 180], [320, 180], 700)), [[700, 394]]);
        assert.deepEqual(plain(live.sizes([320, 180], [80, 45], 320)),
                         [[160, 90], [320, 180]]);
        assert.deepEqual(plain(live.sizes([320, 180], [320, 180], 300)), []);
        const [width, height] = live.sizes([320, 180], [320, 180], 1e6).at(-1);
        assert.deepEqual([width, height], [1920, 1080]);
    },
    "cards: projected as CSS does"() {
        near(space.project([10, 20, 0], 0, 0, 100), [10, 20]);
        near(space.project([10, 20, 50], 0, 0, 100), [20, 40]);
        near(space.project([0, 0, 10], 90, 0, 1e12), [10, 0]);
        near(space.project([10, 0, 0], 90, 0, 20), [10 * Math.cos(Math.PI / 2), 0]);
        near(space.project([0, 0, 10], 0, 90, 1e12), [0, -10]);
        near(space.project([0, 10, 0], 0, 90, 20), [0, 0]);
    },
    "cards: all within the stage, front first"() {
        assert.deepEqual(plain(space.places(1, 100, 100)), [0]);
        assert.deepEqual(plain(space.places(3, 100, 100)), [35, 0, -35]);
        const cases = [[1, 0, 0, [300, 200]], [10, -42, -12, [900, 500]], [3, 0, 0, [2000, 200]],
                       [48, 85, 30, [360, 240]], [5, 170, -90, [500, 900]]];
        for (const [count, yaw, tilt, stage] of cases) {
            const { width, height, shift } = space.fit(count, 16 / 9, 60, yaw, tilt, stage);
            for (const z of space.places(count, 60, width))
                for (const x of [-0.5, 0.5])
                    for (const y of [-0.5, 0.5]) {
                        const at = space.project([x * width, y * height, z], yaw, tilt,
                                                 3.5 * width);
                        near(at.map((v, i) => Math.max(0, Math.abs(v + shift[i]) - stage[i] / 2)),
                             [0, 0]);
                    }
        }
    },
    "layers: of methods that keep them"() {
        const frame = (peels, ...names) => ({
            peels, buffer: (name) => names.includes(name) ? {} : undefined });
        const ids = (...all) => plain(space.layers(frame(...all)).map((one) => one.id));
        assert.deepEqual(ids(2, "peel.0.source", "peel.1.source", "opaque.source"),
                         ["peel-0", "peel-1", "opaque", "background"]);
        assert.deepEqual(ids(2, "opaque.source"), []);
        assert.deepEqual(ids(0, "opaque.source"), ["opaque", "background"]);
    },
    "cards show a colour without its alpha"() {
        near(space.color([0.2, 0.1, 0, 0.5]), [0.4, 0.2, 0, 127.5]);
        assert.deepEqual(plain(space.color([0, 0, 0, 0])), [0, 0, 0, 0]);
    },
};

function makeScene() {
    const material = (red, alpha, mode) => ({ name: "", base_color: [red, 0.2, 0.1, alpha],
        roughness: 0.3, metallic: 0, occlusion: 1, mode });
    return { ambient: [0.25, 0.25, 0.25], bounds: BOUNDS, cameras: [CAMERAS[0]],
             materials: [material(0.9, 1, "opaque"), material(0.1, 0.5, "blend")] };
}

class FakeEngine {
    calls = [];
    now = {};
    async setMaterial(...call) {
        this.calls.push(call);
        this.now[`${call[0]}.${call[1]}`] = call[2];
    }
    async setAmbient(...rgb) { this.now.ambient = rgb; }
    async setCamera(index, ...values) { this.now[`camera${index}`] = values; }
    state() { return plain(this.now); }
}

(async () => {
    let failed = 0;
    for (const [name, test] of Object.entries(tests)) {
        try {
            await test();
        } catch (error) {
            failed++;
            console.error(`${name}: ${error.message}`);
        }
    }
    console.log(`${Object.keys(tests).length - failed} of ${Object.keys(tests).length} passed`);
    process.exit(failed > 0 ? 1 : 0);
})();
