#!/bin/sh
# Killed half-way: no file under its final name, and none under another. Usage: killed.sh PEEL
set -u
peel=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1

"$peel" render alpha_ladder --size 1280x720 --trace trace.exr >/dev/null 2>&1 &
process=$!
tries=0
until [ -n "$(find . -name '.peel-*')" ]; do # it is writing
    tries=$((tries + 1))
    if [ $tries -gt 1500 ] || [ -e trace.exr ]; then
        echo "FAIL no temporary file was seen"
        exit 1
    fi
    sleep 0.02
done
kill -TERM $process
wait $process
code=$?
left=$(find . -type f)
if [ $code != 143 ] || [ -n "$left" ]; then
    echo "FAIL exit $code (expected 143, by SIGTERM), left behind: '$left'"
    exit 1
fi
echo "1 passed, 0 failed"
