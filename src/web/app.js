/* The page's state: what it carries, the engine, the frame, the step and the pixel that are shown,
 * the address that leads there again, and who wants to know of changes. */
"use strict";

const app = {
    data: null, /* {program, wasm, scene, ref, gl, truth, lesson?}; bytes as Uint8Array */
    engine: null, /* EngineClient */
    scene: null, /* engine.scene(), as it was at the last refresh */
    settings: {}, /* name -> {choices, value}; passes, lights, … are plain; size is [w, h] */
    frame: null, /* the latest traced frame; frame.buffer(name) -> buffer or undefined */
    steps: [], /* of steps.js */
    step: 0,
    pixel: null, /* [x, y], origin top left, or null */
    view: "steps", /* "steps", "live" or "space" */
    makeSteps: () => [],
    listeners: {},
    linkTimer: null,
    linkTime: 0, /* when it was written last */
    followed: 0, /* addresses so far */
    following: Promise.resolve(), /* the last of them */
    links: [], /* further parts of the address: see permalink */
    stale: false,
    refreshing: null,
    working: 0, /* changes and frames that are not there yet: body's data-busy */
    asked: {}, /* what changes name -> the last change that named it */
    setting: Promise.resolve(), /* the settings of the last change */
};

const VIEWS = ["steps", "live", "space"];

/* ---- start ---- */

app.start = async () => {
    try {
        await app.open();
        await app.check();
        await sides.open();
        app.useFrame(app.frame); /* its steps, now that the truth is there */
        app.showHead();
        await app.follow(location.hash);
        document.body.dataset.state = "ready";
        addEventListener("hashchange", (event) => app.follow(new URL(event.newURL).hash));
    } catch (error) {
        app.fail(error);
    }
};

app.open = async () => {
    if (typeof WebAssembly === "undefined" || typeof DecompressionStream === "undefined")
        throw new Error("This page needs a browser with WebAssembly and DecompressionStream " +
                        "(of 2023 or later).");
    app.data = JSON.parse(document.getElementById("data").textContent);
    app.data.wasm = await app.unpack(app.data.wasm);
    app.data.scene = await app.unpack(app.data.scene);
    app.engine = await EngineClient.open(app.data.wasm, app.data.scene);
    const { size, settings } = app.data.program;
    for (const [name, value] of settings) {
        await app.engine.set(name, value);
        app.settings[name] = value;
    }
    for (const { name, choices, value } of await app.engine.settings())
        app.settings[name] = { choices, value };
    app.settings.size = size;
    app.carried = app.copySettings();
    app.bindControls();
    await app.refresh();
};

app.showHead = () => {
    const { name, command } = app.data.program;
    document.getElementById("scene-name").textContent = name;
    document.getElementById("command").textContent = command;
};

app.unpack = async (text) => {
    const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
};

/* Whether the page's bits are the program's: of every buffer that both traced. */
app.check = async () => {
    const wrong = [];
    for (const [name, sum] of app.data.ref.checksums) {
        const buffer = app.frame.buffer(name);
        if (!buffer || app.checksum(buffer.data) !== sum)
            wrong.push(name);
    }
    const count = app.data.ref.checksums.length;
    const line = document.getElementById("self-check");
    line.classList.toggle("off", wrong.length > 0);
    line.textContent = wrong.length === 0
        ? `Computed in this page; its bits are those of the program, in all ${count} buffers.`
        : `This browser computes other bits than the program, in ${wrong.length} of ${count} ` +
          `buffers: ${wrong.slice(0, 4).join(", ")}${wrong.length > 4 ? ", …" : ""}.`;
};

/* FNV-1a, 32 bits, of an array's bytes. */
app.checksum = (data) => {
    const bytes = new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
    let sum = 0x811c9dc5;
    for (let i = 0; i < bytes.length; i++)
        sum = Math.imul(sum ^ bytes[i], 0x01000193);
    return (sum >>> 0).toString(16).padStart(8, "0");
};

app.fail = (error) => {
    document.body.dataset.state = "failed";
    app.say(error.message);
    console.error(error);
};

/* One line for the reader, and for a screen reader. */
app.say = (text) => {
    document.getElementById("status").textContent = text;
};

/* ---- listeners ---- */

/* what: "frame", "step", "pixel", "view", "scene", "settings" or "edit": of the scene. */
app.on = (what, listener) => {
    (app.listeners[what] ??= []).push(listener);
};

app.tell = (...whats) => {
    for (const what of whats)
        for (const listener of app.listeners[what] ?? [])
            listener();
};

/* ---- changes ---- */

/* step: index or id; pixel: [x, y] or null; view; anything else is a setting: an index or a name
 * of a choice, a number, size [w, h]. Resolves when the new frame, if one is needed, is there. Of
 * changes that overlap each waits for the settings and the frame of those before it, and what a
 * later one names is the later one's. */
