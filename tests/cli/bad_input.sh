#!/bin/sh
# Bad input: exit 4, one line on stderr, nothing left behind. Usage: bad_input.sh PEEL SOURCE_DIR
set -u
peel=$1
scenes=$2/data/scenes
. "$(dirname "$0")/checks.sh"
sink=/dev/null # for standard output

# refuse WHAT PATTERN ARGUMENT...: exit 4, one stderr line that has PATTERN, no new file.
refuse() {
    what=$1
    pattern=$2
    shift 2
    before=$(find . | sort)
    "$peel" "$@" >"$sink" 2>"$work/../peel-err.$$"
    code=$?
    after=$(find . | sort)
    lines=$(wc -l <"$work/../peel-err.$$")
    text=$(cat "$work/../peel-err.$$")
    rm -f "$work/../peel-err.$$"
    if [ $code != 4 ] || [ "$lines" != 1 ] || [ "$before" != "$after" ] ||
        ! printf '%s' "$text" | grep -q -- "$pattern"; then
        echo "FAIL $what: exit $code (expected 4), $lines lines (expected 1), '$text'" \
            "(expected '$pattern'); new files: $(printf '%s' "$after" | wc -l)" \
            "of $(printf '%s' "$before" | wc -l)"
        failed=$((failed + 1))
    else
        passed=$((passed + 1))
    fi
}

mkdir directory directory.exr
ln -s /dev/full full.exr
: >empty.gltf
: >empty.glb
echo 'hello' >text.gltf
echo '{"a":1}' >other.gltf
echo '{"asset":{"version":"1.0"}}' >old.gltf
printf 'v 0 0 0\n' >mesh.obj
head -c 2000 "$scenes/chain.gltf" >truncated.gltf
"$peel" scenes chain -o whole.glb || failed=$((failed + 1))
head -c 3000 whole.glb >truncated.glb
head -c 19 whole.glb >header.glb
sed 's/"count": *[0-9]*/"count": 99999999/' "$scenes/crossing_planes.gltf" >count.gltf

# textured NAME IMAGE [SAMPLER]: a triangle whose base colour is the image.
textured() {
    positions=$(printf '%048d' 0 | tr 0 A)
    cat >"$1" <<END
{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"buffers":[{"byteLength":36,"uri":"data:;base64,$positions"}],
"bufferViews":[{"buffer":0,"byteLength":36}],
"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
"meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
"samplers":[${3-{\}}],"textures":[{"source":0,"sampler":0}],"images":[$2]}
END
}
"$peel" render "$scenes/tutorial.gltf" --size 8x8 -o whole.png >"$sink" || failed=$((failed + 1))
head -c 60 whole.png >truncated.png
"$peel" render "$scenes/tutorial.gltf" --size 8x8 -o flat.exr >"$sink" || failed=$((failed + 1))
"$peel" render "$scenes/tutorial.gltf" --size 32x32 --with truth --deep -o deep.exr >"$sink" ||
    failed=$((failed + 1))
head -c 900 deep.exr >header.exr
head -c 2000 deep.exr >truncated.exr
textured image_missing.gltf '{"uri":"nosuch.png"}'
textured image_truncated.gltf '{"uri":"truncated.png"}'
textured image_text.gltf '{"uri":"text.gltf"}'
textured image_view.gltf '{"bufferView":0}'
textured image_index.gltf '{"bufferView":1}'
textured sampler.gltf '{"uri":"whole.png"}' '{"wrapS":1}'
textured image_whole.gltf '{"uri":"whole.png"}'
"$peel" render image_whole.gltf --size 8x8 -o textured.png >"$sink" || failed=$((failed + 1))

