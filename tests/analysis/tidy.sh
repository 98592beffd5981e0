#!/bin/sh
# clang-tidy over all of src, ref and gl, by the checks of .clang-tidy.
#
#   tidy.sh [SOURCE_DIR]
#
# Exits 1 if it finds anything.
set -u
. "$(dirname "$0")/static.sh"

needs clang-tidy clang-tidy
examine tidy ': error: .*\[[a-z].*[-,]warnings-as-errors\]$'
