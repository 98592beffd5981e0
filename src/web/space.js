/* The layers in space: each peel's lit layer as a card, front to back, the opaque surfaces and the
 * background behind them, turned as the reader likes. The chosen pixel is a ray through all cards.
 * Cards are canvases that CSS places; nothing moves by itself. */
"use strict";

const space = {
    stage: null,
    cards: [], /* {id, title, element, buffer, peel, shown} */
    hidden: new Set(), /* ids of cards that are switched off */
    yaw: -42, tilt: -12, /* degrees */
    spread: 60, /* percent of the widest */
    down: null, /* {x, y, moved, card} */
    frame: null, /* that the cards are of */
};

const SPACE_CARDS_MAX = 48;
const SPACE_EYE = 3.5; /* its distance from the middle, in widths of a card */

/* ---- geometry ---- */

/* Where CSS puts a point of the turned world, from the middle of the stage, in pixels: rotateY,
 * then rotateX, then perspective. y down, z towards the eye. */
space.project = ([x, y, z], yaw, tilt, eye) => {
    const [a, b] = [yaw, tilt].map((degrees) => degrees * Math.PI / 180);
    const turnedX = x * Math.cos(a) + z * Math.sin(a), turnedZ = z * Math.cos(a) - x * Math.sin(a);
    const turnedY = y * Math.cos(b) - turnedZ * Math.sin(b);
    const depth = y * Math.sin(b) + turnedZ * Math.cos(b), scale = eye / (eye - depth);
    return [turnedX * scale, turnedY * scale];
};

/* z of each of `count` cards, the first nearest the eye. */
space.places = (count, spread, width) => {
    const gap = count > 1 ? Math.min(0.35 * width, 1.5 * width / (count - 1)) * spread / 100 : 0;
    return Array.from({ length: count }, (none, i) => ((count - 1) / 2 - i) * gap);
};

/* ---- the layers of a frame ---- */

/* [{id, title, buffer or null, peel}]; empty where the method keeps no layers. */
space.layers = (frame) => {
    const layers = [];
    for (let peel = 0; frame.buffer(`peel.${peel}.source`); peel++)
        layers.push({ id: `peel-${peel}`, title: `peel ${peel}`, peel,
                      buffer: frame.buffer(`peel.${peel}.source`) });
    const opaque = frame.buffer("opaque.source");
    if (layers.length === 0 && frame.peels > 0)
        return [];
    if (opaque)
        layers.push({ id: "opaque", title: "opaque surfaces", peel: null, buffer: opaque });
    layers.push({ id: "background", title: "background", peel: null, buffer: null });
    return layers;
};

/* A premultiplied colour as the display shows it over nothing, its alpha beside it. */
space.color = ([r, g, b, a]) => a > 0 ? [...[r, g, b].map((v) => draw.display(v / a)), 255 * a]
                                      : [0, 0, 0, 0];

space.paint = (canvas, buffer) => {
    const { width, height, data } = buffer;
    const rgba = new Uint8ClampedArray(4 * width * height);
    for (let at = 0; at < rgba.length; at += 4)
        if (data[at + 3] > 0)
            rgba.set(space.color(data.subarray(at, at + 4)), at);
    Object.assign(canvas, { width, height });
    canvas.getContext("2d").putImageData(new ImageData(rgba, width, height), 0, 0);
};

space.makeCard = (layer) => {
    const canvas = app.element("canvas", {});
    const element = app.element("div", { className: "space-card" }, canvas,
        app.element("span", { className: "space-title", textContent: layer.title }));
    if (layer.buffer)
        space.paint(canvas, layer.buffer);
    else {
        const rgb = app.scene.background.map((v) => Math.round(draw.display(v)));
        Object.assign(canvas, { width: app.frame.width, height: app.frame.height });
        element.style.background = `rgb(${rgb})`;
    }
    return { ...layer, element };
};

/* ---- what is seen ---- */

