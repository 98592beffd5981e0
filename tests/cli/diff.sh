#!/bin/sh
# peel diff, beside OpenImageIO's idiff: its wording and exit codes, and what it does not do.
# Usage: diff.sh PEEL
set -u
peel=$1
. "$(dirname "$0")/checks.sh"

# make NAME CHANNELS COLOUR TYPE [ARGUMENT...]: an image of 8 x 6 pixels.
make_image() {
    name=$1
    channels=$2
    colour=$3
    type=$4
    shift 4
    oiiotool --create 8x6 "$channels" --fill:color="$colour" 8x6 "$@" -d "$type" -o "$name" ||
        failed=$((failed + 1))
}

# same ARGUMENT...: idiff's exit code, and every line that idiff prints, in its order.
same() {
    idiff "$@" >theirs 2>&1
    theirs=$?
    "$peel" diff "$@" >ours 2>ours.err
    ours=$?
    grep -Fxf theirs ours >common
    if [ $theirs = $ours ] && cmp -s theirs common && [ ! -s ours.err ]; then
        passed=$((passed + 1))
    else
        echo "FAIL as idiff: $*: exit $ours, idiff $theirs"
        diff theirs common
        cat ours.err
        failed=$((failed + 1))
    fi
}

# refuse WHAT PATTERN ARGUMENT...: exit 4 and one line on stderr that matches.
refuse() {
    what=$1
    pattern=$2
    shift 2
    "$peel" diff "$@" >/dev/null 2>err
    code=$?
    if [ $code = 4 ] && [ "$(wc -l <err)" = 1 ] && grep -q -- "$pattern" err; then
        passed=$((passed + 1))
    else
        echo "FAIL $what: exit $code, expected 4 and '$pattern': $(cat err)"
        failed=$((failed + 1))
    fi
}

make_image a.exr 4 .25,.5,.75,.5 float
make_image b.exr 4 .25,.5,.75,.5 float --box:color=.25,.625,.75,.5:fill=1 2,1,3,3
make_image big.exr 4 3,.5,.75,.5 float
make_image bigger.exr 4 4,.5,.75,.5 float
make_image half.exr 4 .25,.5,.75,.5 half
make_image half2.exr 4 .2,.5,.75,.5 half
make_image a.png 3 .2,.4,.6 uint8
make_image b.png 3 .2,.4,.6 uint8 --box:color=.2,.5,.6:fill=1 2,1,3,3
make_image a16.png 3 .2,.4,.6 uint16
make_image grey.png 1 .2 uint8
make_image alpha.png 4 .2,.4,.6,1 uint8
make_image z.exr 5 .25,.5,.75,.5,7 float --chnames R,G,B,A,Z
make_image zonly.exr 1 7 float --chnames Z
make_image nan.exr 4 nan,.5,.75,.5 float
make_image inf.exr 4 inf,.5,.75,.5 float
make_image minus.exr 4 -inf,.5,.75,.5 float
make_image zero.exr 1 0 float
make_image minus_zero.exr 1 -0 float
oiiotool --create 9x6 4 -d float -o wide.exr
oiiotool a.exr --tile 4 4 -o tiled.exr
oiiotool b.exr --tile 5 4 -d half -o tiled_half.exr
oiiotool a.exr --origin +1+0 -o moved.exr
oiiotool a.exr half.exr --siappend -o two.exr
oiiotool a.exr half2.exr --siappend -o two_other.exr

