/* The steps of a frame, in their order. */
"use strict";

app.makeSteps = () => app.frame.buffers.map((buffer) => ({
    id: buffer.name.replaceAll(".", "-"),
    title: buffer.name,
    kind: "peel",
    peel: null,
    buffers: [buffer.name],
    code: [],
    equation: () => "",
    source: "",
}));

/* Shows every traced buffer, one after the other. */
app.showStep = () => {
    const place = document.getElementById("panels-steps");
    const canvas = document.createElement("canvas");
    const { width, height, rgba, legend } =
        draw.buffer(app.frame.buffer(app.steps[app.step].buffers[0]));
    Object.assign(canvas, { width, height });
    canvas.getContext("2d").putImageData(new ImageData(rgba, width, height), 0, 0);
    place.replaceChildren(app.element("h2", { textContent: app.steps[app.step].title }), canvas,
                          app.element("p", { textContent: legend }));
};

app.on("step", app.showStep);
document.addEventListener("keydown", (event) => {
    if (event.key === "ArrowRight" || event.key === "ArrowLeft")
        app.change({ step: app.step + (event.key === "ArrowRight" ? 1 : -1) });
});
