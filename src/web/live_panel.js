/* What the live view shows: the picture, its figures, and a control for everything. */
"use strict";

/* Of engine_settings' choices: what they are called here, and what they do. */
const LIVE_SETTINGS = {
    "depth": ["Depth format", "How depths are stored: fewer bits, more ties"],
    "accum": ["Accumulation format", "How colour and transmittance are stored between peels"],
    "gbuffer": ["G-buffer formats", "full keeps every bit; seed: the original program's"],
    "position": ["Position from", "A buffer of its own, or computed from the depth"],
    "depth-func": ["Depth test", "Which of two fragments at equal depth stays: first or last"],
    "depth-range": ["Depth range", "reversed: 1 is near, which floats resolve better far away"],
    "peel-test": ["Previous depth test", "Compare depths as stored, or as computed"],
    "cull": ["Face culling", "Whether faces that look away are drawn"],
    "normals": ["Normals of back faces", "faced: turned towards the eye"],
    "shading": ["Shading", "ggx: the original's point lights; phong: one light, plain"],
    "ggx": ["Highlight formula", "stable: without cancellation"],
    "back-light": ["Back light", "Transparent surfaces reflect lights behind them"],
    "sort": ["Painter sorts", "By whole objects or single triangles; of painter"],
    "weight": ["Weight equation", "Of the paper by McGuire and Bavoil; of weighted-blended"],
    "post": ["Afterwards", "edges: outlines; of linked-list"],
    "model": ["Computed", "all: also what changes no bit"],
};
const LIVE_NUMBERS = {
    "opaque-blend": ["Opaque blend", "seed: the original's; only the alpha differs",
                     ["under", "seed"]],
    "draw-order": ["Order of drawing", "Peeling gives the same image, ties apart",
                   ["scene", "reverse", "shuffle"]],
    "unfused": ["a·b + c", "Whether the driver's processor rounds once or twice",
                ["rounded once", "rounded twice"]],
};

live.build = () => {
    live.buildPicture(app.panel("live-view", "Live", "live"));
    const place = app.element("div", { className: "live-controls" });
    document.getElementById("panels-live").append(place);
    const part = (id, title) => {
        const section = app.panel(id, title, "live");
        place.append(section);
        return section;
    };
    live.buildFrame(part("live-frame", "The frame"));
    live.buildCamera(part("live-camera", "Camera"));
    live.buildMaterials(part("live-materials", "Materials"));
    live.buildMore(part("live-more", "More"));
    live.listeners.push(controls.update, live.showFigures);
    app.on("settings", controls.update);
    app.on("pixel", live.showPixel);
    live.showPixel();
    controls.update();
};

live.button = (text, use) => {
    const button = app.element("button", { type: "button", textContent: text });
    button.addEventListener("click", use);
    return button;
};

/* ---- the picture ---- */

live.buildPicture = (section) => {
    const help = app.element("p", { id: "live-help", className: "note", textContent:
        "Drag turns, with Shift it moves; two fingers move and pinch. Click the picture: it " +
        "takes a pixel, and the wheel and keys go to it: arrows turn, + and − or the wheel go " +
        "nearer and back, W A S D Q E move, F changes between orbit and fly, 0 is the scene's " +
        "own camera." });
    live.canvas = app.element("canvas", { id: "live-canvas", tabIndex: 0, width: 1, height: 1 });
    live.canvas.style.aspectRatio = app.settings.size.join(" / ");
    live.canvas.setAttribute("role", "application");
    live.canvas.setAttribute("aria-label", "The picture as it is now");
    live.canvas.setAttribute("aria-describedby", help.id);
    live.mark = app.element("div", { className: "live-mark", hidden: true });
    live.figures = app.element("dl", { className: "settings live-figures" });
    live.state = app.element("p", { className: "note", id: "live-state" });
    section.append(app.element("div", { className: "live-picture" }, live.canvas, live.mark),
        live.state, live.figures, app.element("div", { className: "buttons" },
            live.button("Show this in the steps view", () => app.change({ view: "steps" })),
            live.button("Reset everything", live.reset)), help);
    steer.bind(live.canvas);
};

live.showPixel = () => {
    live.mark.hidden = !app.pixel;
    if (app.pixel)
        ["left", "top"].forEach((side, i) => {
            live.mark.style[side] = `${100 * (app.pixel[i] + 0.5) / app.settings.size[i]}%`;
        });
};

