#!/bin/sh
# Every shell script of the repository under shellcheck.
#
#   shell.sh [SOURCE_DIR]
#
# Exits 1 if it finds anything. Exceptions: .shellcheckrc.
set -u
. "$(dirname "$0")/analysis.sh"

needs shellcheck shellcheck
cd "$root" || exit 1
scripts=$(find . -name 'build*' -prune -o -name node_modules -prune -o -name .git -prune -o \
    -type f \( -name '*.sh' -o -name run -o -path ./tests/determinism \) -print | LC_ALL=C sort)
# shellcheck disable=SC2086 # a list of words
findings=$(shellcheck -f gcc $scripts) # in one go: what they read is known
[ -z "$findings" ] || printf '%s\n' "$findings"
count=$(printf '%s' "$findings" | grep -c .)
# shellcheck disable=SC2086
set -- $scripts
echo "$name: $count findings in $# scripts"
[ "$count" = 0 ]
