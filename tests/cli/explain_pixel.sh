#!/bin/sh
# peel explain --pixel: its blend steps replayed from the printed numbers, its text, what it
# refuses. REPLAY: the program that replays.
set -eu
peel=$1
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
cd "$directory"

fail() {
    echo "$*" >&2
    exit 1
}

# ---- 1,000 random pixels of each scene; the methods share them ----
seed=1
for scene in tutorial crossing_planes teapot_hall; do
    for settings in "peel rgba32f 150" "peel rgba8 150" "peel rgba16 150" "peel rgba16f 150" \
        "peel-id rgba32f 60" "forward rgba16f 60" "dual rgba32f 60" "dual rgba8 40" \
        "forward-dual rgba32f 30" "linked-list rgba16 60" "painter rgba32f 60" \
        "weighted-average rgba32f 20" "weighted-sum rgba16f 20" "weighted-blended rgba8 40"; do
        # shellcheck disable=SC2086 # three words
        set -- $settings
        # shellcheck disable=SC2046 # as many words as pixels
        "$peel" explain "$scene" --renderers ref --size 192x108 --method "$1" --accum "$2" \
            $("$REPLAY" pixels "$3" "$seed" 192 108) --json histories.json
        "$REPLAY" check "$scene" "$1" "$2" 192 108 histories.json >> replayed.txt ||
            fail "$scene, $settings: $(tail -3 replayed.txt)"
        seed=$((seed + 1))
    done
done
awk '{ pixels += $1; steps += $3 } END { exit !(pixels >= 3000 && steps > pixels) }' replayed.txt ||
    fail "too little was replayed"

# ---- gl and truth ----
for method in peel peel-id forward dual forward-dual linked-list painter weighted-average \
    weighted-blended; do
    for accum in rgba32f rgba8; do
        # shellcheck disable=SC2046 # as many words as pixels
        "$peel" explain tutorial --size 96x54 --method $method --accum $accum \
            $("$REPLAY" pixels 30 "$seed" 96 54) --json sides.json
        "$REPLAY" sides sides.json > said.txt || fail "$method, $accum: $(tail -3 said.txt)"
        seed=$((seed + 1))
    done
done

# ---- the contract's keys ----
"$peel" explain tutorial --size 64x36 --pixel 32,18 --json one.json
for key in '"ref":{"pixel":\[32,18\]' '"gl":' '"truth":' '"fragments":\[{"primitive":' '"depth":"0x' \
    '"fate":"peeled","peel":0' '"blend":\[{"step":' '"source":\["0x' '"before":\["' '"after":\["' \
    '"accum":\["'; do
    grep -q "$key" one.json || fail "no $key in the JSON"
done
"$peel" explain tutorial --size 64x36 --pixel 32,18 --json /dev/stdout | cmp - one.json

# ---- text: width, colour ----
COLUMNS=80 "$peel" explain tutorial --size 64x36 --pixel 32,18 > narrow.txt
COLUMNS=200 "$peel" explain tutorial --size 64x36 --pixel 32,18 > wide.txt
awk 'length > 80 { print; bad = 1 } END { exit bad }' narrow.txt || fail "wider than 80 columns"
awk 'length > most { most = length } END { exit !(most > 100 && most <= 200) }' wide.txt ||
    fail "200 columns are not used, or not kept"
if grep -q "$(printf '\033')" narrow.txt; then
    fail "colour in a file"
fi
head -1 narrow.txt | grep -q ": [0-9]* layers" || fail "no summary in the first line"
grep -q "gl: the same steps" narrow.txt || fail "gl differs"

# ---- what is refused, in one line ----
refused() {
    code=0
    "$peel" explain "$@" > out.txt 2> err.txt || code=$?
    if [ "$code" != 4 ] || [ "$(wc -l < err.txt)" != 1 ] || [ -s out.txt ]; then
        fail "explain $*: exit $code: $(cat err.txt)"
    fi
}
refused tutorial --size 64x36 --pixel 64,0
refused tutorial --size 64x36 --pixel 0,36
refused tutorial --size 64x36 --pixel -1,0
refused tutorial --pixel 1
refused tutorial --pixel 1,2,3
refused tutorial --pixel 1,x
refused tutorial --pixel 99999999999,0
refused tutorial --size 64x36 --pixel 4294967297,0
refused tutorial --pixel 1,1 --renderers ref,none
refused tutorial --pixel 1,1 --method all
refused tutorial --pixel 1,1 --json /no/such/directory/file.json
refused no_such_scene --pixel 1,1
refused --pixel 1,1