# As idiff.
same a.exr a.exr
same a.exr b.exr
same b.exr a.exr
same -v a.exr a.exr
same a.exr half.exr
same half.exr half2.exr
same big.exr bigger.exr
same bigger.exr big.exr
same nan.exr nan.exr
same inf.exr inf.exr
same -fail 0.2 a.exr b.exr
same -fail 0.2 -warn 0.2 a.exr b.exr
same --fail 0.2 --warn 0.2 -v a.exr b.exr
same -fail 0.1 -failpercent 12.5 a.exr b.exr
same -fail 0.1 -failpercent 12.4 a.exr b.exr
same -failpercent 12.5 -warnpercent 12.5 a.exr b.exr
same -failpercent 12.5 -warnpercent 12.4 a.exr b.exr
same -allowfailures 6 a.exr b.exr
same -allowfailures 5 a.exr b.exr
same -failpercent 50 -hardfail .1 -warn 1 a.exr b.exr
same -failpercent 50 -hardfail .2 -warn 1 a.exr b.exr
same -failrelative .2 -warn 1 a.exr b.exr
same -failrelative .3 -warn 1 a.exr b.exr
same -fail .1 -failrelative .3 -warn 1 a.exr b.exr
same -fail 1 a.exr b.exr
same -fail .3 -failpercent 50 a.exr b.exr
same -fail .3 -failpercent 50 -warnrelative .6 a.exr b.exr
same z.exr a.exr
same a.exr z.exr
same a.png a.png
same alpha.png alpha.png
same two.exr two_other.exr
same a.exr two.exr
same tiled.exr a.exr
same tiled.exr b.exr
same tiled_half.exr b.exr

# The picture of the difference.
exits 2 'difference' "$peel" diff -o ours.exr -scale 2 a.exr b.exr
exits 2 'difference' idiff -o theirs.exr -scale 2 a.exr b.exr
exits 0 'difference as idiff' idiff ours.exr theirs.exr
exits 2 'absolute difference' "$peel" diff -o ours.exr -abs a.exr b.exr
exits 2 'absolute difference' idiff -o theirs.exr -abs a.exr b.exr
exits 0 'absolute difference as idiff' idiff ours.exr theirs.exr
exits 0 'none where nothing differs' "$peel" diff -od -o none.png a.exr a.exr
exits 1 'none where nothing differs' test -e none.png
exits 2 'heat map' "$peel" diff -o heat.png a.exr b.exr
exits 0 'heat map: 42 of 48 are black' oiiotool heat.png --rangecheck 0,0,0 0,0,0
has 'heat map' '^ *6  *>'
exits 2 'heat map, scaled' "$peel" diff -o bright.png -scale 8 a.exr b.exr
exits 0 'heat map, scaled: 1 is the brightest' oiiotool --dumpdata bright.png
has 'brightest' 'Pixel (2, 1): 255 2'

# Not as idiff 2.4: what it says of thresholds and sizes but does not do; what is not finite.
exits 2 'quiet' "$peel" diff -q a.exr b.exr
exits 0 'quiet' test ! -s output
exits 1 'a warning without a failure' "$peel" diff -fail 1 -warn .1 a.exr b.exr
has 'a warning' '^WARNING$'
exits 1 'a relative one' "$peel" diff -fail 1 -warnrelative .5 a.exr b.exr
exits 0 'a relative one' "$peel" diff -fail 1 -warnrelative .6 a.exr b.exr
exits 3 'sizes' "$peel" diff a.exr wide.exr
has 'sizes' '^peel: sizes differ: a.exr has 8x6 pixels, wide.exr has 9x6$'
exits 3 'sizes, quietly' "$peel" diff -q a.exr wide.exr --json sizes.json -o sizes.png
check 'sizes, quietly: nothing' test ! -s output
exits 0 'sizes in JSON' grep -q '"verdict": "sizes"' sizes.json
exits 1 'no picture of sizes' test -e sizes.png
exits 3 'windows' "$peel" diff a.exr moved.exr
has 'windows' 'a.exr has 8x6 pixels from 0,0, moved.exr has 8x6 from 1,0$'
oiiotool b.exr --origin +1+0 -o moved_b.exr
exits 2 'the window of both' "$peel" diff moved.exr moved_b.exr -o moved_difference.exr
oiiotool --info -v moved_difference.exr >output
has 'the window of both' 'pixel data origin: x=1, y=0'
for other in a inf minus; do
    exits 2 "NaN and $other" "$peel" diff -fail 9 -warn 9 -failpercent 100 nan.exr $other.exr
    has 'NaN' '48 pixels are not finite, and not alike: a failure'
