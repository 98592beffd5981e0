#!/bin/sh
# What the commands write, read by other programs, and their exit codes.
# Usage: outputs.sh PEEL SOURCE_DIR
set -u
peel=$1
source=$2
. "$(dirname "$0")/checks.sh"

# expect WHAT COMMAND...: the command succeeds.
expect() {
    what=$1
    shift
    if "$@" >log 2>&1; then
        passed=$((passed + 1))
    else
        echo "FAIL $what: $*: exit $?"
        tail -5 log
        failed=$((failed + 1))
    fi
}

has() {
    expect "$1 has '$3'" grep -q -- "$3" "$2"
}

for scene in teapot_hall teapot_hall_stress tutorial chain crossing_planes alpha_ladder lamps; do
    expect "scenes $scene" "$peel" scenes $scene -o $scene.gltf
    expect "data/scenes/$scene.gltf is what 'peel scenes' writes" \
        cmp $scene.gltf "$source/data/scenes/$scene.gltf"
    exits 0 "compare $scene" "$peel" compare $scene.gltf --size 96x54 --lights 16
done

expect 'png' "$peel" render chain.gltf --size 100x60 -o a.png
expect 'exr' "$peel" render chain.gltf --size 100x60 -o a.exr
expect 'gl exr' "$peel" render chain.gltf --size 100x60 -o b.exr --with gl
expect 'truth exr' "$peel" render chain.gltf --size 100x60 -o c.exr --with truth
expect 'ref and gl: the same file content' idiff -q a.exr b.exr
exits 0 'ref and truth: close' idiff -q -fail 1e-3 -warn 1e-3 a.exr c.exr
oiiotool --info -v a.exr >info
has 'EXR' info '100 x   60, 4 channel, float'
oiiotool --info -v a.png >info
has 'PNG' info '100 x   60, 3 channel, uint8'

expect 'trace' "$peel" render chain.gltf --size 100x60 --passes 2 --trace t.exr
oiiotool --info -v -a t.exr >info
for name in opaque.depth opaque.normal opaque.position opaque.diffuse opaque.material \
    peel.0.depth peel.0.accum peel.1.normal peel.1.material peel.1.accum accum display; do
    has 'trace' info "\"$name\""
done
has 'trace' info 'peel:format: "rgba8"'

# The file that standard output goes to keeps what was written to it, and no two outputs are one file.
echo before >log.txt
"$peel" blend vectors --count 1 -o /dev/stdout >>log.txt
expect 'appended' test "$(head -1 log.txt)" = before
has 'appended' log.txt '^# end: 1 '
"$peel" compare chain.gltf --size 9x9 --json /dev/fd/1 >log.txt
has 'table and JSON' log.txt '^AGREE'
has 'table and JSON' log.txt '"agree"'
# shellcheck disable=SC2016 # the inner shell's
exits 4 'a trace into it' sh -c '"$0" render chain.gltf --size 9x9 --trace /dev/fd/1 >t.exr' "$peel"
ln -s a.exr link.exr
mkdir report
for outputs in "render chain.gltf --size 9x9 -o a.exr --trace ./a.exr" \
    "render chain.gltf --size 9x9 -o a.exr --trace link.exr" \
    "compare chain.gltf --size 9x9 --budget --json one.png --classes $PWD/one.png" \
    "compare chain.gltf --size 9x9 --report report --json report/index.html" \
    "diff a.exr b.exr -o one.png --json one.png"; do
    # shellcheck disable=SC2086 # a list of words
    exits 4 'two outputs' "$peel" $outputs
    has 'two outputs' output 'two outputs in one file'
done
cp chain.gltf mine.gltf
cp a.exr mine.exr
for clash in 'compare mine.gltf --size 9x9 --json mine.gltf' 'diff a.exr mine.exr -o ./mine.exr' \
    'check chain.gltf mine.exr --size 9x9 --json mine.exr'; do
    # shellcheck disable=SC2086 # a list of words
    exits 4 'an output that is an input' "$peel" $clash
    has 'an output that is an input' output 'an input, expected another name'
