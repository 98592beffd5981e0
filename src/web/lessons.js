/* The lessons of the course, in the order of report/course.c, which has their titles and scenes.
 *
 * start: the address a lesson opens at. text, question: paragraphs (course.words), or a table's
 * {head, rows} of texts. check(): whether the question is answered as things stand, {right, text}.
 */
"use strict";

const LESSONS = [];

/* ---- 1: alpha ---- */

LESSONS.push({
    start: "step=display&pixel=18,61",
    text: [
        "Beside this text, or below it, is the explorer: a picture as it is made, one step at a " +
        "time. The lessons lead to the steps they are about; what else is seen there can wait.",
        "A *transparent* surface lets some of the light from behind it through. How much it " +
        "keeps for itself is its opacity, written *α* (alpha): of the light from behind, the " +
        "part 1 − α comes through. At α = 0 the surface is not seen; at α = 1 nothing comes " +
        "through, and it is *opaque*.",
        "The scene is a wall with stripes behind orange squares. [The image](step=display) shows " +
        "them: every row has another α, from nearly 0 at the top to 1 at the bottom. In the " +
        "first column there is one square, in the second there are two, one behind the other, " +
        "and so on. The ring marks a pixel of the third row, first column: one square with α = " +
        "0.25.",
        "The piece of a surface that falls on one pixel is called a *fragment*. A fragment that " +
        "keeps a quarter of the light from behind also sends only a quarter of its own colour. " +
        "So its colour is multiplied by α before anything else is done with it. The product is " +
        "the *premultiplied* colour: [here it is](step=peel-0-light&pixel=18,61), with α as a " +
        "fourth number beside red, green and blue. Together, the four numbers are the fragment's " +
        "*source*.",
        "What the eye gets is a sum: source + (1 − α) · light from behind. To put " +
        "one thing over another like this is to *blend* them. The part that still comes through, " +
        "here 1 − α, is called *transmittance*, T; of several surfaces it is the product of " +
        "theirs. At the ring, in red: 0.215 from the square, + 0.75 · 0.817 from the wall, " +
        "= 0.828 to the eye. (These numbers are light, before they are fitted to the display.)",
        "The page adds in another order: [first the square](step=peel-0-blend&pixel=18,61), to " +
        "nothing, which leaves T = 0.75; and later, as the last of all, [the wall]" +
        "(step=light&pixel=18,61), times T. The sum is the same; lesson 4 tells why it is done " +
        "so.",
    ],
    question: [
        "Make the square at the ring let exactly a tenth of the light through. Its material is " +
        "“alpha 0.25”: [move its alpha](view=live&focus=material-4-alpha), or type a " +
        "number there.",
    ],
    source: "T. Porter, T. Duff, Compositing Digital Images, SIGGRAPH 1984",
    async check() {
        const frame = await course.frame(), pixel = [18, 61];
        const through = course.at(frame, "peel.0.accum", pixel, 3);
        const number = course.value(through, "peel.0.accum.a");
        if (edits.mode(4) === "opaque")
            return { right: false, text: "At α = 1 the square is opaque: it is drawn with the " +
                "wall and no longer blended, and nothing comes through it." };
        if (course.near(through, 0.1))
            return { right: true, text: ["T is ", number, ". The square keeps α = 0.9 and " +
                "lets 1 − 0.9 through; its source has become brighter, as it is now " +
                "multiplied by 0.9."] };
        if (course.near(through, 0.9))
            return { right: false, text: ["T is ", number, ". α is what the square keeps, " +
                "not what it lets through."] };
        return { right: false, text: ["At the ring T is ", number, "; a tenth is 0.1."] };
    },
});

/* ---- 2: sorting ---- */

