#!/bin/sh
# gcc's static analyzer over all of src, ref and gl.
#
#   analyzer.sh [SOURCE_DIR]
#
# Exits 1 if it finds anything. Not asked for leaks: gcc 12 takes what is stored through a pointer
# that a function was given for lost; leaks.sh finds those that happen. Nor for uninitialised values:
# where gcc 12 merges states it believes that a loop over an array ends after one element; clang's
# analyzer (tidy.sh) and valgrind.sh look for those.
set -u
. "$(dirname "$0")/static.sh"

examine analyzer ': error: .*\[-Werror='
