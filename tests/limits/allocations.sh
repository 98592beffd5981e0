#!/bin/sh
# Every allocation of our own fails in turn, in every command and form of output: one line and exit
# code 4, or the same result without it. Usage: allocations.sh FAULTY PEEL [RUNS]
# RUNS: so many of each command (default 0: each allocation, alone and with all that follow); below
# 10 the commands that take long are left out.
set -u
faulty=$(realpath "$1") || exit 1
peel=$(realpath "$2") || exit 1
runs=${3-0}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
ran=0
failed=0

# sweep ARGUMENT...: of peel; it runs in a folder below this one.
sweep() {
    ran=$((ran + 1))
    "$faulty" "$runs" "$@" || failed=$((failed + 1))
}

need() {
    "$peel" "$@" >/dev/null || {
        echo "FAIL peel $*"
        exit 1
    }
}

need scenes chain -o chain.glb
need render tutorial --size 8x8 -o texture.png
need render tutorial --size 8x8 -o a.png
need render tutorial --size 8x8 --passes 1 -o b.png
need render tutorial --size 8x8 -o a.exr
need render tutorial --size 8x8 --passes 1 -o b.exr
need render tutorial --size 8x8 --with truth --deep -o deep.exr
need render tutorial --size 8x8 --trace a_trace.exr
need render tutorial --size 8x8 --passes 1 --trace b_trace.exr
for form in csv jsonl bin; do
    need blend vectors --set random --count 40 -o vectors.$form
    need blend vectors --set sequences --count 4 -o sequences.$form
done
echo '1,0,0,0.5' >layers.txt
echo '#00ff0080' >>layers.txt
cat >textured.gltf <<END
{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"buffers":[{"byteLength":36,"uri":"data:;base64,$(printf '%048d' 0 | tr 0 A)"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
"samplers":[{}],"textures":[{"source":0,"sampler":0}],"images":[{"uri":"texture.png"}]}
END
small='--size 8x8 --lights 2 --threads 1'

# shellcheck disable=SC2086 # $small is words
{
    sweep render tutorial $small -o a.png
    sweep render tutorial $small -o a.exr --threads 3
    sweep render tutorial $small -o a.png --trace t.exr --passes 2
    sweep render tutorial $small -o a.exr --with truth
    sweep render tutorial $small -o a.exr --with truth --trace t.exr
    sweep render tutorial $small -o a.exr --with truth --deep
    sweep render ../textured.gltf $small -o a.png
    sweep render ../chain.glb $small -o a.png --mutate passes-4
    sweep diagnose --list
    sweep diff ../a.png ../b.png -o heat.png --json j.json
    sweep diff ../a.exr ../b.exr -o d.exr -p -v
    sweep diff ../deep.exr ../deep.exr
    sweep diff ../a_trace.exr ../b_trace.exr -o heat.png
    sweep explain tutorial $small -o page
    sweep explain tutorial $small --pixel 4,4
    sweep explain tutorial $small --pixel 4,4 --json j.json
    sweep flatten ../deep.exr -o a.exr
    sweep flatten ../deep.exr -o a.png
    sweep plan tutorial $small
    sweep methods
    sweep scenes
    sweep scenes tutorial -o a.gltf
    sweep scenes tutorial --export out --size 8x8
    sweep scenes --contract -o contract.html
    sweep blend eval --format rgba8 '#ff000080' '#00ff0080' --json j.json
    sweep blend eval --format rgba16f --layers ../layers.txt --brief
    sweep blend vectors --list
    sweep blend vectors --checksum --set random --count 40
    for form in csv jsonl bin; do
        sweep blend vectors --set random --count 40 -o v.$form
        sweep blend vectors --set sequences --count 4 -o v.$form
        sweep blend check ../vectors.$form --json j.json
        sweep blend check ../sequences.$form
    done
    sweep hard --list
    sweep render tutorial $small -o a.exr --with gl
    sweep render tutorial $small --trace t.exr --with gl --passes 1
    sweep blend check --gl --format rgba8 --equation under --limit 20 --json j.json
    sweep check tutorial ../a.exr $small --lights 0 --json j.json --report out
    sweep check tutorial ../a_trace.exr $small --lights 0 --report out
    sweep diagnose tutorial ../b.png $small --lights 0 --json j.json --report out
    if [ "$runs" = 0 ] || [ "$runs" -ge 10 ]; then # those that take long
        sweep explain --course -o course
        sweep plan tutorial $small --max-error 1e-2 --json j.json
        sweep render tutorial $small -o a.exr --with gl --gl egl
        sweep hard --export out
        sweep blend check --list
        sweep diff ../a.exr ../b.exr --scene tutorial --json j.json
        for method in $("$peel" methods | sed -n 's/^\([a-z][-a-z]*\) .*/\1/p'); do
            sweep render tutorial $small -o a.png --method $method --trace t.exr
            sweep render tutorial $small -o a.exr --method $method --with gl
        done
        sweep compare tutorial $small --tolerance 1
        sweep compare tutorial $small --tolerance 1 --json j.json --report out --classes c.png
        sweep compare tutorial $small --tolerance 1 --profile seed --budget --bound --report out
        sweep compare tutorial $small --tolerance 1 --method all --json j.json --report out
        sweep bench tutorial $small --runs 1 --passes 1,2 --json j.json --report out
        sweep bench tutorial $small --runs 1 --renderers gl --no-error
    fi
}
echo "$((ran - failed)) passed, $failed failed"
[ $failed = 0 ]
