#!/bin/sh
# Scene files are loaded in a child process: its limits, its end and its parent's.
# Usage: loading.sh PEEL SOURCE_DIR
set -u
peel=$1
. "$2/tests/cli/checks.sh"

# A file of 10 KB that holds 8192x8192 pixels: 1 GiB of texels.
node -e '
    const zlib = require("zlib"), fs = require("fs");
    const word = (n) => { const b = Buffer.alloc(4); b.writeUInt32BE(n); return b; };
    const table = [...Array(256)].map((_, n) => {
        for (let k = 0; k < 8; k++) n = n & 1 ? 0xedb88320 ^ (n >>> 1) : n >>> 1;
        return n;
    });
    const crc = (b) => ~b.reduce((c, x) => table[(c ^ x) & 255] ^ (c >>> 8), -1) >>> 0;
    const chunk = (type, data) => {
        const body = Buffer.concat([Buffer.from(type), data]);
        return Buffer.concat([word(data.length), body, word(crc(body))]);
    };
    const side = 8192, head = Buffer.concat([word(side), word(side), Buffer.from([1, 0, 0, 0, 0])]);
    fs.writeFileSync("large.png", Buffer.concat([Buffer.from("89504e470d0a1a0a", "hex"),
        chunk("IHDR", head), chunk("IDAT", zlib.deflateSync(Buffer.alloc(side * (side / 8 + 1)))),
        chunk("IEND", Buffer.alloc(0))]));
    const gltf = { asset: { version: "2.0" }, scenes: [{ nodes: [0] }], nodes: [{ mesh: 0 }],
        buffers: [{ byteLength: 36, uri: "data:;base64," + Buffer.alloc(36).toString("base64") }],
        bufferViews: [{ buffer: 0, byteLength: 36 }],
        accessors: [{ bufferView: 0, componentType: 5126, count: 3, type: "VEC3" }],
        meshes: [{ primitives: [{ attributes: { POSITION: 0 }, material: 0 }] }],
        materials: [{ pbrMetallicRoughness: { baseColorTexture: { index: 0 } } }],
        textures: [{ source: 0 }], images: [{ uri: "large.png" }] };
    fs.writeFileSync("large.gltf", JSON.stringify(gltf));
'
check 'the file is small' test "$(wc -c <large.png)" -lt 20000

# refused WHAT LINE: output is that line alone, and no image is left.
refused() {
    check "$1: one line" test "$(wc -l <output)" = 1
    has "$1" "^peel: $2\$"
    check "$1: no image" test ! -e out.png
}

exits 4 'more memory than a file of its size may take' "$peel" render large.gltf --size 8x8 -o out.png
refused 'more memory than a file of its size may take' \
    'large.gltf: loading it takes more memory than 10[0-9]* MiB (--max-memory), or than there is'
exits 4 '--max-memory' "$peel" render "$2/data/scenes/chain.gltf" --max-memory 1M -o out.png
refused '--max-memory' '.*/chain.gltf: loading it takes more memory than 1 MiB (--max-memory), or than there is'

# start: peel, in the background, while it loads: `process` and its `child`. A shell has such programs
# ignore SIGINT.
start() {
    env --default-signal=INT "$peel" render large.gltf --size 8x8 -o out.png >output 2>&1 &
    process=$!
    child=
    tries=0
    until [ -n "$child" ] || [ $tries -gt 1000 ]; do
        child=$(cat /proc/$process/task/$process/children 2>/dev/null)
        child=${child%% *}
        tries=$((tries + 1))
    done
    check 'a child is seen' test -n "$child"
}

gone() {
    for _ in 1 2 3 4 5 6 7 8 9 10; do
        case $(cat "/proc/$1/stat" 2>/dev/null) in '' | *') Z '*) return 0 ;; esac
        sleep 0.2
    done
    return 1
}

start
kill -SEGV "$child"
wait $process 2>/dev/null
check 'the child crashes: exit 4' test $? = 4
refused 'the child crashes' \
    'large.gltf: cannot load: the library that reads it ended by signal 11 (Segmentation fault); of memory it may take [0-9]* MiB (--max-memory)'

for signal in INT TERM KILL; do
    start
    kill -$signal $process
    wait $process 2>/dev/null
    check "$signal: it ends the program" test $? -gt 128
    check "$signal: and its child" gone "$child"
done

echo "$passed passed, $failed failed"
[ $failed = 0 ]
