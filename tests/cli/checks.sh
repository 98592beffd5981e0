# shellcheck shell=sh
# For the scripts beside it, which read it first: a scratch directory to work in, and counts.
case ${peel-} in
*/*) peel=$(realpath "$peel") || exit 1 ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failed=0
passed=0

# exits CODE WHAT COMMAND...: output in `output`.
exits() {
    code=$1
    what=$2
    shift 2
    "$@" >output 2>&1
    got=$?
    if [ $got = "$code" ]; then
        passed=$((passed + 1))
    else
        echo "FAIL $what: $*: exit $got, expected $code"
        tail -5 output
        failed=$((failed + 1))
    fi
}

# check WHAT COMMAND...: it succeeds.
check() {
    what=$1
    shift
    if "$@"; then
        passed=$((passed + 1))
    else
        echo "FAIL $what: $*"
        failed=$((failed + 1))
    fi
}

# has WHAT PATTERN [FILE]: the file, `output` unless it is given, has a line that matches.
has() {
    if grep -q -- "$2" "${3-output}"; then
        passed=$((passed + 1))
    else
        echo "FAIL $1: no '$2' in ${3-output}:"
        head -40 "${3-output}"
        failed=$((failed + 1))
    fi
}

# narrow WHAT [COLUMNS]: no line of `output` is wider, than 100 columns unless it is said.
narrow() {
    if awk -v most="${2-100}" 'length > most { exit 1 }' output; then
        passed=$((passed + 1))
    else
        echo "FAIL $1: wider than ${2-100} columns:"
        awk -v most="${2-100}" 'length > most' output
        failed=$((failed + 1))
    fi
}

# json_holds WHAT FILE EXPRESSION: JavaScript of d, the document; `output` stays.
json_holds() {
    if node -e "const d = JSON.parse(require('fs').readFileSync('$2'));
        process.exit($3 ? 0 : 1)"; then
        passed=$((passed + 1))
    else
        echo "FAIL $1: in $2, expected $3"
        failed=$((failed + 1))
    fi
}

# opaque_red FROM TO: a glTF whose material red is opaque, so that some surfaces are hidden.
opaque_red() {
    exits 0 'the red plane is opaque' node -e "const fs = require('fs');
        const scene = JSON.parse(fs.readFileSync('$1'));
        scene.materials.find((one) => one.name === 'red').alphaMode = 'OPAQUE';
        fs.writeFileSync('$2', JSON.stringify(scene))"
}
