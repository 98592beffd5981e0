#!/bin/sh
# peel blend check: exit codes, what it says, JSON, the local driver. Usage: blend_check.sh PEEL
set -u
peel=$1
. "$(dirname "$0")/checks.sh"

# refuses WHAT PATTERN ARGUMENT...: exit 4 and one line that matches.
refuses() {
    what=$1
    pattern=$2
    shift 2
    exits 4 "$what" "$peel" blend check "$@"
    has "$what" "$pattern"
    if [ "$(wc -l <output)" = 1 ]; then
        passed=$((passed + 1))
    else
        echo "FAIL $what: more than one line"
        failed=$((failed + 1))
    fi
}

# make FILE ARGUMENT...
make() {
    file=$1
    shift
    exits 0 "make $file" "$peel" blend vectors "$@" -o "$file"
}

# ---- right, wrong, and neither

make right.csv --set random --format rgba8 --count 4000 --arithmetic codes-nearest
exits 0 'a right arithmetic' "$peel" blend check right.csv --json out.json
has 'a right arithmetic' '^= codes-nearest'
has 'a right arithmetic' '^verdict: a right arithmetic, all values$'
has 'a right arithmetic' '4,000 vectors, 16,000 values'
has 'a right arithmetic' '^Direct3D .* none$'
has 'a right arithmetic' '^The same on these vectors:$'
has 'a right arithmetic' '^  source-stored'
cp output whole
exits 1 'all indented as the first' grep -q -E '^ [a-z]|: $' whole
cp whole output
narrow 'a right arithmetic'
json_holds 'a right arithmetic' out.json 'd.exit_code === 0 && d.reports[0].unexplained === 0'
json_holds 'a right arithmetic' out.json 'd.reports[0].verdict === "named" && d.reports[0].values === 16000'
json_holds 'a right arithmetic' out.json 'd.reports[0].rules.every(r => r.outside === 0 && r.judged > 0)'

make wrong.jsonl --set random --format rgba8 --count 4000 --arithmetic codes-shift
exits 2 'a wrong arithmetic' "$peel" blend check wrong.jsonl --json out.json
has 'a wrong arithmetic' '^arithmetic: codes-shift$'
has 'a wrong arithmetic' '^verdict: a WRONG arithmetic$'
json_holds 'a wrong arithmetic' out.json 'd.reports[0].verdict === "wrong" && d.exit_code === 2'

make unnamed.bin --set random --format rgba16f --count 4000 --arithmetic store=up
exits 1 'no name' "$peel" blend check unnamed.bin
has 'no name' '^arithmetic: store=up$'
has 'no name' 'no named arithmetic, but within the rules'

make outside.csv --set random --format rgba8 --count 4000 \
    --arithmetic precision=half,rounding=up,store=up
exits 2 'outside the rules' "$peel" blend check outside.csv
has 'outside the rules' 'OUTSIDE the rules'

exits 0 'standard input' sh -c "$peel blend check - <right.csv"

# One result changed by hand: its line and bits are named.
awk -F, -v OFS=, '!/^#/ && $1 == 77 { $NF = $NF > 100 ? $NF - 9 : $NF + 9 } 1' right.csv >one.csv
exits 2 'one value' "$peel" blend check one.csv --json out.json
has 'one value' '^nearest: exact$'
has 'one value' '^1 of 16,000 values unexplained$'
has 'one value' 'random vector 77, alpha: source .*, before '
has 'one value' '; expected .*, 0x.*; 9 codes apart'
narrow 'one value'
json_holds 'one value' out.json 'd.reports[0].arithmetics.find(a => a.name === "codes-nearest").simplest.index === 77'
exits 2 'against' "$peel" blend check one.csv --against codes-nearest
has 'against' '^against codes-nearest: 1 of 16,000 values differ, by 9 codes at most$'
exits 2 'under the threshold' "$peel" blend check one.csv --against codes-nearest --fail 8
exits 1 'a warning' "$peel" blend check one.csv -against codes-nearest -fail 9
exits 0 'no warning' "$peel" blend check one.csv -against codes-nearest -warn 9
exits 0 'fields' "$peel" blend check right.csv --against precision=codes
exits 2 'another' "$peel" blend check right.csv --against codes-floor --worst 1
has 'another' '^Farthest from codes-floor:'

