#!/bin/sh
# What becomes of every file of Debian's assimp-testmodels, of all formats, broken ones among them.
#
#   models.sh PEEL SOURCE_DIR [--gltf] [--all] [--update] [FOLDER]
#
# Each is rendered at 64x36, within 20 seconds of processor time and 1 GiB. It ends with exit code 0
# and a PNG, or with 4, one line that begins "peel: FILE: ", and no file; warnings may come before.
# What renders is rendered again at opacity 0.5, and compared; what is not named as glTF is tried
# again under such names. Prints what became of each glTF file and how often each other kind had each
# outcome (--all: each file), what took most, and exits 1 when an outcome breaks these rules or is
# not the one in data/golden/models.txt; --update writes that. --gltf takes glTF files alone.
# MODELS_MEBIBYTES, in the environment, is another limit than 1,024; 0: none.
set -u
peel=$(realpath "$1") || exit 1
golden=$(realpath "$2")/data/golden/models.txt || exit 1
shift 2
folder=/usr/share/assimp/models
only_gltf=
all=
update=
for argument; do
    case $argument in
    --gltf) only_gltf=1 ;;
    --all) all=1 ;;
    --update) update=1 ;;
    *) folder=$argument ;;
    esac
done
limited=$(dirname "$peel")/tests/limited

stop() {
    echo "models: $*" >&2
    exit 1
}
[ -d "$folder" ] || stop "no folder $folder: expected Debian's package assimp-testmodels"
[ -x "$limited" ] || stop "no program $limited: expected a build with tests"
command -v oiiotool >/dev/null || stop "no oiiotool: expected Debian's package openimageio-tools"
[ -z "$only_gltf$update" ] || [ "$only_gltf" != "$update" ] || stop "--update: expected no --gltf"

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 1' HUP INT TERM
mkdir "$work/scratch"
cd "$work/scratch" || exit 1
: >"$work/outcomes"
: >"$work/costs"
failed=0
count=0

violation() {
    echo "FAIL $name: $*"
    failed=$((failed + 1))
}

# run COMMAND...: code; errors and warnings are counted, the error's text is in `text`.
run() {
    rm -f out.png
    "$limited" "$work/record" 20 "${MODELS_MEBIBYTES-1024}" "$peel" "$@" >"$work/out" 2>"$work/err" </dev/null
    read -r code ms clock_ms kib <"$work/record"
    echo "$ms $clock_ms $((kib / 1024)) $1 $name" >>"$work/costs"
    errors=0
    text=
    while IFS= read -r line; do
        case $line in
        'peel: warning: '*) ;;
        *)
            errors=$((errors + 1))
            text=$line
            ;;
        esac
    done <"$work/err"
    [ "$ms" -lt 20000 ] || violation "$1 took $ms ms, expected below 20 s"
}

expect_png() {
    [ "$errors" = 0 ] || violation "an image, and '$text'"
    case $(oiiotool --info out.png 2>&1) in
    *'64 x   36, 3 channel'* | *'64 x   36, 4 channel'*) ;;
    *) violation "expected a PNG of 64x36" ;;
    esac
}

# Exit 4: one line that names the file, which is taken off it, and nothing else.
expect_refusal() {
    [ "$errors" = 1 ] || violation "$errors lines, expected 1"
    case $text in
    "peel: $file: "?*) text=${text#"peel: $file: "} ;;
    *) violation "'$text', expected a line that begins 'peel: $file: '" ;;
    esac
    [ ! -s "$work/out" ] || violation "refused, but there is output"
    [ ! -e out.png ] || violation "refused, but there is an image"
}

