/* The live view: the picture follows what the reader changes, small while it changes, and is drawn
 * again as large as it is shown once all is still. The first by app.engine; the second by a worker
 * of its own, which is ended when something changes, so that nothing waits for it. */
"use strict";

const live = {
    canvas: null,
    wanted: false, /* something changed since the last picture began */
    busy: false,
    scale: 1, /* of app.settings.size, while things change */
    frame: null, /* the latest picture's figures */
    refining: null, /* {engine} while a larger picture is drawn */
    idle: null, /* timer */
    times: [], /* of the last pictures: {ms, scale} */
    turning: null, /* what turns the lights */
    listeners: [],
};

const LIVE_MS = 150; /* slower than this, pictures get smaller */
const LIVE_IDLE_MS = 350;
const LIVE_PIXELS_MAX = 1920 * 1080;

/* ---- pictures that follow ---- */

/* Something changed: another picture, as soon as the one at hand is done. */
live.request = () => {
    live.wanted = true;
    live.stopRefining();
    if (!live.busy && app.view === "live")
        live.follow();
};

live.size = () => app.settings.size.map((n) => Math.max(16, Math.round(n * live.scale)));

live.follow = async () => {
    live.busy = true;
    try {
        while (live.wanted && app.view === "live") {
            live.wanted = false;
            const start = performance.now();
            const frame = await app.engine.render(...live.size(), false);
            live.show(frame, performance.now() - start, false);
        }
    } catch (error) {
        app.say(error.message);
    }
    live.busy = false;
    live.idle = setTimeout(live.refine, LIVE_IDLE_MS);
};

live.show = (frame, ms, refined) => {
    const display = frame.buffers.find((buffer) => buffer.name === "display");
    Object.assign(live.canvas, { width: frame.width, height: frame.height });
    const rgba = new Uint8ClampedArray(display.data.buffer);
    live.canvas.getContext("2d").putImageData(new ImageData(rgba, frame.width, frame.height), 0, 0);
    live.frame = { ...frame, ms, refined, buffers: null };
    if (!refined) {
        live.times.push({ ms, scale: live.scale });
        live.times.splice(0, live.times.length - 100);
        live.scale = live.nextScale(live.scale, live.times);
    }
    live.tell();
};

/* A quarter of the pixels where they take too long, and back where four times as many would do: by
 * the middle one of the last three pictures, as any may have been held up. */
live.nextScale = (scale, times) => {
    const last = times.slice(-3).filter((one) => one.scale === scale).map((one) => one.ms);
    const [, middle] = last.sort((a, b) => a - b);
    if (last.length < 3)
        return scale;
    if (middle > LIVE_MS && scale > 1 / 4)
        return scale / 2;
    return middle < LIVE_MS / 5 && scale < 1 ? scale * 2 : scale;
};

live.tell = () => {
    for (const listener of live.listeners)
        listener();
};

/* ---- the picture as large as it is shown ---- */

/* Sizes on the way there: twice as wide and high each, the last as shown. */
live.sizes = ([width, height], [from], shown) => {
    const most = Math.min(shown / width, Math.sqrt(LIVE_PIXELS_MAX / (width * height)));
    const sizes = [];
    for (let scale = 2 * from / width; scale < most / 1.4; scale *= 2)
        sizes.push(scale);
    if (most * width > from)
        sizes.push(most);
    return sizes.map((scale) => [Math.round(width * scale), Math.round(height * scale)]);
};

/* In pixels. A lesson judges by the steps' frame, so its figures must be of that size too. */
live.shownWidth = () => app.data.lesson ? app.settings.size[0]
                                        : live.canvas.clientWidth * (devicePixelRatio || 1);

live.refine = async () => {
    if (app.view !== "live" || live.wanted || live.busy || live.turning)
        return;
    const shown = live.shownWidth();
    const sizes = live.sizes(app.settings.size, live.size(), shown);
    if (sizes.length === 0)
        return;
    const mine = live.refining = {};
    live.tell();
    try {
        mine.engine = await EngineClient.open(app.data.wasm, app.data.scene);
        if (mine === live.refining)
            await live.copyTo(mine.engine);
        for (const size of sizes) {
            const start = performance.now();
            const frame = mine === live.refining ? await mine.engine.render(...size, false) : null;
            if (mine === live.refining)
                live.show(frame, performance.now() - start, true);
        }
    } catch (error) {
        app.say(error.message);
    }
    mine.engine?.worker.terminate();
    if (mine === live.refining) {
        live.refining = null;
        live.tell();
    }
};

live.copyTo = async (engine) => {
    for (const [name, value] of Object.entries(app.copySettings()))
        if (name !== "size")
            await engine.set(name, value);
    await edits.replay(engine);
};

/* A worker that is drawing cannot be told to stop: it is ended. */
live.stopRefining = () => {
    clearTimeout(live.idle);
    live.refining?.engine?.worker.terminate();
    live.refining = null;
};

/* ---- changes ---- */

/* done: of a change to the scene, made on app.engine. */
live.edit = async (done) => {
    try {
        await done;
    } catch (error) {
        app.say(error.message);
    }
    app.stale = true;
    app.writeLink();
    app.tell("edit");
    if (app.view === "live")
        live.request();
    else
        await app.refresh();
};

live.setMaterial = (index, field, value) =>
    live.edit(edits.setMaterial(app.engine, index, field, value));
live.setAmbient = (rgb) => live.edit(edits.setAmbient(app.engine, rgb));

/* All as the page carries it. */
live.reset = async () => {
    live.turn(false);
    await edits.become(app.engine, "");
    await app.change(Object.fromEntries(Object.entries(app.carried).filter(([name, value]) =>
        String(value) !== String(app.copySettings()[name]))));
    await live.edit();
};

/* The lights go on turning, in real time; a picture at a time. */
live.turn = (on) => {
    cancelAnimationFrame(live.turning);
    live.turning = null;
    if (!on) {
        live.request();
        return;
    }
    let last = performance.now();
    const step = (now) => {
        live.turning = requestAnimationFrame(step);
        if (live.busy || live.wanted || app.view !== "live")
            return;
        const period = 360 / Math.abs(app.scene.light_degrees_per_second);
        const time = (app.settings.time + (now - last) / 1000) % period;
        last = now;
        app.change({ time: Math.round(time * 1000) / 1000 });
    };
    live.turning = requestAnimationFrame(step);
};

live.useLink = async (text) => {
    edits.original ??= app.scene;
    if (text === edits.write())
        return;
    await edits.become(app.engine, text);
    app.stale = true;
    live.request();
};

app.permalink("edit", edits.write, live.useLink, true);
app.on("settings", live.request);
app.on("view", () => {
    if (app.view === "live")
        live.enter();
    else
        live.leave();
});

live.enter = () => {
    if (!live.canvas)
        live.build();
    live.request();
};

live.leave = () => {
    live.turn(false);
    live.stopRefining();
};
