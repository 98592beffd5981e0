#!/bin/sh
# cppcheck over all of src, ref and gl: mistakes, and what does not do the same everywhere.
#
#   cppcheck.sh [SOURCE_DIR]
#
# Exits 1 if it finds anything. Exceptions, each with its reason: cppcheck.txt. Files that did not
# change are not examined again.
set -u
. "$(dirname "$0")/analysis.sh"

needs cppcheck cppcheck
needs clang clang
directory=$root/build-cppcheck
(cd "$root" && cmake --preset clang -B "$directory" -DBUILD_TESTING=OFF) >"$directory.log" 2>&1 || {
    cat "$directory.log" >&2
    stop 'cmake --preset clang failed'
}
rm -f "$directory.log"
mkdir -p "$directory/cppcheck"
# The files that are embedded are arrays: nothing to be found there, but slowly.
(cd "$root" && cppcheck --project="$directory/compile_commands.json" -i "$directory" --std=c17 -j 2 \
    --enable=warning,performance,portability --inline-suppr \
    --suppressions-list="$here/cppcheck.txt" --cppcheck-build-dir="$directory/cppcheck" \
    --template='{file}:{line}: {severity}: {message} [{id}]' --output-file="$directory/output") |
    grep --line-buffered '^[0-9]*0/.*files checked'
grep -a '\[[A-Za-z0-9]*\]$' "$directory/output" | sort -u >"$directory/findings"
cat "$directory/findings"
count=$(wc -l <"$directory/findings")
echo "$name: $count findings"
[ "$count" = 0 ]
