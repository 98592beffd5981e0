# shellcheck shell=sh
# For the scripts beside it, which read it first: their arguments, a build, a run of the tests.
#
#   sh tests/analysis/NAME.sh [SOURCE_DIR] [REGEX]   all tests of CI, or those whose names match
name=$(basename "$0" .sh)

stop() {
    echo "$name: $*" >&2
    exit 1
}

here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "${1-$here/../..}" && pwd) || stop "$1: expected the source directory"
only=${2-.}
[ -f "$root/CMakePresets.json" ] || stop "$root: expected the source directory"

# needs PROGRAM PACKAGE
needs() {
    command -v "$1" >/dev/null || stop "no $1 here: apt-get install $2"
}

# build PRESET [OPTION...]: in `directory`; what the tests' run reports goes to `logs`.
build() {
    directory=$root/build-$1
    logs=$directory/analysis
    echo "$name: building $directory"
    (cd "$root" && cmake --preset "$@") >"$directory.log" 2>&1 || {
        cat "$directory.log" >&2
        stop "cmake --preset $1 failed"
    }
    rm -f "$directory.log"
    cmake --build "$directory" || stop "build of $directory failed"
    rm -rf "$logs"
    mkdir "$logs"
}

# Tests of what an instrumented program is not: within so much memory (loading, limits,
# surroundings), in need of so few libraries (deb).
# shellcheck disable=SC2034 # for them
uninstrumented='loading|limits|surroundings|deb'

# run_tests WITHOUT: all but those whose names match; `tests` of them ran, `failed` of them failed.
run_tests() {
    ctest --test-dir "$directory" -L '^ci$' -R "$only" -E "$1" -j "$(nproc)" --no-tests=error \
        --output-on-failure -O "$logs/ctest.log"
    tests=$(sed -n 's/.* out of \([0-9]*\)$/\1/p' "$logs/ctest.log")
    failed=$(sed -n 's/.*, \([0-9]*\) tests\{0,1\} failed out of .*/\1/p' "$logs/ctest.log")
    [ "${tests:-0}" -gt 0 ] || stop "no tests ran: expected names that match '$only'"
}

# count_reports: files report.PID, of all processes that the tests started, each report once; ends.
count_reports() {
    reports=0
    for report in "$logs"/report.*; do
        [ -s "$report" ] || continue
        reports=$((reports + 1))
        # A sanitizer's last line, UBSan's only one, the first of each that valgrind has.
        sed -n -e 's/^SUMMARY: //p' -e 's/.*: \(runtime error: .*\)/\1/p' \
            -e 's/ in loss record .*//' -e 's/^==[0-9]*== \([^ ].*\)/\1/p' "$report"
    done >"$logs/summary"
    sort "$logs/summary" | uniq -c | sort -rn
    echo "$name: $tests tests, $failed failed, $reports reports (in $logs)"
    [ "$failed" = 0 ] && [ "$reports" = 0 ]
}
