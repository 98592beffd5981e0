/* The pages of peel explain in a browser: every number that they show is the program's.
 *
 * node test_pages.js PEEL WEB_FRAME [SCENE]... */
"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { execFileSync } = require("node:child_process");
const { launch, open, ready, close, numbers } = require("./pages.js");
const { Expected, parseNumber } = require("./expected.js");

const [peel, program, ...wanted] = process.argv.slice(2);

const SIZE = [96, 54];
const WAIT_MS = 20000; /* for a number that is late */

/* ---- comparing ---- */

/* Figures that are no stored numbers: of sums in another order, or written with fewer digits. */
const LOOSE = /rmse$|residual_max$|^camera\./;

function same(shown, value, what) {
    if (typeof value === "string")
        return shown === value;
    const number = shown === "none" ? 0xffffffff : parseNumber(shown);
    if (Object.is(number, value) || number === value)
        return true;
    if (LOOSE.test(what))
        return Math.abs(number - value) <= 1e-6 * Math.abs(value);
    return /^(material|scene|setting)\./.test(what) && Math.fround(number) === Math.fround(value);
}

/* The text of a number means the number: decimals that read back, or four digits of a figure. */
function reads(text, shown) {
    const number = parseNumber(shown);
    const decimal = Number(text.split(" ")[0].replace("inf", "Infinity"));
    return Number.isNaN(decimal) || Math.fround(decimal) === Math.fround(number) ||
           Math.abs(decimal - number) <= 1e-3 * Math.abs(number);
}

function wrongNumbers(shown, expected, pixel) {
    return shown.filter(([what, value, text]) =>
        !same(value, expected.value(what, pixel), what) || !reads(text, value))
        .map(([what, value, text]) => `${what}: ${value} (${text}), expected ` +
                                      `${expected.value(what, pixel)}`);
}

/* Compares all that is visible; how many numbers that were. What is computed beside may be late. */
async function compare(page, expected, pixel, where) {
    const end = Date.now() + WAIT_MS;
    for (;;) {
        const shown = await numbers(page), wrong = wrongNumbers(shown, expected, pixel);
        if (wrong.length === 0)
            return shown.length;
        if (Date.now() > end)
            assert.fail(`${where}, pixel ${pixel}: ${wrong.length} of ${shown.length} numbers ` +
                        `are not the program's:\n${wrong.slice(0, 8).join("\n")}`);
        await page.waitForTimeout(50);
    }
}

/* ---- what a reader does ---- */

const current = (page) => page.evaluate(() => [app.step, app.steps.length, app.steps[app.step].id]);

/* Through all steps by a key, from one end to the other. */
async function walk(page, expected, pixel, key) {
    const [from, to] = key === "ArrowRight" ? ["Home", "End"] : ["End", "Home"];
    await page.locator("body").press(from);
    let total = 0, count = 0, before = -1;
    for (;;) {
        await ready(page);
        const [step, length, id] = await current(page);
        if (step === before) {
            assert.equal(count, length, `${expected.scene}: ${key} stops before ${to}`);
            return total;
        }
        total += await compare(page, expected, pixel, `${expected.scene}, step ${id}`);
        assert.doesNotMatch(await page.innerText("body"), /Infinity|undefined/, id);
        before = step;
        count++;
        await page.keyboard.press(key);
    }
}

async function choosePixel(page, pixel) {
    await page.fill("#pixel-input", pixel.join(","));
    await page.locator("#pixel-input").press("Enter");
    await page.evaluate(() => document.activeElement.blur());
}

/* The pixel with most layers, one with some, and a corner. */
function pixels(expected) {
    const [width, height] = expected.size, counts = [];
    const layers = [...expected.ref.buffers.values()].filter(({ name }) =>
        /^peel\.\d+\.primitive$/.test(name));
    for (let i = 0; i < width * height; i++)
        counts.push(layers.filter(({ data }) => data[i] !== 0xffffffff).length);
    const most = Math.max(...counts), at = (i) => [i % width, Math.floor(i / width)];
    return [at(counts.indexOf(most)), at(counts.findLastIndex((count) => count > 0)), [0, 0]];
}

async function setSlider(page, id, value) {
    await page.locator(`#${id}`).evaluate((slider, to) => {
        for (let box = slider.closest("details"); box; box = box.parentElement.closest("details"))
            box.open = true;
        slider.value = to;
        slider.dispatchEvent(new Event("input", { bubbles: true }));
    }, String(value));
}

/* ---- a scene ---- */

