# For the scripts beside it, which read it first: a scratch directory to work in, and counts.
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
