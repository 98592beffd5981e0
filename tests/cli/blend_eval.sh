#!/bin/sh
# peel blend eval: its help's examples, tables, JSON and one-line refusals.
# Usage: blend_eval.sh PEEL
set -u
peel=$1
. "$(dirname "$0")/checks.sh"

# holds WHAT EXPRESSION: JavaScript of d, the document in eval.json, with layers, its first
# arithmetic's, and differ(A, B, C): whether A - B is not C, fractions in text.
holds() {
    json_holds "$1" eval.json "((layers, ratio) => {
        const differ = (...texts) => {
            const [[a, m], [b, n], [c, o]] = texts.map(ratio);
            return (a * n - b * m) * o !== c * m * n;
        };
        return $2;
    })(d.arithmetics[0].layers, (text) => [...text.split('/'), '1'].slice(0, 2).map(BigInt))"
}

# refused WHAT PATTERN ARGUMENT...: exit 4 and one line that has PATTERN.
refused() {
    name=$1
    pattern=$2
    shift 2
    exits 4 "$name" "$peel" blend eval "$@"
    exits 0 "$name: one line" test "$(grep -c '^peel: ' output)" -eq "$(wc -l <output)"
    exits 4 "$name" "$peel" blend eval "$@"
    has "$name" "$pattern"
}

# ---- the help's examples, and what it says of them ----

exits 0 'help' "$peel" blend eval --help
cp output help
exits 0 'two examples' test "$(grep -c '^  peel blend eval' help)" -eq 2
# shellcheck disable=SC2016 # example.sh expands it
sed -n 's/^  peel blend eval/"$peel" blend eval/p' help >examples
exits 0 '64 of 63.749' grep -q '63.749/255 arrives' help
sed -n 1p examples >example.sh
exits 0 'first example' env peel="$peel" sh example.sh
has 'first example' 'C = C + T\*a\*c'
has 'first example' ' T\*a\*c .*~63.749 .* 16256/65025$'
has 'first example' ' C stored .* 64 *+0.251 *+0.00098 *64/255$'
has 'first example' '  green .* 64 *+0.251 .*16256/65025$'
has 'first example' '^The same layers under each other'
exits 0 '16/81' grep -q '16/81, and stores 1.9 units' help
sed -n 2p examples >example.sh
exits 0 'second example' env peel="$peel" sh example.sh
has 'second example' '  alpha .*-1.9 .* 16/81$'
exits 0 'a line a layer' test "$(grep -c '^ *[1-4]  *1/3  *0\.' output)" -eq 4

# ---- layouts ----

exits 0 '80 columns' "$peel" blend eval --width 80 1,0,0,1/2 0,1,0,1/3
narrow '80 columns' 80
exits 0 '80 columns, codes' "$peel" blend eval --width 80 --format rgba8 '#ff000080' '#00ff0080'
narrow '80 columns, codes' 80
exits 0 '80 columns, brief' "$peel" blend eval --width 80 --brief 1/7,1/7,1/7,1/7 1/3,1/3,1/3,1/3
narrow '80 columns, brief' 80
exits 0 '80 columns, all' "$peel" blend eval --width 80 --arithmetic all --format rgba8 '#ff000080'
narrow '80 columns, all' 80
has 'all' '^  codes-shift (wrong)'
has 'no room' 'have no room for the steps'
exits 0 '200 columns' "$peel" blend eval --width 200 --arithmetic exact,separate,fused,driver \
    1,0,0,1/2 0,1,0,1/3
narrow '200 columns' 200
has 'side by side' ' exact .*ULP .*separate .*ULP .*fused .*ULP .*driver .*ULP'
exits 0 'no colours in a pipe' test "$(tr -cd '\033' <output | wc -c)" -eq 0
exits 0 '--width' "$peel" blend eval --width 150 --arithmetic exact,driver 1,0,0,1/2
cp output wide
exits 0 'COLUMNS' env COLUMNS=150 "$peel" blend eval --arithmetic exact,driver 1,0,0,1/2
check 'COLUMNS is as --width' cmp output wide
if command -v script >/dev/null; then
    exits 0 'a terminal' env TERM=xterm NO_COLOR= script -qec "'$peel' blend eval 1,0,0,1/3" \
        /dev/null
    exits 0 'colours in a terminal' test "$(tr -cd '\033' <output | wc -c)" -gt 20
    env TERM=xterm NO_COLOR=1 script -qec "'$peel' blend eval 1,0,0,1/3" /dev/null >output
    exits 0 'NO_COLOR' test "$(tr -cd '\033' <output | wc -c)" -eq 0
    for terminal in dumb ''; do
        env TERM=$terminal script -qec "'$peel' blend eval 1,0,0,1/3" /dev/null >output
        exits 0 "TERM=$terminal" test "$(tr -cd '\033' <output | wc -c)" -eq 0
    done
fi

# ---- equations, formats, arithmetics ----

for equation in under over over-premultiplied over-transmittance add max weighted-sum product seed \
    replace keep src-color,dst-color,zero,one:reverse-subtract,min; do
    for format in rgba32f rgba16f rgba16 rgba8 rg32f r32f; do
        exits 0 "$equation $format" "$peel" blend eval --equation $equation --format $format \
            --arithmetic exact,driver 0.3,-0,inf,1 nan,1e-45,1,0
    done
done
exits 0 'named and by fields' "$peel" blend eval --arithmetic \
    exact,precision=half,store=truncate,separate 1/3,0,0,1/3