function makePage(scene, folder) {
    const args = [scene, "--size", SIZE.join("x"), "--lights", "16"];
    execFileSync(peel, ["explain", ...args, "-o", folder]);
    return args;
}

async function stateOf(page, scene, folder, args) {
    const program_ = await page.evaluate(() => app.data.program);
    const settings = Object.fromEntries(program_.settings);
    return { peel, program, scene, folder, size: SIZE, settings, edits: {}, truth: true,
             methods: program_.methods.map(({ name }) => name),
             command: [...args, "--fma", settings.unfused ? "off" : "on"] };
}

/* The same scene as a file, with another alpha. */
function editScene(scene, index, alpha, folder) {
    const file = path.join(folder, `${scene}.gltf`);
    execFileSync(peel, ["scenes", scene, "-o", file]);
    const gltf = JSON.parse(fs.readFileSync(file, "utf8"));
    gltf.materials[index].pbrMetallicRoughness.baseColorFactor[3] = alpha;
    fs.writeFileSync(file, JSON.stringify(gltf));
    return file;
}

/* Another alpha and two passes, set in the live view; then all views show the new frame. */
async function edit(page, state, folder) {
    const index = await page.evaluate(() =>
        app.scene.materials.findIndex(({ mode }) => mode === "blend"));
    const args = [editScene(state.scene, index, 0.3125, folder), ...state.command.slice(1),
                  "--passes", "2"];
    await page.click('[data-view="live"]');
    await setSlider(page, "set-passes", 2);
    await page.locator(`#material-${index}-alpha ~ input`).evaluate((number) => {
        number.value = "0.3125";
        number.dispatchEvent(new Event("change", { bubbles: true }));
    });
    return new Expected({ ...state, settings: { ...state.settings, passes: 2 }, command: args,
                          edits: { [`material.${index}.alpha`]: 0.3125 }, truth: false });
}

/* All that is folded of a pixel's fragments: edges, surfaces, each light's terms. */
async function unfold(page, expected, pixel) {
    const clickAll = () => page.evaluate(() => {
        for (const fold of document.querySelectorAll("#pixel .fold"))
            fold.click();
    });
    await clickAll();
    const total = await compare(page, expected, pixel, `${expected.scene}: unfolded`);
    await clickAll();
    return total;
}

async function testScene(browser, scene) {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "peel-pages-"));
    const args = makePage(scene, folder);
    const page = await open(browser, path.join(folder, "index.html"));
    assert.match(await page.textContent("#self-check"), /its bits are those of the program/);
    assert.match(await page.evaluate(() =>
        String(app.steps.find(({ id }) => id === "truth").text)), /It counts/);
    const expected = new Expected(await stateOf(page, scene, folder, args));
    const [first, second, third] = pixels(expected);
    await choosePixel(page, first);
    let total = await walk(page, expected, first, "ArrowRight");
    total += await unfold(page, expected, first);
    await choosePixel(page, second);
    total += await walk(page, expected, second, "ArrowLeft");
    const edited = await edit(page, expected, folder);
    await page.waitForFunction(() => live.frame?.refined && !live.refining, null,
                               { timeout: 60000 });
    edited.setLive(await page.evaluate(() => [live.frame.width, live.frame.height]));
    total += await compare(page, edited, second, `${scene}, live`);
    await page.click('[data-view="space"]');
    await ready(page);
    total += await compare(page, edited, second, `${scene}, layers in space`);
    await page.click('[data-view="steps"]');
    await choosePixel(page, third);
    total += await walk(page, edited, third, "ArrowRight");
    await close(page);
    fs.rmSync(folder, { recursive: true });
    assert.ok(total > 500, `${scene}: only ${total} numbers`);
    return total;
}

/* All methods' steps, and the methods side by side. */
async function testMethods(browser, scene) {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "peel-pages-"));
    const args = makePage(scene, folder);
    const page = await open(browser, path.join(folder, "index.html"));
    const state = await stateOf(page, scene, folder, args);
    let total = 0, pixel = null;
    for (const method of state.methods.filter((name) => name !== "peel")) {
        await page.selectOption("#step-method", method);
        await page.waitForFunction((name) => !document.body.dataset.busy &&
            app.settings.method.choices[app.settings.method.value] === name, method);
        const expected = new Expected({ ...state, command: [...state.command, "--method", method],
            settings: { ...state.settings, method: state.methods.indexOf(method) } });
        pixel ??= pixels(new Expected(state))[0];
        await choosePixel(page, pixel);
        total += await walk(page, expected, pixel, "ArrowRight");
    }
    const settings = { ...state.settings, method: state.methods.indexOf("painter") };
    const last = new Expected({ ...state, command: [...state.command, "--method", "painter"],
                                settings });
    await page.click("#methods summary");
    await page.waitForFunction(() => !document.querySelector("#methods .later"), null,
                               { timeout: 60000 });
    total += await compare(page, last, pixel, `${scene}: methods`);
    await close(page);
    fs.rmSync(folder, { recursive: true });
    return total;
}

