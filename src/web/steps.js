/* The steps view: moving through the steps, and what a step shows. walk.js lists the steps. */
"use strict";

const steps = { timer: null, SECONDS: 2.2, at: (id) => document.getElementById(`step-${id}`) };

/* ---- moving ---- */

steps.go = (step) => {
    app.change({ step: Math.max(0, Math.min(app.steps.length - 1, step)) });
};

steps.play = (on) => {
    clearInterval(steps.timer);
    steps.timer = on ? setInterval(() => {
        if (app.step >= app.steps.length - 1 || app.view !== "steps")
            steps.play(false);
        else
            steps.go(app.step + 1);
    }, 1000 * steps.SECONDS) : null;
    steps.at("play").textContent = on ? "Pause" : "Play";
    steps.at("play").setAttribute("aria-pressed", String(on));
    if (on && app.step >= app.steps.length - 1)
        steps.go(0);
};

/* Shift and an arrow key moves the pixel instead. */
steps.KEYS = {
    ArrowRight: () => steps.go(app.step + 1),
    ArrowLeft: () => steps.go(app.step - 1),
    Home: () => steps.go(0),
    End: () => steps.go(app.steps.length - 1),
    PageDown: () => steps.go(steps.nextPeel(1)),
    PageUp: () => steps.go(steps.nextPeel(-1)),
    " ": () => steps.play(steps.timer === null),
};
steps.MOVES = { ArrowRight: [1, 0], ArrowLeft: [-1, 0], ArrowDown: [0, 1], ArrowUp: [0, -1] };

/* The same step of the next or the previous peel; else where the peels end. */
steps.nextPeel = (direction) => {
    const { peel, part } = app.steps[app.step];
    const same = app.steps.findIndex((one) => one.part === part && one.peel === peel + direction);
    if (peel !== null && same >= 0)
        return same;
    for (let i = app.step + direction; app.steps[i]; i += direction)
        if (app.steps[i].peel !== peel)
            return i;
    return direction > 0 ? app.steps.length - 1 : 0;
};

steps.onKey = (event) => {
    const typing = event.target.closest?.("input, select, textarea, [contenteditable]");
    const pressing = event.key === " " && event.target.closest?.("button, summary, a");
    const modified = event.ctrlKey || event.metaKey || event.altKey;
    if (app.view !== "steps" || typing || pressing || modified)
        return;
    const move = event.shiftKey && app.pixel && steps.MOVES[event.key];
    if (move)
        app.change({ pixel: app.pixel.map((n, i) => Math.max(0, n + move[i])) });
    else if (!event.shiftKey && steps.KEYS[event.key])
        steps.KEYS[event.key]();
    else
        return;
    event.preventDefault();
};

steps.bind = () => {
    document.addEventListener("keydown", steps.onKey);
    steps.at("first").addEventListener("click", steps.KEYS.Home);
    steps.at("back").addEventListener("click", steps.KEYS.ArrowLeft);
    steps.at("next").addEventListener("click", steps.KEYS.ArrowRight);
    steps.at("last").addEventListener("click", steps.KEYS.End);
    steps.at("play").addEventListener("click", steps.KEYS[" "]);
    steps.at("slider").addEventListener("input", () => steps.go(Number(steps.at("slider").value)));
    steps.at("method").addEventListener("change", () =>
        app.change({ method: steps.at("method").value }));
};

/* ---- showing ---- */

steps.show = () => {
    const step = app.steps[app.step];
    steps.at("slider").max = app.steps.length - 1;
    steps.at("slider").value = app.step;
    steps.at("slider").setAttribute("aria-valuetext", `${app.step + 1}: ${step.title}`);
    steps.at("count").textContent = `${app.step + 1} of ${app.steps.length}`;
    steps.at("kicker").textContent = step.group;
    steps.at("title").textContent = step.title;
    steps.at("text").replaceChildren(...[step.text].flat());
    steps.at("source").textContent = step.source ? `Source: ${step.source}` : "";
    steps.showCode(step);
    steps.showPictures(step);
    steps.showEquation();
    steps.at("sides").replaceChildren(...sides.line(step));
};

steps.showPictures = (step) => {
    const made = [...step.pictures(), ...sides.pictures(step)].map((one) =>
        one instanceof Node ? one : figure.make(one.title, one.picture));
    const count = step.kind === "naive" ? 3 : Math.min(made.length, 4);
    steps.at("pictures").closest(".step").classList.toggle(
        "broad", step.kind === "naive" || step.kind === "truth");
    steps.at("pictures").className = `pictures count-${count}`;
    steps.at("pictures").replaceChildren(...made);
    figure.update();
};

steps.showCode = ({ code, lines }) => {
    steps.at("code").parentElement.hidden = lines.length === 0;
    steps.at("code").replaceChildren(...lines.map((text, i) => {
        const line = app.element("li", {}, app.element("code", { textContent: text }));
        if (code.includes(i + 1))
            line.setAttribute("aria-current", "step");
        return line;
    }));
};

steps.showEquation = () => {
    const place = steps.at("equation"), step = app.steps[app.step];
    const heading = app.element("h3", {
        textContent: app.pixel ? `At pixel ${app.pixel}` : "Equation" });
    const body = app.pixel ? step.equation(app.pixel) : null;
    place.replaceChildren(heading, body ?? app.element("p", {
        className: "note", textContent: app.pixel ? "Nothing is computed for a pixel in this step."
            : "Click a picture, or type x,y above, to see a pixel's numbers." }));
};

steps.showMethods = () => {
    steps.at("method").replaceChildren(...app.settings.method.choices.map((name) =>
        app.element("option", { value: name, textContent: name })));
    steps.at("method").value = app.choice("method");
};

app.on("step", steps.show);
app.on("pixel", () => {
    steps.showEquation();
    if (document.querySelector("#step-pictures .plain"))
        steps.showPictures(app.steps[app.step]);
});
app.on("frame", steps.showMethods);
app.on("view", () => steps.play(false));
steps.bind();
