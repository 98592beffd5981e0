/* A lesson: its text and its question beside the explorer. What it says is in lessons.js; whether
 * the page is a lesson, body's data-lesson. */
"use strict";

const course = { number: Number(document.body.dataset.lesson ?? 0), section: null, verdict: null,
                 strip: null, timer: null, asked: 0 };

const COURSE_WAIT_MS = 250; /* after the last change */

/* ---- texts ---- */

/* Of "plain, *a term at its definition*, [words](step=…&pixel=x,y)": text, terms, and links that
 * lead there without taking back what the reader changed. */
course.words = (text) => text.split(/(\*[^*]+\*|\[[^\]]+\]\([^)]*\))/).map((part) => {
    const link = part.match(/^\[([^\]]+)\]\(([^)]*)\)$/);
    if (link)
        return course.guide(link[1], new URLSearchParams(link[2]));
    return /^\*.*\*$/.test(part) ? app.element("dfn", { textContent: part.slice(1, -1) }) : part;
});

course.paragraph = (text) => typeof text === "string"
    ? app.element("p", {}, ...course.words(text)) : course.table(text);

course.table = ({ head, rows }) => {
    const cells = (texts, tag) => texts.map((text, i) => {
        const [name, ...code] = text.split(/(?<=: )/);
        return app.element(i === 0 ? "th" : tag, {}, name,
                           ...code.map((long) => app.element("code", {}, ...long.split(/(?<=_)/)
                               .flatMap((part) => [part, app.element("wbr", {})]))));
    });
    return app.element("table", {},
        app.element("thead", {}, app.element("tr", {}, ...cells(head, "th"))),
        app.element("tbody", {}, ...rows.map((row) =>
            app.element("tr", {}, ...cells(row, "td")))));
};

course.guide = (text, parts) => {
    const link = app.element("a", { href: `#${parts}`, textContent: text });
    link.addEventListener("click", async (event) => {
        if (document.body.dataset.state !== "ready")
            return; /* app.follow goes where the address then says */
        event.preventDefault();
        const wanted = Object.fromEntries(parts);
        const focus = wanted.focus;
        delete wanted.focus;
        if (wanted.pixel)
            wanted.pixel = wanted.pixel.split(",").map(Number);
        await app.change({ view: "steps", ...wanted });
        if (focus)
            course.focus(focus);
        else
            document.getElementById(`view-${app.view}`).scrollIntoView({ block: "start" });
    });
    return link;
};

/* A control, wherever it is folded away. */
course.focus = (id) => {
    const control = document.getElementById(id);
    for (let box = control?.closest("details"); box; box = box.parentElement.closest("details"))
        box.open = true;
    control?.focus();
    control?.scrollIntoView({ block: "center" });
};

/* ---- the lesson ---- */

course.make = () => {
    const lesson = LESSONS[course.number - 1];
    course.section = app.element("section", { id: "lesson" });
    course.section.setAttribute("aria-label", "The lesson");
    document.body.prepend(course.section);
    course.fold("methods-panel");
    course.fold("pixel");
    if (!location.hash)
        history.replaceState(null, "", `#${lesson.start}`);
    course.fill(lesson, JSON.parse(document.getElementById("data").textContent).lesson.titles);
    for (const what of ["frame", "pixel", "settings", "edit", "view"])
        app.on(what, course.later);
    live.listeners.push(course.later);
};

/* What the lessons do not speak of is folded, under its heading. */
course.fold = (id) => {
    const section = document.getElementById(id), [heading, ...rest] = section.children;
    section.append(app.element("details", { className: "folded" },
        app.element("summary", {}, heading), ...rest));
};

