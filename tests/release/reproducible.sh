#!/bin/sh
# The same source makes the same program: built in two folders of other names and lengths, byte for
# byte, the library and the manual pages too.
# Usage: reproducible.sh PEEL SOURCE_DIR
set -u
source=$2
. "$source/tests/cli/checks.sh"
unset CMAKE_C_COMPILER_LAUNCHER # a cache of results would hide a folder's name

mkdir one another_and_longer
for folder in one another_and_longer; do
    echo "reproducible: building in $folder"
    if [ -d "$source/.git" ]; then
        exits 0 "clone to $folder" git clone -q "$source" "$folder/source"
    else
        exits 0 "copy to $folder" cp -r "$source" "$folder/source"
    fi
    exits 0 "configure $folder" cmake -S "$folder/source" -B "$folder/build" -G Ninja \
        -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS_RELEASE='-O3 -g1' -DBUILD_TESTING=OFF
    exits 0 "build $folder" nice cmake --build "$folder/build"
done
(cd one/build && find . -name peel -type f -o -name 'libpeel.so.*.*.*' -o -name libpeel.a \
    -o -name '*.1.gz' -o -name peel.wasm) >files
check 'all of it was built' [ "$(wc -l <files)" -ge 20 ]
while read -r file; do
    check "the same bytes: $file" cmp "one/build/$file" "another_and_longer/build/$file"
done <files

echo "$passed passed, $failed failed"
[ $failed = 0 ]
