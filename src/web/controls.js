/* One way to make a control: a label, what is moved, the number itself, and a button that takes the
 * change back. controls.update() shows all as things stand. */
"use strict";

const controls = { all: [] };

/* parts: elements between the label and the button. desc: {id, label, of: of what, changed() ->
 * whether the button is seen, reset(), update()}. */
controls.row = ({ id, label, of = "", hint = "", changed, reset, update }, ...parts) => {
    const text = app.element("label", { textContent: label, htmlFor: id, title: hint });
    const title = `Reset ${label.toLowerCase()}${of && ` of ${of}`}`;
    const back = app.element("button", { type: "button", className: "reset", textContent: "↺",
                                         title });
    back.setAttribute("aria-label", title);
    back.addEventListener("click", () => {
        reset();
        document.getElementById(id).focus(); /* the button goes away */
    });
    const row = app.element("div", { className: "control" }, text, ...parts, back);
    controls.all.push(() => {
        back.hidden = !changed();
        update();
    });
    return row;
};

controls.update = () => {
    for (const one of controls.all)
        one();
};

/* A number with a slider. desc also: {min, max, step, get() -> number, own() -> as carried,
 * set(number), what}; max may be a function; show(number) -> words instead of the number. */
controls.slider = (desc) => {
    const { id, label, of, min, max, step, get, own, set, what, show } = desc;
    const slider = app.element("input", { type: "range", id, min, step });
    const most = () => (typeof max === "function" ? max() : max);
    const number = show ? app.element("output", {})
                        : app.element("input", { type: "number", step: "any", min });
    number.className = "number";
    number.setAttribute("aria-label", `${label}${of ? ` of ${of}` : ""}, as a number`);
    number.dataset.what = what;
    const use = (text) => {
        const value = Number(text);
        if (text !== "" && value >= Number(min) && value <= most() && value !== get())
            set(value);
    };
    slider.addEventListener("input", () => use(slider.value));
    number.addEventListener("change", () => {
        use(number.value);
        controls.update();
    });
    const update = () => {
        const value = get();
        slider.max = most();
        slider.value = value;
        number.dataset.value = app.hexFloat(value);
        if (show)
            number.textContent = show(value);
        else if (document.activeElement !== number) {
            number.max = most();
            number.value = app.shortest(Math.fround(value));
        }
        slider.disabled = number.disabled = Number(slider.max) <= Number(min);
    };
    return controls.row({ ...desc, changed: () => get() !== own(), reset: () => set(null), update },
                        slider, number);
};

/* A number without one, such as a distance. */
controls.number = (desc) => {
    const row = controls.slider(desc), [slider, number] = row.querySelectorAll("input");
    number.id = slider.id;
    number.removeAttribute("aria-label");
    slider.remove();
    number.classList.add("wide");
    return row;
};

/* A colour, as linear numbers: get() -> [r, g, b], set([r, g, b]). */
controls.color = (desc) => {
    const { id, get, own, set, what } = desc;
    const picker = app.element("input", { type: "color", id });
    const numbers = app.element("span", { className: "linear" });
    picker.addEventListener("input", () => set(edits.parseColor(picker.value)));
    const update = () => {
        const rgb = get();
        picker.value = edits.hexColor(rgb);
        numbers.replaceChildren(...rgb.flatMap((value, i) => [
            app.numberElement(Math.fround(value), "r32f", `${what}.${"rgb"[i]}`), " "]));
    };
    const same = () => get().every((v, i) => Math.fround(v) === Math.fround(own()[i]));
    return controls.row({ ...desc, changed: () => !same(), reset: () => set(null), update }, picker,
                        numbers);
};

/* One of a few names, of app.settings[name]. */
controls.choice = (name, label, hint = "", names = app.settings[name].choices) => {
    const id = `set-${name}`;
    const select = app.element("select", { id, title: hint });
    const now = () => app.settings[name].value ?? app.settings[name];
    const set = (value) => app.change({ [name]: value });
    names.forEach((text, value) =>
        select.append(app.element("option", { value, textContent: text })));
    select.dataset.what = `setting.${name}`;
    select.addEventListener("change", () => set(Number(select.value)));
    const update = () => {
        select.value = now();
        select.dataset.value = now();
    };
    return controls.row({ id, label, hint, update, changed: () => now() !== app.carried[name],
                          reset: () => set(app.carried[name]) }, select);
};

/* A plain number of app.settings. */
controls.plain = (name, desc) => controls.slider({
    id: `set-${name}`, what: `setting.${name}`, get: () => app.settings[name],
    own: () => app.carried[name],
    set: (value) => app.change({ [name]: value ?? app.carried[name] }), ...desc,
});
