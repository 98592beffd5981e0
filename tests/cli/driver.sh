#!/bin/sh
# peel driver on every driver there is: its table, JSON and exit codes. Usage: driver.sh PEEL
set -u
peel=$1
. "$(dirname "$0")/checks.sh"

for gl in osmesa egl; do
    exits 0 "$gl" "$peel" driver --gl $gl --json driver.json
    has "$gl" 'renderer: llvmpipe'
    has "$gl" '^EXACT$'
    has "$gl" 'upper-left'
    narrow "$gl"
    json_holds "$gl" driver.json 'd.differ === 0 && d.broken === 0 && d.untested > 0 && d.exact > 90'
    json_holds "$gl" driver.json 'd.rules.length === d.exact + d.untested && d.gl.renderer.startsWith("llvmpipe")'
    json_holds "$gl" driver.json 'd.rules.every(r => (r.verdict === "exact") === (r.samples > 0))'

    exits 2 "$gl, softpipe" env GALLIUM_DRIVER=softpipe "$peel" driver --gl $gl --json driver.json
    has "$gl, softpipe" 'renderer: softpipe'
    has "$gl, softpipe" 'multiply-adds: neither'
    has "$gl, softpipe" '^BROKEN: .*peels-d16'
    narrow "$gl, softpipe"
    json_holds "$gl, softpipe" driver.json 'd.gl.arithmetic === "neither" && d.differ > 20 && d.broken > 0'
    json_holds "$gl, softpipe" driver.json 'd.rules.every(r => (r.example !== null) === (r.differing > 0))'
    json_holds "$gl, softpipe" driver.json 'd.rules.find(r => r.id === "add").verdict === "exact"'
done

exits 0 'unfused' "$peel" driver --fma off --threads 1
has 'unfused' 'multiply-adds: unfused'
has 'unfused' '^EXACT$'
exits 0 'compare by EGL' "$peel" compare tutorial --size 64x36 --gl egl
exits 0 'render by EGL' "$peel" render tutorial --size 64x36 --gl egl --with gl -o egl.exr
exits 0 'render by OSMesa' "$peel" render tutorial --size 64x36 --gl osmesa --with gl -o osmesa.exr
exits 0 'the same image' cmp egl.exr osmesa.exr
exits 0 'help' "$peel" driver --help
has 'help' '--json'

exits 4 'a mode that the driver does not have' env GALLIUM_OVERRIDE_CPU_CAPS=sse4.1 \
    "$peel" driver --fma on
has 'a mode that the driver does not have' 'is unfused'
exits 4 'a name' "$peel" driver --gl glx
has 'a name' 'expected osmesa or egl'
exits 4 'an argument' "$peel" driver tutorial
exits 4 'a missing directory' "$peel" driver --json nosuch/driver.json
has 'a missing directory' 'nosuch'
mkdir library && : >library/libEGL.so.1
exits 4 'no EGL' env LD_LIBRARY_PATH="$work/library" "$peel" driver --gl egl
has 'no EGL' 'libegl1, libegl-mesa0 and libgl1-mesa-dri'
exits 4 'no driver for EGL' env __EGL_VENDOR_LIBRARY_FILENAMES=/dev/null "$peel" driver --gl egl
has 'no driver for EGL' 'libgl1-mesa-dri'

echo "$passed passed, $failed failed"
[ $failed = 0 ]
