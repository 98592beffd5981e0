#!/bin/sh
# Manual pages and completion against the program: each option of every command's --help stands in
# its page and the other way round, the pages format without a warning, and what bash offers for an
# option is what the program takes for it.
# Usage: pages.sh PEEL SOURCE_DIR
set -u
peel=$1
. "$2/tests/cli/checks.sh"
export LC_ALL=C.UTF-8


"$peel" --man --list >names
check 'a page for each command' [ "$(wc -l <names)" -ge 18 ]
while read -r name; do
    exits 0 "page $name" "$peel" --man "$name"
    cp output "$name.1"
    command=$(echo "$name" | tr - ' ')
    case $name in
    peel | peel-blend) continue ;;
    peel-explain)
        # Three commands in one.
        "$peel" explain --help >help
        "$peel" explain --pixel 0,0 --help >>help
        "$peel" explain --course --help >>help
        ;;
    *)
        # shellcheck disable=SC2086 # words
        "$peel" ${command#peel } --help >help
        ;;
    esac
    {
        echo help
        sed -n 's/^ *\(-[a-zA-Z][^-]*, \)\{0,1\}--\([a-z][a-z-]*\).*/\2/p' help
    } | LC_ALL=C sort -u >of_help
    sed -n '/^\.SH OPTIONS/,/^\.SH [^O]/p' "$name.1" |
        sed -n 's/.*\\fB\\-\\-\([a-z][a-z\\-]*\)\\fR.*/\1/p' | sed 's/\\//g' |
        LC_ALL=C sort -u >of_page
    check "options of $name" cmp of_help of_page
    check "$name has options" [ -s of_page ]
done <names
check 'no page without name' [ "$("$peel" --man | head -c 3)" = .TH ]
exits 4 'no such page' "$peel" --man nonsense
exits 4 'no such shell' "$peel" --completion ksh
exits 4 'version of what' "$peel" --version 2

# ---- the version ----

exits 0 'version' "$peel" --version
has 'version first' '^peel [0-9]*\.[0-9]*\.[0-9]*$'
for fact in compiler build flags sanitizers simd flushing source Assimp OpenEXR jansson zlib GMP \
    nettle glibc libjpeg-turbo libpng OSMesa; do
    has "fact $fact" "^$fact  *[^ ]"
done
has 'the flags that bits rest on' '^flags .*-ffp-contract=off'
exits 0 'version as JSON' "$peel" --version --json
cp output version.json
json_holds 'version as JSON' version.json 'd.version && d.simd.includes("scalar") &&
    d.simd.includes(d.simd_here) && d.libraries.zlib.built && d.libraries.zlib.runs'
mkdir broken && : >broken/libOSMesa.so.8
exits 0 'version without OSMesa' env LD_LIBRARY_PATH="$work/broken" "$peel" --version
has 'version without OSMesa' '^OSMesa .*found none$'

# ---- the pages' form ----

if command -v man >/dev/null && command -v groff >/dev/null; then
    for page in *.1; do
        MANWIDTH=80 man --warnings -l "$page" >page.txt 2>warnings
        check "warnings of $page" [ ! -s warnings ]
        cp page.txt output
        has "sections of $page" '^EXIT STATUS'
        narrow "width of $page" 80
    done
else
    echo 'pages: formatting not checked: install man-db and groff'
fi

# ---- completion ----

for shell in bash zsh fish; do
    exits 0 "completion of $shell" "$peel" --completion $shell
    cp output "peel.$shell"
    if command -v $shell >/dev/null; then
        exits 0 "syntax of $shell" $shell -n "peel.$shell"
    else
        echo "pages: syntax not checked: no $shell"
    fi
done

# offers WORD...: what bash offers for the last word, in `output`.
offers() {
    bash -c '. ./peel.bash
        COMP_WORDS=("$@")
        COMP_CWORD=$(($# - 1))
        _peel
        printf "%s\n" "${COMPREPLY[@]}"' bash "$@" >output 2>errors || echo FAILED >>output
    cat errors >>output
}
# is WHAT WORD...: output is these words in this order.
is() {
    what=$1
    shift
    [ $# = 0 ] && : >expected || printf '%s\n' "$@" >expected
    check "$what" cmp output expected
}
mkdir files files/folder
for file in a.gltf b.glb c.png d.exr e.txt; do : >files/$file; done
offers peel re
is 'a command' render
offers peel blend v
is 'a subcommand' vectors
offers peel compare --cull ''
is 'values' gltf seed none
offers peel compare --cull = s
is 'values behind =' seed
offers peel render --with ''
is 'renderers' ref gl truth
offers peel blend check --gl
is 'an option whose value is optional' --gl
offers peel render tuto
is 'a scene' tutorial
offers peel hard fan
is 'a hard case' fan
LC_ALL=C offers peel render tutorial -o files/
LC_ALL=C sort -o output output
is 'files to write' files/c.png files/d.exr files/folder
offers peel compare files/
LC_ALL=C sort -o output output
is 'scene files' files/a.gltf files/b.glb files/folder
offers peel compare --report files/
is 'folders' files/folder
offers peel nonsense --
printf '' >expected
check 'nothing for what is no command' [ -z "$(cat output)" ]

# Every option of compare that has values: the program names the same ones when it refuses another.
offers peel compare --
grep '^--' output >options
checked=0
while read -r option; do
    case $option in --method | --passes | --fma | --gl | --profile) continue ;; esac
    offers peel compare "$option" ''
    cp output values
    "$peel" compare tutorial "$option" no-such-value >/dev/null 2>refusal
    list=$(sed -n "s/^peel: $option no-such-value: expected //p" refusal)
    case $list in *' or '*) ;; *) continue ;; esac
    case $list in *[!a-z0-9,\ -]*) continue ;; esac
    grep -q . values || continue
    checked=$((checked + 1))
    echo "$list" | sed 's/,* or /\n/; s/, /\n/g' >expected
    check "values of $option" cmp values expected
done <options
check 'values were compared' [ $checked -ge 12 ]
for method in $("$peel" methods | sed -n 's/^\([a-z][a-z-]*\) .*/\1/p'); do
    offers peel plan --method "$method"
    has "method $method" "^$method\$"
done

echo "$passed passed, $failed failed"
[ $failed = 0 ]
