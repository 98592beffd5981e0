#!/bin/sh
# Surroundings that are not what a program hopes for: closed and broken streams, folders that may not
# be written, files that may not be read or are none, no threads, little memory and stack, another
# language and time zone. Usage: surroundings.sh PEEL SOURCE_DIR
# shellcheck disable=SC2016 # the inner shells'
set -u
peel=$1
source=$2
. "$source/tests/cli/checks.sh"

# refuses WHAT PATTERN COMMAND...: exit 4 and one line with PATTERN, within 20 seconds.
refuses() {
    what=$1
    pattern=$2
    shift 2
    text=$(timeout 20 "$@" 2>&1 >/dev/null)
    code=$?
    if [ $code = 4 ] && [ "$(printf '%s\n' "$text" | wc -l)" = 1 ] &&
        printf '%s\n' "$text" | grep -q -- "$pattern"; then
        passed=$((passed + 1))
    else
        echo "FAIL $what: $*: exit $code (expected 4), '$text' (expected '$pattern')"
        failed=$((failed + 1))
    fi
}

# does WHAT COMMAND...: exit 0 within 20 seconds.
does() {
    what=$1
    shift
    exits 0 "$what" timeout 20 "$@"
}

streams() {
    refuses 'standard output closed' 'standard output' sh -c '"$0" methods >&-' "$peel"
    refuses 'standard output closed' 'standard output' sh -c \
        '"$0" blend vectors --set random --count 3 >&-' "$peel"
    exits 4 'standard error closed' sh -c '"$0" render nosuch -o a.png 2>&-' "$peel"
    does 'standard error closed' sh -c '"$0" render tutorial --size 8x8 -o a.png 2>&-' "$peel"
    does 'standard input closed' sh -c '"$0" render tutorial --size 8x8 -o a.png <&-' "$peel"
    refuses 'standard input closed' 'standard input' sh -c '"$0" blend check - <&-' "$peel"
    # A reader that has gone away, with and without the signal.
    mkfifo pipe
    for case in default:141 ignore:4; do
        exits "${case#*:}" 'a reader that has gone' env "--${case%:*}-signal=PIPE" sh -c \
            ': <pipe & exec 3>pipe; wait; exec "$0" methods >&3' "$peel"
    done
    exits 4 'a reader that has gone' sh -c \
        ': <pipe & exec 3>pipe; wait; exec "$0" blend vectors --set random --count 9 >&3' "$peel"
    rm pipe
}

kinds() {
    for end in gltf glb exr png csv; do
        mkfifo pipe.$end
        mkdir folder.$end
    done
    "$peel" render tutorial --size 8x8 -o a.png >/dev/null
    for name in pipe folder; do
        for end in gltf glb; do
            refuses "a $name" 'not a regular file' "$peel" render $name.$end -o out.png
        done
        for end in exr png; do
            refuses "a $name" 'not a regular file' "$peel" diff $name.$end a.png
            refuses "a $name" 'not a regular file' "$peel" check tutorial $name.$end
            refuses "a $name" 'not a regular file' "$peel" diagnose tutorial $name.$end
        done
        refuses "a $name" "$name.exr: not a regular file" "$peel" flatten $name.exr -o out.png
    done
    refuses 'a folder' 'Is a directory' "$peel" blend check folder.csv
    refuses 'a folder' 'Is a directory' "$peel" blend eval --layers folder.csv
}

