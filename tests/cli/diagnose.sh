#!/bin/sh
# peel diagnose as a command: what it says, what it writes, its exit codes.
# Usage: diagnose.sh PEEL SOURCE_DIR
set -u
peel=$1
source=$2
. "$(dirname "$0")/checks.sh"

# key KEY...: the JSON's value under these keys.
key() {
    python3 -c 'import json, sys
value = json.load(open("out.json"))
for key in sys.argv[1:]:
    value = value[int(key) if key.lstrip("-").isdigit() else key]
print(value)' "$@"
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
    check "$image agrees" test "$(key verdict)" = agrees
    check "$image: no ranking" test "$(key ranking)" = '[]'
done
exits 0 'flip, told' "$peel" diagnose tutorial right.png $settings --no-flip --encoding seed
exits 2 'the wrong encoding, told' "$peel" diagnose tutorial right.png $settings --encoding linear

# --- a mistake ---
for mistake in not-premultiplied background-forgotten srgb-encoded-twice; do
    for image in mistake.png mistake.exr; do
        "$peel" render tutorial $settings --mutate $mistake -o $image >/dev/null
        exits 2 "$mistake" "$peel" diagnose tutorial $image $settings --json out.json
        check "$mistake found" test "$(key ranking 0 name)" = $mistake
        check "$mistake verdict" test "$(key verdict)" = mistake
        check "$mistake explains" test "$(key ranking 0 explains)" = 1.0
        check "$mistake in the text" grep -q "^The mistake is $mistake\|apart:.* $mistake" output
        check 'the last word' test "$(tail -1 output)" = MISTAKE
        check 'a pixel' grep -q 'tells the best from the next' output
        check 'cause' test -n "$(key ranking 0 cause)"
        check 'cure' test -n "$(key ranking 0 cure)"
    done
done
"$peel" render tutorial $settings --mutate not-premultiplied,peel-bias-1e-3 -o two.exr >/dev/null
exits 2 'two mistakes' "$peel" diagnose tutorial two.exr $settings --json out.json
check 'both' test "$(key ranking 0 name)" = 'not-premultiplied + peel-bias-1e-3'

# --- equals ---
"$peel" render tutorial $settings --mutate layers-reversed -o equal.png >/dev/null
exits 2 'equals' "$peel" diagnose tutorial equal.png $settings --json out.json --report page
check 'both are first' test "$(key ranking 1 rank)" = 1
check 'equals' test "$(key ranking 0 equals)" = "['$(key ranking 1 name)']"
check 'said' grep -q 'cannot tell apart: over-front-to-back, layers-reversed' output
for picture in theirs reference difference mistake left classes scale; do
    check "picture $picture" test -s page/$picture.png
done
check 'the page' grep -q 'layers-reversed' page/index.html
check 'the page ends' grep -q '^</html>' page/index.html

# --- unknown ---
"$peel" render crossing_planes $settings -o other.png >/dev/null
exits 2 'another scene' "$peel" diagnose tutorial other.png $settings --json out.json --report page
check 'unknown' test "$(key verdict)" = unknown
check 'the last word' test "$(tail -1 output)" = UNKNOWN
check 'a ranking' test "$(key ranking -1 explains | cut -c1)" = 0

oiiotool right.exr --mulc nan -o nan.exr
exits 2 'all NaN' "$peel" diagnose tutorial nan.exr $settings --json out.json --report page
check 'NaN is unknown' test "$(key verdict)" = unknown
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
python3 - <<'END'
data = bytearray(open("right.exr", "rb").read())
open("none.exr", "wb").write(data.replace(b"R\0\2\0\0\0", b"Q\0\2\0\0\0"))
END
refused 3 'another size' tutorial right.png --size 64x47 --json none.json
check 'both sizes' grep -q '64x48.*64x47' output
check 'nothing written' test ! -e none.json
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
python3 - "$source/data/scenes/crossing_planes.gltf" crossing.gltf <<'END'
import json, sys
scene = json.load(open(sys.argv[1]))
for material in scene["materials"]:
    if material["name"] == "red":
        material["alphaMode"] = "OPAQUE"
json.dump(scene, open(sys.argv[2], "w"))
END
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
    check "foreign, $mistake, is first" test "$(key ranking 0 name)" = $mistake
    check "foreign, $mistake, exactly" test "$(key ranking 0 exact)" = True
done

# --- the least there is ---
settings='--size 64x48'
"$peel" render tutorial --size 1x1 --lights 0 -o one.png >/dev/null
exits 0 'one pixel without lights' "$peel" diagnose tutorial one.png --size 1x1 --lights 0
"$peel" render tutorial $settings --opacity 1 -o opaque.png >/dev/null
exits 0 'nothing transparent' "$peel" diagnose tutorial opaque.png $settings --opacity 1

echo "$passed passed, $failed failed"
[ $failed = 0 ]
