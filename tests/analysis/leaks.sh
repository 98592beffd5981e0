#!/bin/sh
# Every test of CI under AddressSanitizer, UndefinedBehaviorSanitizer and LeakSanitizer.
#
#   leaks.sh [SOURCE_DIR] [REGEX]   all tests, or those whose names match REGEX
#
# Exits 1 if a test fails or a process of one reports anything.
#
# By gcc: clang 14's LeakSanitizer crashes where a library of Mesa's has been unloaded. CI has
# clang's for the unit tests.
#
# gcc 12 misaligns 64-byte locals where it looks for uses after return (its bug 110027): that is off.
set -u
. "$(dirname "$0")/analysis.sh"

build sanitize-gcc
export ASAN_OPTIONS="log_path=$logs/report:detect_leaks=1"
export UBSAN_OPTIONS="log_path=$logs/report:print_stacktrace=1"
export CK_TIMEOUT_MULTIPLIER=10
run_tests '^$'
count_reports