course.fill = (lesson, titles) => {
    const { number, section } = course;
    course.verdict = app.element("p", { id: "lesson-verdict" });
    course.verdict.setAttribute("role", "status");
    section.append(
        app.element("p", { className: "kicker", textContent:
            `Lesson ${number} of ${titles.length}` }),
        app.element("h2", { textContent: titles[number - 1] }),
        ...lesson.text.map(course.paragraph),
        app.element("div", { className: "question" }, app.element("h3", { textContent: "Try it" }),
            ...lesson.question.map(course.paragraph),
            course.verdict),
        app.element("p", { className: "note", textContent: `Source: ${lesson.source}` }),
        course.others(number, titles));
    course.makeStrip();
};

/* The verdict again, at the edge of the window: from when the question was first seen, while it
 * is out of view. A screen reader has the verdict itself. */
course.makeStrip = () => {
    course.strip = app.element("div", { id: "lesson-strip", hidden: true });
    course.strip.setAttribute("aria-hidden", "true");
    course.strip.addEventListener("click", () =>
        course.verdict.scrollIntoView({ block: "center" }));
    document.body.append(course.strip);
    const question = course.verdict.parentElement;
    let met = false;
    new IntersectionObserver(([{ isIntersecting }]) => {
        met ||= isIntersecting;
        course.strip.hidden = isIntersecting || !met;
    }).observe(question);
};

course.others = (number, titles) => {
    const link = (to, text) => app.element("a", { href: to, textContent: text });
    const nav = app.element("nav", { className: "lessons" });
    nav.setAttribute("aria-label", "Lessons");
    if (number > 1)
        nav.append(link(`lesson-${number - 1}.html`, `\u2190 ${titles[number - 2]}`));
    nav.append(link("index.html", "All lessons"));
    if (number < titles.length)
        nav.append(link(`lesson-${number + 1}.html`, `${titles[number]} \u2192`));
    return nav;
};

/* ---- the question ---- */

course.later = () => {
    clearTimeout(course.timer);
    course.verdict.classList.add("late");
    course.timer = setTimeout(course.check, COURSE_WAIT_MS);
};

/* The traced frame of things as they stand; the live view leaves app.frame behind. */
course.frame = async () => {
    if (!app.stale)
        return app.frame;
    const frame = await app.engine.render(...app.settings.size, true);
    const buffers = new Map(frame.buffers.map((buffer) => [buffer.name, buffer]));
    frame.buffer = (name) => buffers.get(name);
    return frame;
};

/* The figures of what the reader sees: the live view's picture may be the larger one. */
course.figures = async () => app.view === "live" && live.frame ? live.frame : app.frame;

/* What a frame stored at a pixel. */
course.at = (frame, name, [x, y], channel = 0) => {
    const buffer = frame.buffer(name);
    return buffer && app.stored(buffer.data[(y * buffer.width + x) * buffer.channels + channel],
                                buffer.format);
};

/* How many layers peels took at a pixel. */
course.layers = (frame, [x, y]) => {
    let count = 0;
    for (let k = 0; k < frame.peels; k++)
        count += course.at(frame, `peel.${k}.primitive`, [x, y]) !== 0xffffffff;
    return count;
};

course.check = async () => {
    const asked = ++course.asked;
    try {
        const { right, text } = await LESSONS[course.number - 1].check();
        if (asked !== course.asked)
            return;
        course.verdict.className = right ? "right" : "not-yet";
        course.verdict.replaceChildren(
            app.element("strong", { textContent: right ? "\u2713 Right. " : "Not yet. " }),
            ...[text].flat());
        course.strip.className = course.verdict.className;
        course.strip.textContent = course.verdict.textContent;
    } catch (error) {
        app.say(error.message);
    }
};

/* Whether a number is the wanted one, in the digits that are shown. */
course.near = (value, wanted) => app.rounded(value) === app.rounded(wanted);

/* A number in a verdict, of four digits; what it is exactly is in its title. */
course.value = (value, what, format = "r32f") => {
    const element = app.numberElement(value, format, what);
    if (format !== "count")
        element.textContent = app.rounded(app.stored(value, format));
    return element;
};

if (course.number > 0)
    course.make();
