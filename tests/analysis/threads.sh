#!/bin/sh
# Every test of CI under ThreadSanitizer.
#
#   threads.sh [SOURCE_DIR] [REGEX]   all tests, or those whose names match REGEX
#
# Exits 1 if a test fails or a process of one reports anything.
set -u
. "$(dirname "$0")/analysis.sh"

build thread
# No search for deadlocks: Mesa holds more locks at a time than it counts (64), of which it dies.
export TSAN_OPTIONS="log_path=$logs/report:suppressions=$here/threads.supp:detect_deadlocks=0"
export CK_TIMEOUT_MULTIPLIER=20
run_tests "^($uninstrumented)\$"
count_reports
