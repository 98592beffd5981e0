#!/bin/sh
# Scans the #include "..." lines of src/, ref/ and gl/ for violations of the folders' order:
# includes point only upstream, and the truth never sees the pipeline's arithmetic.
#
#   includes.sh ROOT          prints every violation as file:line and exits 1 if there is one
#   includes.sh --self ROOT   checks ROOT, then that violations planted in a copy are found
set -eu

scan() {
    (cd "$1" && find src ref gl -name '*.[ch]' | LC_ALL=C sort | xargs grep -n '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' /dev/null) |
        awk -v root="$1" '
# The folder that a path belongs to.
function folder(path, part) {
    split(path, part, "/")
    return part[1] == "gl" ? "gl" : part[2]
}
function exists(path, line) {
    if (!(path in known)) {
        known[path] = (getline line < (root "/" path)) >= 0
        close(root "/" path)
    }
    return known[path]
}
# "a/b/../c" as "a/c".
function simplify(path) {
    while (sub(/[^\/]+\/\.\.\//, "", path))
        ;
    return path
}
# The file that an include names: beside the includer, or on the include path of its target.
function resolve(file, name, directory) {
    directory = file
    sub(/[^\/]*$/, "", directory)
    if (exists(simplify(directory name)))
        return simplify(directory name)
    if (exists("src/" name))
        return "src/" name
    if (exists(name))
        return name
    if (folder(file) == "gl" && exists("gl/" name))
        return "gl/" name
    return ""
}
function report(place, text) {
    print place ": " text
    failed = 1
}
# First forbidden header that can be reached from file, "" if none.
function reaches_arithmetic(file, visited, i, found, count, list) {
    if (file ~ /^src\/(number\/(op|blend)|blend\/)/)
        return file
    if (file in visited)
        return ""
    visited[file] = 1
    count = split(edges[file], list, " ")
    for (i = 1; i <= count; i++)
        if ((found = reaches_arithmetic(list[i], visited)) != "")
            return found
    return ""
}
BEGIN {
    upstream["base"] = " base "
    upstream["number"] = " number" upstream["base"]
    upstream["blend"] = " blend" upstream["number"]
    upstream["image"] = " image" upstream["blend"]
    upstream["scene"] = " scene" upstream["image"]
    upstream["frame"] = " frame" upstream["scene"]
    upstream["compare"] = " compare" upstream["frame"]
    upstream["study"] = " study" upstream["compare"]
    upstream["report"] = " report" upstream["study"]
    upstream["pipeline"] = " pipeline" upstream["frame"]
    upstream["truth"] = " truth" upstream["frame"]
    upstream["gl"] = " gl" upstream["frame"]
    upstream["cli"] = " cli pipeline truth gl" upstream["report"]
}
{
    split($0, field, ":")
    file = field[1]
    place = file ":" field[2]
    match($0, /"[^"]*"/)
    name = substr($0, RSTART + 1, RLENGTH - 2)
    lines++
    target = resolve(file, name)
    if (target == "") {
        report(place, "\"" name "\" is nowhere on the include path")
        next
    }
    if (!(folder(file) in upstream))
        report(place, "folder " folder(file) " has no place in the order of folders")
    else if (index(upstream[folder(file)], " " folder(target) " ") == 0)
        report(place, folder(file) " must not include " target)
    edges[file] = edges[file] " " target
    if (folder(file) == "truth")
        truth[file] = 1
}
END {
    for (file in truth) {
        delete visited
        if ((found = reaches_arithmetic(file, visited)) != "")
            report(file, "truth must not see " found)
    }
    if (lines < 100)
        report(root, "only " lines " includes found: this is not the source tree")
    exit failed
}'
}

# planted FILE LINE: the line at the end of a copy of FILE must turn the scan red.
planted() {
    cp "$copy/$1" "$copy/saved"
    printf '%s\n' "$2" >>"$copy/$1"
    if scan "$copy" >"$copy/found"; then
        echo "$1: the planted line was not found: $2"
        exit 1
    fi
    grep -q "^$1" "$copy/found" || {
        echo "$1: the planted line was reported elsewhere:"
        cat "$copy/found"
        exit 1
    }
    cp "$copy/saved" "$copy/$1"
}

if [ "$1" != --self ]; then
    scan "$1"
    exit
fi
scan "$2"
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
cp -R "$2/src" "$2/ref" "$2/gl" "$copy"
planted src/base/pool.c '#include "number/format.h"'
planted src/number/format.c '#include "image/image.h"'
planted src/frame/view.c '#include "ref/pipeline/setup.h"'
planted src/compare/store.c '  #  include "study/threeway.h"'
planted src/study/threeway.c '#include "gl/gl_renderer.h"'
planted src/report/html.c '#include "cli/options.h"'
planted ref/pipeline/setup.c '#include "ref/truth/truth.h"'
planted ref/truth/truth.c '#include "number/blend.h"'
planted ref/truth/truth.c '#include "blend/arithmetic.h"'
planted ref/truth/soup.h '#include "../../src/number/op.h"'
planted ref/truth/coverage.c '#include "ref/pipeline/setup.h"'
planted gl/passes.c '#include "compare/metrics.h"'
planted gl/passes.c '#include "no/such/file.h"'
# A header that truth may include must not bring the arithmetic along.
cp "$copy/src/number/format.h" "$copy/format.h"
printf '#include "number/op.h"\n' >>"$copy/src/number/format.h"
if scan "$copy" >"$copy/found"; then
    echo "ref/truth: op.h behind number/format.h was not found"
    exit 1
fi
cp "$copy/format.h" "$copy/src/number/format.h"
scan "$copy"