app.change = async (wanted) => {
    const { step, pixel, view, ...settings } = wanted, told = [];
    for (const name of Object.keys(wanted))
        app.asked[name] = wanted;
    const decides = (name) => wanted[name] !== undefined && app.asked[name] === wanted;
    app.say("");
    app.work(1);
    if (Object.keys(settings).length > 0) {
        app.setting = app.setting.then(() => app.set(settings));
        told.push("settings");
    }
    await app.setting;
    if (decides("view") && VIEWS.includes(view) && view !== app.view) {
        app.view = view;
        told.push("view");
    }
    try {
        if (app.view !== "live")
            await (app.stale ? app.refresh() : app.refreshing);
    } catch (error) {
        app.say(error.message);
    }
    if (decides("step") && app.toStep(step))
        told.push("step");
    if (decides("pixel") && app.toPixel(pixel))
        told.push("pixel");
    app.work(-1);
    app.writeLink();
    app.tell(...told);
};

app.work = (by) => {
    app.working += by;
    if (app.working > 0)
        document.body.dataset.busy = "true";
    else
        delete document.body.dataset.busy;
};

/* Each by itself: one that is refused leaves the others. */
app.set = async (settings) => {
    for (const [name, wanted] of Object.entries(settings))
        try {
            await app.setOne(name, wanted);
            app.stale = true;
        } catch (error) {
            app.say(error.message);
        }
};

app.setOne = async (name, wanted) => {
    const choices = app.settings[name]?.choices;
    if (name === "size") {
        app.settings.size = wanted;
        return;
    }
    const value = choices?.includes(wanted) ? choices.indexOf(wanted) : Number(wanted);
    await app.engine.set(name, value);
    app.settings[name] = choices ? { choices, value } : value;
};

app.toStep = (wanted) => {
    const found = typeof wanted === "number" ? wanted
                                             : app.steps.findIndex((one) => one.id === wanted);
    const before = app.step;
    app.step = Math.max(0, Math.min(app.steps.length - 1, found));
    return app.step !== before;
};

app.toPixel = (wanted) => {
    const [w, h] = [app.frame.width, app.frame.height], before = String(app.pixel);
    app.pixel = wanted && [Math.max(0, Math.min(w - 1, Math.floor(wanted[0]))),
                           Math.max(0, Math.min(h - 1, Math.floor(wanted[1])))];
    return String(app.pixel) !== before;
};

/* Traces a new frame and reads the scene again: after an edit through app.engine. */
app.refresh = () => {
    app.stale = true;
    app.refreshing ??= app.renderStale().finally(() => {
        app.refreshing = null;
    });
    return app.refreshing;
};

app.renderStale = async () => {
    app.work(1);
    try {
        while (app.stale) {
            app.stale = false;
            const [scene, frame] = await Promise.all([
                app.engine.scene(), app.engine.render(...app.settings.size, true)]);
            app.scene = scene;
            app.useFrame(frame);
        }
    } finally {
        app.work(-1);
    }
    app.tell("scene", "frame", "step", "pixel");
};

/* Another frame of the scene as it is now, without its trace: resolves to its buffers by name. The
 * calls are posted together, so nothing comes between them. */
app.renderWith = async (settings) => {
    const calls = Object.entries(settings).map(([name, value]) => app.engine.set(name, value));
    const frame = app.engine.render(...app.settings.size, false);
    for (const name of Object.keys(settings)) {
        const one = app.settings[name];
        calls.push(app.engine.set(name, one.choices ? one.value : one));
    }
    await Promise.all(calls);
    return Object.fromEntries((await frame).buffers.map((buffer) => [buffer.name, buffer]));
};

app.useFrame = (frame) => {
    const buffers = new Map(frame.buffers.map((buffer) => [buffer.name, buffer]));
    const id = app.steps[app.step]?.id;
    frame.buffer = (name) => buffers.get(name);
    app.frame = frame;
    app.steps = app.makeSteps();
    const same = app.steps.findIndex((one) => one.id === id);
    app.step = same >= 0 ? same : Math.max(0, Math.min(app.step, app.steps.length - 1));
    if (app.pixel)
        app.toPixel(app.pixel);
};

/* The name of the choice of a setting that has some. */
app.choice = (name) => app.settings[name].choices[app.settings[name].value];

app.copySettings = () => Object.fromEntries(
    Object.entries(app.settings).map(([name, one]) => [name, one.choices ? one.value : one]));

/* Whether gl's and the truth's values, which are of the frame that the program rendered, can stand
 * beside this frame. apart: settings that do not matter. */
app.asCarried = (apart = []) => {
    const now = app.copySettings();
    return Object.entries(app.carried).every(([name, value]) => apart.includes(name) ||
               String(now[name]) === String(value)) &&
           app.links.every((link) => !link.edits || !link.get());
};

/* ---- the address ---- */

/* A further part: get() gives its text, "" where there is nothing to say; set(text) applies it.
 * edits: where it says something, the scene is not the carried one. */
app.permalink = (name, get, set, edits = false) => {
    app.links.push({ name, get, set, edits });
};

