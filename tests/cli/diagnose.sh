#!/bin/sh
# peel diagnose as a command: what it says, what it writes, its exit codes.
# Usage: diagnose.sh PEEL SOURCE_DIR
# shellcheck disable=SC2086 # $settings are several words, $mistake is one
set -u
peel=$1
source=$2
. "$(dirname "$0")/checks.sh"

# finds WHAT EXPRESSION: JavaScript of d, the latest document.
finds() {
    json_holds "$1" out.json "$2"
}

foreign=${PEEL_FOREIGN:-$(dirname "$peel")/tests}
settings='--size 64x48 --background 0.2,0.3,0.4'

# --- the catalogue ---
exits 0 'list' "$peel" diagnose --list
check 'at least 30' test "$(grep -c '^[a-z]' output)" -ge 30
check 'causes' test "$(grep -c '^    cause: ' output)" = "$(grep -c '^[a-z]' output)"
check 'cures' test "$(grep -c '^    cure:  ' output)" = "$(grep -c '^[a-z]' output)"
for name in not-premultiplied premultiplied-twice over-front-to-back destination-alpha-zero \
    transmittance-as-coverage background-forgotten opaque-depth-ignored layers-reversed \
    passes-short; do
    check "$name" grep -qx "$name" output
done
exits 4 'list and a scene' "$peel" diagnose --list tutorial

# --- right images ---
"$peel" render tutorial $settings -o right.png >/dev/null
"$peel" render tutorial $settings -o right.exr >/dev/null
"$peel" render tutorial $settings --with gl -o gl.png >/dev/null
for image in right.png right.exr gl.png; do
    exits 0 "$image" "$peel" diagnose tutorial $image $settings --json out.json
    check 'the last word' test "$(tail -1 output)" = AGREES
    finds "$image agrees" "d.verdict === 'agrees'"
    finds "$image: no ranking" 'd.ranking.length === 0'
done
exits 0 'flip, told' "$peel" diagnose tutorial right.png $settings --no-flip --encoding seed
exits 2 'the wrong encoding, told' "$peel" diagnose tutorial right.png $settings --encoding linear

# --- a mistake ---
for mistake in not-premultiplied background-forgotten srgb-encoded-twice; do
    for image in mistake.png mistake.exr; do
        "$peel" render tutorial $settings --mutate $mistake -o $image >/dev/null
        exits 2 "$mistake" "$peel" diagnose tutorial $image $settings --json out.json
        finds "$mistake found" "d.ranking[0].name === '$mistake'"
        finds "$mistake verdict" "d.verdict === 'mistake'"
        finds "$mistake explains" 'd.ranking[0].explains === 1'
        check "$mistake in the text" grep -q "^The mistake is $mistake\|apart:.* $mistake" output
        check 'the last word' test "$(tail -1 output)" = MISTAKE
        check 'a pixel' grep -q 'tells the best from the next' output
        finds 'cause' 'd.ranking[0].cause.length > 0'
        finds 'cure' 'd.ranking[0].cure.length > 0'
    done
done
"$peel" render tutorial $settings --mutate not-premultiplied,peel-bias-1e-3 -o two.exr >/dev/null
exits 2 'two mistakes' "$peel" diagnose tutorial two.exr $settings --json out.json
finds 'both' "d.ranking[0].name === 'not-premultiplied + peel-bias-1e-3'"

# --- equals ---
"$peel" render tutorial $settings --mutate layers-reversed -o equal.png >/dev/null
exits 2 'equals' "$peel" diagnose tutorial equal.png $settings --json out.json --report page
finds 'both are first' 'd.ranking[1].rank === 1'
finds 'equals' 'd.ranking[0].equals.length === 1 && d.ranking[0].equals[0] === d.ranking[1].name'
check 'said' grep -q 'cannot tell apart: over-front-to-back, layers-reversed' output
for picture in theirs reference difference mistake left classes scale; do
    check "picture $picture" test -s page/$picture.png
done
check 'the page' grep -q 'layers-reversed' page/index.html
check 'the page ends' grep -q '^</html>' page/index.html

# --- unknown ---
"$peel" render crossing_planes $settings -o other.png >/dev/null
exits 2 'another scene' "$peel" diagnose tutorial other.png $settings --json out.json --report page
finds 'unknown' "d.verdict === 'unknown'"
check 'the last word' test "$(tail -1 output)" = UNKNOWN
finds 'a ranking' 'd.ranking.length > 0 && d.ranking.at(-1).explains < 1'