done
exits 2 'infinities' "$peel" diff inf.exr minus.exr
has 'infinities' 'Not finite: R: 0 NaN and 48 infinite vs 0 NaN and 48 infinite'
has 'no average of it' '^  Mean error = 0$'
exits 1 'hardwarn' "$peel" diff -fail 1 -warn 1 -hardwarn .1 a.exr b.exr
exits 2 'hardfail' "$peel" diff -fail 1 -warn 1 -hardfail .1 a.exr b.exr

# Distances of stored values.
exits 2 'ULP of 8 bits' "$peel" diff a.png b.png
has 'ULP of 8 bits' '^  G  *unorm8 .* 2, 1  *6  *26  *42  *0  *0  *0  *6$'
exits 0 '8 and 16 bits' "$peel" diff -v a.png a16.png
has '8 and 16 bits' '^  R  *unorm8/unorm16  *0  *0  *inf  *0  *-  *0  *0  *48$'
exits 2 'ULP of halves' "$peel" diff half.exr half2.exr
has 'ULP of halves' '^  R  *half .* 410  *0  *0  *0  *0  *0  *48$'
exits 0 'zeros' "$peel" diff -v zero.exr minus_zero.exr
has 'zeros' '^  Y  *float .* 48  *1  *0  *48$'

# Channels and parts.
exits 2 'alpha in one' "$peel" diff a.png alpha.png
has 'alpha in one' 'Channels that read as 0, being in one file only: A of "a.png"'
exits 0 'chosen channels' "$peel" diff --channels R,G,B a.png alpha.png
exits 0 'chosen channels' "$peel" diff --channels R,G,B,A z.exr a.exr
exits 0 'the first part' "$peel" diff two.exr two_other.exr
has 'the first part' 'Only compared the first subimage (of 2 and 2, respectively)'
exits 2 'all parts' "$peel" diff -a two.exr two_other.exr
has 'all parts' '^First differing subimage: 1 subimage01$'
exits 2 'parts of one' "$peel" diff -a two.exr a.exr
has 'parts of one' '^Subimage 1 subimage01 : only "two.exr" has it$'
exits 2 'worst' "$peel" diff --worst 2 a.exr b.exr
has 'worst' '^  2, 1  *G  *0.375 '
exits 0 'two of them' test "$(grep -c ', 1  *G  *0.375 ' output)" = 2

exits 2 'what is seen' "$peel" diff -p -fail 1 -warn 1 a.exr b.exr
has 'what is seen' '^  6 pixels (12.5%) failed the perceptual test$'
exits 0 'what may be seen' "$peel" diff -p -fail 1 -warn 1 -failpercent 12.5 a.exr b.exr
exits 0 'what is not seen' "$peel" diff -p -v a.exr a.exr
has 'what is not seen' '^  0 pixels (  0%) failed the perceptual test$'

oiiotool --create 8x6 1 -d uint32 --fill:color=0.5 8x6 -d uint32 -o ids.exr
oiiotool --create 8x6 1 -d uint32 --fill:color=0.75 8x6 -d uint32 -o other_ids.exr
exits 2 'identifiers' "$peel" diff ids.exr other_ids.exr
has 'identifiers' 'values are [0-9]\{10\} vs [0-9]\{10\}$'

oiiotool ids.exr --chnames "$(printf 'R\033[31m')" -o escape.exr
exits 0 'a name with a command for the terminal' "$peel" diff -v escape.exr escape.exr
has 'a name with a command for the terminal' '^  R?\[31m '

# Deep images and traces.
for alpha in 0.5 0.25; do
    exits 0 'deep' "$peel" render tutorial --size 48x32 --lights 4 --opacity $alpha --with truth \
        --deep -o deep$alpha.exr
    exits 0 'trace' "$peel" render tutorial --size 48x32 --lights 4 --opacity $alpha \
        --trace trace$alpha.exr