LESSONS.push({
    start: "step=naive&pixel=164,74",
    text: [
        "Several transparent surfaces are blended one over the other, from the farthest to the " +
        "nearest, and the order matters: red glass in front of blue glass is not blue in front " +
        "of red. So each *fragment*, the piece of a surface at one pixel, must be blended in its " +
        "turn.",
        "The obvious way is the painter's: sort the objects by the distance of their centres, " +
        "and draw the farthest first. [Here](step=naive) four square panes stand through each " +
        "other on an opaque ground. The first picture is the painter's. In the second each " +
        "pixel's fragments were sorted by themselves. The third marks in red where the two differ.",
        "Where two panes cross, the first is in front on one side of the line, and the second on " +
        "the other. Whichever is drawn first, one side comes out wrong. Cutting objects into " +
        "triangles does not help: triangles cross as well.",
        "At a single pixel, though, there always is a right order: each fragment there has a " +
        "*depth*, which says how far from the eye it is, as a number from 0, near, to 1, far. " +
        "(The number is not in proportion to the distance: most of the numbers are spent on " +
        "what is near, so that far things have depths close to 1.) The rest of the " +
        "course is about finding that order for every pixel, without sorting anything.",
    ],
    question: [
        "The painter is not wrong everywhere. Choose a pixel that lies behind at least two panes " +
        "and that the painter gets right: click it in one of [the pictures](step=naive).",
    ],
    source: "M. Newell, R. Newell, T. Sancha, A Solution to the Hidden Surface Problem, ACM 1972",
    async check() {
        if (!app.pixel)
            return { right: false, text: "No pixel is chosen." };
        const painter = (await walk.other("painter")).display;
        const frame = await course.frame(), [x, y] = app.pixel;
        const at = 4 * (y * painter.width + x), right = frame.buffer("display");
        const layers = course.layers(frame, app.pixel);
        const count = course.value(layers, "frame.layers", "count");
        if (layers < 2)
            return { right: false, text: ["This pixel has ", count,
                layers === 1 ? " layer" : " layers",
                " of glass: with fewer than two, nothing can be in the wrong order."] };
        const color = (buffer, name) => ["(", ...[0, 1, 2].flatMap((k) => [k ? ", " : "",
            course.value(buffer.data[at + k], `${name}.${"rgb"[k]}`, "rgba8")]), ")"];
        if ([0, 1, 2].some((k) => painter.data[at + k] !== right.data[at + k]))
            return { right: false, text: ["This pixel has ", count, " layers, and the painter is " +
                "wrong here: it shows ", ...color(painter, "painter.display"), ", in the right " +
                "order they give ", ...color(right, "display"), "."] };
        return { right: true, text: ["This pixel has ", count, " layers, and both ways give ",
            ...color(right, "display"), ": here the order of the panes happens to be that of " +
            "their fragments. On the other side of a crossing it cannot be."] };
    },
});

/* ---- 3: peeling ---- */