/* Addresses with parts that cannot be: those are left out, and the others count. */
async function testAddresses(browser) {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "peel-pages-"));
    makePage("chain", folder);
    const cases = [
        ["#step=999&pixel=-1,abc&view=zzz&passes=1e9&method=dual", /passes/, { method: "dual" }],
        ["#accum=rgba8&lights=NaN&depth=d16&view=live", /lights/,
         { accum: "rgba8", depth: "d16", view: "live" }],
        ["#constructor=2&size=0x5&edit=9.alpha:7;;camera9:1&%E0%A4%A&pixel=9999,0", /^$/,
         { pixel: `${SIZE[0] - 1},0` }],
    ];
    for (const [hash, said, wanted] of cases) {
        const page = await open(browser, path.join(folder, "index.html"), hash);
        await page.waitForFunction((name) => app.settings.method && app.view === name,
                                   wanted.view ?? "steps", { timeout: WAIT_MS });
        assert.match(await page.textContent("#status"), said, hash);
        const now = await page.evaluate(() => ({ view: app.view, pixel: String(app.pixel),
            method: app.choice("method"), accum: app.choice("accum"), depth: app.choice("depth"),
            size: String(app.settings.size) }));
        const unset = { view: "steps", method: "peel", accum: "rgba32f", depth: "d32f",
                        size: String(SIZE), pixel: now.pixel };
        assert.deepEqual(now, { ...unset, ...wanted }, hash);
        await close(page);
    }
    fs.rmSync(folder, { recursive: true });
}

/* Changes that overlap: what the later one names holds, once the earlier one's frame is there. */
async function testOverlaps(browser) {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "peel-pages-"));
    makePage("chain", folder);
    const page = await open(browser, path.join(folder, "index.html"));
    const cases = [
        [{ method: "forward", step: "light" }, { step: "peel-0-gbuffer" }],
        [{ method: "peel", step: "peel-1-light", pixel: [1, 2] }, { step: "light" }],
        [{ method: "linked-list" }, { step: "nodes" }],
        [{ lights: 2, view: "live" }, { view: "steps", pixel: [3, 4] }],
        [{ method: "peel", passes: 2 }, { method: "dual", step: "display" }],
    ];
    for (const [first, second] of cases) {
        const now = await page.evaluate(async (both) => {
            await Promise.all(both.map((one) => app.change(one)));
            return { method: app.choice("method"), step: app.steps[app.step].id, view: app.view,
                     lights: app.settings.lights, passes: app.settings.passes,
                     pixel: app.pixel };
        }, [first, second]);
        const wanted = { ...first, ...second };
        assert.deepEqual(Object.fromEntries(Object.keys(wanted).map((name) => [name, now[name]])),
                         wanted);
        assert.equal(await page.evaluate(() => document.body.dataset.busy), undefined);
    }
    const back = await page.evaluate(async () => {
        await app.follow("#step=naive");
        await Promise.all([app.change({ lights: 3 }), app.follow("#step=light")]);
        return [app.settings.lights === app.carried.lights, app.steps[app.step].id];
    });
    assert.deepEqual(back, [true, "light"], "an address, of what it does not name");
    await close(page);
    fs.rmSync(folder, { recursive: true });
}

async function main() {
    const scenes = execFileSync(peel, ["scenes"], { encoding: "utf8" }).split("\n").filter(Boolean)
        .map((line) => line.split(" ")[0]);
    const browser = await launch();
    try {
        for (const scene of wanted.length > 0 ? wanted : scenes) {
            const start = Date.now(), total = await testScene(browser, scene);
            console.log(`${scene}: ${total} numbers, all the program's (${Date.now() - start} ms)`);
        }
        await testAddresses(browser);
        await testOverlaps(browser);
        const start = Date.now(), total = await testMethods(browser, "tutorial");
        console.log(`methods: ${total} numbers, all the program's (${Date.now() - start} ms)`);
    } finally {
        await browser.close();
    }
}

main().catch((error) => {
    console.error(error.message);
    process.exit(1);
});