done
cmp chain.gltf mine.gltf && cmp a.exr mine.exr
expect 'inputs stay' test $? = 0
"$peel" diff a.exr a.exr --json mine.json >output
chmod 600 mine.json
"$peel" diff a.exr a.exr --json mine.json >output
expect 'rights stay' test "$(stat -c %a mine.json)" = 600
for list in 'hard --list --json a.json' 'hard fan --export hard --report hard' \
    'diagnose --list --json a.json' 'blend vectors --list -o a.csv' \
    'blend check log.txt --seed 4'; do
    # shellcheck disable=SC2086 # a list of words
    exits 4 'what would be left out' "$peel" $list
done

ln -s to_come.exr linked.exr
exits 4 'two outputs by a link' "$peel" render chain.gltf --size 33x17 -o to_come.exr --trace linked.exr
exits 4 'a picture of the report' "$peel" compare chain.gltf --size 33x17 --report pictures \
    --json pictures/ref.png
expect 'said' grep -q 'pictures/ref.png: two outputs in one file' output
exits 0 'glb' "$peel" scenes chain -o chain.glb
exits 0 'compare glb' "$peel" compare chain.glb --size 64x36
exits 2 'a tolerance that nothing meets' "$peel" compare chain.gltf --size 64x36 --tolerance 0
exits 0 'the seed profile with room' "$peel" compare chain.gltf --size 64x36 --profile seed \
    --tolerance 1
exits 0 'unfused' "$peel" compare chain.gltf --size 64x36 --fma off
has 'unfused' output 'separate'
for choice in '--depth d24' '--depth d16' '--accum rgba16f' '--accum rgba16' '--accum rgba8' \
    '--gbuffer seed' '--peel-test raw' '--depth-func lequal' \
    '--depth-range zero-one' '--depth-range reversed' '--depth-range reversed --depth d24' \
    '--cull none' '--cull seed' '--normals kept' '--profile seed --accum rgba8' \
    '--ggx stable' '--back-light on' '--profile seed --ggx stable --back-light on --fma off' \
    '--fma off --depth d16 --accum rgba16f'; do
    # shellcheck disable=SC2086 # words
    exits 0 "compare $choice" "$peel" compare tutorial --size 64x36 --tolerance 1 $choice
done
exits 2 'the raw test with 16 bits repeats layers and loses others' \
    "$peel" compare tutorial --size 64x36 --tolerance 1 --peel-test raw --depth d16
"$peel" methods | sed -n 's/^\([a-z][-a-z]*\) .*/\1/p' >rows
expect 'methods' test "$(wc -l <rows)" = 10
# The one with 8-bit materials differs more from truth: those behind it must be there all the same.
exits 2 'every method' "$peel" compare chain.gltf --size 33x17 --lights 1 --method all \
    --tolerance 1e-4 --json all.json
exits 0 'every method, with room' "$peel" compare chain.gltf --size 33x17 --lights 1 --method all \
    --tolerance 1 --sort triangles --weight 7 --nodes-per-pixel 40 --post edges --bias 0.0001 \
    --shading phong
while read -r method; do
    has 'every method' output "^$method "
    has 'JSON of every method' all.json "\"method\": \"$method\""
    expect "trace of $method" "$peel" render chain.gltf --size 33x17 --lights 1 --passes 1 \
        --method "$method" --trace "$method.exr"
    oiiotool --info -v -a "$method.exr" >info
    case $method in
    peel) names='peel.0.normal peel.0.accum' ;;
    peel-id | linked-list) names='peel.0.id peel.0.accum' ;;
    forward) names='opaque.color peel.0.color peel.0.accum' ;;
    dual) names='dual.first.depth dual.0.depth dual.0.front_normal dual.0.back_material
        dual.0.back_accum peel.0.accum' ;;
    forward-dual) names='forward-dual.first.depth forward-dual.0.depth forward-dual.0.front
        forward-dual.0.back forward-dual.0.back_accum' ;;
    weighted-average) names="$method.sum $method.count" ;;
    weighted-sum) names=$method.sum ;;
    weighted-blended) names="$method.sum $method.product" ;;
    painter) names=painter.layers ;;
    *) names='no names are known here' ;;
    esac
    for name in opaque.depth $names accum display; do
        has "trace of $method" info "\"$name\""
    done
