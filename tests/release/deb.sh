#!/bin/sh
# Debian's packages of a build: made by cpack, their contents and dependencies, and the program from
# the unpacked one.
# Usage: deb.sh PEEL SOURCE_DIR BUILD_DIR
set -u
build=$3
. "$2/tests/cli/checks.sh"
for tool in dpkg-shlibdeps dpkg-deb file; do
    command -v $tool >/dev/null || {
        echo "deb: no $tool here: install dpkg-dev and file"
        exit 77
    }
done

version=$("$1" --version | sed -n '1s/^peel //p')
library=libpeel${version%.*}
exits 0 'cpack' cpack --config "$build/CPackConfig.cmake" -G DEB -B "$work/packages"
for name in peel "$library" libpeel-dev; do
    set -- packages/"${name}_${version}"_*.deb
    exits 0 "contents of $name" dpkg-deb -x "$1" root
    dpkg-deb -I "$1" >"$name.info"
    dpkg-deb -c "$1" >"$name.files"
    has "maintainer of $name" '^ Maintainer: .*@' "$name.info"
    has "summary of $name" '^ Description: [a-z]' "$name.info"
    check "owners in $name" [ -z "$(grep -v ' root/root ' "$name.files")" ]
    check "nothing outside usr in $name" [ -z "$(grep -v ' \./usr/' "$name.files")" ]
done
for needed in libassimp5 libopenexr libjansson4 libjpeg62-turbo libpng16-16 libgmp10 libnettle zlib1g libc6 libosmesa6; do
    has 'what the program needs' "^ Depends: .*$needed" peel.info
done
has 'what the library needs' '^ Depends: libc6 [^,]*, libgmp10 [^,]*$' "$library.info"
has 'what compiling needs' "^ Depends: $library (= $version), libgmp-dev" libpeel-dev.info
for file in bin/peel share/man/man1/peel.1.gz share/man/man1/peel-blend-eval.1.gz \
    share/bash-completion/completions/peel share/zsh/vendor-completions/_peel \
    share/fish/vendor_completions.d/peel.fish share/doc/peel/README.md; do
    has "peel has $file" " \./usr/$file\$" peel.files
done
has 'the library by its version' "/libpeel\.so\.$version\$" "$library.files"
for file in 'include/peel\.h' '.*/libpeel\.a' '.*/libpeel\.so -> .*' '.*/pkgconfig/peel\.pc' \
    '.*/cmake/peel/peelConfig\.cmake'; do
    has "libpeel-dev has $file" " \./usr/$file\$" libpeel-dev.files
done
check 'one owner of each file' [ -z "$(cat ./*.files | grep -v '/$' | awk '{print $6}' |
    sort | uniq -d)" ]
check 'stripped' [ -z "$(readelf -S root/usr/bin/peel | grep debug_info)" ]

# The unpacked program, where nothing of the build is.
exits 0 'the packaged program' env -i PATH=/usr/bin:/bin root/usr/bin/peel --version
has 'its version' "^peel $version\$"
exits 0 'it renders' env -i PATH=/usr/bin:/bin HOME="$work" root/usr/bin/peel compare tutorial \
    --size 32x18 --lights 2
check 'its page' [ "$(gzip -dc root/usr/share/man/man1/peel.1.gz | head -c 8)" = '.TH PEEL' ]

echo "$passed passed, $failed failed"
[ $failed = 0 ]