one_file() {
    name=${file#"$folder/"}
    run render "$file" --size 64x36 -o out.png
    if [ "$code" = 4 ]; then
        expect_refusal
        outcome="refused: $text"
    elif [ "$code" = 0 ]; then
        expect_png
        run render "$file" --size 64x36 --opacity 0.5 -o out.png
        [ "$code" = 0 ] || violation "at opacity 0.5: exit $code, expected 0; $text"
        expect_png
        run compare "$file" --size 64x36 --opacity 0.5
        outcome="rendered; compare at opacity 0.5: exit $code"
        [ "$errors" = 0 ] || violation "compare: '$text'"
        case $code in 0 | 2) ;; *) violation "compare: exit $code, expected 0 or 2" ;; esac
    else
        outcome="exit $code"
        violation "exit $code, expected 0 or 4; $(head -c 200 "$work/err")"
    fi
    rm -f out.png
    nothing_left
    kind=${name##*/}
    case $kind in *.*) kind=$(echo ".${kind##*.}" | tr '[:upper:]' '[:lower:]') ;; *) kind=none ;; esac
    printf '%s\t%s\t%s\n' "$kind" "$name" "$outcome" >>"$work/outcomes"
}

nothing_left() {
    set -- * .[!.]*
    [ "$*" = '* .[!.]*' ] || {
        violation "left behind: $*"
        rm -rf -- "$@"
    }
}

# one_renamed EXTENSION: the same bytes under a name of glTF. What a message quotes is left out.
one_renamed() {
    name="${model#"$folder/"} as .$1"
    file=$work/renamed.$1
    ln -s "$model" "$file"
    run render "$file" --size 64x36 -o out.png
    [ "$code" = 4 ] || violation "exit $code, expected 4; $(head -c 200 "$work/err")"
    expect_refusal
    nothing_left
    printf '%s\t%s\t%s\n' "any, named .$1" "$name" "refused: ${text%%[:,]*}" >>"$work/outcomes"
    rm -f "$file"
}

find "$folder" -type f | LC_ALL=C sort >"$work/files"
if [ -n "$only_gltf" ]; then
    grep -i '\.glb$\|\.gltf$' "$work/files" >"$work/chosen"
    mv "$work/chosen" "$work/files"
fi
total=$(wc -l <"$work/files")
while IFS= read -r model <&3; do
    count=$((count + 1))
    [ ! -t 2 ] || printf '\r\033[K%d of %d: %s' $count "$total" "${model##*/}" >&2
    file=$model
    one_file
    case $kind in .gltf | .glb) continue ;; esac
    one_renamed gltf
    one_renamed glb
done 3<"$work/files"
[ ! -t 2 ] || printf '\r\033[K' >&2

# Files by name, then the others' kinds with how many there are.
table() {
    awk -F '\t' -v all="$1" '
        all || $1 == ".gltf" || $1 == ".glb" { print $2 ": " $3; next }
        { kinds[$1 "\t" $3]++ }
        END {
            for (kind in kinds) {
                split(kind, part, "\t")
                printf "%d of kind %s: %s\n", kinds[kind], part[1], part[2] | "LC_ALL=C sort -k 4"
            }
        }' "$work/outcomes"
}
table "$all"
table '' >"$work/table"
if [ -n "$update" ]; then
    cp "$work/table" "$golden" || failed=$((failed + 1))
elif [ -n "$only_gltf" ]; then
    grep -v '^[0-9]* of kind ' "$golden" | diff - "$work/table" >"$work/diff"
else
    diff "$golden" "$work/table" >"$work/diff"
fi
if [ -s "$work/diff" ]; then
    failed=$((failed + 1))
    echo "FAIL other outcomes than in $golden (<; models.sh PEEL SOURCE_DIR --update):"
    cat "$work/diff"
fi
awk -F '\t' '{ what = $3; sub(/[:;].*/, "", what); of[what]++ }
    END { for (what in of) printf "%d %s\n", of[what], what }' "$work/outcomes" | LC_ALL=C sort
# most COLUMN: the run that has the most there.
most() {
    sort -n -k "$1,$1" "$work/costs" | tail -1 | cut -d' ' -f "$1,4-"
}
echo "processor time, ms: $(most 1)"
echo "on the clock, ms:   $(most 2)"
echo "memory, MiB:        $(most 3)"
echo "$count files, $failed failed"
[ $failed = 0 ]
