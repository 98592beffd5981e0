#!/bin/sh
# peel explain -o: its page stands alone and its pipeline has the program's bits.
# Usage: explain.sh PEEL SOURCE_DIR
set -u
peel=$1
source=$2
. "$(dirname "$0")/checks.sh"

# page WHAT GL ARGUMENT...: a page whose bits are right, and of which gl says GL.
page() {
    name=$1
    gl=$2
    shift 2
    exits 0 "$name" "$peel" explain "$@" -o out
    exits 0 "$name: bits" node "$source/tests/cli/explain.js" "$source" out/index.html
    cp output said
    exits 0 "$name: gl $gl" grep -q "gl $gl" said
}

# refused WHAT PATTERN ARGUMENT...: exit 4 and one line that has PATTERN.
refused() {
    name=$1
    pattern=$2
    shift 2
    exits 4 "$name" "$peel" explain "$@"
    grep '^peel: ' output >said
    exits 0 "$name: one line" test "$(wc -l <said)" -eq 1
    exits 0 "$name: '$pattern'" grep -q -- "$pattern" said
}

for scene in tutorial teapot_hall alpha_ladder; do
    page $scene 0 $scene --size 64x36
done
page 'seed profile' 0 chain --size 64x36 --profile seed
page 'other settings' 0 lamps --size 64x36 --accum rgba8 --depth d24 --gbuffer compact \
    --depth-range reversed --method peel-id --lights 3 --draw-order shuffle=7 --time 2.5 --camera 0
page 'dual' 0 tutorial --size 33x17 --method dual --passes 2
page 'one pixel, no lights' 0 tutorial --size 1x1 --lights 0
page 'nothing transparent' 0 crossing_planes --size 64x36 --opacity 1
page 'without fusing' 0 tutorial --size 64x36 --fma off
GALLIUM_DRIVER=nosuch page 'no GL' 'GALLIUM_DRIVER' tutorial --size 64x36
GALLIUM_DRIVER=nosuch page 'no GL, fused' 'GALLIUM_DRIVER' tutorial --size 64x36 --fma on

exits 0 'default size' "$peel" explain tutorial -o out
cp output said
exits 0 'default size' grep -q '"size":\[320,180\]' out/index.html
exits 0 'the place is printed' grep -q '^out/index.html$' said
exits 0 'one file' test "$(ls out)" = index.html
# A namespace is no address.
sed 's|http://www.w3.org/2000/svg||g' out/index.html >plain.html
exits 1 'no network' grep -qE '(src|href)="|https?://|@import|url\(' plain.html
"$peel" scenes chain -o "it's <script>&.gltf" >output 2>&1
exits 0 'a name with markup' "$peel" explain "it's <script>&.gltf" -o "<b>" --size 8x8
exits 0 'a name with markup: bits' node "$source/tests/cli/explain.js" "$source" "<b>/index.html"
exits 0 'a name with markup: title' grep -q '<title>it&#39;s &lt;script&gt;&amp;' "<b>/index.html"

refused 'no output' '-o DIR' tutorial
refused 'a course of no folder' '-o DIR' --course
refused 'a course of a scene' 'built in' --course tutorial -o course
refused 'a course below a file' 'out/index.html' --course -o out/index.html/sub
refused 'no scene' 'scene' -o out
refused 'all methods' '--method all' tutorial -o out --method all
refused 'below a file' 'out/index.html' tutorial -o out/index.html/sub
refused 'more than a browser can keep' 'a smaller --size' alpha_ladder --size 960x720 \
    -o large
exits 1 'nothing is left of it' test -e large/index.html

echo "$passed passed, $failed failed"
test $failed -eq 0
