#!/bin/sh
# gcc's static analyzer over all of src, ref and gl.
#
#   analyzer.sh [SOURCE_DIR]
#
# Exits 1 if it finds anything.
set -u
. "$(dirname "$0")/static.sh"

examine analyzer ': error: .*\[-Werror='
