/* The ray through the chosen pixel: its fragments along the view axis as the peels take them, and
 * the transmittance that is left behind each. */
"use strict";

const ray = { WIDTH: 640, HEIGHT: 172, LEFT: 44, RIGHT: 24, AXIS: 66, TOP: 96, BOTTOM: 148 };

ray.svg = (tag, attributes, ...children) => {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes))
        element.setAttribute(name, value);
    element.append(...children);
    return element;
};

/* Evenly spaced where distances would lie on each other, in their order: a place of 0 to 1. */
ray.places = (distances) => {
    const low = Math.min(...distances), high = Math.max(...distances);
    const least = Math.min(0.06, 1 / Math.max(1, distances.length));
    const places = distances.map((d) => high > low ? (d - low) / (high - low) : 0.5);
    for (let i = 1; i < places.length; i++)
        places[i] = Math.max(places[i], places[i - 1] + least);
    const most = Math.max(1, ...places);
    return places.map((place) => place / most);
};

ray.x = (place) => ray.LEFT + 34 + place * (ray.WIDTH - ray.LEFT - ray.RIGHT - 76);

/* Shape and text say what colour alone would. */
ray.mark = (fragment, x) => {
    const kept = pixel.isKept(fragment), opaque = fragment.list === "opaque";
    const text = fragment.fate === "peeled" ? String(fragment.peel)
               : fragment.fate === "seen" ? "" : kept ? "\u2022" : "\u00d7";
    const shape = opaque
        ? ray.svg("rect", { x: x - 7, y: ray.AXIS - 22, width: 14, height: 44, rx: 2 })
        : ray.svg("circle", { cx: x, cy: ray.AXIS, r: 12 });
    const label = ray.svg("text", { x, y: ray.AXIS + 5, class: kept ? "inside" : "cross" }, text);
    const title = ray.svg("title", {}, `triangle ${fragment.primitive}, ` +
        `${fragment.instance_name}: ${pixel.fate(fragment)}`);
    return ray.svg("g", { class: kept ? "kept" : "lost" }, title, shape, label);
};

/* The transmittance as a staircase: it falls at every fragment that is blended. */
ray.stairs = (fragments, xs) => {
    const y = (t) => ray.BOTTOM - (ray.BOTTOM - ray.TOP) * Math.max(0, Math.min(1, t));
    let left = 1, path = `M${ray.LEFT} ${y(1)}`;
    fragments.forEach((fragment, i) => {
        const alpha = fragment.fate === "seen" ? 1 : pixel.parse(fragment.surface.base[3]);
        path += `H${xs[i]}`;
        left *= pixel.isKept(fragment) ? 1 - alpha : 1;
        path += `V${y(left)}`;
    });
    return [ray.svg("path", { d: `${path}H${ray.WIDTH - ray.RIGHT}`, class: "stairs" }),
            ray.svg("text", { x: ray.LEFT - 8, y: y(1) + 4, class: "axis" }, "T = 1"),
            ray.svg("text", { x: ray.LEFT - 8, y: y(0) + 4, class: "axis" }, "0")];
};

ray.draw = () => {
    const fragments = pixel.nearToFar().map(({ fragment }) => fragment);
    const part = app.element("figure", { className: "ray" });
    if (fragments.length === 0)
        return part;
    const distances = fragments.map((fragment) => pixel.parse(fragment.distance));
    const xs = ray.places(distances).map(ray.x);
    const words = fragments.map((fragment) => pixel.fate(fragment)).join("; ");
    const image = ray.svg("svg", { viewBox: `0 0 ${ray.WIDTH} ${ray.HEIGHT}`, role: "img",
                                   "aria-label": `The ray from the eye meets: ${words}.` },
        ray.svg("text", { x: 4, y: ray.AXIS + 5, class: "eye" }, "eye"),
        ray.svg("line", { x1: ray.LEFT - 10, y1: ray.AXIS, x2: ray.WIDTH - ray.RIGHT,
                          y2: ray.AXIS, class: "line" }),
        ...ray.stairs(fragments, xs));
    fragments.forEach((fragment, i) => {
        image.append(ray.mark(fragment, xs[i]));
        image.append(ray.svg("text", { x: xs[i], y: ray.AXIS - (i % 2 ? 46 : 32), class: "name" },
                             (fragment.fate === "seen" ? "opaque, " : "") +
                             app.rounded(distances[i])));
    });
    part.append(image, app.element("figcaption", { className: "note", textContent:
        "Along the ray, with distances from the eye: a number is the peel that took the " +
        "fragment, \u00d7 one that is not seen; below, the light T that is let through." }));
    return part;
};