done <rows

exits 0 'report and JSON' "$peel" compare chain.gltf --size 64x36 --passes 1 --json j.json \
    --report report/of/this
has 'the pass limit' output 'passes ended first'
exits 0 'outlines, which truth has not' "$peel" compare chain.gltf --size 48x32 \
    --method linked-list --post edges
has 'outlines' output 'linked-list draws outlines, which truth has not, so it is not judged'
has 'JSON' j.json '"lost_to_pass_limit"'
has 'JSON' j.json '"residual"'
expect 'report' test -s report/of/this/index.html
has 'report' report/of/this/index.html 'peel compare chain.gltf --size 64x36 --passes 1'
exits 0 'all methods, report and JSON' "$peel" compare chain.gltf --size 64x36 --method all \
    --tolerance 1 --json all.json --report methods/of/this
has 'JSON of all methods' all.json '"agree": true'
has 'report of all methods' methods/of/this/index.html \
    'peel compare chain.gltf --size 64x36 --method all'
while read -r name; do
    has 'JSON of all methods' all.json "\"method\": \"$name\""
    has 'report of all methods' methods/of/this/index.html "<h3><a href=\"$name/index.html\">"
    has 'report of a method' "methods/of/this/$name/index.html" 'href="../index.html"'
done <rows
for page in methods/of/this/index.html methods/of/this/*/index.html; do
    grep -o -E '(src|href)="[^"]*"' "$page" | cut -d '"' -f 2 | sort -u >links
    while read -r link; do
        expect "a file that $page names" test -s "${page%/*}/$link"
    done <links
done
exits 2 'all methods, a tolerance that nothing meets' "$peel" compare chain.gltf --size 64x36 --method all \
    --tolerance 1e-30 --json all.json --report methods/of/this
has 'every method, also after one that differs' all.json '"method": "painter"'
has 'every method, also after one that differs' methods/of/this/index.html '[0-9] of [0-9]* methods differ'
exits 0 'error budget' "$peel" compare chain.gltf --size 64x36 --profile seed --tolerance 1 \
    --json budget.json --report budget --classes classes.png
has 'the classes' output '^gbuffer .*#66c278'
has 'the terms' budget.json '"gbuffer": {'
has 'the classes in JSON' budget.json '"opaque_flip"'
expect 'the picture of classes' test -s classes.png
expect 'the same on the page' cmp classes.png budget/classes.png
has 'the section' budget/index.html 'Where the error comes from'
exits 4 'error budget of all methods' "$peel" compare chain.gltf --size 8x8 --method all --budget
exits 0 '1x1' "$peel" compare chain.gltf --size 1x1
exits 0 'no lights' "$peel" compare chain.gltf --size 33x17 --lights 0
exits 0 'all opaque' "$peel" compare chain.gltf --size 33x17 --opacity 1
exits 0 'all nearly gone' "$peel" compare chain.gltf --size 33x17 --opacity 0.00001
exits 0 'background' "$peel" compare chain.gltf --size 33x17 --background 0.2,0.5,1
exits 0 'time' "$peel" compare teapot_hall.gltf --size 33x17 --time 3.5
exits 0 'help' "$peel" --help
exits 0 'help of a command' "$peel" compare --help
has 'help of a command' output '--tolerance'
cp output help.txt
exits 0 'help, whatever its layout is to be' env ARGP_HELP_FMT=rmargin=1 timeout 20 "$peel" compare --help
expect 'the same help' cmp help.txt output
exits 0 'options behind arguments' env POSIXLY_CORRECT=1 "$peel" compare chain.gltf --size 1x1
exits 0 'version' "$peel" --version

engine=/usr/share/assimp/models/glTF2/2CylinderEngine-glTF-Binary/2CylinderEngine.glb
exits 0 'a real scene' "$peel" compare $engine --opacity 0.3 --size 192x108 --cull none

echo "$passed passed, $failed failed"
[ $failed = 0 ]
