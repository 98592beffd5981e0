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
# Files that a build would generate from what is embedded, arrays: to be there is enough.
sed -n 's|.*"file": "\(.*/embed/.*\.c\)".*|\1|p' "$directory/compile_commands.json" |
    while read -r file; do
        mkdir -p "$(dirname "$file")"
        : >"$file"
    done
(
    cd "$root" || exit
    cppcheck --project="$directory/compile_commands.json" --std=c17 -j 2 \
        --enable=warning,performance,portability --inline-suppr \
        --suppressions-list="$here/cppcheck.txt" --cppcheck-build-dir="$directory/cppcheck" \
        --template='{file}:{line}: {severity}: {message} [{id}]' 2>"$directory/output"
    echo "exit $?"
) | tee "$directory/progress" | grep --line-buffered '^[0-9]*0/.*files checked'
grep -q '^exit 0$' "$directory/progress" || {
    tail -5 "$directory/progress" >&2
    stop 'cppcheck failed'
}
sed "s|^$root/||" "$directory/output" | grep -a '\[[A-Za-z0-9]*\]$' | sort -u >"$directory/findings"
cat "$directory/findings"
count=$(wc -l <"$directory/findings")
echo "$name: $count findings"
[ "$count" = 0 ]
