/* A picture in the page: its canvas, its legend, the chosen pixel's place in it, that pixel's
 * neighbourhood magnified, and the values stored there. */
"use strict";

const figure = { NEIGHBOURS: 11, live: new Set() };

/* picture: of draw; plain: its points are no pixels of the frame. title: text. Clicks choose the
 * pixel. */
figure.make = (title, picture) => {
    const canvas = app.element("canvas", { width: picture.width, height: picture.height });
    canvas.getContext("2d").putImageData(
        new ImageData(picture.rgba, picture.width, picture.height), 0, 0);
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", title);
    const marker = app.element("span", { className: "marker", hidden: true });
    const frame = app.element("div", { className: "frame" }, canvas, marker);
    const pixel = app.element("div", { className: "at-pixel", hidden: true });
    const element = app.element("figure", { className: "picture" },
        app.element("figcaption", {}, app.element("strong", { textContent: title })), frame,
        figure.legend(picture.legend), pixel);
    if (picture.plain) {
        frame.classList.add("plain");
        element.classList.add("wide");
        return element;
    }
    canvas.addEventListener("click", (event) => figure.choose(event, canvas));
    canvas.addEventListener("pointermove", (event) => figure.hover(event, canvas, picture));
    const one = { element, picture, canvas, marker, pixel };
    figure.live.add(one);
    figure.mark(one);
    return element;
};

/* Text, or a list of {color, pattern, text}. */
figure.legend = (legend) => {
    if (typeof legend === "string")
        return app.element("p", { className: "legend", textContent: legend });
    const list = app.element("ul", { className: "legend" });
    for (const { color, pattern, text } of legend) {
        const key = app.element("span", { className: `swatch ${pattern}` });
        key.style.setProperty("--swatch", `rgb(${color.join(" ")})`);
        list.append(app.element("li", {}, key, ...[text].flat()));
    }
    return list;
};

figure.place = (event, canvas) => {
    const box = canvas.getBoundingClientRect();
    return [Math.floor((event.clientX - box.left) * canvas.width / box.width),
            Math.floor((event.clientY - box.top) * canvas.height / box.height)];
};

figure.choose = (event, canvas) => app.change({ pixel: figure.place(event, canvas) });

figure.hover = (event, canvas, picture) => {
    const [x, y] = figure.place(event, canvas);
    if (x < 0 || y < 0 || x >= picture.width || y >= picture.height)
        return;
    const values = picture.describe(x, y).map(([label, stored, format]) =>
        `${label} ${app.number(stored, format).decimal}`);
    canvas.title = `${x},${y}: ${values.join(", ")}`;
};

/* ---- the chosen pixel ---- */

figure.mark = ({ picture, marker, pixel }) => {
    const shown = app.pixel !== null;
    marker.hidden = pixel.hidden = !shown;
    if (!shown)
        return;
    const [x, y] = app.pixel;
    marker.style.left = `${100 * (x + 0.5) / picture.width}%`;
    marker.style.top = `${100 * (y + 0.5) / picture.height}%`;
    pixel.replaceChildren(figure.magnify(picture, x, y), figure.values(picture, x, y));
};

figure.magnify = ({ width, height, rgba }, x, y) => {
    const n = figure.NEIGHBOURS, half = n >> 1;
    const canvas = app.element("canvas", { width: n, height: n, className: "magnifier" });
    const image = new ImageData(n, n);
    for (let j = 0; j < n; j++)
        for (let i = 0; i < n; i++) {
            const [u, v] = [x + i - half, y + j - half];
            if (u >= 0 && v >= 0 && u < width && v < height)
                image.data.set(rgba.subarray(4 * (v * width + u), 4 * (v * width + u) + 4),
                               4 * (j * n + i));
        }
    canvas.getContext("2d").putImageData(image, 0, 0);
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `Pixel ${x},${y} and its neighbours`);
    return app.element("div", { className: "magnified" }, canvas);
};

figure.values = (picture, x, y) => {
    const list = app.element("dl", { className: "values" });
    for (const [label, stored, format, what] of picture.describe(x, y))
        list.append(app.element("dt", { textContent: label }),
                    app.element("dd", {}, app.numberElement(stored, format, what)));
    return list;
};

/* Forgets figures that left the page and marks the others. */
figure.update = () => {
    for (const one of figure.live)
        if (one.element.isConnected)
            figure.mark(one);
        else
            figure.live.delete(one);
};

app.on("pixel", figure.update);
