/* The pages for everyone: axe-core's rules in light and dark, by keyboard alone, no motion where
 * none is wanted, three widths. Pictures of what was seen are left in the folder that is given.
 *
 * node test_access.js PEEL PICTURES_FOLDER */
"use strict";

const assert = require("node:assert/strict");
const fs = require("node:fs");
const os = require("node:os");
const path = require("node:path");
const { execFileSync } = require("node:child_process");
const { launch, open, ready, close } = require("./pages.js");

const [peel, pictures] = process.argv.slice(2).map((one) => path.resolve(one));

const WIDTHS = [[360, 740], [768, 1024], [1920, 1080]];
const SCHEMES = ["dark", "light"];

/* ---- rules ---- */

async function obeysRules(page, where) {
    await page.addScriptTag({ path: require.resolve("axe-core") });
    const { violations } = await page.evaluate(() => axe.run(document, {
        runOnly: ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "best-practice"] }));
    const lines = violations.map(({ id, help, nodes }) =>
        `${id}: ${help}: ${nodes.length} of ${nodes[0].html.slice(0, 160)} ` +
        `(${nodes[0].failureSummary})`);
    assert.equal(lines.length, 0, `${where}:\n${lines.join("\n")}`);
}

/* The page does not scroll sideways. */
async function fits(page, where) {
    const [wide, width] = await page.evaluate(() =>
        [document.scrollingElement.scrollWidth, document.scrollingElement.clientWidth]);
    assert.ok(wide <= width, `${where}: ${wide} pixels wide`);
}

/* ---- by keyboard ---- */

/* Every control that is seen is reached by Tab, and is then marked. */
async function reachesAll(page, where) {
    const count = await page.evaluate(() => {
        const all = document.querySelectorAll(
            "a[href], button, input, select, summary, [tabindex='0']");
        const seen = [...all].filter((one) =>
            !one.disabled && one.tabIndex >= 0 && one.checkVisibility());
        seen.forEach((one) => { one.dataset.expected = "yes"; });
        document.body.tabIndex = -1;
        document.body.focus();
        return seen.length;
    });
    for (let i = 0; i < count + 5; i++) {
        await page.keyboard.press("Tab");
        await page.evaluate(() => {
            const one = document.activeElement, style = getComputedStyle(one);
            const plain = style.outlineStyle === "none" && style.boxShadow === "none";
            if (plain && one !== document.body)
                one.dataset.unmarked = "yes";
            delete one.dataset.expected;
        });
    }
    const left = await page.evaluate(() => ["expected", "unmarked"].map((name) =>
        [...document.querySelectorAll(`[data-${name}]`)].map((one) =>
            one.outerHTML.slice(0, 100))));
    assert.deepEqual(left, [[], []], `${where}: not reached, or not seen to be`);
}

/* A whole visit: a step, a pixel, a view, a change and back, without a mouse. */
async function visit(page) {
    const tabTo = async (selector) => {
        for (let i = 0; i < 200; i++) {
            if (await page.evaluate((wanted) => document.activeElement.matches(wanted), selector))
                return;
            await page.keyboard.press("Tab");
        }
        assert.fail(`Tab does not reach ${selector}`);
    };
    await page.keyboard.press("PageDown");
    await page.keyboard.press("ArrowRight");
    const [step, pixel] = await page.evaluate(() => [app.step, app.pixel]);
    assert.ok(step > 1);
    await page.keyboard.press("Shift+ArrowRight");
    assert.deepEqual(await page.evaluate(() => app.pixel), [pixel[0] + 1, pixel[1]]);
    await page.keyboard.press("Space");
    assert.equal(await page.textContent("#step-play"), "Pause");
    await page.keyboard.press("Space");
    await tabTo('[data-view="live"]');
    await page.keyboard.press("Enter");
    await tabTo("#set-passes");
    await page.keyboard.press("ArrowRight");
    await page.waitForFunction(() => app.settings.passes === 1);
    await page.evaluate(() => window.getSelection().removeAllRanges());
    await page.locator('[data-view="steps"]').focus();
    await page.keyboard.press("Enter");
    await ready(page);
    assert.equal(await page.evaluate(() => app.frame.peels), 1);
}

/* ---- motion ---- */

async function staysStill(browser, file) {
    for (const [reducedMotion, moves] of [["reduce", false], ["no-preference", true]]) {
        const page = await open(browser, file, "#step=peel-0-swap", { reducedMotion });
        const running = await page.evaluate(() => document.getAnimations().length);
        assert.equal(running > 0, moves, `motion ${reducedMotion}: ${running} animations`);
        await close(page);
    }
}

/* ---- all views ---- */

const VIEWS = ["#step=naive", "#step=peel-1-blend", "#step=peel-1-discard", "#step=peel-0-swap",
               "#view=live", "#view=space"];

async function look(page, name) {
    await page.waitForTimeout(200);
    await page.screenshot({ path: path.join(pictures, `${name}.jpeg`), type: "jpeg", quality: 60 });
}

/* Of the schemes, which are the style sheet's alone, both; of the widths all in the last scheme. */
async function testViews(browser, file, hashes, name) {
    for (const hash of hashes) {
        const page = await open(browser, file, hash);
        const where = `${name} ${hash}`.replace(/[#=]/g, "-");
        const see = (what) => look(page, `${where} ${what}`.replace(/[^\w]+/g, "-"));
        if (hash === hashes[0])
            await reachesAll(page, where);
        for (const colorScheme of SCHEMES) {
            await page.emulateMedia({ colorScheme });
            await obeysRules(page, `${where} ${colorScheme}`);
            await see(colorScheme);
        }
        for (const [width, height] of WIDTHS) {
            await page.setViewportSize({ width, height });
            await fits(page, `${where} at ${width}`);
            await see(width);
        }
        await close(page);
    }
    console.log(`${name}: ${hashes.length} views in light and dark, at ${WIDTHS.length} widths`);
}

async function main() {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "peel-access-"));
    const file = path.join(folder, "index.html");
    fs.mkdirSync(pictures, { recursive: true });
    execFileSync(peel, ["explain", "tutorial", "-o", folder]);
    execFileSync(peel, ["explain", "--course", "-o", path.join(folder, "course")]);
    const browser = await launch();
    try {
        await testViews(browser, file, VIEWS, "tutorial");
        await testViews(browser, path.join(folder, "course/lesson-3.html"), [""], "lesson");
        await testViews(browser, path.join(folder, "course/index.html"), [""], "course");
        const page = await open(browser, file);
        await visit(page);
        await page.click('[data-view="live"]');
        await reachesAll(page, "live");
        await close(page);
        await staysStill(browser, file);
    } finally {
        await browser.close();
    }
    fs.rmSync(folder, { recursive: true });
}

main().catch((error) => {
    console.error(error.message);
    process.exit(1);
});
