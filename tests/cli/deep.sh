#!/bin/sh
# Deep EXR as other programs see it: oiiotool's flattening and ours agree with truth's flat image.
# Usage: deep.sh PEEL
set -u
peel=$1
. "$(dirname "$0")/checks.sh"

# agree WHAT A B: R, G, B, A of A within 1e-6 of B's, relative to max(1, value).
agree() {
    oiiotool "$2" "$3" --absdiff "$3" --maxc 1 --div --rangecheck 0,0,0,0 1e-6,1e-6,1e-6,1e-6 \
        >output 2>&1
    if grep -q '^ *0  *<' output && grep -q '^ *0  *>' output; then
        passed=$((passed + 1))
    else
        echo "FAIL $1: $2 and $3 differ by more than 1e-6: $(cat output)"
        failed=$((failed + 1))
    fi
}

# deep RENDERING ARGUMENT...: the flat image and the two flattened ones of one rendering.
deep() {
    rendering=$1
    shift
    exits 0 "$rendering: flat" "$peel" render "$@" --with truth --background 0,0,0 -o flat.exr
    exits 0 "$rendering: deep" "$peel" render "$@" --with truth --deep -o deep.exr
    exits 0 "$rendering: oiiotool" oiiotool deep.exr --flatten --ch R,G,B,A -d float -o theirs.exr
    exits 0 "$rendering: flatten" "$peel" flatten deep.exr -o ours.exr
    agree "$rendering: oiiotool" theirs.exr flat.exr
    agree "$rendering: flatten" ours.exr flat.exr
}

for scene in teapot_hall teapot_hall_stress tutorial chain crossing_planes alpha_ladder lamps; do
    deep $scene $scene --size 320x180 --lights 16
done
deep 'one pixel' tutorial --size 1x1
deep 'one column' chain --size 1x70
deep 'nothing transparent' teapot_hall --size 65x33 --opacity 1
deep 'nothing seen' crossing_planes --size 65x33 --opacity 0.00001
deep 'reversed depth, lequal' alpha_ladder --size 96x54 --depth-range reversed --depth-func lequal
deep 'one thread' alpha_ladder --size 96x54 --threads 1
mv deep.exr one.exr
deep 'three threads' alpha_ladder --size 96x54 --threads 3
exits 0 'the same file for any number of threads' cmp one.exr deep.exr
deep 'a background is no sample' alpha_ladder --size 96x54 --background 1,2,3
exits 0 'the same file over any background' cmp one.exr deep.exr

exits 0 'flatten' "$peel" flatten one.exr -o ours.png
cp output said
exits 0 'flatten says how much' \
    grep -q '^one.exr: 96x54 pixels, [0-9]* samples, 17 in one pixel$' said
exits 0 'flat PNG' "$peel" render alpha_ladder --size 96x54 --with truth --background 0,0,0 \
    -o flat.png
exits 0 'PNG: at most one step apart' idiff -q -fail 0.00393 -warn 0.00393 ours.png flat.png
exits 0 'oiiotool reads it' oiiotool --info -v --stats one.exr
cp output info
for pattern in '96 x   54, 8 channel, deep float/float/float/float/float/uint/uint/float' \
    'channel list: R (float), G (float), B (float), A (float), Z (float)' 'compression: "zips"' \
    'maxSamplesPerPixel: 17' 'worldToCamera' 'Stats NanCount: 0 0 0 0 0 0 0 0' \
    'Stats InfCount: 0 0 0 0 0 0 0 0'; do
    exits 0 "one.exr has '$pattern'" grep -q -- "$pattern" info
done
# Windows: a part of an image, and one that begins outside of what is shown.
for crop in 40x20+8+9 30x20-5-7; do
    exits 0 'a part of it' oiiotool one.exr --crop $crop -o part.exr
    exits 0 'a part of it, oiiotool' oiiotool part.exr --flatten --ch R,G,B,A -d float -o theirs.exr
    exits 0 'a part of it, flatten' "$peel" flatten part.exr -o ours.exr
    exits 0 'the same windows and pixels' "$peel" diff --fail 1e-6 --warn 1e-6 ours.exr theirs.exr
    oiiotool --info -v ours.exr | grep 'full/display\|origin' >windows
    oiiotool --info -v theirs.exr | grep 'full/display\|origin' >theirs
    exits 0 'the same windows' cmp windows theirs
    exits 0 'windows' test -s windows
done
exits 0 'help' "$peel" flatten --help
exits 0 'nothing else is left' test "$(find . -name '.peel-*')" = ''

echo "$passed passed, $failed failed"
[ $failed = 0 ]
