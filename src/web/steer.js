/* Turning and moving the camera on the live picture: mouse, fingers, wheel and keys. */
"use strict";

const steer = {
    mode: "orbit", /* or "fly" */
    pointers: new Map(), /* id -> [x, y] that are down */
    travelled: 0, /* pixels since the first went down: a click stays where it is */
    held: new Set(), /* keys */
    last: 0, /* time of the last frame with keys held */
};

const STEER_TURN = 0.007; /* radians a pixel */
const STEER_STEP = Math.PI / 36; /* of an arrow key */
const STEER_MOVES = { w: [0, 0, 1], s: [0, 0, -1], a: [-1, 0, 0], d: [1, 0, 0], e: [0, 1, 0],
                      q: [0, -1, 0] };

steer.now = () => edits.cameraNow(app.settings.camera);
steer.use = (one) => live.edit(edits.setCamera(app.engine, app.settings.camera, one));

/* By pixels to the right and down on the picture. */
steer.drag = (dx, dy, move) => {
    const one = steer.now(), [yaw, pitch] = [-dx * STEER_TURN, dy * STEER_TURN];
    if (move) {
        const unit = 2 * one.distance * Math.tan(one.yfov / 2) / live.canvas.clientHeight;
        steer.use(camera.move(one, -dx * unit, dy * unit, 0));
    } else
        steer.use(steer.mode === "orbit" ? camera.orbit(one, yaw, pitch)
                                         : camera.look(one, yaw, -pitch));
};

/* factor below 1: nearer. */
steer.zoom = (factor) => {
    const one = steer.now();
    steer.use(steer.mode === "orbit" ? camera.zoom(one, factor)
                                     : camera.move(one, 0, 0, one.distance * (1 - factor)));
};

/* ---- pointers ---- */

steer.down = (event) => {
    live.canvas.setPointerCapture(event.pointerId);
    if (steer.pointers.size === 0)
        steer.travelled = 0;
    steer.pointers.set(event.pointerId, [event.clientX, event.clientY]);
};

steer.spread = () => {
    const [a, b] = [...steer.pointers.values()];
    return { gap: Math.hypot(a[0] - b[0], a[1] - b[1]),
             x: (a[0] + b[0]) / 2, y: (a[1] + b[1]) / 2 };
};

steer.moved = (event) => {
    const from = steer.pointers.get(event.pointerId), to = [event.clientX, event.clientY];
    if (!from || event.buttons === 0)
        return;
    const before = steer.pointers.size === 2 ? steer.spread() : null;
    steer.pointers.set(event.pointerId, to);
    steer.travelled += Math.hypot(to[0] - from[0], to[1] - from[1]);
    if (steer.travelled < 4)
        return;
    if (before) {
        const after = steer.spread();
        steer.drag(after.x - before.x, after.y - before.y, true);
        if (before.gap > 0 && after.gap > 0)
            steer.zoom(before.gap / after.gap);
    } else if (steer.pointers.size === 1)
        steer.drag(to[0] - from[0], to[1] - from[1], event.shiftKey || event.buttons !== 1);
};

steer.up = (event) => {
    const first = steer.pointers.delete(event.pointerId) && steer.pointers.size === 0;
    if (!first || event.type === "pointercancel" || steer.travelled >= 4)
        return;
    const box = live.canvas.getBoundingClientRect(), [w, h] = app.settings.size;
    app.change({ pixel: [(event.clientX - box.left) / box.width * w,
                         (event.clientY - box.top) / box.height * h] });
};

/* Only once the picture was clicked or reached by Tab: else the page scrolls. */
steer.wheel = (event) => {
    if (document.activeElement !== live.canvas && !event.ctrlKey)
        return;
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 30 : 1;
    steer.zoom(Math.exp(Math.max(-200, Math.min(200, event.deltaY * lines)) * 0.0015));
};

/* ---- keys ---- */

steer.key = (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey)
        return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (STEER_MOVES[key])
        steer.hold(key);
    else if (arrows[key])
        steer.drag(...arrows[key].map((n) => n * STEER_STEP / STEER_TURN), event.shiftKey);
    else if (key === "+" || key === "=" || key === "-")
        steer.zoom(key === "-" ? 1.1 : 1 / 1.1);
    else if (key === "0")
        steer.use(null);
    else if (key === "f")
        steer.setMode(steer.mode === "orbit" ? "fly" : "orbit");
    else
        return;
    event.preventDefault();
    event.stopPropagation();
};

steer.hold = (key) => {
    if (steer.held.size === 0) {
        steer.last = performance.now();
        requestAnimationFrame(steer.glide);
    }
    steer.held.add(key);
};

/* Moves while keys are down: a scene's size in four seconds. */
steer.glide = (time) => {
    const seconds = Math.max(0, Math.min(0.1, (time - steer.last) / 1000));
    steer.last = time;
    if (steer.held.size === 0)
        return;
    let by = [0, 0, 0];
    for (const key of steer.held)
        by = camera.add(by, STEER_MOVES[key]);
    const one = steer.now(), far = seconds * one.size / 4;
    if (far > 0)
        steer.use(camera.move(one, ...by.map((n) => n * far)));
    requestAnimationFrame(steer.glide);
};

steer.setMode = (mode) => {
    steer.mode = mode;
    live.tell();
};

steer.bind = (canvas) => {
    canvas.addEventListener("pointerdown", steer.down);
    canvas.addEventListener("pointermove", steer.moved);
    canvas.addEventListener("pointerup", steer.up);
    canvas.addEventListener("pointercancel", steer.up);
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", steer.wheel, { passive: false });
    canvas.addEventListener("keydown", steer.key);
    canvas.addEventListener("keyup", (event) => steer.held.delete(event.key.toLowerCase()));
    canvas.addEventListener("blur", () => steer.held.clear());
};