out="-o out.png"
# shellcheck disable=SC2086 # $out is two words
{
    refuse 'missing file' 'nosuch.gltf' render nosuch.gltf $out
    refuse 'directory' 'directory' render directory $out
    refuse 'empty gltf' 'empty.gltf' render empty.gltf $out
    refuse 'empty glb' 'empty.glb' render empty.glb $out
    refuse 'text' 'text.gltf' render text.gltf $out
    refuse 'another JSON' 'other.gltf' render other.gltf $out
    refuse 'glTF 1.0' 'old.gltf' render old.gltf $out
    refuse 'OBJ' 'mesh.obj' render mesh.obj $out
    refuse 'truncated JSON' 'truncated.gltf' render truncated.gltf $out
    refuse 'truncated glb' 'truncated.glb' render truncated.glb $out
    refuse 'glb header only' 'header.glb' render header.glb $out
    refuse 'counts past the buffer' 'count.gltf' render count.gltf $out
    refuse 'missing image' 'image 0: no file nosuch.png' render image_missing.gltf $out
    refuse 'truncated image' 'image 0: cannot decode the PNG' render image_truncated.gltf $out
    refuse 'image of text' 'image 0: expected PNG or JPEG' render image_text.gltf $out
    refuse 'image of positions' 'image 0: expected PNG or JPEG' render image_view.gltf $out
    refuse 'image out of range' 'image 0: expected' render image_index.gltf $out
    refuse 'wrap mode' 'sampler 0: expected wrapS' render sampler.gltf $out
    refuse 'size 0' '--size' render tutorial $out --size 0x10
    refuse 'size huge' '--size' render tutorial $out --size 100000x100000
    refuse 'size text' '--size' render tutorial $out --size big
    refuse 'size trailing' '--size' render tutorial $out --size 10x10x
    refuse 'memory' 'max-memory' render tutorial $out --size 4096x4096 --max-memory 1M
    refuse 'memory, gl' 'max-memory' render tutorial $out --with gl --size 4096x4096 --max-memory 1M
    refuse 'memory, truth' 'max-memory' render tutorial $out --with truth --size 4096x4096 --max-memory 1K
    refuse 'memory below nothing' '--max-memory  -1: expected bytes' render tutorial $out --max-memory ' -1'
    refuse 'memory with a sign' '--max-memory +1: expected bytes' render tutorial $out --max-memory +1
    refuse 'a blank' '--lights  4: expected a whole number' render tutorial $out --lights ' 4'
    refuse 'a blank, real' '--time  4: expected a number' render tutorial $out --time ' 4'
    refuse 'unknown option' 'bogus' render tutorial $out --bogus
    refuse 'hidden option' 'HANG' render tutorial $out --HANG
    refuse 'hidden option' 'usage' compare --usage tutorial
    refuse 'hidden option' '-?' render tutorial $out '-?'
    refuse 'option without value' 'lacks its value' render tutorial -o
    refuse 'size with a space' '--size' render tutorial $out --size ' 8x8'
    refuse 'line break' 'a b' render tutorial -o 'a
b'
    refuse 'misspelt scene' 'built-in scene' render tutoral $out
    refuse 'unknown method' '--method' render tutorial $out --method magic
    refuse 'unknown renderer' '--with' render tutorial $out --with vulkan
    refuse 'depth format' 'd32f, d24 or d16' render tutorial $out --depth d32
    refuse 'accumulation format' 'rgba8' render tutorial $out --accum rgb
    refuse 'passes 0' '--passes' render tutorial $out --passes 0
    refuse 'passes -1' '--passes' render tutorial $out --passes -1
    refuse 'lights x' '--lights' render tutorial $out --lights x
    refuse 'opacity 2' '--opacity' render tutorial $out --opacity 2
    refuse 'opacity nan' '--opacity' render tutorial $out --opacity nan
    refuse 'background' '--background' render tutorial $out --background 1,2
    refuse 'a blank in the background' '--background 1, 2,3' render tutorial $out --background '1, 2,3'
    refuse 'camera' '--camera' render tutorial $out --camera nosuch
    refuse 'camera index' '--camera' render tutorial $out --camera 99
    refuse 'threads 0' '--threads' render tutorial $out --threads 0
    refuse 'tile 12' '--tile' render tutorial $out --tile 12
    refuse 'two scenes' 'already given' render tutorial chain $out
    refuse 'no scene' 'no scene' render $out
    refuse 'no command' 'no command'
    refuse 'unknown command' "'paint' is no command" paint
}
refuse 'no output' '-o FILE' render tutorial
refuse 'output extension' '.png or .exr' render tutorial -o out.jpg
refuse 'output directory missing' 'nosuch/out.png' render tutorial --size 8x8 -o nosuch/out.png
refuse 'output is a directory' 'directory' render tutorial --size 8x8 --trace directory.exr
refuse 'unwritable directory' '/proc/x.png' render tutorial --size 8x8 -o /proc/x.png
refuse 'a page of what is too large' 'the limit is' bench tutorial --size 64x64 --max-memory 10 \
    --report page