LESSONS.push({
    start: "step=peel-0-depth&pixel=164,74",
    text: [
        "Graphics hardware does not sort. What it has is the *depth test*: a *depth buffer* " +
        "holds one depth for each pixel, and a fragment stays only if it is nearer than that. So " +
        "drawing everything once, in any order, leaves the nearest fragment of every pixel. That " +
        "is [the first layer](step=peel-0-depth) of the four panes: its depth, light where it is " +
        "near. The ring marks a pixel that lies behind all four.",
        "For the second layer, everything is drawn again, with one more test: a fragment is " +
        "thrown away unless it is behind the depth that the first layer has at this pixel, the " +
        "*previous depth*. Of what is left the depth test keeps the nearest: [the second " +
        "layer](step=peel-1-depth). Compare the numbers at the ring: its new depth is greater " +
        "than the previous one, and no layer is between them.",
        "Why is the previous depth needed? Each pass draws the same surfaces again, and the " +
        "previous depth is all it knows of the passes before. Without it, every pass would find " +
        "the first layer again. [See what each test throws away](step=peel-1-discard): " +
        "orange is what was taken already, green is what must wait for a later pass, and " +
        "vertical bands are some of each.",
        "And so on: a pass that takes one layer from every pixel, always the next one behind, is " +
        "called a *peel*. [Layers in space](view=space) shows what each of them took; the last " +
        "picture [of this step](step=peel-1-depth&pixel=164,74) shows the depths of the ring's " +
        "row, seen from above. After the last peel one more [pass finds " +
        "nothing](step=stop): so it is known that all layers were taken, in the right order at " +
        "every pixel.",
        "One depth buffer cannot do both tests: what a pass compares with must not change while " +
        "the pass writes the depths that it finds. So there are two, and [they change " +
        "places](step=peel-1-swap) after each peel.",
        "What a peel took is lit and [blended behind](step=peel-1-blend) what is there: the new " +
        "colour is 1 · the colour so far + T · the source, and T then becomes T · (1 − α). The " +
        "two multipliers are the *blend factors*. T, the light that all layers in front let " +
        "through, weakens the new layer; 1 leaves alone what came before it. Lesson 4 tries " +
        "them out.",
        "Opaque surfaces, here the ground, are drawn before all this. What is behind them cannot " +
        "be seen, so a fragment must also be [in front of their depth](step=peel-1-compare), the " +
        "*opaque depth*.",
    ],
    question: [
        "The number of peels can be limited, to save time; then the last pass, which finds " +
        "nothing, is saved as well. Which is the smallest number that loses nothing here? " +
        "[Set the passes](view=live&focus=set-passes).",
    ],
    source: "C. Everitt, Interactive Order-Independent Transparency, NVIDIA, 2001",
    async check() {
        const frame = await course.figures(), { passes } = app.settings;
        const count = (value, what) => course.value(value, `frame.${what}`, "count");
        const lost = frame.lost_to_pass_limit;
        if (!["peel", "peel-id", "forward"].includes(app.choice("method")))
            return { right: false, text: `The method ${app.choice("method")} does not take one ` +
                "layer in each pass: choose peel." };
        if (passes === 0)
            return { right: false, text: "Passes is automatic now: the program goes on until a " +
                "pass finds nothing. Set a number." };
        if (lost > 0)
            return { right: false, text: ["With ", count(frame.peels, "peels"),
                frame.peels === 1 ? " peel " : " peels ",
                count(lost, "lost_to_pass_limit"),
                lost === 1 ? " fragment is" : " fragments are", " never reached, behind all " +
                "layers that were taken."] };
        if (frame.peels < passes)
            return { right: false, text: ["Nothing is lost, but only ", count(frame.peels, "peels"),
                frame.peels === 1 ? " peel" : " peels", " found anything: fewer will do."] };
        return { right: true, text: ["Some pixels have ", count(frame.max_layers, "max_layers"),
            " layers, and each peel takes one of them: the nearest behind the previous depth. " +
            "With one peel less the last layer would be lost."] };
    },
});

/* ---- 4: blending under ---- */

