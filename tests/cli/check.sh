#!/bin/sh
# peel check: images and passes of others, right, wrong and unreadable; the contract for producers,
# and a renderer that has nothing else. PEEL_FOREIGN: the folder of its programs.
# Usage: check.sh PEEL SOURCE_DIR
# shellcheck disable=SC2086 # $options and $extra are several words
set -u
peel=$1
source=$2
foreign=${PEEL_FOREIGN:-$(dirname "$peel")/tests}
. "$(dirname "$0")/checks.sh"

one_line() {
    if [ "$(wc -l <output)" -eq 1 ]; then
        passed=$((passed + 1))
    else
        echo "FAIL $1: more than one line"
        cat output
        failed=$((failed + 1))
    fi
}

options='--size 96x54 --lights 8 --background 0.2,0.3,0.4'
scene=$source/data/scenes/tutorial.gltf
check() {
    code=$1
    shift
    exits "$code" "check $*" "$peel" check "$scene" $options "$@"
}
render() {
    "$peel" render "$scene" $options "$@" >log 2>&1 || echo "FAIL render $*"
}

# The right image, in every form.
render -o right.png
render -o right.exr
render -o truth.exr --with truth
render --trace right_trace.exr --with gl
check 0 right.png
has 'png' '8-bit PNG, display-encoded (seed), rows from the top, no alpha'
has 'png' ' identical$'
check 0 right.exr
has 'exr' '32-bit float EXR, linear, rows from the top, alpha is coverage'
has 'exr' ' identical$'
check 0 truth.exr
check 0 truth.exr --bound
check 0 right_trace.exr
check 0 right_trace.exr --bound
check 4 right_trace.exr --flip
one_line 'a trace that means something else'
check 2 truth.exr --tolerance 0
oiiotool right.exr -d half -o half.exr
check 0 half.exr
has 'half' '16-bit float EXR'
oiiotool right.exr --flip -o flipped.exr
check 0 flipped.exr
has 'flipped' 'rows from the bottom'
check 0 flipped.exr --flip
check 2 flipped.exr --no-flip
oiiotool right.exr --ch R,G,B -o rgb.exr
check 0 rgb.exr
has 'RGB' 'no alpha'
oiiotool right.exr --ch R,G,B -d uint8 -o linear8.png
check 0 linear8.png
has 'linear PNG' '8-bit PNG, linear'
check 2 linear8.png --encoding seed
oiiotool right.exr --ch R,G,B --colorconvert linear sRGB -d uint16 -o srgb16.png
check 0 srgb16.png
has 'sRGB PNG' '16-bit PNG, sRGB'
oiiotool right.exr --ch A --mulc -1 --addc 1 -o t.exr
oiiotool right.exr --ch R,G,B t.exr --chappend --chnames R,G,B,A -o transmittance.exr
check 0 transmittance.exr
has 'transmittance' 'alpha is transmittance'
check 2 transmittance.exr --alpha coverage
check 0 transmittance.exr --alpha none

# Wrong ones.
render -o short.png --passes 1
check 2 short.png
has 'short' '^DIFFER'
render --trace short_trace.exr --passes 2
check 2 short_trace.exr --json short.json
has 'short trace' 'first step that differs: peel.2'
json_holds 'short trace' short.json "d.verdict === 'differs' && d.first === 'peel.2'"
step='((name) => d.steps.find((step) => step.name === name))'
json_holds 'a step before' short.json "$step('peel.1.accum').agree
    && $step('peel.1.accum').equal === 96 * 54"
json_holds 'the last step' short.json "!$step('accum').agree
    && /^0x[01][.p]/.test($step('accum').worst.theirs_hex)"
render --trace biased.exr --bias 1e-3
check 2 biased.exr
has 'biased' 'first step that differs: peel.1.depth'
has 'biased' 'peel.1.depth: worst pixel (.*theirs .*(0x.*reference .*(0x.*apart'
render -o other_lights.png --lights 1
check 2 other_lights.png
exits 0 'another scene' "$peel" render teapot_hall $options -o other.exr
check 2 other.exr
has 'another scene' 'hardly resembles the reference'
oiiotool right.exr --mulc nan -o nan.exr
check 2 nan.exr
has 'NaN' 'every pixel is NaN or infinite'
oiiotool right.exr --origin +10+10 -o shifted.exr
check 4 shifted.exr
one_line 'another data window'
has 'another data window' 'part 0 has pixels from 10,10 on'
oiiotool right.exr --eraseattrib peel:format --attrib oiio:subimagename display -o named.exr
check 0 named.exr
has 'an image with a name' ' identical$'

