#!/bin/sh
# peel blend vectors: forms, checksums, defaults, refusals, and writes that fail.
# Usage: blend_vectors.sh PEEL SOURCE_DIR
set -u
peel=$1
. "$(dirname "$0")/checks.sh"

# same WHAT GOT EXPECTED
same() {
    if [ "$2" = "$3" ]; then
        passed=$((passed + 1))
    else
        echo "FAIL $1: got '$2', expected '$3'"
        failed=$((failed + 1))
    fi
}

# refused 'MESSAGE' ARGUMENT...: exit 4 and one line that holds the message; no file is left.
refused() {
    message=$1
    shift
    exits 4 "$message" "$peel" blend vectors "$@"
    same "$message: lines" "$(wc -l <output)" 1
    grep -q -F -- "$message" output || same 'message' "$(cat output)" "$message"
    same "$message: files" "$(find . -name 'out*' ! -name output -o -name '.peel*')" ''
}

vectors() {
    "$peel" blend vectors "$@"
}

# What is there is what it is said to be: bytes of version 1.
same 'operands of rgba8' "$(vectors --count 65536 --checksum | sed -n 1p)" \
    '27579f672836331ecdb1d4549eabdc9051e9cee4fd506c0acb063ecf8f20420c  operands'
vectors --count 4 >four.csv
same 'rows' "$(grep -c '^[0-9]' four.csv)" 4
same 'first line' "$(sed -n 1p four.csv)" '# peel-blend-vectors: 1'
same 'columns' "$(sed -n 9p four.csv)" "index,source_r,source_g,source_b,source_a,destination_r,\
destination_g,destination_b,destination_a,result_r,result_g,result_b,result_a"
same 'row 3' "$(sed -n 13p four.csv)" \
    '3,0x0p+0,0x1.818182p-7,0x1p+0,0x1.818182p-7,3,0,252,0,3,0,252,0'

# The same in all forms, to a file and to standard output.
for form in csv jsonl bin binary; do
    ending=${form%ary}
    exits 0 "$form" "$peel" blend vectors --set random --count 100 --format rgba16f -o "out.$ending"
    vectors --set random --count 100 --format rgba16f --form $form >piped
    exits 0 "$form: piped" cmp piped "out.$ending"
    vectors --set random --count 100 --format rgba16f --form $form -o - >dashed
    exits 0 "$form: -" cmp piped dashed
    rm "out.$ending"
done

# A part is that part of the whole.
vectors --set directed --format rgba32f --count 3000 | grep '^2[0-9][0-9][0-9],' >whole
vectors --set directed --format rgba32f --first 2000 --count 1000 | grep '^[0-9]' >part
exits 0 'a part' cmp whole part
same 'a seed' "$(vectors --set random --seed 7 --count 50 | tail -n 1)" \
    "$(vectors --set random --seed 7 --count 50 | tail -n 1)"
if [ "$(vectors --set random --seed 7 --count 50 --checksum)" = \
    "$(vectors --set random --seed 8 --count 50 --checksum)" ]; then
    same 'seeds' equal different
fi

# Checksums are of the raw bytes of the binary form: 16 of source, 4 of destination, 4 of result.
vectors --set random --count 300 --form bin --arithmetic driver | tail -c +297 |
    head -c 7200 | od -An -v -tx1 -w24 | cut -c 61-72 | tr -d ' \n' >hex
sum=$(sed 's/../\\x&/g' hex | xargs -0 printf '%b' | sha256sum | cut -c 1-64)
vectors --set random --count 300 --checksum --arithmetic all >sums
same 'a checksum' "$(sed -n 's/  driver$//p' sums)" "$sum"
same 'checksum alone' "$(vectors --set random --count 300 --checksum --arithmetic driver |
    sed -n 2p)" "$sum  driver"
same 'checksums and threads' "$(vectors --set random --count 70000 --checksum --threads 1)" \
    "$(vectors --set random --count 70000 --checksum --threads 3)"
exits 0 'wrong ones are among them' grep -q ' factors-swapped$' sums

# Sequences.
vectors --set sequences --format rgba8 --first 10 --count 2 >sequences.csv
same 'sequences' "$(grep -c '^10,3,[012],' sequences.csv)" 3
same 'exact results' "$(grep -c ',0x[0-9a-f]*/0x[0-9a-f]*$' sequences.csv)" 2

exits 0 'the list' "$peel" blend vectors --list
mv output list
for word in exhaustive sequences over-premultiplied codes-nearest; do
    exits 0 "the list has $word" grep -q -w -- $word list
done
exits 0 'help' "$peel" blend vectors --help
mv output help
exits 0 'help says how checksums are used' grep -q 'sha256sum results.bin' help

refused "--set all: expected exhaustive, directed, random or sequences" --set all
refused "--format rgb: expected rgba8" --format rgb
refused "--form xml: expected csv, jsonl or bin" --form xml
refused "--seed -1: expected an integer from 0 to 2^53 - 1" --seed -1
refused "--count x: expected an integer" --count x
refused "--count 0: expected at least 1" --count 0
refused "--count 0: expected at least 1" --set random --count 0
refused "the set has 16777216 vectors" --first 16777216
refused "the set has 16777216 vectors" --first 16777000 --count 1000
refused "exhaustive vectors of rgba32f: expected rgba8 or rgba16" --set exhaustive --format rgba32f
refused "sequences of rg32f: expected a format with alpha" --set sequences --format rg32f
refused "--set sequences: expected --equation under" --set sequences --equation over
refused "peel: --equation: 'sideways': expected under, over, " --equation sideways
refused "peel: --equation: 'GL_ONE': expected a factor: zero, one, " --equation one,GL_ONE
refused "peel: --arithmetic: 'sideways': expected a name, or " --arithmetic sideways
refused "--threads 0: expected " --checksum --threads 0
refused "--arithmetic codes-nearest: " --format rgba32f --arithmetic codes-nearest
refused "--arithmetic all: expected --checksum" --arithmetic all
refused "--checksum: expected no -o" --checksum -o out.csv
refused "--checksum: expected no --form" --checksum --form csv
refused "--threads: expected --checksum" --threads 2
refused "-o out.txt: expected a name ending in .csv, .jsonl or .bin, or --form" -o out.txt
refused "seed or index above 2^53 - 1" --set random --first 9007199254740991 --count 2
refused "'stray': expected no arguments" stray

# Writes that fail: one line, no half file.
refused "/dev/full: cannot write this file: No space left on device" -o /dev/full
refused "no/such/out.csv: cannot write this file" -o no/such/out.csv
mkdir directory.csv
refused "directory.csv: cannot write this file: Is a directory" -o directory.csv
"$peel" blend vectors >/dev/full 2>output
same 'full standard output' "$? $(cat output)" \
    '4 peel: standard output: cannot write this file: No space left on device'
{
    "$peel" blend vectors 2>output
    echo $? >code
} | head -n 1 >/dev/null
same 'closed pipe' "$(cat code) $(cat output)" \
    '4 peel: standard output: cannot write this file: Broken pipe'
if [ "$(id -u)" != 0 ]; then
    mkdir sealed && chmod 555 sealed
    refused "sealed/out.csv: cannot write this file: Permission denied" -o sealed/out.csv
fi

echo "$passed passed, $failed failed"
[ $failed = 0 ]