done
exits 0 'other samples' "$peel" render chain --size 48x32 --with truth --deep -o more.exr
exits 0 'deep, equal' "$peel" diff deep0.5.exr deep0.5.exr
oiiotool deep0.5.exr --origin +5+7 -o deep_moved.exr
exits 3 'deep, windows' "$peel" diff deep0.5.exr deep_moved.exr
exits 2 'deep' "$peel" diff deep0.5.exr deep0.25.exr -o deep.png
has 'deep' '^  Z  *float  *0  *0 '
has 'deep' '^  A  *float  *0.25  *0.25 '
has 'deep' 'as many in every pixel$'
check 'deep: all of it' sh -c '! grep "Not compared" output'
oiiotool deep0.5.exr -d half --ch R,G,B,A,Z,AR=R -o deep_half.exr
exits 2 'deep, other channels' "$peel" diff deep_half.exr deep0.25.exr
has 'deep, other channels' '^Not compared: AR of "deep_half.exr"$'
has 'deep, other channels' '^Not compared: depth.window, materialid, primitiveid of "deep0.25.exr"$'
has 'deep, other channels' '^  A  *half/float '
exits 2 'deep, one channel' "$peel" diff --channels A deep0.5.exr deep0.25.exr
check 'deep: one channel' sh -c '! grep "^  [ZRGB] " output'
exits 0 'deep, channels alike' "$peel" diff --channels Z,primitiveid deep0.5.exr deep0.25.exr
exits 2 'deep, counts' "$peel" diff deep0.5.exr more.exr
has 'deep, counts' 'pixels have another number: a failure; first @ ('
exits 2 'deep and flat' "$peel" diff deep0.5.exr a.exr
has 'deep and flat' '^One image contains deep data, the other does not$'
exits 0 'trace, equal' "$peel" diff trace0.5.exr trace0.5.exr
exits 2 'trace' "$peel" diff trace0.5.exr trace0.25.exr --json trace.json
has 'trace' '^First differing buffer: peel.0.diffuse ('
exits 0 'trace, JSON' grep -q '"first_differing": "peel.0.diffuse"' trace.json
exits 0 'trace of gl' "$peel" render tutorial --size 48x32 --lights 4 --opacity 0.5 --with gl \
    --trace gl.exr
exits 0 'ref and gl, bit for bit' "$peel" diff -fail 0 -warn 0 trace0.5.exr gl.exr
has 'ref and gl' '^Left out: [0-9]* \*.primitive buffers'
grep -q 'iffer' output && echo "FAIL ref and gl: a buffer differs" && failed=$((failed + 1))

# Classes.
exits 0 'seed' "$peel" render chain --size 64x48 --lights 4 --profile seed -o seed.exr
exits 0 'truth' "$peel" render chain --size 64x48 --lights 4 --with truth -o truth.exr
exits 2 'classes' "$peel" diff seed.exr truth.exr --scene chain --lights 4 --profile seed \
    --json classes.json
has 'classes' '^  gbuffer  *[0-9,]* .*quantisation of the G-buffer$'
# sum_of FIRST LAST: the sum of the numbers between two lines of classes.json.
sum_of() {
    sed -n "/$1/,/$2/s/.*: \([0-9]*\),*$/\1/p" classes.json | awk '{ sum += $1 } END { print sum }'
}
differing=$(sed -n 's/.*"differing_pixels": \([0-9]*\),/\1/p' classes.json)
exits 0 'every differing pixel has a class' test "$(sum_of '"classes"' '}')" = "$differing"
exits 0 'some differ' test "$differing" -gt 100
exits 0 'every value has a distance' test "$(sum_of '"ulp": {' '}')" = $((4 * 64 * 48))
exits 0 'the worst have classes' test "$(grep -c '"class": "' classes.json)" = 5
exits 0 'verdict and exit code' grep -q '"exit_code": 2' classes.json

# What is refused.
mkdir directory.png
: >empty.png
echo 'no image' >text.exr
head -c 40 a.png >cut.png
head -c 400 a.exr >cut.exr
head -c 900 trace0.5.exr >cut_trace.exr
head -c 2000 deep0.5.exr >cut_deep.exr
mkfifo pipe.exr
refuse 'cut_deep.exr' '^peel: cut_deep.exr: ' cut_deep.exr deep0.5.exr
for file in missing.png directory.png empty.png text.exr cut.png cut.exr cut_trace.exr pipe.exr; do
    refuse "$file, first" "^peel: $file: " "$file" a.exr
    refuse "$file, second" "^peel: $file: " a.exr "$file"