LESSONS.push({
    start: "step=peel-0-blend&pixel=56,61",
    text: [
        "Blending over goes from the farthest layer to the nearest. Peeling finds them the other " +
        "way round, nearest first. Keeping all layers until the last is found would take much " +
        "memory. Instead each layer is blended at once, *under* those before it.",
        "Two things are kept for each pixel, in one buffer, the *accumulation*: the light " +
        "gathered so far (red, green, blue), and the *transmittance* T, the part of the light " +
        "from behind that all layers so far let through. At first there is no light, and T = 1.",
        "A new layer is behind all others, so only T of its light arrives. It is added, and T " +
        "becomes smaller: light ← light + T · source, T ← T · (1 − α). " +
        "The ring is in a column with three squares, α = 0.25 each: [first]" +
        "(step=peel-0-blend&pixel=56,61), [second](step=peel-1-blend&pixel=56,61), [third]" +
        "(step=peel-2-blend&pixel=56,61). Before each, T is 1, 0.75 and 0.5625.",
        "Hardware blends with two *blend factors*: one multiplies the new value (the source), " +
        "one the old. OpenGL has a name for each:",
        { head: ["", "new value times", "old value times"],
          rows: [["light", "T: GL_DST_ALPHA", "1: GL_ONE"],
                 ["T", "0: GL_ZERO", "1 − α: GL_ONE_MINUS_SRC_ALPHA"]] },
        "For the light, T dims the new layer by what is in front of it, and 1 keeps what was " +
        "gathered. For T nothing is added, and the layer's α takes its part of what was left. " +
        "(T is stored as the fourth channel of the accumulation, which OpenGL calls the " +
        "destination's alpha.)",
        "Both ways give the same sum. For two layers a and b before a background c: a + " +
        "(1 − α of a) · (b + (1 − α of b) · c). Multiplied out, b counts " +
        "(1 − α of a) times, which is T after a.",
    ],
    question: [
        "After the three squares at the ring, T is 0.4219. [Set their " +
        "alpha](view=live&focus=material-4-alpha) so that an eighth of the light comes through " +
        "all three.",
    ],
    source: "L. Bavoil, K. Myers, Order Independent Transparency with Dual Depth Peeling, " +
        "NVIDIA, 2008",
    async check() {
        const frame = await course.frame(), pixel = [56, 61];
        const name = `peel.${Math.min(2, frame.peels - 1)}.accum`;
        const through = course.at(frame, name, pixel, 3);
        const number = course.value(through, `${name}.a`);
        if (edits.mode(4) === "opaque")
            return { right: false, text: "At α = 1 the squares are opaque: they are drawn with " +
                "the wall and no longer blended, and nothing comes through." };
        if (course.near(through, 0.125))
            return { right: true, text: ["T is ", number, ". With α = 0.5 each square halves " +
                "what is left: 1 · 0.5 · 0.5 · 0.5. The third one counts only a " +
                "quarter of its own light."] };
        return { right: false, text: ["T is ", number, "; an eighth is 0.125. " +
            "T is (1 − α) · (1 − α) · (1 − α)."] };
    },
});

/* ---- 5: deferring ---- */

LESSONS.push({
    start: "step=peel-0-gbuffer&pixel=160,90",
    text: [
        "So far a fragment had a colour. To find it, the surface is *lit*: for every light, how " +
        "much of it the surface reflects towards the eye. That is the expensive part, about a " +
        "hundred operations for each light.",
        "When a fragment is drawn, nobody knows yet whether it will stay: a nearer one may still " +
        "come, and then lighting it was in vain. So a *deferred* renderer does not light what it " +
        "draws. It stores what lighting will need: normal (the direction that the surface " +
        "faces), position, own colour with α, material. These buffers are the *G-buffer* ([of " +
        "the first layer](step=peel-0-gbuffer)).",
        "When the peel is complete, one pass over the picture [lights the " +
        "layer](step=peel-0-light), once for each pixel, and blends it. The opaque surfaces wait " +
        "in a G-buffer of their own, and are lit [at the very end](step=light), when all that is " +
        "in front of them is blended.",
        "The method forward is the other way: it lights while it draws. [Its " +
        "steps](method=forward&step=peel-0-gbuffer) show what it stores: nothing but a colour. " +
        "The image is the same. [Back to peel](method=peel&step=peel-0-gbuffer).",
    ],
    question: [
        "How much is saved depends on the pixel. [In the first " +
        "peel](step=peel-0-discard&method=peel), choose a pixel at which the depth test threw " +
        "away three fragments or more, because another was nearer: look for green, and click.",
    ],
    source: "L. Rapetta, OpenGL 4.6 Deferred Renderer with Deferred Depth Peeling",
    async check() {
        if (!app.pixel)
            return { right: false, text: "No pixel is chosen." };
        const frame = await course.frame();
        const farther = course.at(frame, "peel.0.farther", app.pixel);
        if (farther === undefined)
            return { right: false, text: "This method does not count them: choose peel." };
        const number = course.value(farther, "peel.0.farther", "count");
        if (farther < 3)
            return { right: false, text: ["Here the depth test threw away ", number, ". Look " +
                "where several teapots are behind each other."] };
        return { right: true, text: ["Here it threw away ", number, ". Drawn from far to near, " +
            "each was the nearest for a while: lit as it was drawn, all of them were lit for " +
            "nothing, in this peel alone. Deferred, one fragment is."] };
    },
});