has 'named and by fields' '3 arithmetics'
has 'named and by fields' '^  precision=half,store=truncate '
exits 0 'back to front' "$peel" blend eval --equation over 1,0,0,1/2 0,1,0,1/4
has 'back to front' 'back to front'
has 'what layers let through' '  let through .*3/8$'
exits 0 'the last first' test "$(grep '^Layer' output | head -1 | cut -c1-12)" = 'Layer 2 of 2'
exits 0 'negative numbers' "$peel" blend eval --destination -1,0,0,1 -0x1p-1,-.5,0,1/2 -inf,0,0,1
has 'negative numbers' 'c = -0.5, -0.5, 0; a = 0.5'
exits 0 'premultiplied' "$peel" blend eval --premultiplied 1/2,0,0,1/2
has 'premultiplied' 'C = C + T\*s'

# ---- layers of files ----

printf '# layers\r\n1,0,0,1/2\r\n\n#00ff0080\n0.5 0.5 0.5 0.5' >layers.txt
exits 0 'a file' "$peel" blend eval --layers layers.txt
has 'a file' '3 layers'
exits 0 'standard input' sh -c "'$peel' blend eval --layers - <layers.txt"
has 'standard input' '3 layers'
yes '#10203040' | head -4096 >many.txt
exits 0 'many layers' "$peel" blend eval --layers many.txt --format rgba8
exits 0 'brief by itself' test "$(grep -c '^ *[0-9][0-9]*  *64/255' output)" -eq 4096

# ---- JSON ----

exits 0 'JSON' "$peel" blend eval --format rgba8 --json eval.json --arithmetic exact,driver \
    '#ff000080' '#00ff0080'
holds 'the head' "d.equation === 'under' && d.format === 'rgba8' && d.straight === true
    && d.colour_formula === 'C = C + T*a*c'
    && d.arithmetics.map((a) => a.name).join() === 'exact,driver'"
holds 'fractions' "!differ(layers[1].channels.green.exact.fraction, '0', '16256/65025')"
holds 'errors are differences' "!d.arithmetics.flatMap((a) => a.layers)
    .flatMap((l) => Object.values(l.channels))
    .some((c) => differ(c.steps.stored.fraction, c.exact.fraction, c.off_fraction))"
holds 'bits' "layers[1].channels.green.code === 64
    && layers[1].channels.green.bits === '0x40'"
holds 'both sides' "d.arithmetics[0].under_over.green.under.fraction === '64/255'"
holds 'totals' "d.arithmetics[0].totals.step === 'stored'"
exits 0 'JSON of what is no number' "$peel" blend eval --json eval.json nan,inf,1e40,1
holds 'no number' "layers[0].channels.red.exact.value === null
    && layers[0].channels.green.exact.hex === 'inf'
    && layers[0].channels.blue.off_ulp === null"
exits 0 'JSON of a format with one channel' "$peel" blend eval --format r32f --json eval.json 1,2,3,1
holds 'one channel' "Object.keys(layers[0].channels).join() === 'red'
    && d.start.length === 1 && d.arithmetics[0].under_over === null"

# ---- refusals ----

refused 'no layer' 'expected R,G,B,A'
refused 'three numbers' "layer 1: '1,2,3': expected 4 numbers .* found 3" 1,2,3
refused 'five numbers' 'found more' 1,2,3,4,5
refused 'second layer' "layer 2: blue: 'x': .*expected a number" 1,0,0,1 1,0,x,1
refused 'by zero' 'division by 0' 1/0,0,0,1
refused 'huge exponent' 'exponent beyond' 1e99999,0,0,1
refused 'code' 'expected #rrggbb' '#12345'
refused 'empty' 'expected 4 numbers' ''
refused 'format' 'expected rgba32f' --format rgb10 1,0,0,1
refused 'depth format' 'expected rgba32f' --format d24 1,0,0,1
refused 'equation' '--equation: ' --equation sideways 1,0,0,1
refused 'arithmetic' '--arithmetic: ' --arithmetic precise 1,0,0,1
refused 'codes of floats' 'codes-nearest: rgba32f: ' --arithmetic codes-nearest 1,0,0,1
refused 'start' '--destination: ' --destination 1,2 1,0,0,1
refused 'premultiplied over' 'over-premultiplied' --equation over --premultiplied 1,0,0,1
refused 'width' '--width' --width 10 1,0,0,1
refused 'an option' 'is no option' --nosuch 1,0,0,1
refused 'no file' 'nosuch: cannot read' --layers nosuch
refused 'a directory' 'cannot read' --layers .
refused 'no layers' 'no layers' --layers /dev/null
refused 'a long line' ':1: a line of' --layers /dev/zero
printf '1,0,0,1\n1,0,\000,1\n' >zero.txt
refused 'a 0 byte' 'zero.txt:2: blue: .*0 byte' --layers zero.txt
printf '1,0,0,1\n\n1,0,0\n' >short.txt
refused 'a short line' "short.txt:3: '1,0,0'" --layers short.txt
refused 'too many' 'many.txt:4096: one layer too many' 1,0,0,1 --layers many.txt
yes '1e-9999,0,0,1/3' | head -100 >digits.txt
refused 'digits' 'digits.txt:32: too many digits' --layers digits.txt
refused 'JSON nowhere' 'nowhere' --json nowhere/e.json 1,0,0,1
exits 4 'a full disk' sh -c "'$peel' blend eval 1,0,0,1 >/dev/full"

echo "$passed passed, $failed failed"
[ $failed = 0 ]
