#!/bin/sh
# A coarse guard of ref's speed that no other load disturbs: instructions, not time.
# Usage: instructions.sh PEEL SOURCE_DIR [--update]
# Exit code 77 (skipped) where the processor has no AVX2, which is the widest that valgrind runs.
set -u
peel=$1
file=$2/tests/bench/instructions.txt
update=${3-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# count SCENE SIZE LIGHTS: instructions of the rendering alone, without loading and writing.
count() {
    valgrind --tool=callgrind --callgrind-out-file="$work/callgrind" \
        --toggle-collect=pipeline_render "$peel" render "$1" --size "$2" --lights "$3" --threads 1 \
        --simd avx2 -o "$work/image.png" >"$work/log" 2>&1
    code=$?
    if [ $code != 0 ] && grep -q 'does not have it' "$work/log"; then
        echo "skipped: no AVX2" >&2
        exit 77
    fi
    sed -n 's/.*Collected : \([0-9]*\)$/\1/p' "$work/log"
}

failed=0
grep '^#' "$file" >"$work/new"
grep -v '^#' "$file" >"$work/old"
while read -r scene size lights limit; do
    counted=$(count "$scene" "$size" "$lights") || exit $?
    if [ -z "$counted" ] || [ "$counted" -lt 1000000 ]; then
        echo "FAIL $scene: no count"
        cat "$work/log"
        exit 1
    fi
    echo "$scene $size $lights $counted" >>"$work/new"
    echo "$scene $size, $lights lights: $counted instructions, $limit recorded"
    [ "$update" = --update ] && continue
    if [ $((counted * 100)) -gt $((limit * 125)) ]; then
        echo "FAIL $scene: $counted instructions, expected at most $((limit * 125 / 100)):"
        echo "     make it faster, or record it with --update (see instructions.txt)"
        failed=1
    fi
done <"$work/old"
[ "$update" = --update ] && cp "$work/new" "$file"
exit $failed
