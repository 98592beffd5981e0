#!/bin/sh
# Fuzzes one target with libFuzzer, under AddressSanitizer and UndefinedBehaviorSanitizer.
#
#   fuzz.sh TARGET [CPU_SECONDS [FOLDER]]   one of tests/fuzz/fuzz_TARGET.c; default 600 seconds
#   fuzz.sh TARGET merge FOLDER             the fewest of FOLDER's inputs that reach all that they
#                                           reach, the smaller first, to tests/fuzz/corpus/TARGET
#
# The target gl has raster's inputs.
#
# FOLDER (default build-fuzz/found/TARGET) keeps inputs that reach something new, and is where the
# next run starts, with tests/fuzz/corpus/TARGET and tests/fuzz/found/TARGET. What ends the program
# goes to FOLDER.found: exit code 1. Progress: a line from each round.
set -u

fail() {
    echo "fuzz.sh: $*" >&2
    exit 4
}

source=$(cd "$(dirname "$0")/../.." && pwd) || exit 4
[ $# -ge 1 ] || fail "expected a target: $(cd "$source/tests/fuzz" && echo fuzz_*.c)"
target=$1
what=${2-600}
inputs=$source/tests/fuzz
[ -f "$inputs/fuzz_$target.c" ] || fail "no tests/fuzz/fuzz_$target.c"
command -v clang >/dev/null || fail "no clang: expected Debian's packages clang and libclang-rt-14-dev"

case ${3-} in
'') folder=$source/build-fuzz/found/$target ;;
/*) folder=$3 ;;
*) folder=$PWD/$3 ;;
esac
cd "$source" || exit 4
[ -f build-fuzz/build.ninja ] || cmake --preset fuzz >/dev/null || fail "cmake --preset fuzz failed"
cmake --build build-fuzz --target "fuzzer_$target" -- --quiet >/dev/null || fail "the build failed"
found=$folder.found
log=$folder.log
scratch=$(mktemp -d) || exit 4
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/merged" "$scratch/run" || exit 4
mkdir -p "$folder" "$found" || exit 4
# Its own copy: a build while it runs must not change it.
fuzzer=$scratch/fuzzer_$target
cp "$source/build-fuzz/tests/fuzz/fuzzer_$target" "$fuzzer" || exit 4

# Bytes of an input, and of all that are kept in the source tree.
longest=16384
kept=100000
corpus=$target
leaks=1
case $target in
raster | gl)
    longest=1300 # what they look at
    kept=20000   # each takes its time
    corpus=raster
    ;;
esac
[ "$target" != gl ] || leaks=0 # Mesa's own

# The folders that there are, of those that inputs come from.
starts() {
    for start in "$inputs/corpus/$corpus" "$inputs/found/$corpus"; do
        [ ! -d "$start" ] || echo "$start"
    done
}

if [ "$what" = merge ]; then
    # shellcheck disable=SC2046 # a list of words
    "$fuzzer" -set_cover_merge=1 -timeout=25 -rss_limit_mb=3000 "$scratch/merged" "$folder" \
        "$inputs/corpus/$corpus" >"$log" 2>&1 || fail "the merge failed: $log"
    rm -f "$inputs/corpus/$corpus"/*
    total=0
    for file in $(cd "$scratch/merged" && ls -Sr); do
        bytes=$(wc -c <"$scratch/merged/$file")
        [ $((total + bytes)) -le $kept ] || break
        total=$((total + bytes))
        cp "$scratch/merged/$file" "$inputs/corpus/$corpus/$file"
    done
    echo "$target: $(find "$inputs/corpus/$corpus" -type f | wc -l) inputs, $total bytes"
    exit 0
fi

dictionary=
[ ! -f "$inputs/$target.dict" ] || dictionary=-dict=$inputs/$target.dict
case $what in
*[!0-9]* | '') fail "'$what': expected CPU seconds" ;;
esac

# used: the CPU seconds of the processes that this one waited for. Not in a subshell, which has none.
count_cpu() {
    times >"$scratch/times"
    used=$(awk 'NR == 2 { for (i = 1; i <= 2; i++) { split($i, t, /[ms]/); s += 60 * t[1] + t[2] }
                   printf "%d", s }' "$scratch/times")
}

# Rounds, as libFuzzer counts wall time, of which a busy machine gives less than it says.
count_cpu
start=$used
executions=0
used=0
: >"$log"
while [ "$used" -lt "$what" ]; do
    left=$((what - used))
    [ $left -lt 900 ] || left=900
    # shellcheck disable=SC2046,SC2086 # lists of words
    (cd "$scratch/run" && exec nice -n 19 "$fuzzer" -fork=1 -ignore_crashes=1 -ignore_ooms=1 \
        -ignore_timeouts=1 -detect_leaks=$leaks -max_total_time="$left" -timeout=25 -report_slow_units=25 \
        -rss_limit_mb=3000 -max_len="$longest" -artifact_prefix="$found/" $dictionary \
        "$folder" $(starts)) >"$scratch/log" 2>&1
    cat "$scratch/log" >>"$log"
    last=$(grep -a '^#[0-9]*: cov:' "$scratch/log" | tail -1)
    [ -n "$last" ] || {
        tail -5 "$scratch/log" >&2
        fail "the fuzzer did not run: $log"
    }
    executions=$((executions + $(echo "$last" | sed 's/^#\([0-9]*\):.*/\1/')))
    count_cpu
    used=$((used - start))
    echo "$target: $executions executions, $(echo "$last" | grep -o 'cov: [0-9]*'), $used CPU" \
        "seconds, $(find "$folder" -type f | wc -l) inputs, $(find "$found" -type f | wc -l) findings"
done
[ -z "$(ls "$found")" ]