space.build = () => {
    const section = app.panel("space-view", "Layers in space", "space");
    space.world = app.element("div", { className: "space-world" });
    space.labels = app.element("div", { className: "space-labels" });
    space.labels.setAttribute("aria-hidden", "true");
    space.scene = app.element("div", { className: "space-scene" }, space.world, space.labels);
    space.stage = app.element("div", { className: "space-stage", tabIndex: 0 }, space.scene);
    space.stage.setAttribute("role", "application");
    space.stage.setAttribute("aria-label", "The layers as cards, nearest first");
    space.stage.setAttribute("aria-describedby", "space-help");
    space.none = app.element("div", { hidden: true },
        app.element("p", {}),
        live.button("Show peel's layers", () => app.change({ method: "peel" })));
    space.table = app.element("div", { className: "table" });
    section.append(space.none, space.stage, space.buildControls(),
        app.element("p", { id: "space-help", className: "note", textContent:
            "What each peel found, lit, as opaque as its alpha says. Drag or the arrow keys " +
            "turn, + and − spread, 0 is the first view; a click on a card chooses the pixel." }),
        space.table);
    space.bind();
};

space.buildControls = () => {
    const slider = (name, label, min, max, unit) => {
        const id = `space-${name}`;
        const input = app.element("input", { type: "range", id, min, max, step: 1 });
        const number = app.element("output", { className: "number", htmlFor: input.id });
        input.addEventListener("input", () => {
            space[name] = Number(input.value);
            space.place();
        });
        space[`${name}Update`] = () => {
            input.value = space[name];
            number.textContent = `${Math.round(space[name])}${unit}`;
        };
        return app.element("div", { className: "control" }, app.element("label", {
            htmlFor: input.id, textContent: label }), input, number);
    };
    const view = (text, yaw, tilt) => live.button(text, () => space.turn(yaw, tilt));
    return app.element("div", { className: "space-controls" },
        slider("spread", "Spread", 0, 100, " %"), slider("yaw", "Turn", -180, 180, "°"),
        slider("tilt", "Tilt", -90, 90, "°"),
        app.element("div", { className: "buttons" }, view("Front", 0, 0), view("Aslant", -42, -12),
                    view("Side", -80, -4), view("From above", -8, -70)));
};

space.turn = (yaw, tilt) => {
    space.yaw = (((yaw + 180) % 360) + 360) % 360 - 180;
    space.tilt = Math.max(-90, Math.min(90, tilt));
    space.place();
};

/* Cards of the frame at hand. */
space.fill = () => {
    const layers = space.layers(app.frame), many = layers.length > SPACE_CARDS_MAX;
    const kept = many ? [...layers.slice(0, SPACE_CARDS_MAX - 2), ...layers.slice(-2)] : layers;
    const { method } = app.settings;
    space.frame = app.frame;
    space.cards = kept.map(space.makeCard);
    space.rays = [0, 1].map(() => app.element("div", { className: "space-ray" }));
    space.world.replaceChildren(...space.cards.map((card) => card.element), ...space.rays);
    space.none.hidden = layers.length > 0;
    space.none.firstChild.textContent =
        `Method ${method.choices[method.value]} keeps no picture of each layer.`;
    space.stage.hidden = space.table.hidden = layers.length === 0;
    if (many)
        app.say(`The first ${SPACE_CARDS_MAX - 2} of ${layers.length - 2} layers are shown.`);
    space.place();
    space.showTable();
};

/* How wide cards can be, at most 0.8 of the stage, and what brings their middle to its middle:
 * {width, height, shift: [x, y]}. Lengths grow with the width, perspective included. */
space.fit = (count, aspect, spread, yaw, tilt, [stageWidth, stageHeight]) => {
    const xs = [], ys = [], places = space.places(count, spread, 1);
    for (const z of [places[0], places.at(-1)])
        for (const x of [-0.5, 0.5])
            for (const y of [-0.5 / aspect, 0.5 / aspect]) {
                const [atX, atY] = space.project([x, y, z], yaw, tilt, SPACE_EYE);
                xs.push(atX);
                ys.push(atY);
            }
    const least = [Math.min(...xs), Math.min(...ys)], most = [Math.max(...xs), Math.max(...ys)];
    const width = Math.min(0.8 * stageWidth, 0.94 * stageWidth / (most[0] - least[0]),
                           0.92 * stageHeight / (most[1] - least[1]));
    return { width, height: width / aspect,
             shift: [0, 1].map((i) => -(least[i] + most[i]) / 2 * width) };
};

