/* The same frame by all methods, side by side: each beside what it differs by from the truth. */
"use strict";

const methods = { panel: null, frame: null };

methods.make = () => {
    const details = app.element("details", { id: "methods" },
        app.element("summary", { textContent: "The same frame by the other methods" }),
        app.element("div", { className: "methods" }));
    app.panel("methods-panel", "Methods side by side", "steps").append(
        app.element("p", { className: "note", textContent: "Peeling is one way of many. Each " +
            "method below draws this frame, and is compared with the truth, or where the page " +
            "has none for these settings, with the method peel-id." }), details);
    details.addEventListener("toggle", methods.show);
    app.on("frame", methods.show);
    methods.panel = details;
};

/* Renders them when they are looked at, once for each frame. */
methods.show = () => {
    if (!methods.panel?.open || methods.frame === app.frame)
        return;
    methods.frame = app.frame;
    const place = methods.panel.querySelector(".methods");
    place.replaceChildren(...app.data.program.methods.map((method) => methods.card(method)));
};

methods.reference = async () => sides.truth() ?? (await walk.other("peel-id")).final.data;

methods.card = ({ name, summary, paper, exact }) => {
    const steps = app.element("button", { type: "button", textContent: "Its steps" });
    steps.addEventListener("click", () => {
        scrollTo({ top: 0 });
        app.change({ method: name, step: 0 });
    });
    steps.setAttribute("aria-label", `The steps of ${name}`);
    const text = app.element("div", {}, app.element("h3", { textContent: name }),
        app.element("p", { textContent: `${summary[0].toUpperCase()}${summary.slice(1)}.` }),
        app.element("p", { className: "note", textContent: paper }),
        app.element("p", {
            textContent: exact ? "Exact with enough passes." : "An approximation." }),
        steps);
    const pictures = Promise.all([walk.other(name), methods.reference()]);
    return app.element("div", { className: "method" }, text,
        walk.later(pictures, ([{ final, display }, data]) =>
            methods.pictures(name, text, final, display, data)));
};

methods.pictures = (name, text, final, display, data) => {
    const error = draw.error(final, data, `methods.${name}.error`);
    const number = (value, what) => app.numberElement(value, "double", `methods.${name}.${what}`);
    text.append(app.element("p", {}, "Greatest difference ", number(error.greatest, "max_abs"),
                            ", root of the mean square ", number(error.rmse, "rmse"), "."));
    return [figure.make(name, draw.bytes({ ...display, name: `methods.${name}.display` })),
            figure.make(`${name}: difference`, error)];
};

methods.make();