refuse 'a page of one pixel' 'expected one' explain tutorial --pixel 1,1 -o page
refuse 'unwritable report' '/proc/x' compare tutorial --size 8x8 --report /proc/x
refuse 'deep with ref' 'expected --with truth, not ref' render tutorial --size 8x8 -o a.exr --deep
refuse 'deep with gl' 'expected --with truth, not gl' render tutorial -o a.exr --deep --with gl
refuse 'deep PNG' 'ending in .exr' render tutorial --size 8x8 -o a.png --deep --with truth
refuse 'deep with a trace' 'no --trace' render tutorial -o a.exr --deep --with truth --trace b.exr
refuse 'deep, memory' 'deep image.*--max-memory' render tutorial -o a.exr --deep --with truth \
    --size 512x512 --max-memory 9M
refuse 'deep, directory missing' 'nosuch/a.exr' render tutorial -o nosuch/a.exr --deep --with truth
refuse 'deep, disk full' 'No space left' render tutorial --size 8x8 -o full.exr --deep --with truth
refuse 'unknown mistake' '--mutate nonsense' render tutorial --size 8x8 -o a.png --mutate nonsense
refuse 'no mistake' 'with commas between' render tutorial --size 8x8 -o a.png --mutate passes-4,
refuse 'mistake with gl' 'expected --with ref, not gl' render tutorial --size 8x8 -o a.png --with gl \
    --mutate passes-4
refuse 'mistake with dual' 'expected method peel or forward' render tutorial --size 8x8 -o a.png \
    --method dual --mutate passes-4
refuse 'flatten: no file' 'expected a deep EXR' flatten -o a.exr
refuse 'flatten: no output' '-o FILE' flatten deep.exr
refuse 'flatten: extension' '.png or .exr' flatten deep.exr -o a.jpg
refuse 'flatten: two files' 'already given' flatten deep.exr deep.exr -o a.exr
refuse 'flatten: missing file' 'nosuch.exr' flatten nosuch.exr -o a.exr
refuse 'flatten: a directory' 'directory.exr' flatten directory.exr -o a.exr
refuse 'flatten: text' 'text.gltf' flatten text.gltf -o a.exr
refuse 'flatten: empty' 'empty.glb' flatten empty.glb -o a.exr
refuse 'flatten: flat' 'flat.exr: flat or tiled' flatten flat.exr -o a.exr
refuse 'flatten: header only' 'header.exr' flatten header.exr -o a.exr
refuse 'flatten: truncated' 'truncated.exr' flatten truncated.exr -o a.exr
refuse 'flatten: memory' '--max-memory' flatten deep.exr -o a.exr --max-memory 2K
refuse 'flatten: memory, text' '--max-memory' flatten deep.exr -o a.exr --max-memory much
refuse 'flatten: directory missing' 'nosuch/a.png' flatten deep.exr -o nosuch/a.png
refuse 'one file for two' 'two outputs in one file' render tutorial --size 8x8 -o a.exr --trace a.exr
refuse 'disk full' '/dev/full' compare tutorial --size 8x8 --json /dev/full
refuse 'report below a file' 'text.gltf' compare tutorial --size 8x8 --report text.gltf/out
refuse 'report of all methods below a file' 'text.gltf' compare tutorial --size 8x8 --method all \
    --report text.gltf/out
