#!/bin/sh
# Every test of CI under AddressSanitizer, UndefinedBehaviorSanitizer and LeakSanitizer.
#
#   leaks.sh [SOURCE_DIR] [REGEX]   all tests, or those whose names match REGEX
#
# Exits 1 if a test fails or a process of one reports anything.
set -u
. "$(dirname "$0")/analysis.sh"

build sanitize
export ASAN_OPTIONS="log_path=$logs/report:detect_leaks=1:detect_stack_use_after_return=1"
export UBSAN_OPTIONS="log_path=$logs/report:print_stacktrace=1"
export LSAN_OPTIONS="suppressions=$here/leaks.supp:print_suppressions=0"
export CK_TIMEOUT_MULTIPLIER=10
run_tests '^$'
count_reports