app.link = () => {
    const parts = [];
    const now = app.copySettings();
    if (app.steps.length > 0)
        parts.push(["step", app.steps[app.step].id]);
    parts.push(["pixel", app.pixel ? app.pixel.join(",") : "none"]);
    if (app.view !== "steps")
        parts.push(["view", app.view]);
    for (const [name, value] of Object.entries(now)) {
        if (String(value) === String(app.carried[name]))
            continue;
        const choices = app.settings[name].choices;
        parts.push([name, choices ? choices[value] : name === "size" ? value.join("x") : value]);
    }
    for (const { name, get } of app.links)
        if (get())
            parts.push([name, get()]);
    return "#" + parts.map(([name, value]) =>
        `${name}=${encodeURIComponent(value).replace(/%2C/g, ",")}`).join("&");
};

/* At most five times a second: browsers refuse more. */
app.writeLink = () => {
    app.linkTimer ??= setTimeout(() => {
        app.linkTimer = null;
        app.linkTime = performance.now();
        history.replaceState(null, "", app.link());
    }, app.linkTime + 200 - performance.now());
};

/* Goes where an address says: not where location says, which writeLink may have replaced since. One
 * after the other, because each looks at what is set; of those that wait the last one counts. */
app.follow = (hash) => {
    const turn = ++app.followed;
    clearTimeout(app.linkTimer);
    app.linkTimer = null;
    app.following = app.following.catch(() => {}).then(() =>
        turn === app.followed ? app.go(hash) : undefined);
    return app.following;
};

/* What the address does not name is as carried. */
app.go = async (hash) => {
    await app.setting;
    const parts = new URLSearchParams(hash.slice(1));
    const wanted = { view: "steps", step: 0, pixel: app.deepestPixel() };
    const now = app.copySettings();
    for (const [name, value] of Object.entries(app.carried))
        if (String(now[name]) !== String(value) && !parts.has(name))
            wanted[name] = value;
    for (const [name, text] of parts)
        app.followPart(name, text, wanted);
    for (const link of app.links)
        await link.set(parts.get(link.name) ?? "");
    await app.change(wanted);
};

/* Where most layers are, of those the nearest to the middle: worth looking at first. */
app.deepestPixel = () => {
    const { width, height, buffers } = app.frame;
    const layers = new Uint16Array(width * height);
    for (const { name, data } of buffers)
        if (/^peel\.\d+\.primitive$/.test(name))
            data.forEach((id, i) => layers[i] += id !== 0xffffffff);
    let best = null, least = Infinity;
    const most = layers.reduce((a, b) => Math.max(a, b), 0);
    layers.forEach((count, i) => {
        const [x, y] = [i % width, Math.floor(i / width)];
        const away = (x - width / 2) ** 2 + (y - height / 2) ** 2;
        if (count === most && away < least)
            [best, least] = [[x, y], away];
    });
    return best;
};

app.followPart = (name, text, wanted) => {
    const numbers = text.split(/[,x]/).map(Number);
    const two = numbers.length === 2 && numbers.every((n) => Number.isInteger(n) && n >= 0);
    if (name === "pixel" && two)
        wanted.pixel = numbers;
    else if (name === "pixel" && text === "none")
        wanted.pixel = null;
    else if (name === "size" && two && Math.min(...numbers) >= 1 && Math.max(...numbers) <= 2048)
        wanted.size = numbers;
    else if (name === "step")
        wanted.step = /^\d+$/.test(text) ? Number(text) : text;
    else if (name === "view")
        wanted.view = text;
    else if (name !== "pixel" && name !== "size" && Object.hasOwn(app.settings, name))
        wanted[name] = app.settings[name].choices ? text : Number(text);
};

/* ---- controls that every view has ---- */

app.bindControls = () => {
    for (const button of document.querySelectorAll("[data-view]"))
        button.addEventListener("click", () => app.change({ view: button.dataset.view }));
    const place = document.getElementById("pixel-input");
    place.addEventListener("change", () => {
        const numbers = place.value.split(/[\s,]+/).filter(Boolean).map(Number);
        const good = numbers.length === 2 && numbers.every((n) => Number.isInteger(n) && n >= 0);
        if (good || place.value.trim() === "")
            app.change({ pixel: good ? numbers : null });
        else
            app.say("Pixel: expected two whole numbers, x,y, from the top left.");
    });
    app.on("view", app.showView);
    app.on("pixel", () => {
        place.value = app.pixel ? app.pixel.join(",") : "";
    });
    app.showView();
};

app.showView = () => {
    document.body.dataset.view = app.view;
    for (const button of document.querySelectorAll("[data-view]"))
        if (button.tagName === "BUTTON")
            button.setAttribute("aria-pressed", String(button.dataset.view === app.view));
    for (const name of VIEWS)
        document.getElementById(`view-${name}`).hidden = name !== app.view;
};

/* A section to fill, below the view's own parts; without a view it is seen in all of them. */
app.panel = (id, title, view) => {
    const section = app.element("section", { id, className: "panel" });
    const heading = app.element("h2", { id: `${id}-title`, textContent: title });
    section.setAttribute("aria-labelledby", heading.id);
    section.append(heading);
    document.getElementById(view ? `panels-${view}` : "panels").append(section);
    return section;
};

app.element = (tag, properties, ...children) => {
    const element = Object.assign(document.createElement(tag), properties);
    element.append(...children);
    return element;
};
