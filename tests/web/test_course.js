/* The course: each lesson's question is answered as a reader would, wrongly and rightly, and what
 * the lessons lead to exists.
 *
 * node test_course.js PEEL */
"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { execFileSync } = require("node:child_process");
const { launch, open, ready, close } = require("./pages.js");

const [peel] = process.argv.slice(2);

const MOST_BYTES = 15e6;
const WAIT_MS = 30000;

/* ---- what a reader does ---- */

const link = (page, text) => page.locator("#lesson a", { hasText: text }).first().click();

/* Types into the focused control's number, or moves the focused slider or list. */
async function type(page, selector, value) {
    const control = page.locator(selector);
    await control.fill(value);
    await control.press("Enter");
    await control.blur();
}

async function choose(page, pixel) {
    await type(page, "#pixel-input", pixel);
}

/* The first pixel, for which say(pixel's index) of the page's frame. */
const find = (page, say) => page.evaluate(`(() => {
    const say = ${say}, [w, h] = app.settings.size;
    for (let i = 0; i < w * h; i++)
        if (say(i))
            return [i % w, Math.floor(i / w)].join(",");
})()`);

const LAYERS = "app.frame.buffers.filter((b) => /^peel.\\d+.primitive$/.test(b.name))" +
               ".filter((b) => b.data[i] !== 0xffffffff).length";
const PAINTER_RIGHT = "[0, 1, 2].every((k) => window.painter[4 * i + k] === " +
                      "app.frame.buffer('display').data[4 * i + k])";
const keepPainter = (page) => page.evaluate(async () => {
    window.painter = (await walk.other("painter")).display.data;
});

/* Of each lesson: [what is done, what the page says] in turn; the last is right. */
const ANSWERS = [
    [[async (page) => {}, /T is 0.75/],
     [async (page) => {
         await link(page, "move its alpha");
         await type(page, "#material-4-alpha ~ input", "0.1");
     }, /not what it lets through/],
     [(page) => type(page, "#material-4-alpha ~ input", "1"), /no longer blended/],
     [(page) => type(page, "#material-4-alpha ~ input", "0.901"), /T is 0.099/],
     [(page) => type(page, "#material-4-alpha ~ input", "0.9"), null]],
    [[async (page) => {}, /the painter is wrong here/],
     [(page) => choose(page, "0,0"), /0 layers/],
     [async (page) => {
         await keepPainter(page);
         await choose(page, await find(page, `(i) => ${LAYERS} > 1 && ${PAINTER_RIGHT}`));
     }, null]],
    [[async (page) => link(page, "Set the passes"), /automatic/],
     [(page) => slide(page, "#set-passes", 2), /never reached/],
     [(page) => slide(page, "#set-passes", 7), /fewer will do/],
     [(page) => page.selectOption("#set-method", { label: "dual" }), /choose peel/],
     [(page) => page.selectOption("#set-method", { label: "peel" }), /fewer will do/],
     [(page) => slide(page, "#set-passes", 4), null]],
    [[async (page) => {}, /0.4219/],
     [async (page) => {
         await link(page, "Set their alpha");
         await type(page, "#material-4-alpha ~ input", "0.75");
     }, /T is 0.01563/],
     [(page) => type(page, "#material-4-alpha ~ input", "0.5"), null]],
    [[async (page) => {}, /threw away 1/],
     [(page) => choose(page, ""), /No pixel/],
     [(page) => choose(page, "0,0"), /threw away \d/],
     [async (page) => {
         await link(page, "Its steps");
         await ready(page);
     }, /threw away \d/],
     [async (page) => {
         await link(page, "In the first peel");
         await ready(page);
         await choose(page, await find(page,
             "(i) => app.frame.buffer('peel.0.farther').data[i] >= 3"));
     }, null]],
    [[async (page) => link(page, "Open the depth format"), /d32f/],
     [(page) => page.selectOption("#set-depth", { label: "d16" }), /lost to ties/],
     [(page) => page.selectOption("#set-method", { label: "dual" }), null],
     [(page) => page.selectOption("#set-method", { label: "weighted-average" }), /approximation/],
     [(page) => page.selectOption("#set-method", { label: "peel-id" }), null]],
];

async function slide(page, selector, value) {
    const slider = page.locator(selector);
    await slider.focus();
    for (let i = 0; i < 40 && Number(await slider.inputValue()) !== value; i++)
        await slider.press(Number(await slider.inputValue()) < value ? "ArrowRight" : "ArrowLeft");
}

