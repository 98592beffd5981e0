/* Pages of peel explain in Debian's chromium, from disk: what the tests of pages share.
 *
 * node pages.js: installs the packages that the tests need. */
"use strict";

const fs = require("node:fs");
const path = require("node:path");
const { execFileSync } = require("node:child_process");
const { pathToFileURL } = require("node:url");

const CHROMIUM = process.env.PEEL_CHROMIUM ?? "/usr/bin/chromium";

/* playwright-core and axe-core, once. */
function install() {
    if (!fs.existsSync(path.join(__dirname, "node_modules", "playwright-core")))
        execFileSync("npm", ["ci", "--no-audit", "--no-fund"],
                     { cwd: __dirname, stdio: "inherit" });
}

async function launch() {
    const { chromium } = require("playwright-core");
    return chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
}

/* A page, once it is ready where it computes. page.problems: errors on its console, and requests
 * that leave the disk; context: of playwright's newContext. */
async function open(browser, file, hash = "", context = {}) {
    const inside = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...context });
    const page = await inside.newPage();
    page.problems = [];
    page.on("console", (message) => {
        if (["error", "warning"].includes(message.type()))
            page.problems.push(`console: ${message.text()}`);
    });
    page.on("pageerror", (error) => page.problems.push(`error: ${error.message}`));
    page.on("request", (request) => {
        if (!/^(file|data|blob):/.test(request.url()))
            page.problems.push(`request: ${request.url()}`);
    });
    await page.goto(pathToFileURL(path.resolve(file)).href + hash);
    if (await page.locator("#data").count() > 0)
        await ready(page);
    return page;
}

/* Waits until nothing is being computed any more. */
async function ready(page) {
    await page.waitForFunction(() => document.body.dataset.state === "failed" ||
        (document.body.dataset.state === "ready" && !document.body.dataset.busy &&
         !document.querySelector("#view-steps:not([hidden]) #step-pictures .later")),
        null, { timeout: 60000, polling: 20 });
    const state = await page.evaluate(() => document.body.dataset.state);
    if (state !== "ready")
        throw new Error(`the page failed: ${await page.textContent("#status")}`);
}

async function close(page) {
    await page.context().close();
    if (page.problems.length > 0)
        throw new Error(page.problems.join("\n"));
}

/* [what, value as shown, text] of every number that is visible. */
function numbers(page) {
    return page.evaluate(() => [...document.querySelectorAll("[data-what]")]
        .filter((element) => element.checkVisibility())
        .map((element) => {
            const text = element.matches("input, select") ? element.value : element.textContent;
            return [element.dataset.what, element.dataset.value ?? text, text];
        }));
}

/* ---- frames of the program ---- */

const FORMATS = {
    rgba32f: [Float32Array, 4], rgba16f: [Uint16Array, 4], rgba16: [Uint16Array, 4],
    rgba8: [Uint8Array, 4], rg16: [Uint16Array, 2], rg32f: [Float32Array, 2],
    r32f: [Float32Array, 1], d32f: [Float32Array, 1], d24: [Uint32Array, 1], d16: [Uint32Array, 1],
    r32ui: [Uint32Array, 1],
};

/* What web_frame (frame.c) writes: figures, and buffers by name. settings: {name: value}. */
function frame(program, side, scene, [width, height], settings, folder) {
    const file = path.join(folder, `${side}.frame`);
    execFileSync(program, [side, scene, width, height, file,
                           ...Object.entries(settings).map(([name, value]) => `${name}=${value}`)]);
    const bytes = fs.readFileSync(file), line = bytes.indexOf(10);
    const { buffers, ...figures } = JSON.parse(bytes.subarray(0, line).toString());
    figures.width = width;
    figures.height = height;
    figures.buffers = new Map(buffers.map(({ name, format, at, bytes: size }) => {
        const [type, channels] = FORMATS[format];
        const own = Uint8Array.from(bytes.subarray(line + 1 + at, line + 1 + at + size));
        return [name, { name, format, channels, data: new type(own.buffer) }];
    }));
    return figures;
}

module.exports = { launch, open, ready, close, numbers, frame };

if (require.main === module)
    install();
