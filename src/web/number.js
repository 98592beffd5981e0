/* One way to print a stored number, everywhere in the page. */
"use strict";

/* The shortest decimal that reads back as the same single-precision float. */
app.shortest = (value) => {
    if (value === 0 || !Number.isFinite(value))
        return Object.is(value, -0) ? "-0" : Number.isNaN(value) ? "nan"
                                           : value === 0 ? "0" : value > 0 ? "inf" : "-inf";
    for (let digits = 1; digits < 17; digits++) {
        const text = value.toPrecision(digits);
        if (Math.fround(Number(text)) === value)
            return String(Number(text));
    }
    return String(value);
};

/* Four digits, for what is no stored number. */
app.rounded = (value) => Number.isFinite(value) ? String(Number(value.toPrecision(4)))
                                                : app.shortest(value);

/* As C's "%a" prints a number that a float or a double holds. */
app.hexFloat = (value) => {
    if (value === 0 || !Number.isFinite(value))
        return Object.is(value, -0) ? "-0x0p+0" : value === 0 ? "0x0p+0" : app.shortest(value);
    const view = new DataView(new ArrayBuffer(8));
    view.setFloat64(0, value);
    const bits = view.getBigUint64(0);
    const exponent = Number(bits >> 52n & 0x7ffn);
    const mantissa = (bits & 0xfffffffffffffn).toString(16).padStart(13, "0").replace(/0+$/, "");
    const power = exponent === 0 ? -1022 : exponent - 1023;
    return `${value < 0 ? "-" : ""}0x${exponent === 0 ? 0 : 1}${mantissa && "."}${mantissa}p` +
           `${power < 0 ? "" : "+"}${power}`;
};

app.halfToFloat = (bits) => {
    const exponent = bits >> 10 & 31, mantissa = bits & 1023;
    const size = exponent === 31 ? (mantissa ? NaN : Infinity)
               : exponent === 0 ? mantissa * 2 ** -24
               : (1 + mantissa / 1024) * 2 ** (exponent - 15);
    return bits & 0x8000 ? -size : size;
};

const UNORM_MAX = { rgba16: 65535, rgba8: 255, rg16: 65535, d24: 16777215, d16: 65535 };

/* The number that a stored value of a format means: halves come as bits, unorm as integers. */
app.stored = (stored, format) => {
    if (format === "rgba16f")
        return app.halfToFloat(stored);
    return UNORM_MAX[format] ? Math.fround(stored / UNORM_MAX[format]) : stored;
};

/* {value, decimal, hex}; of unorm formats also code, the integer. Without a format: a float. */
app.number = (stored, format = "r32f") => {
    if (format === "r32ui" || format === "count") {
        const text = format === "r32ui" && stored === 0xffffffff ? "none" : String(stored);
        return { value: stored, decimal: text, hex: String(stored) };
    }
    if (format === "double")
        return { value: stored, decimal: app.rounded(stored), hex: app.hexFloat(stored) };
    const value = app.stored(stored, format);
    const number = { value, decimal: app.shortest(value), hex: app.hexFloat(value) };
    if (UNORM_MAX[format])
        number.code = stored;
    return number;
};

/* A number in the text. what: "peel.2.accum.r": whose number it is, for whoever checks the page. */
app.numberElement = (stored, format, what) => {
    const { decimal, hex, code } = app.number(stored, format);
    const element = app.element("data", { className: "number", textContent: decimal });
    element.title = code === undefined ? hex : `${hex}, stored as ${code}`;
    element.dataset.value = hex;
    element.dataset.what = what;
    return element;
};