/* Puts cards, ray and labels where they belong. */
space.place = () => {
    if (space.cards.length === 0)
        return;
    const { yaw, tilt, spread } = space, count = space.cards.length;
    const { width, height, shift } = space.fit(count, app.frame.width / app.frame.height, spread,
        yaw, tilt, [space.stage.clientWidth, space.stage.clientHeight]);
    const places = space.places(count, spread, width);
    const moved = shift.map((v) => `${v}px`).join(", ");
    space.scene.style.perspective = `${SPACE_EYE * width}px`;
    space.scene.style.transform = `translate(${moved})`;
    space.world.style.transform = `rotateX(${tilt}deg) rotateY(${yaw}deg)`;
    space.cards.forEach((card, i) => {
        card.z = places[i];
        card.element.hidden = space.hidden.has(card.id);
        Object.assign(card.element.style, {
            width: `${width}px`, height: `${height}px`,
            transform: `translate(-50%, -50%) translateZ(${places[i]}px)` });
    });
    for (const name of ["spread", "yaw", "tilt"])
        space[`${name}Update`]();
    space.thinTitles(width, height);
    space.placeRay(width, height);
};

/* A title that would cover another is left out; the table names all. */
space.thinTitles = (width, height) => {
    let last = null;
    for (const card of space.cards.filter((one) => !space.hidden.has(one.id))) {
        const at = space.project([-width / 2, height / 2, card.z], space.yaw, space.tilt,
                                 SPACE_EYE * width);
        const covers = last && Math.abs(at[0] - last[0]) < 24 && Math.abs(at[1] - last[1]) < 20;
        card.element.lastChild.hidden = Boolean(covers);
        last = covers ? last : at;
    }
};

space.placeRay = (width, height) => {
    space.labels.replaceChildren();
    for (const ray of space.rays)
        ray.hidden = !app.pixel;
    if (!app.pixel)
        return;
    const x = ((app.pixel[0] + 0.5) / app.frame.width - 0.5) * width;
    const y = ((app.pixel[1] + 0.5) / app.frame.height - 0.5) * height;
    const [near, far] = [space.cards[0].z + 0.06 * width, space.cards.at(-1).z];
    /* A line is seen from its side alone: there are two, at right angles. */
    space.rays.forEach((ray, i) => Object.assign(ray.style, { width: `${near - far}px`, transform:
        `translate3d(${x}px, ${y}px, ${near}px) rotateY(90deg) rotateX(${90 * i}deg)` }));
    space.placeDots([x, y], SPACE_EYE * width);
};

/* A dot and, where there is room, the alpha where the ray meets each card. */
space.placeDots = ([x, y], eye) => {
    const taken = [];
    for (const card of space.cards.filter((one) => !space.hidden.has(one.id))) {
        const at = space.project([x, y, card.z], space.yaw, space.tilt, eye);
        const dot = app.element("div", { className: "space-dot" });
        const color = space.at(card);
        dot.classList.toggle("empty", color[3] === 0);
        const rgb = space.color(color).slice(0, 3).map(Math.round);
        dot.style.background = color[3] > 0 ? `rgb(${rgb})` : "none";
        const text = app.element("span", { textContent: card.buffer && color[3] > 0
            ? `α ${Number(color[3].toPrecision(3))}` : "" });
        if (taken.some(([a, b]) => Math.abs(a - at[0]) < 54 && Math.abs(b - at[1]) < 22))
            text.textContent = "";
        else if (text.textContent)
            taken.push(at);
        dot.append(text);
        dot.style.transform = `translate(${at[0]}px, ${at[1]}px)`;
        space.labels.append(dot);
    }
};

/* A card's premultiplied colour at the chosen pixel. */
space.at = ({ buffer }) => {
    if (!buffer)
        return [...app.scene.background, 1];
    const at = 4 * (app.pixel[1] * buffer.width + app.pixel[0]);
    return buffer.data.subarray(at, at + 4);
};

/* ---- the numbers ---- */

