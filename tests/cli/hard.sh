#!/bin/sh
# The hard cases: a slice of the catalogue, what it writes, its exit codes.
# Usage: hard.sh PEEL SOURCE_DIR
set -u
peel=$1
source=$2
. "$(dirname "$0")/checks.sh"

exits 0 'the slice' "$peel" hard --ci --json hard.json --report page
cat output
check 'every expectation holds' grep -q '^AS EXPECTED$' output
json_holds 'JSON' hard.json 'd.cases.length >= 32 && d.cases.every((one) => one.why)'
json_holds 'no NaN' hard.json 'd.nonfinite === 0'
json_holds 'ref and gl' hard.json 'd.ref_gl_differing === 0'
check 'page' grep -q 'Every expectation holds' page/index.html
for name in $("$peel" hard --list | grep -o '^[a-z0-9_]*'); do
    check "pictures of $name" test -s "page/$name-ref.png" -a -s "page/$name-truth.png" \
        -a -s "page/$name-error.png"
    check "section of $name" grep -q "id=\"$name\"" page/index.html
    check "README has $name" grep -q "^| \`$name\`" "$source/README.md"
done

exits 0 'export' "$peel" hard --export scenes
check 'data/hard is what --export writes' diff -r scenes "$source/data/hard"
exits 0 'a file of it' "$peel" compare "$source/data/hard/fan.gltf" --size 48x48
exits 4 'no such case' "$peel" hard no_such_case
check 'one line' test "$(wc -l <output)" -eq 1
exits 4 'a list of one case' "$peel" hard --list fan
exits 4 'json nowhere' "$peel" hard fan --json none/x.json
exits 4 'report over a file' "$peel" hard fan --report hard.json

echo "$passed passed, $failed failed"
[ $failed = 0 ]