done
refuse 'no common channel' 'a.exr has the channels R, G, B, A, zonly.exr has Z: none in common' \
    a.exr zonly.exr
refuse 'nothing to see' 'expected R, G and B in both' -p grey.png grey.png
refuse 'all methods' 'expected a single method' --scene chain --method all a.exr b.exr
refuse 'grey' 'none in common' grey.png a.png
refuse 'no such channel' '--channels R,Q: a.exr has only R, G, B, A' --channels R,Q a.exr b.exr
refuse 'no channels' 'expected names' --channels= a.exr b.exr
escape=$(printf 'A\033X')
oiiotool --create 8x8 3 --attrib oiio:subimagename "$escape" -o escape8.exr
oiiotool --create 9x8 3 --attrib oiio:subimagename "$escape" -o escape9.exr
exits 3 'a name of control characters' "$peel" diff escape8.exr escape9.exr
has 'a name of control characters' 'sizes differ: escape8.exr: A?X has 8x8'
# The picture is of the first part that both have and that differs.
part() {
    oiiotool --pattern constant:color="$1,$1,$1" 8x6 3 --attrib oiio:subimagename "$2" -o "$2$1.exr"
}
part 0.5 first
part 0.5 same
part 0.25 other
part 0.75 other
oiiotool first0.5.exr same0.5.exr other0.25.exr --siappendall -o three.exr
oiiotool same0.5.exr other0.75.exr --siappendall -o last_two.exr
exits 2 'a part that one file lacks' "$peel" diff -a -o parts.exr three.exr last_two.exr
exits 0 'it is not pictured' sh -c 'oiiotool --stats parts.exr | grep -q "Stats Max: -0.5"'
refuse 'one file' 'expected two files' a.exr
refuse 'three files' 'expected two files, already given' a.exr b.exr a.exr
for option in -fail -failrelative -hardfail -warn -warnrelative -hardwarn; do
    refuse $option "^peel: $option -1: expected a number from 0$" $option -1 a.exr b.exr
    refuse $option "^peel: $option x: expected" $option x a.exr b.exr
done
refuse '-failpercent' 'from 0 to 100' -failpercent 101 a.exr b.exr
refuse '-warnpercent' 'from 0 to 100' -warnpercent nan a.exr b.exr
refuse '-allowfailures' 'a whole number' -allowfailures 1.5 a.exr b.exr
refuse '-scale' 'expected a number' -scale x a.exr b.exr
refuse '-o' 'a name ending in .png or .exr' -o out.jpg a.exr b.exr
refuse '--channels of deep images' 'expected of deep images Z, R, G, B or A' --channels AR \
    deep0.5.exr deep0.25.exr
refuse '-o of deep images' 'only a heat map' -o out.exr deep0.5.exr deep0.25.exr
refuse '--worst' 'from 0 to' --worst -1 a.exr b.exr
refuse 'unknown' "'-foo' is no option" -foo a.exr b.exr
refuse 'scene' 'no such file' --scene nosuch a.exr b.exr
for option in '--lights 2' '--depth d16'; do
    # shellcheck disable=SC2086 # two words
    refuse "$option" "^peel: diff: ${option% *} says how a scene is rendered; expected --scene, too$" \
        $option a.exr b.exr
done
refuse 'size' 'the images have 8x6 pixels' --scene chain --size 9x9 a.exr b.exr
refuse 'memory' 'need more than 100 bytes' --max-memory 100 a.exr b.exr
refuse 'memory of a PNG' '^peel: a.png: 3 channels of 8x6 pixels need more than 100 bytes$' \
    --max-memory 100 a.png a.png
refuse 'memory to see with' 'test of 8x6 pixels: needs more than 4000 bytes' -p --max-memory 4000 \
    a.exr b.exr
refuse 'JSON' 'cannot write' --json /nosuch/file a.exr b.exr
exits 0 'help' "$peel" diff --help
exits 0 'nothing else is left' test "$(find . -name '.peel-*')" = ''

echo "$passed passed, $failed failed"
[ $failed = 0 ]
