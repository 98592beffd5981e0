#!/bin/sh
# Checks the checks: puts the deliberate faults of faults.txt into a copy of the source tree, one at
# a time, and expects the test that faults.txt names to fail.
#
#   faults.sh ROOT [TEXT]   all faults, or those whose name, test or file holds TEXT
#
# Prints a row per fault and exits 1 if a test passes with a fault in, fails without, or an edit no
# longer applies or compiles. The copy and its build are in a folder of their own in TMPDIR.
set -eu

root=$(cd "$1" && pwd)
only=${2-}
list=$root/tests/faults/faults.txt
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
tree=$work/tree
build=$work/build

stop() {
    echo "faults: $*" >&2
    exit 1
}

# Calls $1 NAME TEST FILE OLD NEW for every fault in the list that was asked for.
each_fault() {
    while IFS= read -r name; do
        case $name in '' | '#'*) continue ;; esac
        { IFS=' ' read -r test file && IFS= read -r old && IFS= read -r new; } ||
            stop "$name: expected four lines"
        case $old/$new in
        '- '?*/'+ '?*) ;;
        *) stop "$name: expected the lines '- OLD' and '+ NEW'" ;;
        esac
        case "$name $test $file" in
        *"$only"*) "$1" "$name" "$test" "$file" "${old#- }" "${new#+ }" </dev/null ;;
        esac
    done <"$list"
}

row() {
    printf '%-52s %-20s %s\n' "$1" "$2" "$3"
}

# A program that ctest also runs against a driver that does not fuse has a second test, _unfused.
# What is called otherwise is a script that runs peel.
build_test() {
    case $1 in
    test_* | fuzz_* | campaign) target=${1%_unfused} ;;
    *) target=peel ;;
    esac
    ninja -C "$build" "$target" >"$work/build.log" 2>&1
}

run_test() {
    ctest --test-dir "$build" -R "^$1\$" --no-tests=error --timeout 300 --output-on-failure \
        >"$work/test.log" 2>&1
}

# The functions whose assertions failed in the run before, or a script's failed checks.
failed_functions() {
    sed -n -e 's/.*:[FE]:[^:]*:\([a-z0-9_]*\):.*/\1/p' -e 's/^FAIL \([^:]*\):.*/\1;/p' \
        "$work/test.log" | LC_ALL=C sort -u | tr '\n' ' '
}

note_test() {
    echo "$2" >>"$work/tests"
}

check_unchanged() {
    build_test "$1" || {
        cat "$work/build.log" >&2
        stop "$1 does not build without a fault"
    }
    run_test "$1" || {
        cat "$work/test.log" >&2
        stop "$1 fails without a fault"
    }
    row '(none)' "$1" green
}

# edit FILE OLD NEW: to standard output; fails unless OLD is in FILE exactly once.
edit() {
    old=$2 new=$3 awk '
BEGIN { old = ENVIRON["old"]; new = ENVIRON["new"] }
at = index($0, old) {
    rest = substr($0, at + length(old))
    found += index(rest, old) ? 2 : 1
    $0 = substr($0, 1, at - 1) new rest
}
{ print }
END { exit found != 1 }' "$1"
}

check_fault() {
    if ! edit "$root/$3" "$4" "$5" >"$work/edited"; then
        verdict="DOES NOT APPLY: expected once in $3: $4"
    else
        cp "$work/edited" "$tree/$3"
        if ! build_test "$2"; then
            verdict='DOES NOT COMPILE'
        elif run_test "$2"; then
            verdict=SURVIVED
        else
            functions=$(failed_functions)
            verdict="red: ${functions:-ended early}"
        fi
        cp "$root/$3" "$tree/$3" # newer than what was built from the faulty one
    fi
    row "$1" "$2" "$verdict"
    case $verdict in
    red*) ;;
    *) echo "$1" >>"$work/bad" ;;
    esac
    count=$((count + 1))
}

[ -f "$list" ] || stop "$list: no such file"
mkdir "$tree"
for part in CMakeLists.txt src ref gl tests; do
    cp -R "$root/$part" "$tree"
done
cmake -S "$tree" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_TESTING=ON \
    >"$work/build.log" 2>&1 || {
    cat "$work/build.log" >&2
    stop 'cmake failed'
}
each_fault note_test
[ -f "$work/tests" ] || stop "'$only': no such fault"
row fault test outcome
# shellcheck disable=SC2013 # a name has no blanks
for test in $(LC_ALL=C sort -u "$work/tests"); do
    check_unchanged "$test"
done
count=0
each_fault check_fault
if [ -f "$work/bad" ]; then
    stop "$(wc -l <"$work/bad") of $count went unnoticed"
fi
echo "faults: all $count noticed"