live.showFigures = () => {
    const frame = live.frame;
    if (!frame)
        return;
    const last = live.times.slice(-20).map((one) => one.ms).sort((a, b) => a - b);
    const ms = last[Math.floor(last.length / 2)];
    const entry = (label, value, format, name) => app.element("div", {},
        app.element("dt", { textContent: label }),
        app.element("dd", {}, app.numberElement(value, format, `live.${name}`)));
    live.state.replaceChildren(
        app.numberElement(frame.width, "count", "live.width"), " × ",
        app.numberElement(frame.height, "count", "live.height"),
        ` pixels in ${Math.round(frame.ms)} ms`,
        live.refining ? "; a larger one is being drawn." : ".",
        ` Pictures a second while things change: ${Math.round(1000 / ms)}.`);
    live.figures.replaceChildren(
        entry("Peels", frame.peels, "count", "peels"),
        entry("Geometry passes", frame.geometry_passes, "count", "geometry_passes"),
        entry("Most layers in a pixel", frame.max_layers, "count", "max_layers"),
        entry("Transparent fragments", frame.fragments, "count", "fragments"),
        entry("Lost to ties", frame.lost_to_ties, "count", "lost_to_ties"),
        entry("Lost to the pass limit", frame.lost_to_pass_limit, "count", "lost_to_pass_limit"),
        entry("Residual transmittance", frame.residual_max, "r32f", "residual_max"));
};

/* ---- the frame ---- */

/* The slider goes from no light to all of them; the setting has 0 for all and −1 for none. */
live.lightCount = (setting) => {
    const all = app.scene.lights;
    return setting < 0 ? 0 : setting === 0 || setting > all ? all : setting;
};

live.lightSetting = (count) => (count === 0 ? -1 : count === app.scene.lights ? 0 : count);

live.buildFrame = (section) => {
    const speed = Math.abs(app.scene.light_degrees_per_second);
    section.append(
        controls.choice("method", "Method"),
        controls.plain("passes", {
            label: "Passes", min: 0, max: () => Math.max(16, live.frame?.max_layers ?? 0), step: 1,
            hint: "At most so many peels; 0: until one finds nothing",
            show: (n) => (n > 0 ? String(n) : `auto (${live.frame?.peels ?? "…"})`) }),
        controls.plain("lights", {
            label: "Lights shown", min: 0, max: app.scene.lights, step: 1,
            get: () => live.lightCount(app.settings.lights),
            own: () => live.lightCount(app.carried.lights),
            set: (n) => app.change({ lights: n === null ? app.carried.lights
                                                        : live.lightSetting(n) }),
            show: (n) => `${n} of ${app.scene.lights}` }));
    if (speed > 0)
        section.append(controls.plain("time", {
            label: "Lights turned", min: 0, max: () => Math.max(360 / speed, app.settings.time),
            step: 0.01, hint: "About the scene's upright axis",
            show: (seconds) => `${Math.round(seconds * speed) % 360}°` }), live.turnButton());
    section.append(controls.color({
        id: "set-ambient", label: "Ambient light", what: "scene.ambient", get: edits.ambientNow,
        own: () => edits.original.ambient, set: live.setAmbient,
        hint: "Reaches every surface alike" }));
};

live.turnButton = () => {
    const button = live.button("Turn the lights", () => {
        live.turn(!live.turning);
        controls.update();
    });
    controls.all.push(() => {
        button.setAttribute("aria-pressed", String(live.turning !== null));
    });
    return app.element("div", { className: "buttons" }, button);
};

/* ---- the camera ---- */

