#!/bin/sh
# No room for what is written, in every command that writes: exit 4, one line, and no file but whole
# ones. By a limit on the size of files, and, where this user may mount one, a full file system.
# Usage: no_space.sh PEEL SOURCE_DIR [all]: more sizes and commands
set -u
peel=$1
source=$2
all=${3-}
. "$source/tests/cli/checks.sh"
. "$source/tests/limits/writers.sh"
export LC_ALL=C

# judge WHAT COMMAND...: $code and $text, of a run in got.
judge() {
    what=$1
    shift
    lines=$(printf '%s\n' "$text" | grep -c '^peel: [^w]')
    left=$(leftovers "$work/got" "$work/whole")
    if [ $code = 4 ] && [ "$lines" = 1 ] && [ -z "$left" ] && [ "$(printf '%s\n' "$text" | wc -l)" = 1 ]; then
        passed=$((passed + 1))
        refused=$((refused + 1))
    elif [ $code = "$whole_code" ] && [ -z "$left" ]; then
        passed=$((passed + 1))
    else
        echo "FAIL $what: peel $*: exit $code, '$text', left behind: $left"
        failed=$((failed + 1))
    fi
}

limited() {
    rm -rf got && mkdir got
    for blocks in ${all:+0 2 16 64} 1; do
        text=$( (ulimit -f "$blocks" && cd got && exec "$peel" "$@") 2>&1 >/dev/null)
        code=$?
        judge "files of at most $blocks blocks" "$@"
    done
}

full() {
    for room in ${all:+16k 64k 256k} 4k; do
        rm -rf got && mkdir got
        mount -t tmpfs -o size="$room" none got || return
        text=$( (cd got && exec "$peel" "$@") 2>&1 >/dev/null)
        code=$?
        judge "a file system of $room" "$@"
        umount got
    done
}

try() {
    rm -rf whole && mkdir whole
    (cd whole && exec "$peel" "$@") >output 2>&1
    whole_code=$?
    refused=0
    limited "$@"
    [ $mounts = 0 ] || full "$@"
    check "some room is too little for: $*" test $refused -gt 0
}

# The device that is always full, where one file is written.
device() {
    ln -sf /dev/full "$1"
    shift
    text=$("$peel" "$@" 2>&1 >/dev/null)
    code=$?
    check "a full device: $*: exit $code, $text" test "$code:$(printf '%s\n' "$text" | wc -l)" = 4:1
    check "a full device says so: $text" expr "$text" : '.*No space left' >output
}

check inputs inputs
mkdir got
mounts=0
if mount -t tmpfs -o size=64k none got 2>output; then
    umount got
    mounts=1
else
    echo "no_space: a full file system is not tested: this user may not mount one"
fi
trap 'umount "$work/got" 2>/dev/null; rm -rf "$work"' EXIT
each try
[ -z "$all" ] || each_slow try
device full.png render tutorial --size 8x8 -o full.png
device full.exr render tutorial --size 8x8 -o full.exr
device full.exr render tutorial --size 8x8 --trace full.exr
device full.json compare tutorial --size 8x8 --json full.json
device full.png diff a.png b.png -o full.png
device full.gltf scenes tutorial -o full.gltf
device full.csv blend vectors --set random --count 500 -o full.csv
text=$("$peel" blend vectors --set random --count 500 2>&1 >/dev/full)
check "standard output on a full device: $text" expr "$text" : '.*No space left' >output

echo "$passed passed, $failed failed"
[ $failed = 0 ]
