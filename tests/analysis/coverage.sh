#!/bin/sh
# How much of ref, src and gl the tests of CI run: a table by folder, and the files that miss most.
# Lines of children that end by _exit are not counted, nor those of tests in which a program cannot
# write its counts without a message (no_space, surroundings) or the library needs gcc's (package).
#
#   coverage.sh [SOURCE_DIR] [REGEX]   by all tests, or by those whose names match REGEX
#
# Exits 1 if a test fails, or if less than 90 % of the lines of ref and src, or of gl, run.
set -u
. "$(dirname "$0")/analysis.sh"

needs gcovr gcovr
build coverage
find "$directory" -name '*.gcda' -delete
export CK_TIMEOUT_MULTIPLIER=10
run_tests '^(no_space|surroundings|package)$'

echo "$name: counting"
# gcov may give a count of branches below 0, of which gcovr would hang; lines are what is wanted.
(cd "$root" && gcovr --gcov-ignore-parse-errors --root . --filter src/ --filter ref/ --filter gl/ \
    -j "$(nproc)" --csv "$logs/lines.csv" "$directory/src" "$directory/gl") \
    >"$logs/gcovr.log" 2>&1 || {
    tail -5 "$logs/gcovr.log" >&2
    stop 'gcovr failed'
}
# Columns: file, lines, lines that ran. FOLDER, or FILE, and what it has, in one row each.
sed 1d "$logs/lines.csv" | awk -F, -v OFS='\t' '
{
    folder = $1
    sub("/[^/]*$", "", folder)
    sub("/methods$", "", folder)
    part = $1 ~ "^gl/" ? "gl" : "ref and src"
    lines[folder] += $2; ran[folder] += $3
    all[part] += $2; all_ran[part] += $3
    print 2, $2 - $3, $1, $2, $3
}
END {
    for (folder in lines) print 1, 0, folder, lines[folder], ran[folder]
    for (part in all) print 3, 0, part, all[part], all_ran[part]
}' | sort -t "$(printf '\t')" -k1,1n -k2,2nr -k3,3 >"$logs/rows"
awk -F '\t' '
function row() { printf "%-36s %7d %7d %7d %6.1f %%\n", $3, $4, $5, $4 - $5, 100 * $5 / $4 }
$1 != kind { kind = $1; rows = 0; printf "\n%-36s %7s %7s %7s\n", title[kind], "lines", "ran", "missed" }
BEGIN { title[1] = "folder"; title[2] = "the 20 files that miss most"; title[3] = "all" }
$1 != 2 || ++rows <= 20 { row() }
$1 == 3 && $5 < 0.9 * $4 { low = 1 }
END { exit low }' "$logs/rows"
low=$?
echo
[ $low = 0 ] || echo "$name: less than 90 %"
echo "$name: $tests tests, $failed failed (in $logs)"
[ "$failed" = 0 ] && [ $low = 0 ]