space.showTable = () => {
    const head = ["layer", "triangle", "depth", ...(app.pixel ? ["source r", "g", "b", "α",
                  "gathered r", "g", "b", "let through"] : [])];
    const rows = space.cards.map((card) => {
        const box = app.element("input", { type: "checkbox", id: `space-show-${card.id}`,
                                           checked: !space.hidden.has(card.id) });
        box.addEventListener("change", () => {
            space.hidden[box.checked ? "delete" : "add"](card.id);
            space.place();
        });
        const row = app.element("tr", {}, app.element("th", { scope: "row" }, box, " ",
            app.element("label", { htmlFor: box.id, textContent: card.title })));
        row.append(...space.numbers(card, head.length - 1));
        return row;
    });
    const caption = app.element("caption", { textContent: app.pixel
        ? `Along pixel ${app.pixel.join(",")}` : "Choose a pixel for its numbers" });
    const top = app.element("tr", {}, ...head.map((text) =>
        app.element("th", { scope: "col", textContent: text })));
    space.table.replaceChildren(app.element("table", {}, caption,
        app.element("thead", {}, top), app.element("tbody", {}, ...rows)));
};

/* The cells of a layer's row: what is stored at the pixel. */
space.numbers = (card, count) => {
    const of = card.peel === null ? card.id : `peel.${card.peel}`;
    const accum = card.peel === null ? "accum" : `${of}.accum`;
    const names = [[`${of}.primitive`, 0], [`${of}.depth`, 0],
                   ...[0, 1, 2, 3].map((k) => [`${of}.source`, k]),
                   ...[0, 1, 2, 3].map((k) => [accum, k])].slice(0, count);
    const has = app.pixel && card.buffer && space.at(card)[3] > 0;
    return names.map(([name, channel], i) => {
        const buffer = app.frame.buffer(name);
        const cell = app.element("td", {});
        if (has && buffer) {
            const at = buffer.channels * (app.pixel[1] * buffer.width + app.pixel[0]) + channel;
            cell.append(app.numberElement(buffer.data[at], buffer.format,
                buffer.channels > 1 ? `${name}.${"rgba"[channel]}` : name));
        } else if (app.pixel)
            cell.textContent = card.buffer && i === 0 ? "nothing" : "";
        return cell;
    });
};

/* ---- turning ---- */

space.bind = () => {
    const { stage } = space;
    stage.addEventListener("pointerdown", (event) => {
        const card = event.target.closest(".space-card");
        stage.setPointerCapture(event.pointerId);
        space.down = { x: event.clientX, y: event.clientY, moved: 0,
                       at: card && [event.offsetX / card.clientWidth,
                                    event.offsetY / card.clientHeight] };
    });
    stage.addEventListener("pointermove", (event) => {
        if (!space.down || event.buttons === 0)
            return;
        const [dx, dy] = [event.clientX - space.down.x, event.clientY - space.down.y];
        space.down = { ...space.down, x: event.clientX, y: event.clientY,
                       moved: space.down.moved + Math.hypot(dx, dy) };
        if (space.down.moved >= 4)
            space.turn(space.yaw + dx * 0.4, space.tilt - dy * 0.4);
    });
    stage.addEventListener("pointerup", () => {
        const { at, moved } = space.down ?? {};
        space.down = null;
        if (at && moved < 4)
            app.change({ pixel: [at[0] * app.frame.width, at[1] * app.frame.height] });
    });
    stage.addEventListener("keydown", space.key);
    new ResizeObserver(() => space.place()).observe(stage);
};

space.key = (event) => {
    const turns = { ArrowLeft: [-5, 0], ArrowRight: [5, 0], ArrowUp: [0, 5], ArrowDown: [0, -5] };
    if (event.ctrlKey || event.metaKey || event.altKey)
        return;
    if (turns[event.key])
        space.turn(space.yaw + turns[event.key][0], space.tilt + turns[event.key][1]);
    else if ("+=-".includes(event.key)) {
        space.spread = Math.max(0, Math.min(100, space.spread + (event.key === "-" ? -5 : 5)));
        space.place();
    } else if (event.key === "0")
        space.turn(-42, -12);
    else
        return;
    event.preventDefault();
    event.stopPropagation();
};

space.show = () => {
    if (app.view !== "space" || !app.frame)
        return;
    if (!space.stage)
        space.build();
    if (space.frame !== app.frame)
        space.fill();
};

app.on("view", space.show);
app.on("frame", space.show);
app.on("pixel", () => {
    if (!space.frame || app.view !== "space")
        return;
    space.place();
    space.showTable();
});
