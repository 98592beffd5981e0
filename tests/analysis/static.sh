# shellcheck shell=sh
# For tidy.sh and analyzer.sh, which read it first: builds in which every finding is an error, so
# that a second run examines the files that have findings, and those that changed.
. "$(dirname "$0")/analysis.sh"

# examine PRESET FINDING: builds with PRESET; FINDING is a regular expression of a finding's line.
examine() {
    directory=$root/build-$1
    log=$directory.log
    # What ninja does not know of.
    [ -z "$(find "$root/.clang-tidy" -newer "$directory/build.ninja" 2>&1)" ] || rm -rf "$directory"
    (cd "$root" && cmake --preset "$1") >"$log" 2>&1 || {
        cat "$log" >&2
        stop "cmake --preset $1 failed"
    }
    cmake --build "$directory" -- -j 2 -k 0 2>&1 | tee "$log" | grep --line-buffered -E '^\[[0-9]*[05]/|: error: '
    sed "s|^$root/||" "$log" | grep -E -- "$2" | sort -u >"$directory/findings"
    count=$(wc -l <"$directory/findings")
    cat "$directory/findings"
    if [ "$count" = 0 ] && grep -q '^ninja: build stopped' "$log"; then
        stop "build of $directory failed: see $log"
    fi
    echo "$name: $count findings"
    [ "$count" = 0 ]
}
