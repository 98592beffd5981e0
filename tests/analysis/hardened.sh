#!/bin/sh
# Every test of CI with the C library's checks (_FORTIFY_SOURCE=3) and gcc's of the stack, at -Os.
#
#   hardened.sh [SOURCE_DIR] [REGEX]   all tests, or those whose names match REGEX
#
# Exits 1 if a test fails.
set -u
. "$(dirname "$0")/analysis.sh"

build hardened
run_tests '^$'
echo "$name: $tests tests, $failed failed (in $logs)"
[ "$failed" = 0 ]