/* The page says so within a while; anything else is a failure. */
async function says(page, right, pattern, where) {
    const end = Date.now() + WAIT_MS;
    for (;;) {
        const [kind, text] = await page.locator("#lesson-verdict").evaluate((element) =>
            [element.className, element.textContent]);
        if (kind === (right ? "right" : "not-yet") && (right || pattern.test(text)))
            return;
        assert.ok(Date.now() < end,
                  `${where}: "${text}" (${kind}), expected ${right ? "right" : pattern}`);
        await page.waitForTimeout(50);
    }
}

/* Every link of a lesson's text leads to a step, a view or a control that is there. */
async function testLinks(page, where) {
    const links = await page.locator("#lesson a[href^='#']").all();
    assert.ok(links.length >= 2, where);
    for (const one of links) {
        const wanted = new URLSearchParams((await one.getAttribute("href")).slice(1));
        await one.click();
        await ready(page);
        await page.waitForFunction(([step, view, method, focus]) =>
            (!step || app.steps[app.step].id === step) && (!view || app.view === view) &&
            (!method || app.choice("method") === method) &&
            (!focus || document.activeElement.id === focus),
            ["step", "view", "method", "focus"].map((name) => wanted.get(name)),
            { timeout: WAIT_MS })
            .catch(async () => assert.fail(`${where}: "${wanted}" leads to ` + await page.evaluate(
                () => `${app.steps[app.step].id} of ${app.choice("method")}, ${app.view}, at ` +
                      `${location.hash}, "${document.activeElement.id}"`)));
    }
}

async function testLesson(browser, folder, number) {
    const where = `lesson ${number}`;
    const page = await open(browser, path.join(folder, `lesson-${number}.html`));
    for (const [act, said] of ANSWERS[number - 1]) {
        await act(page);
        await says(page, said === null, said, where);
    }
    await testLinks(page, where);
    await close(page);
    console.log(`${where}: answered`);
}

/* The live view of a lesson ends at the steps' size, by which the question is judged. */
async function testLiveSize(browser, folder) {
    const page = await open(browser, path.join(folder, "lesson-3.html"), "#view=live");
    await page.waitForFunction(() => live.frame && !live.busy && !live.refining &&
        String([live.frame.width, live.frame.height]) === String(app.settings.size),
        null, { timeout: WAIT_MS });
    const sizes = await page.evaluate(() => live.sizes(app.settings.size, app.settings.size,
                                                       live.shownWidth()));
    assert.deepEqual(sizes, [], "a larger picture would have other figures");
    await close(page);
}

/* On a narrow window the verdict is at its edge while the question is out of view, once it was
 * seen. */
async function testStrip(browser, folder) {
    const page = await open(browser, path.join(folder, "lesson-2.html"), "",
                            { viewport: { width: 400, height: 850 } });
    const strip = page.locator("#lesson-strip");
    assert.equal(await strip.isVisible(), false, "before the question was seen");
    await page.locator(".question").scrollIntoViewIfNeeded();
    await page.locator("#step-pictures canvas").first().click({ position: { x: 5, y: 5 } });
    await page.evaluate(() => document.getElementById("step-pictures").scrollIntoView());
    await says(page, false, /0 layers/, "strip");
    await strip.waitFor({ state: "visible", timeout: WAIT_MS });
    assert.match(await strip.textContent(), /0 layers/);
    assert.equal(await page.locator("[role=status]", { hasText: "Not yet" }).count(), 1);
    await strip.click();
    await strip.waitFor({ state: "hidden", timeout: WAIT_MS });
    await close(page);
}

async function testIndex(browser, folder) {
    const page = await browser.newPage();
    await page.goto(`file://${folder}/index.html`);
    const links = await page.locator("ol.lessons a").all();
    assert.equal(links.length, ANSWERS.length);
    for (const one of links)
        assert.ok(fs.existsSync(path.join(folder, await one.getAttribute("href"))));
    await links[0].click();
    await ready(page);
    await page.click("nav.lessons >> text=All lessons");
    await page.waitForSelector("ol.lessons");
    await page.close();
}

async function main() {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "peel-course-"));
    execFileSync(peel, ["explain", "--course", "-o", folder]);
    const bytes = fs.readdirSync(folder).reduce((sum, name) =>
        sum + fs.statSync(path.join(folder, name)).size, 0);
    assert.ok(bytes < MOST_BYTES, `${bytes} bytes`);
    const browser = await launch();
    try {
        await testIndex(browser, folder);
        for (let number = 1; number <= ANSWERS.length; number++)
            await testLesson(browser, folder, number);
        await testLiveSize(browser, folder);
        await testStrip(browser, folder);
    } finally {
        await browser.close();
    }
    fs.rmSync(folder, { recursive: true });
}

main().catch((error) => {
    console.error(error.message);
    process.exit(1);
});