# As a user without rights.
# shellcheck disable=SC2086 # $as is a list of words
unprivileged() {
    as=
    chmod 755 .
    mkdir closed mine
    cp "$peel" program
    echo x >closed/there.json
    chmod 666 closed/there.json
    echo x >secret.exr
    echo x >secret.gltf
    chmod 000 secret.exr secret.gltf
    if [ "$(id -u)" = 0 ]; then
        as='setpriv --reuid=65534 --regid=65534 --clear-groups'
        chown 65534 mine
    else
        chmod 555 closed
    fi
    cd mine || exit 1
    refuses 'unreadable' 'Permission denied' $as ../program render ../secret.gltf -o a.png
    refuses 'unreadable' 'Permission denied' $as ../program diff ../secret.exr ../secret.exr
    refuses 'unreadable' 'Permission denied' $as ../program flatten ../secret.exr -o a.png
    for output in 'render tutorial --size 8x8 -o ../closed/a.png' \
        'render tutorial --size 8x8 --trace ../closed/a.exr' \
        'compare tutorial --size 8x8 --json ../closed/a.json' \
        'compare tutorial --size 8x8 --report ../closed/a' \
        'bench tutorial --size 8x8 --runs 1 --report ../closed/a' \
        'explain tutorial --size 8x8 -o ../closed/a' \
        'scenes tutorial -o ../closed/a.gltf' \
        'scenes tutorial --export ../closed/a' \
        'hard --export ../closed/a' \
        'blend vectors --set random --count 3 -o ../closed/a.csv'; do
        refuses 'a folder that may not be written' '../closed/a.*Permission denied' $as ../program $output
    done
    echo x >there.csv
    cp there.csv there.gltf
    chmod 444 there.*
    for output in 'blend vectors --count 1 -o there.csv' 'scenes tutorial -o there.gltf'; do
        refuses 'a file that may not be written' 'there.*Permission denied' $as ../program $output
    done
    for output in 'hard fan --ci --report ../closed' \
        'compare tutorial --size 8x8 --json ../closed/there.json'; do
        exits 4 'found before the work' timeout 20 $as ../program $output
        check 'found before the work' test "$(wc -l <output)" = 1
    done
    # Threads: those of other users' processes do not count.
    for most in 0 3; do
        for with in ref gl truth; do
            does "at most $most more processes: $with" $as prlimit --nproc="$most" ../program render \
                tutorial --size 16x16 --threads 4 --with "$with" -o "$with.exr"
        done
        check 'the same bits' cmp ref.exr gl.exr
    done
    refuses 'no processes' 'child process: cannot start' $as prlimit --nproc=0 ../program bench \
        tutorial --size 8x8 --runs 1 --threads 1,2
    cd ..
}

# Memory: the driver's own is some 500 MiB of addresses.
small() {
    for with in ref truth; do
        does "a small stack: $with" prlimit --stack=262144 "$peel" render tutorial --size 64x64 \
            --with $with -o a.png
        does "100 MiB of addresses: $with" prlimit --as=104857600 "$peel" render tutorial \
            --size 64x64 --with $with -o a.png
        refuses "too few addresses: $with" 'out of memory' prlimit --as=104857600 "$peel" render \
            tutorial --size 2048x2048 --with $with -o a.png
    done
    refuses 'no addresses for the driver' 'OpenGL' prlimit --as=104857600 "$peel" render tutorial \
        --size 8x8 --with gl -o a.png
    does 'a small stack: gl' prlimit --stack=262144 "$peel" render tutorial --size 64x64 --with gl \
        -o a.png
}

# A language with decimal commas changes no number, read or written.
language() {
    localedef -i de_DE -f UTF-8 ./de_DE.UTF-8 2>output
    if [ ! -d de_DE.UTF-8 ]; then
        echo "surroundings: no language with decimal commas could be made (Debian's locales)"
        return
    fi
    for place in 'LC_ALL=C' "LC_ALL=de_DE.UTF-8 LOCPATH=$work TZ=Asia/Kathmandu"; do
        # shellcheck disable=SC2086 # words
        {
            does 'a language' env $place "$peel" explain tutorial --size 16x16 --pixel 4,4 \
                --background 0.5,0.25,0.125 --json pixel.json
            does 'a language' env $place "$peel" scenes tutorial -o scene.gltf
            does 'a language' env $place "$peel" render scene.gltf --size 8x8 --bias 0.0001 -o a.exr
            does 'a language' env $place "$peel" blend vectors --set random --count 20 -o v.csv
            does 'a language' env $place "$peel" bench tutorial --size 8x8 --runs 1 --passes 1,2 \
                --report out
        }
        cat pixel.json scene.gltf a.exr v.csv >"all.${place%%.*}"
        check 'a plot' grep -q '</svg>' out/passes.svg
    done
    check 'the same numbers' cmp all.LC_ALL=C all.LC_ALL=de_DE
}

# Nothing set, and places for temporary files and caches that are not there.
environment() {
    does 'no environment' env -i "$peel" compare tutorial --size 8x8 --report out
    does 'no HOME' env HOME=/nosuch "$peel" compare tutorial --size 8x8
    check 'no HOME: nothing is said of it' grep -q '^ref and truth agree' output
    does 'no TMPDIR' env TMPDIR=/nosuch "$peel" bench tutorial --size 8x8 --runs 1 --report out
    does 'no time zone' env TZ=:/nosuch "$peel" compare tutorial --size 8x8 --json a.json
}

streams
kinds
unprivileged
small
language
environment

echo "$passed passed, $failed failed"
[ $failed = 0 ]
