/* Cameras that are turned and moved by hand: {eye, axes: [right, up, back], lengths, distance,
 * yfov, near, far}. axes: unit vectors; lengths: what the camera's matrix scales them by; distance:
 * from the eye, along the view, to what it turns about. Functions give new cameras. */
"use strict";

const camera = {};

camera.add = (a, b, scale = 1) => a.map((v, i) => v + b[i] * scale);
camera.dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
camera.cross = (a, b) => [0, 1, 2].map((i) =>
    a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
camera.unit = (a) => {
    const length = Math.sqrt(camera.dot(a, a));
    return a.map((v) => v / length);
};

/* One of the scene's (engine.h, engine_scene). bounds: [low, high] of all that is drawn. The camera
 * turns about the point of its view that is nearest to the middle, where that is in front of it. */
camera.read = (one, bounds) => {
    const columns = [0, 4, 8].map((at) => one.world.slice(at, at + 3));
    const eye = one.world.slice(12, 15);
    const [low, high] = bounds;
    const middle = low.map((v, i) => (v + high[i]) / 2), to = camera.add(middle, eye, -1);
    const size = Math.sqrt(camera.dot(camera.add(high, low, -1), camera.add(high, low, -1))) || 1;
    const axes = columns.map(camera.unit), along = -camera.dot(to, axes[2]);
    return { eye, axes, lengths: columns.map((c) => Math.sqrt(camera.dot(c, c))), size,
             distance: Math.max(along, 0.05 * size), yfov: one.yfov, near: one.near,
             far: one.far ?? Infinity };
};

/* Seven digits, so that an address of 150 characters gives the same camera, bit for bit. */
camera.round = (value) => Number(value.toPrecision(7));

/* The camera's matrix, column-major. */
camera.world = ({ eye, axes, lengths }) => {
    const column = (axis, i) => [...axis.map((v) =>
        Math.abs(v) < 1e-8 ? 0 : camera.round(v * lengths[i])), 0];
    return [...axes.flatMap(column), ...eye.map(camera.round), 1];
};

/* v turned about a unit axis by an angle (Rodrigues' formula). */
camera.turn = (v, axis, angle) => {
    const c = Math.cos(angle), s = Math.sin(angle), k = camera.dot(axis, v) * (1 - c);
    const across = camera.cross(axis, v);
    return v.map((x, i) => x * c + across[i] * s + axis[i] * k);
};

camera.target = (one) => camera.add(one.eye, one.axes[2], -one.distance);

/* Looks left by yaw and up by pitch, radians, from where it is. The world's y stays up: pitch ends
 * just before the view does. A mirroring camera stays one. */
camera.look = (one, yaw, pitch) => {
    const most = Math.PI / 2 - 0.02;
    const height = Math.asin(Math.max(-1, Math.min(1, -one.axes[2][1])));
    const turned = one.axes.map((axis) => camera.turn(axis, [0, 1, 0], yaw));
    const wanted = Math.max(Math.min(height, -most), Math.min(Math.max(height, most),
                                                              height + pitch));
    const right = camera.cross(turned[1], turned[2]); /* of a mirroring camera, its left */
    const axes = turned.map((axis) => camera.turn(axis, right, wanted - height));
    return { ...one, axes: camera.square(axes) };
};

/* Unit vectors at right angles again, of the same hand. */
camera.square = ([right, up, back]) => {
    const z = camera.unit(back);
    const x = camera.unit(camera.add(right, z, -camera.dot(right, z)));
    const hand = camera.dot(camera.cross(z, x), up) < 0 ? -1 : 1;
    return [x, camera.cross(z, x).map((v) => v * hand), z];
};

/* Goes round its target: to the right by yaw, upwards by pitch. */
camera.orbit = (one, yaw, pitch) => {
    const turned = camera.look(one, yaw, -pitch);
    return { ...turned, eye: camera.add(camera.target(one), turned.axes[2], one.distance) };
};

/* Nearer by a factor below 1; what it turns about stays. */
camera.zoom = (one, factor) => {
    const distance = Math.max(1e-3 * one.size, Math.min(1e3 * one.size, one.distance * factor));
    return { ...one, distance, eye: camera.add(camera.target(one), one.axes[2], distance) };
};

/* By amounts of the scene's units to the right, up and forwards; its target comes along. */
camera.move = (one, right, up, forward) => {
    let eye = camera.add(one.eye, one.axes[0], right);
    eye = camera.add(camera.add(eye, one.axes[1], up), one.axes[2], -forward);
    return { ...one, eye };
};

/* What the address says of it, and back; null where a text is not one. Twelve numbers of the
 * matrix, field of view, near, far, distance. */
camera.write = (one) => [...camera.world(one).filter((v, i) => i % 4 !== 3), one.yfov, one.near,
                         one.far, one.distance].map((v) => String(camera.round(v))).join(",");

camera.parse = (text, size) => {
    const v = text.split(",").map((one) => (one.trim() === "" ? NaN : Number(one)));
    const [yfov, near, far, distance] = v.slice(12);
    if (v.length !== 16 || !v.every((one, i) => Number.isFinite(one) || (i === 14 && one > 0)) ||
        !(yfov > 0 && yfov < Math.PI && near > 0 && far > near && distance > 0))
        return null;
    const columns = [0, 3, 6].map((at) => v.slice(at, at + 3));
    if (camera.dot(camera.cross(columns[0], columns[1]), columns[2]) === 0)
        return null;
    return { eye: v.slice(9, 12), axes: columns.map(camera.unit),
             lengths: columns.map((c) => Math.sqrt(camera.dot(c, c))), size, yfov, near, far,
             distance };
};
