#!/bin/sh
# The largest that Peel takes: images, layers, lights, triangles, memory as it was stated, and what
# it refuses at once. Usage: LIMITS=FOLDER limits.sh PEEL SOURCE_DIR [all]
# FOLDER: of the programs many and limited. all: also what takes minutes and 6 GiB.
set -u
peel=$1
source=$2
all=${3-}
many=$LIMITS/many
limited=$LIMITS/limited
. "$source/tests/cli/checks.sh"

# refuses WHAT PATTERN ARGUMENT...: exit 4 and one line with PATTERN, before any work.
refuses() {
    what=$1
    pattern=$2
    shift 2
    text=$(timeout 20 "$peel" "$@" 2>&1 >/dev/null)
    code=$?
    check "$what: exit $code, expected 4" test $code = 4
    check "$what: '$text', expected '$pattern'" expr "$text" : ".*$pattern" >output
    check "$what: one line" test "$(printf '%s\n' "$text" | wc -l)" = 1
}

# rendered WHAT ARGUMENT...: by peel render, which exits with 0; sets held, in KiB.
rendered() {
    what=$1
    shift
    exits 0 "$what" "$limited" record 0 0 "$peel" render "$@"
    held=$(sed 's/.* //' record)
}

# measured ARGUMENT...: rendered; sets stated, too, in KiB.
measured() {
    rendered "peel $*" "$@"
    stated=$(sed -n 's/.*, \([0-9]*\)[.][0-9]* MiB$/\1/p' output)
    stated=$((${stated:-0} * 1024))
}

# within ARGUMENT...: what was stated is enough, beside what the program has of its own, and not
# half as much again.
within() {
    measured "$@"
    echo "$stated KiB stated, $held KiB held: peel render $*"
    check "what is held is stated: $*" test "$held" -le $((stated + stated / 50 + own))
    check "what is stated is needed: $*" test "$stated" -le $((held * 3 / 2))
}

sizes() {
    refuses 'a side too long' 'from 1 to 16384' render tutorial --size 16385x1 -o a.png
    for with in ref truth gl; do
        refuses "the largest image, $with" 'KiB, the limit is 4194304 KiB (--max-memory)' render \
            tutorial --size 16384x16384 --with $with -o a.png
    done
    for size in 1x16384 16384x1; do
        for with in ref gl truth; do
            exits 0 "$size, $with" "$peel" render tutorial --lights 1 --size $size --with $with \
                -o $with.exr
        done
        check "$size: the same bits" cmp ref.exr gl.exr
    done
    measured tutorial --lights 1 --size 8x8 -o a.png
    own=$((held - stated + 4096))
    within tutorial --lights 1 --size 1024x1024 -o a.png
    within tutorial --lights 1 --size 1024x1024 -o a.exr
    within tutorial --lights 1 --size 1024x1024 --with truth -o a.png
    within tutorial --lights 1 --size 1024x1024 --with truth --deep -o a.exr
}

many_layers() {
    "$many" layers "$1" layers.glb
    for with in $2; do
        exits 0 "$1 layers, $with" "$peel" render layers.glb --size 6x6 --with "$with" -o "$with.exr"
        has "$1 layers, $with" ", $3 peels" output
    done
}

layers() {
    many_layers 4096 'ref truth' 4096
    exits 0 'the same images' "$peel" diff ref.exr truth.exr --fail 1e-4 --warn 1e-4
    exits 4 'more passes' "$peel" render layers.glb --passes 4097 -o a.png
    many_layers 4100 'ref' 4096
    has 'more layers' 'in front of [0-9]* fragments' output
    many_layers 4100 'truth' 4100
}

lights() {
    "$many" lights 10000 lights.glb
    for with in ref gl; do
        exits 0 "10,000 lights, $with" "$peel" render lights.glb --size 16x16 --with $with \
            -o $with.exr
    done
    check '10,000 lights: the same bits' cmp ref.exr gl.exr
    refuses 'too many lights' 'from 0 to 1048576' render tutorial --lights 1048577 -o a.png
}

# Each method with as many layers, its definition in ref against gl.
all_layers() {
    many_layers 4096 'ref' 4096
    "$peel" methods | sed -n 's/^\([a-z][-a-z]*\) .*/\1/p' >names
    while read -r method; do
        for with in ref gl; do
            exits 0 "4,096 layers, $method, $with" "$peel" render layers.glb --size 6x6 \
                --method "$method" --with $with -o $with.exr
        done
        check "4,096 layers, $method: the same bits" cmp ref.exr gl.exr
    done <names
}

triangles() {
    "$many" triangles 10000000 triangles.glb
    for with in ref gl truth; do
        rendered "10,000,000 triangles, $with" triangles.glb --size 256x256 --with $with \
            -o $with.exr
        echo "10,000,000 triangles, $with: $held KiB held"
    done
    check '10,000,000 triangles: the same bits' cmp ref.exr gl.exr
    refuses 'triangles beyond the memory' 'max-memory' render triangles.glb --size 8x8 \
        --max-memory 100M -o a.png
}

largest() {
    refuses 'the largest image, gl' '16384×16384: the driver refuses' render tutorial --with gl \
        --size 16384x16384 --max-memory 100G -o a.png
    within tutorial --lights 1 --size 16384x16384 --max-memory 6G -o a.png
    within tutorial --lights 1 --size 16384x16384 --max-memory 6G -o a.exr
    rm -f a.exr
    within tutorial --lights 1 --size 16384x16384 --max-memory 6G --with truth -o a.png
}

sizes
layers
lights
if [ -n "$all" ]; then
    all_layers
    triangles
    largest
fi

echo "$passed passed, $failed failed"
[ $failed = 0 ]