live.buildCamera = (section) => {
    const put = (values) => steer.use({ ...steer.now(), ...values });
    const own = () => edits.original.cameras[app.settings.camera];
    const modes = app.element("div", { className: "buttons", role: "group" },
        ...["orbit", "fly"].map((mode) => {
            const text = mode === "orbit" ? "Orbit" : "Fly";
            const button = live.button(text, () => steer.setMode(mode));
            controls.all.push(() => {
                button.setAttribute("aria-pressed", String(steer.mode === mode));
            });
            return button;
        }), live.button("Reset the camera", () => steer.use(null)));
    modes.setAttribute("aria-label", "What dragging does");
    const plane = (name, label, min, max) => controls.number({
        id: `camera-${name}`, label, what: `camera.${name}`, min: 1e-6, max: 1e9, step: "any",
        get: () => steer.now()[name], own: () => own()[name] ?? Infinity,
        set: (value) => {
            const wanted = value ?? own()[name] ?? Infinity;
            if (wanted > min() && wanted < max())
                put({ [name]: wanted });
        } });
    section.append(modes,
        controls.choice("camera", "Camera", "", app.scene.cameras.map((one, i) =>
            one.name || `camera ${i}`)),
        controls.slider({
            id: "camera-yfov", label: "Field of view", what: "camera.yfov_degrees",
            min: 1, max: 170, step: 0.5, get: () => camera.round(steer.now().yfov * 180 / Math.PI),
            own: () => camera.round(own().yfov * 180 / Math.PI),
            set: (degrees) =>
                put({ yfov: degrees === null ? own().yfov : degrees * Math.PI / 180 }),
            hint: "From bottom to top, in degrees" }),
        plane("near", "Near plane", () => 0, () => steer.now().far),
        plane("far", "Far plane", () => steer.now().near, () => Infinity));
};

/* ---- materials ---- */

live.buildMaterials = (section) => {
    section.append(app.element("p", { className: "note", textContent:
        "At alpha 1 a material moves to the opaque list: it is drawn first, and not peeled." }));
    const many = edits.original.materials.length > 3;
    edits.original.materials.forEach((material, index) => {
        const name = material.name || `material ${index}`;
        const swatch = app.element("span", { className: "swatch" });
        const list = app.element("span", { className: "list" });
        const box = app.element("details", { className: "material", open: !many },
            app.element("summary", {}, swatch, name, list), live.colorOf(index, name));
        box.id = `material-${index}`;
        for (let field = 3; field < 7; field++)
            box.append(live.fieldOf(index, field, name));
        if (material.textured)
            box.append(app.element("p", { className: "note", textContent:
                "Its textures are multiplied with these." }));
        controls.all.push(() => {
            const rgb = [0, 1, 2].map((k) => edits.value(index, k));
            swatch.style.background = edits.hexColor(rgb);
            list.textContent = { opaque: "opaque", mask: "opaque, masked",
                                 blend: "transparent" }[edits.mode(index)];
            list.dataset.what = `material.${index}.mode`;
            list.dataset.value = edits.mode(index);
        });
        section.append(box);
    });
};

live.colorOf = (index, name) => controls.color({
    id: `material-${index}-color`, label: "Colour", of: name, what: `material.${index}.color`,
    hint: "Picked as sRGB, stored as the linear numbers beside it",
    get: () => [0, 1, 2].map((k) => edits.value(index, k)),
    own: () => edits.original.materials[index].base_color.slice(0, 3),
    set: (rgb) => live.edit(Promise.all([0, 1, 2].map((k) =>
        edits.setMaterial(app.engine, index, k, rgb ? rgb[k] : null)))) });

live.fieldOf = (index, field, name) => {
    const what = edits.FIELDS[field];
    return controls.slider({
        id: `material-${index}-${what}`, label: what[0].toUpperCase() + what.slice(1), of: name,
        what: `material.${index}.${what}`, min: 0, max: 1, step: 0.01,
        get: () => edits.value(index, field),
        own: () => edits.field(edits.original.materials[index], field),
        set: (value) => live.setMaterial(index, field, value) });
};

/* ---- more ---- */

live.buildMore = (section) => {
    const rows = Object.entries(LIVE_SETTINGS).filter(([name]) => app.settings[name]).map(
        ([name, [label, hint]]) => controls.choice(name, label, hint));
    for (const [name, [label, hint, names]] of Object.entries(LIVE_NUMBERS))
        rows.push(controls.choice(name, label, hint, names));
    rows.push(
        controls.plain("bias", { label: "Bias", min: 0, max: 0.01, step: 0.0001,
                                 hint: "A peel takes what is farther than this behind the last" }),
        controls.plain("nodes-per-pixel", { label: "Nodes per pixel", min: 0, max: 64, step: 1,
                                            hint: "Room for lists, on average; 0: enough" }));
    section.append(app.element("details", { id: "live-settings" },
        app.element("summary", { textContent: "Formats, tests and all other settings" }), ...rows));
};
