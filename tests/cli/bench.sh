#!/bin/sh
# peel bench: a tiny run of it, what it writes, its exit codes. Nothing depends on how long it took.
# Usage: bench.sh PEEL
set -u
peel=$1
. "$(dirname "$0")/checks.sh"

# refused WHAT ARGUMENT...: one line and exit code 4.
refused() {
    what=$1
    shift
    exits 4 "$what" "$peel" bench "$@"
    check "one line: $what" test "$(grep -c "^peel: " output)" -eq 1
}

exits 0 'two scenes' "$peel" bench tutorial crossing_planes --size 64x36 --passes 1,2 --lights 1 \
    --threads 1,2 --renderers ref,gl,gl-early,truth --runs 1 --json bench.json --report page
cp output table
check 'rows are announced' grep -q '^32 rows, 1 runs each$' table
check 'ratios' grep -q '^gl-early / ref: geometric mean' table
check 'no line is wide' awk 'length > 100 { exit 1 }' table
json_holds 'rows' bench.json 'd.rows.length === 32'
json_holds 'every combination' bench.json 'new Set(d.rows.map(r => [r.scene, r.passes, r.threads, r.renderer]
    .join())).size === 32'
json_holds 'complete' bench.json 'd.rows.every(r => r.scene && r.size === "64x36" && r.method === "peel" &&
    r.lights === 1 && r.formats === "default" && r.cpu_ms > 0 && r.wall_ms > 0 && r.spread === 0 &&
    r.rmse !== null && r.max_abs >= r.rmse && r.peak_bytes > 0)'
json_holds 'the same images' bench.json 'd.summary.differing_rows === 0 && d.rows.every(r => r.differing === 0)'
json_holds 'errors fall with passes' bench.json 'd.rows.every(r => r.renderer === "truth" || r.passes === 2 ||
    r.rmse > d.rows.find(s => s.passes === 2 && s.renderer === r.renderer && s.scene === r.scene)
    .rmse)'
json_holds 'the same error' bench.json 'd.rows.every(r => r.renderer === "truth" || r.rmse === d.rows.find(s =>
    s.renderer === "ref" && s.scene === r.scene && s.passes === r.passes).rmse)'
json_holds 'truth' bench.json 'd.rows.every(r => r.renderer !== "truth" || r.rmse === 0)'
json_holds 'the front' bench.json 'd.rows.some(r => r.pareto) && d.rows.some(r => !r.pareto)'
json_holds 'cells' bench.json 'd.summary.gl_to_ref.cells === 8 && d.summary.gl_to_ref.tests.length === 4'
for plot in passes triangles threads error-0; do
    check "plot $plot" grep -q '<svg' page/$plot.svg
    check "$plot is on the page" grep -q "src=\"$plot.svg\"" page/index.html
done
check 'no plot of what does not vary' test ! -e page/lights.svg

# Formats, methods and a limit that needs queries.
exits 0 'formats' "$peel" bench tutorial --size 48x27 --passes auto --lights 2 --threads 1 \
    --runs 1 --formats default,seed,compact+rgba8+d16 --method peel,linked-list --json bench.json
json_holds 'formats' bench.json 'd.rows.length === 18 && new Set(d.rows.map(r => r.formats)).size === 3'
json_holds 'formats agree' bench.json 'd.summary.differing_rows === 0 && d.rows.every(r => r.passes === "auto")'
exits 0 'without truth' "$peel" bench tutorial --size 16x9 --runs 2 --no-error --simd scalar \
    --fma off --json bench.json
json_holds 'without truth' bench.json 'd.rows.every(r => r.rmse === null && !r.pareto)'
exits 0 'the preset' "$peel" bench --preset paper --size 16x9 --passes 1 --lights 0 --threads 1 \
    --renderers ref --runs 1 --json bench.json
json_holds 'the preset' bench.json 'd.rows.map(r => r.scene).join() === "teapot_hall,teapot_hall_stress"'

exits 0 'roofline' "$peel" bench --roofline --threads 1 --json bench.json
json_holds 'roofline' bench.json 'd.threads === 1 && d.widths.length > 0 && d.widths.every(w =>
    w.muladd_flops.one_thread > 0 && w.lighting.share_of_muladd_peak > 0)'
exits 0 'help' "$peel" bench --help
check 'help' grep -q -- '--roofline' output

refused 'no scene'
refused 'an unknown scene' nosuch
refused 'a renderer' tutorial --renderers ref,gpu
refused 'an empty value' tutorial --passes 1,,2
refused 'no passes' tutorial --passes 0
refused 'a method' tutorial --method peel,peal
refused 'a format' tutorial --formats rgba8+rgb
refused 'a size' tutorial --size 64x36,64
refused 'threads' tutorial --threads 0
refused 'runs' tutorial --runs 0
refused 'a preset' --preset papers
refused 'more lights than there are' tutorial --lights 1,3
check 'which scene' grep -q 'tutorial' output
refused 'too many values' tutorial --passes "$(seq -s, 1 33)"
refused 'json nowhere' tutorial --json none/x.json
refused 'report over a file' tutorial --report bench.json
refused 'roofline of a scene' tutorial --roofline
refused 'roofline of a size' --roofline --size 64x36
refused 'roofline of settings' --roofline --ggx stable
refused 'a setting that a format changes' tutorial --formats default,rgba8 --accum rgba16f
check 'which' grep -q -- '--formats rgba8: it has another --accum' output
refused 'a setting that the profile changes' tutorial --formats seed --ggx stable
refused 'positions of a compact G-buffer' tutorial --formats compact --position buffer
refused 'no memory' tutorial --size 64x36 --no-error --max-memory 4K
mkdir empty
exits 4 'no gnuplot' env PATH="$work/empty" "$peel" bench tutorial --size 16x9 --passes 1,2 \
    --runs 1 --renderers ref --report page
check 'which package' grep -q 'gnuplot-nox' output

echo "$passed passed, $failed failed"
[ $failed = 0 ]