oiiotool right.exr --mulc nan -o nan.exr
exits 2 'all NaN' "$peel" diagnose tutorial nan.exr $settings --json out.json --report page
finds 'NaN is unknown' "d.verdict === 'unknown'"
check 'NaN is said' grep -qx 'Every pixel is NaN or infinite.' output

# --- bad input: one line, the right code ---
refused() {
    code=$1
    what=$2
    shift 2
    exits "$code" "$what" "$peel" diagnose "$@"
    check "$what: one line" test "$(wc -l <output)" -eq 1
}
head -c 300 right.png >short.png
head -c 300 right.exr >short.exr
echo text >text.png
"$peel" render tutorial $settings --trace trace.exr >/dev/null
LC_ALL=C sed 's/R\x00\x02\x00\x00\x00/Q\x00\x02\x00\x00\x00/' right.exr >none.exr
name=$(printf 'right\377.png')
cp right.png "$name"
exits 0 'a name that is not UTF-8' "$peel" diagnose tutorial "$name" $settings --json name.json
check 'a name that is not UTF-8' node -e "JSON.parse(require('fs').readFileSync('name.json'))"
refused 3 'another size' tutorial right.png --size 64x47 --json none.json \
    --report page_of_sizes
check 'both sizes' grep -q '64x48.*64x47' output
check 'other sizes: no empty folder' test ! -e page_of_sizes
check 'nothing written' test ! -e none.json
# What is not finite is no rounding, of two pixels and of all alphas.
oiiotool right.exr --fill:color=nan,nan,nan,nan 2x1+3+3 -o two_nan.exr
oiiotool right.exr --ch R,G,B,A=nan -o alpha_nan.exr
for name in two_nan alpha_nan; do
    exits 2 "$name" "$peel" diagnose tutorial $name.exr $settings
    check "$name" grep -q 'NaN or infinite' output
done
refused 4 'a list with options' --list --flip
refused 4 'no alpha' tutorial right.png $settings --alpha coverage
refused 4 'cut short' tutorial short.png $settings
refused 4 'cut short' tutorial short.exr $settings
refused 4 'no image' tutorial text.png $settings
refused 4 'no such image' tutorial nowhere.png $settings
refused 4 'no R' tutorial none.exr $settings
refused 4 'no image given' tutorial $settings
refused 4 'two images' tutorial right.png right.png $settings
refused 4 'no scene' nowhere right.png $settings
refused 4 'nothing'
refused 4 'encoding' tutorial right.png $settings --encoding gamma
refused 4 'alpha' tutorial right.png $settings --alpha straight
refused 4 'another method' tutorial right.png $settings --method dual
refused 4 'all methods' tutorial right.png $settings --method all
refused 4 'json nowhere' tutorial right.png $settings --json none/x.json
refused 4 'report over a file' tutorial right.png $settings --report right.png

# --- a renderer that is none of ours; the red plane is opaque, so that some surfaces are hidden ---
opaque_red "$source/data/scenes/crossing_planes.gltf" crossing.gltf
settings='--size 96x54 --lights 8 --background 0.2,0.3,0.4'
exits 0 'export' "$peel" scenes crossing.gltf --export contract $settings
exits 0 'foreign' "$foreign/foreign" contract foreign.png foreign.peel
exits 0 'foreign, right' "$peel" diagnose crossing.gltf foreign.png $settings
for mistake in not-premultiplied over-front-to-back opaque-depth-ignored background-forgotten \
    layers-reversed; do
    exits 0 "foreign, $mistake" "$foreign/foreign_$(echo $mistake | tr - _)" contract foreign.png \
        foreign.peel
    exits 2 "foreign, $mistake" "$peel" diagnose crossing.gltf foreign.png $settings \
        --json out.json
    finds "foreign, $mistake, is first" "d.ranking[0].name === '$mistake'"
    finds "foreign, $mistake, exactly" 'd.ranking[0].exact === true'
done

# --- the least there is ---
settings='--size 64x48'
"$peel" render tutorial --size 1x1 --lights 0 -o one.png >/dev/null
exits 0 'one pixel without lights' "$peel" diagnose tutorial one.png --size 1x1 --lights 0
"$peel" render tutorial $settings --opacity 1 -o opaque.png >/dev/null
exits 0 'nothing transparent' "$peel" diagnose tutorial opaque.png $settings --opacity 1

echo "$passed passed, $failed failed"
[ $failed = 0 ]
