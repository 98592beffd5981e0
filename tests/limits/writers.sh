# shellcheck shell=sh disable=SC2154 # peel is the reader's
# For the scripts beside it, which read it first, in a scratch folder, with $peel: every command
# that writes, and what it may leave behind.

# inputs: what the commands below read.
inputs() {
    "$peel" render tutorial --size 8x8 -o a.png >/dev/null &&
        "$peel" render tutorial --size 8x8 --passes 1 -o b.png >/dev/null &&
        "$peel" render tutorial --size 8x8 -o a.exr >/dev/null &&
        "$peel" render tutorial --size 8x8 --passes 1 -o b.exr >/dev/null &&
        "$peel" render tutorial --size 32x32 --with truth --deep -o deep.exr >/dev/null &&
        "$peel" render tutorial --size 8x8 --passes 1 --trace b_trace.exr >/dev/null &&
        "$peel" render tutorial --size 8x8 --passes 2 --trace a_trace.exr >/dev/null &&
        "$peel" blend vectors --set random --count 500 -o vectors.csv
}

# each FUNCTION: calls it with the arguments of each command, for a folder below the inputs.
each() {
    $1 render tutorial --size 64x64 -o out.png
    $1 render tutorial --size 32x32 -o out.exr
    $1 render tutorial --size 32x32 --with truth --deep -o out.exr
    $1 render tutorial --size 32x32 --passes 1 --trace out.exr
    $1 compare tutorial --size 16x16 --json out.json
    $1 compare tutorial --size 16x16 --passes 2 --classes out.png --report out
    $1 check tutorial ../a.png --size 8x8 --json out.json --report out
    $1 diagnose tutorial ../b.png --size 8x8 --json out.json --report out
    $1 diff ../a.png ../b.png -o out.png --json out.json
    $1 diff ../a.exr ../b.exr -o out.exr
    $1 diff ../a_trace.exr ../b_trace.exr --json out.json
    $1 explain tutorial --size 16x16 -o out
    $1 explain tutorial --size 16x16 --pixel 4,4 --json out.json
    $1 flatten ../deep.exr -o out.exr
    $1 flatten ../deep.exr -o out.png
    $1 plan tutorial --size 16x16 --json out.json
    $1 scenes tutorial -o out.gltf
    $1 scenes tutorial -o out.glb
    $1 scenes tutorial --export out --size 16x16
    $1 scenes --contract -o out.html
    $1 hard --export out
    $1 blend vectors --set random --count 500 -o out.csv
    $1 blend vectors --set random --count 500 -o out.jsonl
    $1 blend vectors --set random --count 500 -o out.bin
    $1 blend eval --format rgba8 '#ff000080' '#00ff0080' --json out.json
    $1 blend check ../vectors.csv --json out.json
    $1 blend check --gl --format rgba8 --equation under --limit 20 --json out.json
}

# each_slow FUNCTION: those that take a second or more.
each_slow() {
    $1 bench tutorial --size 8x8 --runs 1 --passes 1,2 --json out.json --report out
    $1 compare tutorial --size 8x8 --tolerance 1 --method all --report out
    $1 driver --json out.json
    $1 explain --course -o out
}

# Complete, and the same where no times are in it.
is_same() {
    case $1 in
    *.json) [ "$(tail -c 2 "$1")" = '}' ] ;;
    *.html) tail -c 20 "$1" | grep -q '</html>' ;;
    *.svg) tail -c 20 "$1" | grep -q '</svg>' ;;
    *) cmp -s "$1" "$2" ;;
    esac
}

# leftovers GOT WHOLE: prints the files of folder GOT that are not as in WHOLE.
leftovers() {
    (cd "$1" && find . -type f) | while read -r file; do
        if ! [ -f "$2/$file" ] || ! is_same "$1/$file" "$2/$file"; then
            echo "$file"
        fi
    done
}
