#!/bin/sh
# Every test of CI under AddressSanitizer, UndefinedBehaviorSanitizer and LeakSanitizer.
#
#   leaks.sh [SOURCE_DIR] [REGEX]   all tests, or those whose names match REGEX
#
# Exits 1 if a test fails or a process of one reports anything.
#
# By gcc; CI has clang's for the unit tests. LeakSanitizer does not look into thread-local storage
# for what is still in use: it crashes at that of Mesa's libraries that have been unloaded. gcc 12
# misaligns 64-byte locals where it looks for uses after return (its bug 110027): that is off.
set -u
. "$(dirname "$0")/analysis.sh"

build sanitize-gcc
export ASAN_OPTIONS="log_path=$logs/report:detect_leaks=1"
export LSAN_OPTIONS="use_tls=0:suppressions=$here/leaks.supp:print_suppressions=0"
export UBSAN_OPTIONS="log_path=$logs/report:print_stacktrace=1"
export CK_TIMEOUT_MULTIPLIER=10
run_tests "^($uninstrumented)\$"
count_reports
