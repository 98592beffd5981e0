#!/bin/sh
# Every test of CI under ThreadSanitizer.
#
#   threads.sh [SOURCE_DIR] [REGEX]   all tests, or those whose names match REGEX
#
# Exits 1 if a test fails or a process of one reports anything.
set -u
. "$(dirname "$0")/analysis.sh"

build thread
export TSAN_OPTIONS="log_path=$logs/report:suppressions=$here/threads.supp:second_deadlock_stack=1"
export CK_TIMEOUT_MULTIPLIER=20
run_tests '^$'
count_reports
