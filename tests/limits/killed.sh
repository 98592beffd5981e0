#!/bin/sh
# Killed half-way: no file under its final name but whole ones; by signals that can be caught, none
# under another, and the terminal is clean. Usage: killed.sh PEEL SOURCE_DIR [all]: every command,
# at many moments
set -u
peel=$1
source=$2
all=${3-}
. "$source/tests/cli/checks.sh"
. "$source/tests/limits/writers.sh"
export LC_ALL=C

# A shell's background commands ignore SIGINT and SIGQUIT.
heeding="env --default-signal=INT,QUIT"

# wait_for COMMAND...: until it succeeds, half a minute at most.
wait_for() {
    tries=0
    until "$@"; do
        tries=$((tries + 1))
        [ $tries -lt 1500 ] || return 1
        sleep 0.02
    done
}

writes() {
    [ -n "$(find got -name '.peel-*')" ]
}

# While it writes a trace, which takes a second or more.
writing() {
    rm -rf got && mkdir got
    (cd got && exec $heeding "$peel" render alpha_ladder --size 960x540 --trace trace.exr) >output 2>&1 &
    process=$!
    check 'a temporary file is seen' wait_for writes
    kill -"$1" $process
    wait "$process" 2>output
    code=$?
    check "by $1: exit $code, expected $2" test $code = "$2"
    check "by $1: no trace" test ! -e got/trace.exr
    [ "$1" = KILL ] || check "by $1: nothing is left" test -z "$(find got -type f)"
}

# Progress in a terminal: nothing of its line stays.
terminal() {
    cat >terminal.sh <<END
echo \$\$ >process
exec "$peel" render alpha_ladder --size 1280x720 -o out.png --method linked-list --model all
END
    rm -f process
    $heeding script -fqec 'sh terminal.sh' typescript >output 2>&1 &
    session=$!
    check 'the terminal has a process' wait_for test -s process
    check 'the terminal shows progress' wait_for grep -q "$(printf '\033')" typescript
    kill -INT "$(cat process)"
    wait $session
    code=$?
    check "interrupted in a terminal: exit $code, expected 130" test $code = 130
    printf '\r\033[K' >expected
    sed '/^Script/d' typescript | tr -d '\n' | tail -c 4 >got_end
    check 'the line is cleared' cmp expected got_end
    check 'no image' test ! -e out.png
}

# At moments spread over the time that the command takes: whatever it has done by then is whole.
try() {
    rm -rf whole && mkdir whole
    started=$(date +%s%N)
    (cd whole && exec "$peel" "$@") >output 2>&1
    took=$((($(date +%s%N) - started) / 1000000))
    for moment in 1 2 3 4 5 6 7 8 9; do
        signal=$(echo TERM INT HUP KILL TERM INT HUP KILL TERM | cut -d ' ' -f "$moment")
        rm -rf got && mkdir got
        (cd got && exec $heeding "$peel" "$@") >output 2>&1 &
        process=$!
        after=$(printf '%06d' $((took * moment / 10)))
        sleep "${after%???}.${after#???}"
        kill "-$signal" "$process" 2>/dev/null
        wait "$process" 2>/dev/null
        [ "$signal" != KILL ] || find got -name '.peel-*' -delete
        left=$(leftovers "$work/got" "$work/whole")
        check "$signal after $after ms: $*: $left" test -z "$left"
    done
}

writing TERM 143
writing INT 130
writing HUP 129
writing ABRT 134
writing QUIT 131
writing XCPU 152
writing USR1 138
writing KILL 137
terminal
if [ -n "$all" ]; then
    check inputs inputs
    each try
    each_slow try
fi

echo "$passed passed, $failed failed"
[ $failed = 0 ]
