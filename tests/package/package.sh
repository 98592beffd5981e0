#!/bin/sh
# The installed library, as others find it: by find_package(peel CONFIG) and by pkg-config, shared
# and static, from C99 and C++, in an empty folder and without an environment.
# Usage: package.sh BUILD_DIR SOURCE_DIR CC CXX FLAGS
#   FLAGS: of compiling and linking, such as -fsanitize=address,undefined; may be empty
set -eu
build=$1
source=$2
cc=$3
cxx=$4
flags=$5
warnings='-Wall -Wextra -Wpedantic -Wshadow -Wundef -Werror'
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "FAIL $*"
    exit 1
}

# clean COMMAND...: without variables that could point to the build tree.
clean() {
    env -i PATH=/usr/bin:/bin LANG=C ASAN_OPTIONS="${ASAN_OPTIONS-}" "$@"
}

# The installation is moved once it is there: nothing in it may know where it was.
DESTDIR='' cmake --install "$build" --prefix "$work/first" >"$work/log" 2>&1 || {
    cat "$work/log"
    fail 'cmake --install'
}
mkdir "$work/moved"
mv "$work/first" "$work/moved/here"
prefix=$work/moved/here
libdir=$(dirname "$(find "$prefix" -name libpeel.a)")
for file in bin/peel include/peel.h include/peel_dump.h include/peel_shade.h \
    share/man/man1/peel.1.gz share/man/man1/peel-render.1.gz share/doc/peel/README.md \
    share/bash-completion/completions/peel share/zsh/vendor-completions/_peel \
    share/fish/vendor_completions.d/peel.fish; do
    [ -f "$prefix/$file" ] || fail "not installed: $file"
done
"$prefix/bin/peel" methods >/dev/null || fail 'the installed program does not run'
if grep -rlF -e "$build" -e "$source" -e "$work/first" "$libdir/cmake" "$libdir/pkgconfig"; then
    fail 'these files name a folder of the build'
fi

# Exported: peel_* alone. Needed: GMP and the C library.
nm -D --defined-only "$libdir/libpeel.so" | awk '{print $NF}' >"$work/exported"
nm -g --defined-only "$libdir/libpeel.a" | awk 'NF == 3 {print $NF}' >>"$work/exported"
sed -n 's/^PEEL_API .*[ *]\(peel_[a-z_]*\)(.*/\1/p' "$prefix/include/peel.h" | LC_ALL=C sort \
    >"$work/declared"
[ "$(wc -l <"$work/declared")" -ge 20 ] || fail 'too few functions found in peel.h'
LC_ALL=C sort "$work/exported" >"$work/sorted"
LC_ALL=C sort "$work/declared" "$work/declared" | diff - "$work/sorted" >"$work/log" || {
    cat "$work/log"
    fail 'what is declared (<) is not what the two libraries export (>)'
}
readelf -d "$libdir/libpeel.so" | sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' >"$work/needed"
while read -r name; do
    case $name in
    libc.so.* | libm.so.* | libgmp.so.* | ld-linux* | libasan.so.* | libubsan.so.*) ;;
    *) fail "libpeel.so needs $name" ;;
    esac
done <"$work/needed"

# The header alone, as the language's standards have it.
echo '#include <peel.h>' >"$work/header.c"
for standard in c99 c11 c17; do
    # shellcheck disable=SC2086 # a list of words
    "$cc" -std=$standard $warnings -Wstrict-prototypes -I"$prefix/include" -fsyntax-only \
        "$work/header.c" || fail "peel.h in $standard"
done
for standard in c++11 c++20; do
    # shellcheck disable=SC2086 # a list of words
    "$cxx" -std=$standard $warnings -I"$prefix/include" -fsyntax-only -x c++ "$work/header.c" ||
        fail "peel.h in $standard"
done

# An empty folder with the user's files; the program in README among them.
mkdir "$work/user"
cp "$source/tests/package/CMakeLists.txt" "$source/tests/package/example.c" \
    "$source/tests/package/example.cpp" "$work/user"
sed -n '/^### The library/,/^##/{/^    #include/,/^    }$/s/^    //p;}' "$source/README.md" \
    >"$work/user/readme.c"
lines=$(wc -l <"$work/user/readme.c")
if [ "$lines" -lt 10 ] || [ "$lines" -gt 30 ]; then
    fail "README's program has $lines lines"
fi

if ! clean cmake -S "$work/user" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$prefix" \
    -DCMAKE_C_COMPILER="$cc" -DCMAKE_CXX_COMPILER="$cxx" -DCMAKE_C_FLAGS="$flags $warnings" \
    -DCMAKE_CXX_FLAGS="$flags $warnings" >"$work/log" 2>&1 ||
    ! clean cmake --build "$work/cmake" >>"$work/log" 2>&1; then
    cat "$work/log"
    fail 'find_package(peel CONFIG)'
fi

# pkg_config OUTPUT FILE COMPILER OPTION...: compiles and links, static with --static.
pkg_config() {
    output=$1
    file=$2
    compiler=$3
    shift 3
    words=$(clean PKG_CONFIG_PATH="$libdir/pkgconfig" pkg-config --cflags --libs peel)
    [ "${1-}" = --static ] &&
        words="$(clean PKG_CONFIG_PATH="$libdir/pkgconfig" pkg-config --static --cflags --libs peel |
            sed 's/-lpeel/-l:libpeel.a/')"
    # shellcheck disable=SC2086 # lists of words
    clean "$compiler" $flags $warnings -o "$work/$output" "$work/user/$file" $words ||
        fail "pkg-config: $output"
}
pkg_config pc_shared example.c "$cc"
pkg_config pc_static example.c "$cc" --static
pkg_config pc_cpp example.cpp "$cxx"
pkg_config pc_readme readme.c "$cc"

# All of them print the same; the static ones run without the shared library.
run() {
    clean "$@" >"$work/out" 2>&1 || {
        cat "$work/out"
        fail "$1"
    }
}
run LD_LIBRARY_PATH="$libdir" "$work/pc_shared" "$work/picture.ppm"
cp "$work/out" "$work/expected"
cat "$work/expected"
[ "$(wc -c <"$work/picture.ppm")" -eq $((320 * 240 * 3 + 15)) ] || fail 'the picture is incomplete'
[ -z "${PEEL_KEEP_PICTURE-}" ] || cp "$work/picture.ppm" "$PEEL_KEEP_PICTURE"
for program in pc_static cmake/example_shared cmake/example_static; do
    run "$work/$program"
    diff "$work/expected" "$work/out" || fail "$program prints something else"
done
if readelf -d "$work/pc_static" "$work/cmake/example_static" | grep libpeel; then
    fail 'a static program needs the shared library'
fi
for program in pc_cpp cmake/example_cpp; do
    run LD_LIBRARY_PATH="$libdir" "$work/$program"
    grep -q '64 128 191 127' "$work/out" || fail "$program"
done
run LD_LIBRARY_PATH="$libdir" "$work/pc_readme"
run "$work/cmake/readme"
cat "$work/out"
echo 'package: find_package and pkg-config, shared and static, C and C++'