# An API that is not the one of the rule that is broken.
make truncated.csv --set random --format rgba8 --count 2000 --arithmetic rounding=up,store=truncate
exits 1 'any API' "$peel" blend check truncated.csv
exits 1 'OpenGL' "$peel" blend check truncated.csv --api gl
exits 2 'Direct3D' "$peel" blend check truncated.csv --api d3d11 --against exact --json out.json
json_holds 'Direct3D' out.json 'd.reports[0].api === "d3d11" && d.reports[0].against === "exact"'
json_holds 'Direct3D' out.json 'd.reports[0].rules.every(r => r.judged === 0 || r.example !== null)'
json_holds 'Direct3D' out.json 'Number.isInteger(d.reports[0].rules.find(r => r.example).example.got)'

# ---- sequences

make sequences.csv --set sequences --format rgba16f --count 60 --arithmetic separate-truncated
exits 0 'sequences' "$peel" blend check sequences.csv --json out.json
has 'sequences' 'inside the bound of any sane arithmetic: 240 of 240 values'
narrow 'sequences'
json_holds 'sequences' out.json 'd.sequences === 60 && d.outside === 0 && d.exit_code === 0'
make swapped.csv --set sequences --format rgba8 --count 60 --arithmetic factors-swapped
exits 2 'swapped sequences' "$peel" blend check swapped.csv
has 'swapped sequences' 'factors-swapped: a WRONG arithmetic'

# ---- the list

exits 0 'list' "$peel" blend check --list --format rgba8 --equation under --json out.json
has 'list' '^  codes-shift$'
has 'list' 'rgba8    under, alpha'
narrow 'list'
json_holds 'list' out.json 'd.arithmetics.some(a => a.wrong) && d.arithmetics.some(a => !a.wrong)'
json_holds 'list' out.json 'd.shown_by.filter(r => r.vector !== null).length > 10'

# ---- the driver

exits 0 'OSMesa' "$peel" blend check --gl --limit 2000 --format rgba8,rgba16f,r32f --json out.json
has 'OSMesa' '^rgba16f  under .* driver .* 0 within$'
has 'OSMesa' '^0 unexplained of '
narrow 'OSMesa'
json_holds 'OSMesa' out.json 'd.reports.length === 33 && d.reports.every(r => r.unexplained === 0)'
exits 0 'unfused' "$peel" blend check --gl --fma off --limit 2000 --format rgba16f,r32f
has 'unfused' 'multiply-adds: unfused'
has 'unfused' '^0 unexplained of '
exits 0 'factors' "$peel" blend check --gl=egl --format rgba8 --limit 500 \
    --equation dst-color,zero,one,one-minus-src-color
has 'factors' '^dst-color\|^rgba8    dst-color'

# ---- what is refused

refuses 'no file' 'nosuch.csv' nosuch.csv
sed '20s/,[^,]*$/,x/' right.csv >bad.csv
refuses 'a bad result' 'bad.csv:20' bad.csv
head -n 500 right.csv >cut.csv
refuses 'a file that was cut' 'cut.csv' cut.csv
head -c 3000 unnamed.bin >cut.bin
refuses 'a binary file that was cut' 'cut.bin' cut.bin
: >empty.csv
refuses 'an empty file' 'empty.csv' empty.csv
refuses 'a directory' '' .
refuses 'nothing' 'expected one of FILE, --gl and --list'
refuses 'both' 'expected one of FILE, --gl and --list' right.csv --gl
refuses 'two files' 'takes one FILE' right.csv wrong.jsonl
refuses 'an arithmetic' '--against: ' right.csv --against nosuch
refuses 'codes of floats' 'unorm format' unnamed.bin --against codes-nearest
refuses 'a threshold alone' 'go with --against' right.csv --fail 3
refuses 'a negative threshold' 'whole number' right.csv --against exact --fail=-1
refuses 'an API' 'expected gl, vulkan, d3d11 or any' right.csv --api metal
refuses 'a format' 'expected rgba8' --gl --format rgb9
refuses 'an equation' '--equation: ' --gl --equation nosuch
refuses 'a set' 'expected exhaustive, directed or random' --gl --set sequences
refuses 'a set that the format does not have' 'expected a set' --gl --set exhaustive --format r32f
refuses 'a limit' 'whole number from 1' --gl --limit 0
refuses 'a library' 'expected osmesa or egl' --gl=glx
refuses "a file's format" "the file's own" right.csv --format rgba8
refuses '--against of a driver' 'goes with FILE' --gl --against exact
refuses 'a missing directory' 'nosuch' right.csv --json nosuch/out.json

echo "$passed passed, $failed failed"
[ $failed = 0 ]