# Single passes.
subimage() {
    oiiotool -a --info -v right_trace.exr | grep -o 'subimagename: ".*"' |
        grep -n "\"$1\"" | cut -d: -f1 | awk '{ print $1 - 1 }'
}
oiiotool right_trace.exr --subimage "$(subimage peel.1.accum)" -o layer.exr
oiiotool right_trace.exr --subimage "$(subimage peel.1.depth)" -o depth.exr
oiiotool depth.exr --flip -d uint16 -o depth.png
check 0 --layer 1 layer.exr --depth 1 depth.exr
has 'layer' '^peel.1.accum .* agrees$\|^peel.1.accum .* identical$'
check 0 --depth 1 depth.png
has 'depth' 'rows from the bottom'
oiiotool depth.exr -d half -o half_depth.exr
check 0 --depth 1 half_depth.exr
has 'depths as halves' 'halves, rows from the top'
check 4 --depth 1 right.png
one_line 'colours as depths'
check 4 --depth 1 right.exr
has 'colours as depths' 'has colours'
check 4 --depth 1 depth.exr --encoding srgb
check 4 --depth 1 depth.exr --bound
check 4 right.png --alpha coverage
has 'no alpha' 'there is no alpha'
check 2 --layer 0 layer.exr
check 2 right.png --depth 0 depth.exr
has 'depth of another peel' 'first step that differs: peel.0.depth'
check 0 right.png --depth d24
check 4 --layer 9 layer.exr
one_line 'no such peel'

# What cannot be compared.
check 3 right.png --size 48x27
has 'size' '96x54 pixels, the reference has 48x27'
one_line 'size'
check 3 right_trace.exr --size 48x27
oiiotool right.png --cut 48x27+0+0 -o cropped.png
check 3 cropped.png
head -c 2000 right.png >corrupt.png
check 4 corrupt.png
one_line 'corrupt PNG'
has 'corrupt PNG' 'cannot decode the PNG'
head -c 2000 right.exr >corrupt.exr
check 4 corrupt.exr
one_line 'corrupt EXR'
oiiotool right.exr --ch A -o alpha.exr
check 4 alpha.exr
one_line 'EXR without RGB'
oiiotool right.exr --ch R,G -o rg.exr
check 4 rg.exr
one_line 'EXR without B'
printf 'peel-dump 1 accum rgba32f 96x54 top little\nxx' >short.peel
check 4 short.peel
one_line 'a dump that ends early'
{
    printf 'peel-dump 1 peel.0.mine rgba8 96x54 top little\n'
    head -c 20736 /dev/zero
} >unknown.peel
check 4 unknown.peel
has 'a dump of other buffers' 'the reference has none of its buffers'
{
    printf 'peel-dump 1 opaque.depth d32f 96x54 top little\n'
    head -c 20736 /dev/zero
    printf 'peel-dump 1 peel.0.\033X rgba8 96x54 top little\n'
    head -c 20736 /dev/zero
} >escape.peel
check 2 escape.peel
has 'a name of control characters' '^peel.0.?X '
check 4 none.png
check 4 .
check 4
one_line 'nothing to compare'
check 4 right.png --encoding gamma
check 4 right.png --alpha maybe
check 4 --layer x right.png
check 4 --layer 1
check 4 right.png right.exr
check 4 right.png --method all
check 4 right.png --method painter --bound
check 4 right.png --json none/x.json

# 1x1, no lights, nothing transparent.
for extra in '--size 1x1' '--lights 0' '--opacity 1' '--method weighted-blended'; do
    exits 0 "render $extra" "$peel" render "$scene" $options $extra -o small.exr
    check 0 small.exr $extra
done

# The page.
check 2 short.png --report page
for file in index.html style.css theirs.png reference.png difference.png scale.png; do
    exits 0 "page has $file" test -s page/$file
done
exits 0 'page' grep -q 'Theirs differs from the reference' page/index.html

# The contract, and a renderer that knows nothing else. The red plane is opaque, so that some
# transparent surfaces are hidden.
opaque_red "$source/data/scenes/crossing_planes.gltf" crossing.gltf
scene=crossing.gltf
exits 0 'export' "$peel" scenes "$scene" --export contract $options
exits 0 'one header' cmp contract/peel_dump.h "$source/src/dump/peel_dump.h"
exits 0 'the line in it' grep -q 'peel check scene.gltf THEIRS --size 96x54' contract/contract.json
exits 0 'the page alone' "$peel" scenes --contract -o contract.html
exits 0 'an abbreviation' "$peel" scenes chain --exp shorter --size 96x54
exits 0 'an abbreviation' grep -q 'peel check scene.gltf THEIRS --size 96x54"' shorter/contract.json
exits 0 'the page alone' cmp contract.html contract/index.html
exits 0 'foreign' "$foreign/foreign" contract foreign.png foreign.peel
check 0 foreign.png
has 'foreign image' ' identical$'
check 0 foreign.peel
has 'foreign passes' '^peel.1.accum .* identical$'
for mistake in not_premultiplied over_front_to_back opaque_depth_ignored background_forgotten \
    layers_reversed; do
    exits 0 "foreign, $mistake" "$foreign/foreign_$mistake" contract wrong.png wrong.peel
    check 2 wrong.png
    check 2 wrong.peel
    case $mistake in
    not_premultiplied) first=peel.0.accum ;;
    background_forgotten) first=display ;;
    opaque_depth_ignored) first=peel.0.depth ;;
    *) first=peel.1.accum ;;
    esac
    has "foreign, $mistake" "first step that differs: $first"
done
exits 0 'the exported scene' "$peel" check contract/scene.gltf foreign.png $options
exits 4 'export without a scene' "$peel" scenes --export there
exits 4 'export into a file' "$peel" scenes chain --export foreign.png
exits 4 'export and -o' "$peel" scenes chain --export there -o there.gltf
exits 4 'contract without a file' "$peel" scenes --contract

echo "$passed passed, $failed failed"
[ $failed = 0 ]
