/* What the reader changed of the scene: materials, ambient light, cameras. Kept as differences from
 * the scene that the page carries, so that each can be taken back and all stand in the address:
 * "edit=0.alpha:0.25;ambient:0.1,0.1,0.2;camera0:…". */
"use strict";

const edits = {
    original: null, /* engine.scene() of the carried scene */
    materials: new Map(), /* "0.alpha" -> value */
    ambient: null, /* three numbers, or null: the scene's */
    cameras: new Map(), /* number -> camera (camera.js) */
    FIELDS: ["red", "green", "blue", "alpha", "roughness", "metallic", "occlusion"],
};

/* ---- colours ---- */

/* What a colour picker means, 8 bits of sRGB, as the linear numbers that a scene stores (IEC
 * 61966-2-1). The display transform is another function: light is added in between. */
edits.linear = (code) => {
    const s = code / 255;
    return Math.fround(s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4);
};

edits.code = (linear) => {
    const c = Math.max(0, Math.min(1, linear));
    return Math.round(255 * (c <= 0.0031308 ? c * 12.92 : 1.055 * c ** (1 / 2.4) - 0.055));
};

edits.hexColor = (rgb) =>
    "#" + rgb.slice(0, 3).map((v) => edits.code(v).toString(16).padStart(2, "0")).join("");
edits.parseColor = (text) =>
    [1, 3, 5].map((at) => edits.linear(parseInt(text.slice(at, at + 2), 16)));

/* ---- as they stand ---- */

/* Of a material in engine.scene()'s form. */
edits.field = (material, field) =>
    field < 4 ? material.base_color[field] : material[edits.FIELDS[field]];

edits.value = (index, field) =>
    edits.materials.get(`${index}.${edits.FIELDS[field]}`) ??
    edits.field(edits.original.materials[index], field);

/* "opaque", "mask" or "blend", as the engine has it after these edits. */
edits.mode = (index) => {
    const { mode } = edits.original.materials[index];
    if (mode === "mask" || !edits.materials.has(`${index}.alpha`))
        return mode;
    return edits.value(index, 3) < 1 ? "blend" : "opaque";
};

edits.ambientNow = () => edits.ambient ?? edits.original.ambient;

edits.cameraNow = (index) => edits.cameras.get(index) ??
    camera.read(edits.original.cameras[index], edits.original.bounds);

edits.any = () => edits.materials.size > 0 || edits.ambient !== null || edits.cameras.size > 0;

/* ---- changing them; engine: app.engine, or another that is to look the same ---- */

const MODE_FIELD = 7; /* engine.h */

/* value null: the scene's own. */
edits.setMaterial = async (engine, index, field, value) => {
    const own = edits.field(edits.original.materials[index], field);
    const name = `${index}.${edits.FIELDS[field]}`;
    if (value === null || Math.fround(value) === Math.fround(own)) {
        edits.materials.delete(name);
        await engine.setMaterial(index, field, own);
        if (field === 3)
            await engine.setMaterial(index, MODE_FIELD,
                                     edits.original.materials[index].mode === "blend" ? 1 : 0);
        return;
    }
    await engine.setMaterial(index, field, value);
    edits.materials.set(name, value);
};

edits.setAmbient = async (engine, rgb) => {
    await engine.setAmbient(...(rgb ?? edits.original.ambient));
    edits.ambient = rgb;
};

edits.setCamera = async (engine, index, one) => {
    if (one) {
        edits.cameras.set(index, one);
        await engine.setCamera(index, camera.world(one), camera.round(one.yfov),
                               camera.round(one.near), camera.round(one.far));
    } else {
        const { world, yfov, near, far } = edits.original.cameras[index];
        edits.cameras.delete(index);
        await engine.setCamera(index, world, yfov, near, far ?? Infinity);
    }
};

/* Makes them on an engine that has just opened the carried scene. */
edits.replay = async (engine) => {
    for (const [name, value] of edits.materials) {
        const [index, field] = name.split(".");
        await engine.setMaterial(Number(index), edits.FIELDS.indexOf(field), value);
    }
    if (edits.ambient)
        await edits.setAmbient(engine, edits.ambient);
    for (const [index, one] of edits.cameras)
        await edits.setCamera(engine, index, one);
};

/* ---- the address ---- */

edits.write = () => {
    const float = (value) => app.shortest(Math.fround(value));
    const parts = [...edits.materials].map(([name, value]) => `${name}:${float(value)}`);
    if (edits.ambient)
        parts.push(`ambient:${edits.ambient.map(float).join(",")}`);
    for (const [index, one] of edits.cameras)
        parts.push(`camera${index}:${camera.write(one)}`);
    return parts.join(";");
};

/* The edits that a text says, {materials, ambient, cameras}; what is none of this scene's is left
 * out. */
edits.parse = (text, scene) => {
    const out = { materials: new Map(), ambient: null, cameras: new Map() };
    for (const part of text.split(";").filter(Boolean)) {
        const [name, values = ""] = part.split(":");
        const material = name.match(/^(\d+)\.(\w+)$/), numbers = values.split(",").map(Number);
        const within = (most) => numbers.every((v) => v >= 0 && v <= most);
        const [, number] = name.match(/^camera(\d+)$/) ?? [];
        if (material && Number(material[1]) < scene.materials.length &&
            edits.FIELDS.includes(material[2]) && numbers.length === 1 && values && within(1))
            out.materials.set(name, numbers[0]);
        else if (name === "ambient" && numbers.length === 3 && within(1e12))
            out.ambient = numbers;
        else if (number !== undefined && Number(number) < scene.cameras.length) {
            const { size } = camera.read(scene.cameras[number], scene.bounds);
            const one = camera.parse(values, size);
            if (one)
                out.cameras.set(Number(number), one);
        }
    }
    return out;
};

/* Makes the engine's scene as the text says, from whatever it is now. */
edits.become = async (engine, text) => {
    const wanted = edits.parse(text, edits.original);
    for (const name of new Set([...edits.materials.keys(), ...wanted.materials.keys()])) {
        const [index, field] = name.split(".");
        await edits.setMaterial(engine, Number(index), edits.FIELDS.indexOf(field),
                                wanted.materials.get(name) ?? null);
    }
    if (wanted.ambient || edits.ambient)
        await edits.setAmbient(engine, wanted.ambient);
    for (const index of new Set([...edits.cameras.keys(), ...wanted.cameras.keys()]))
        await edits.setCamera(engine, index, wanted.cameras.get(index) ?? null);
};