/* ---- 6: numbers ---- */

const LESSON_6_DUAL = " finds the nearest and the farthest in a buffer of its own, always of " +
    "32-bit floats: with those no two fragments of a pixel are equal here. The method peel-id " +
    "goes further: it would lose none even then, as it compares the triangles' numbers.";

/* Why an exact method loses none. */
const LESSON_6_REASONS = {
    "peel-id": "peel-id compares the number of the triangle where depths are equal, so that each " +
        "fragment has its place, and none is lost.",
    "dual": `dual${LESSON_6_DUAL}`,
    "forward-dual": `forward-dual${LESSON_6_DUAL}`,
    "linked-list": "linked-list keeps every fragment and takes none by a test, so none can be " +
        "lost. It sorts those of equal depth by the number of the triangle, as peel-id does.",
    "peel": "peel loses none here now, but only because no two depths are equal.",
    "forward": "forward loses none here now, but only because no two depths are equal.",
};

LESSONS.push({
    start: "step=peel-1-compare&pixel=none",
    text: [
        "In theory no two fragments have the same depth. In a computer, depths are stored with " +
        "so many bits: 32 bits as a floating-point number (d32f), or 24 or 16 bits as a whole " +
        "number of equal steps (d24, d16). With 16 bits there are 65,536 depths in all.",
        "Two fragments of a pixel that get the same number are a *tie*. The depth test takes one " +
        "of them. In the next peel the other is [not behind the previous " +
        "depth](step=peel-1-compare), so it is thrown away, and never seen again: one layer is " +
        "lost.",
        "The opposite fault is as bad: if the same surface had a slightly other depth in the " +
        "next pass, it would be peeled twice. So every pass must compute the same bits. That is " +
        "why this project compares bits: ref, the renderer in this page, with gl, a graphics " +
        "driver; and [both with the truth](step=truth), which sorts exactly and computes in " +
        "double precision.",
        "The accumulation has a *format* too. With 8 bits a channel every blend rounds to one of " +
        "256 steps: [set it to rgba8](step=display&accum=rgba8), compare the values at a pixel, " +
        "and [back to 32 bits](step=display&accum=rgba32f). In the live view, under More, all " +
        "formats can be changed.",
    ],
    question: [
        "[Open the depth format](view=live&focus=set-depth), set it to d16, and see, in the " +
        "live view's figures, that fragments are lost to ties. Then, with depths still in 16 " +
        "bits, lose none, and keep the image exact. (Two depths may be equal; what else does a " +
        "fragment have that no other has? Some [method](view=live&focus=set-method) may use it.)",
    ],
    source: "C. Everitt, 2001; Peel's own ref/pipeline/NUMBERS.md",
    async check() {
        const frame = await course.figures(), now = app.settings;
        const method = now.method.choices[now.method.value];
        const lost = course.value(frame.lost_to_ties, "frame.lost_to_ties", "count");
        if (now.depth.choices[now.depth.value] !== "d16")
            return { right: false, text: ["Depths are stored as ",
                now.depth.choices[now.depth.value], ", and ", lost,
                " fragments are lost to ties."] };
        if (!app.data.program.methods.find((one) => one.name === method).exact)
            return { right: false, text: [`${method} loses none, but it is an approximation: see ` +
                "how its image differs."] };
        if (frame.lost_to_ties > 0)
            return { right: false, text: ["With d16, ", lost, " fragments are lost to ties."] };
        return { right: true, text: LESSON_6_REASONS[method] };
    },
});
