#!/bin/sh
# The packages on a clean Debian 12: made from this source, installed by apt in a new root with what
# they depend on, used, removed. Takes minutes, root, and a network.
# Usage: package.sh PEEL SOURCE_DIR [MIRROR]
# Exit code 77: cannot be done here, and why.
# shellcheck disable=SC2016 # the inner shells'
set -u
source=$2
mirror=${3-http://deb.debian.org/debian}
. "$source/tests/cli/checks.sh"
root=$work/root

skip() {
    echo "package: $*"
    exit 77
}
[ "$(id -u)" = 0 ] || skip 'needs root, for chroot'
for tool in debootstrap dpkg-shlibdeps; do
    command -v $tool >/dev/null || skip "no $tool here: install debootstrap and dpkg-dev"
done
clean() {
    mountpoint -q "$root/proc" && umount "$root/proc"
    rm -rf "$work"
}
trap clean EXIT
trap 'exit 1' INT TERM HUP

echo 'package: building'
exits 0 'configure' cmake -S "$source" -B build -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_INSTALL_PREFIX=/usr -DBUILD_TESTING=OFF
exits 0 'build' nice cmake --build build
exits 0 'cpack' cpack --config build/CPackConfig.cmake -G DEB -B "$work/packages"
[ $failed = 0 ] || exit 1

echo "package: a clean root, from $mirror"
nice debootstrap --variant=minbase bookworm "$root" "$mirror" >log 2>&1 || {
    tail -3 log
    skip "debootstrap failed: no network, or no $mirror"
}
for file in /etc/resolv.conf /etc/apt/apt.conf.d/*proxy*; do
    [ -f "$file" ] && cp "$file" "$root$file"
done
mkdir "$root/packages"
cp packages/*.deb "$root/packages"
mount -t proc proc "$root/proc" 2>/dev/null || echo 'package: without /proc'

# inside COMMAND...: in the root, with nothing of this environment but the way to the network.
inside() {
    chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
        DEBIAN_FRONTEND=noninteractive http_proxy="${http_proxy-}" https_proxy="${https_proxy-}" \
        "$@"
}
# Which files there are, apart from those that apt and dpkg keep, and caches.
list_files() {
    (cd "$root" && find usr etc opt srv home ! -type d | grep -v "ld\.so\.cache" |
        LC_ALL=C sort) \
        >"$1"
}

inside apt-get update -qq >log 2>&1 || skip 'apt-get update failed in the root'
# Manual pages are left out of a minimal system only if it says so.
rm -f "$root/etc/dpkg/dpkg.cfg.d/docker"
list_files before
inside dpkg-query -W -f '${Package}\n' >packages_before

echo 'package: installing'
exits 0 'apt-get install' inside sh -c 'apt-get install -y -qq --no-install-recommends /packages/*.deb'
has 'installed' '^Setting up peel '
exits 0 'version' inside peel --version
has 'version' '^peel 0\.1\.0$'
has 'OSMesa is found' '^OSMesa .*libOSMesa.so.8$'
exits 0 'render' inside peel render tutorial --size 64x36 -o /tmp/picture.png
exits 0 'render, truth' inside peel render tutorial --size 64x36 --with truth -o /tmp/picture.exr
exits 0 'compare' inside peel compare tutorial --size 64x36 --report /tmp/report
check 'the report' [ -s "$root/tmp/report/index.html" ]
exits 0 'explain' inside peel explain tutorial -o /tmp/page
for file in man/man1/peel.1.gz man/man1/peel-render.1.gz bash-completion/completions/peel; do
    check "$file" [ -s "$root/usr/share/$file" ]
done
exits 0 'completion' inside bash -c '. /usr/share/bash-completion/completions/peel
    COMP_WORDS=(peel re); COMP_CWORD=1; _peel; [ "${COMPREPLY[*]}" = render ]'

echo 'package: compiling against the library'
exits 0 'a compiler' inside apt-get install -y -qq --no-install-recommends gcc libc6-dev pkg-config
sed -n '/^### The library/,/^##/{/^    #include/,/^    }$/s/^    //p;}' "$source/README.md" \
    >"$root/tmp/readme.c"
exits 0 'the program in README' inside sh -c \
    'cd /tmp && gcc -o readme readme.c $(pkg-config --cflags --libs peel) && ./readme'
has 'its output' '^exact: '
exits 0 'static' inside sh -c 'cd /tmp && gcc -o static readme.c -l:libpeel.a -lgmp -lm && ./static'

echo 'package: removing'
exits 0 'apt-get purge' inside sh -c "apt-get purge -y -qq peel 'libpeel*' && apt-get purge -y -qq \
    --autoremove gcc libc6-dev pkg-config"
inside dpkg-query -W -f '${Package}\n' >packages_after
list_files after
check 'no package of ours is left' [ -z "$(grep peel packages_after)" ]
exits 0 'no file of ours is left' sh -c "! LC_ALL=C comm -13 before after | grep -i peel"

echo "$passed passed, $failed failed"
[ $failed = 0 ]
