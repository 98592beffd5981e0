#!/bin/sh
# The tests of CI under valgrind: reads of what was never written, leaks, memory out of bounds.
#
#   valgrind.sh [SOURCE_DIR] [REGEX]   all tests, or those whose names match REGEX
#
# The build flushes denormals in software, because valgrind has no such mode, and has no vector
# paths. Random cases are few: PEEL_TEST_COUNT, 10 unless it is set. Hours for all tests.
#
# Not run, because nothing of Peel would run under valgrind: what node starts (gltf_validator,
# live_view, web_*), what a compiler makes of the installed library (package), includes, shell; nor
# models_gltf, which has 20 seconds for each file; nor the campaign and the tests of single values in
# the driver's arithmetic (labs.h), which go to the least numbers, where Mesa relies on the mode that
# valgrind has not, as alpha_ladder's alpha does in explain and blend_check's vectors do; nor bench,
# which hides all programs, valgrind too, nor killed, which waits seconds for a file to be begun; nor
# tests of limits (testing.h).
# What else is not reported, and why: valgrind.supp.
# Exits 1 if a test fails or a process of one reports anything.
set -u
. "$(dirname "$0")/analysis.sh"

needs valgrind valgrind
build software -DCMAKE_CROSSCOMPILING_EMULATOR=valgrind
# What is possibly lost does not count: Mesa keeps pointers behind its own headers only. Valgrind 3.19
# does not know the ioctl by which a terminal is opened (TIOCGPTPEER).
export VALGRIND_OPTS="--quiet --sim-hints=lax-ioctls --leak-check=full --show-leak-kinds=definite \
--errors-for-leak-kinds=definite --suppressions=$here/valgrind.supp \
--num-callers=30 --fullpath-after=$root/ --log-file=$logs/report.%p"
export CK_TIMEOUT_MULTIPLIER=100 PEEL_TEST_COUNT="${PEEL_TEST_COUNT-10}" PEEL_TEST_STRIDE=100003
export CK_EXCLUDE_TAGS=limits
without='bench|blend_check|explain|killed|gltf_validator|live_view|web_.*|package|includes|shell|models_gltf'
without="$without|campaign.*|test_(arithmetic|blend_factors|blend_gl|driver|gl_formats)(_unfused)?"
run_tests "^($without|$uninstrumented)\$"
count_reports