refuse 'a value that is not taken' "'--deep=3' is no option" render tutorial --deep=3 -o a.exr
refuse 'more than one option begins so' "'--s' is no option" render tutorial --s 8x8 -o a.exr
refuse 'an option of a command without any' "'--nosuch' is no option" methods --nosuch
refuse 'scene list: unknown' 'nosuch' scenes nosuch -o x.gltf
refuse 'scene list: rendering' '--lights says how a scene is rendered; expected --export' \
    scenes tutorial --lights 3 -o x.gltf
refuse 'scene list: methods' 'expected a single method' scenes tutorial --method all --export x
refuse 'scene without output' '-o FILE' scenes tutorial
refuse 'json in a missing directory' 'nosuch/x.json' compare tutorial --size 8x8 --json nosuch/x.json
refuse 'tolerance' '--tolerance' compare tutorial --tolerance -1

# No output is a file that the command reads, whatever named it.
mkdir -p read/page
"$peel" scenes tutorial -o read/scene.gltf >/dev/null
"$peel" render tutorial --size 8x8 -o read/theirs.exr >/dev/null
"$peel" render tutorial --size 8x8 -o read/page/theirs.png >/dev/null
printf '1,0,0,0.5\n' >read/layers.txt
head -c 36 /dev/zero >read/buffer.exr
cat >read/named.gltf <<'END'
{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
 "buffers":[{"byteLength":36,"uri":"buffer.exr"}],"bufferViews":[{"buffer":0,"byteLength":36}],
 "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
 "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]}
END
cp -r read before
input='an input, expected another name for the output'
refuse 'layer' "$input" check tutorial --size 8x8 --layer 0 read/theirs.exr --json read/theirs.exr
refuse 'depth' "$input" check tutorial --size 8x8 --depth 0 read/theirs.exr --json read/theirs.exr
refuse 'scene' "$input" diff read/theirs.exr read/theirs.exr --scene read/scene.gltf \
    --json read/scene.gltf
refuse 'layers' "$input" blend eval --layers read/layers.txt --json read/layers.txt
refuse 'export' "$input" scenes read/scene.gltf --export read --size 8x8
refuse 'page of check' "$input" check tutorial read/page/theirs.png --size 8x8 --report read/page
refuse 'page of diagnose' "$input" diagnose tutorial read/page/theirs.png --size 8x8 \
    --report read/page
refuse 'buffer' "$input" render read/named.gltf --size 8x8 -o read/buffer.exr
refuse 'buffer of a plan' "$input" plan read/named.gltf --size 8x8 --json read/buffer.exr
exits 0 'what is read stays' diff -r before read
mkdir tutorial
exits 0 'a folder named like a scene' "$peel" render tutorial --size 8x8 -o tutorial/a.png
rm -rf read before tutorial

# No GL: a driver that Mesa does not have, and no OSMesa at all (the loader finds an empty file).
export GALLIUM_DRIVER=nosuch
refuse 'no such driver' 'GALLIUM_DRIVER' render tutorial --size 8x8 --with gl -o gl.png
refuse 'no such driver' 'GALLIUM_DRIVER' compare tutorial --size 8x8
unset GALLIUM_DRIVER
for width in 0 31 0x10; do
    export LP_NATIVE_VECTOR_WIDTH=$width
    refuse "vectors of $width bits" "LP_NATIVE_VECTOR_WIDTH=$width" render tutorial --size 8x8 --with gl \
        -o gl.png
done
for width in 32 none; do
    LP_NATIVE_VECTOR_WIDTH=$width exits 0 "vectors of $width bits" "$peel" compare tutorial --size 8x8
done
unset LP_NATIVE_VECTOR_WIDTH
mkdir -p library && : >library/libOSMesa.so.8
export LD_LIBRARY_PATH="$work/library"
refuse 'no OSMesa' 'libosmesa6' render tutorial --size 8x8 --with gl -o gl.png
refuse 'no OSMesa' 'libosmesa6' compare tutorial --size 8x8
unset LD_LIBRARY_PATH

for arguments in '--help' '--version' 'compare --help'; do
    sink=/dev/full
    # shellcheck disable=SC2086 # several words
    refuse "full disk under $arguments" 'standard output' $arguments
done

echo "$passed passed, $failed failed"
[ $failed = 0 ]
