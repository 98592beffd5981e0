#!/bin/sh
# peel plan: its figures add up, its answer is what it says, its exit codes.
# Usage: plan.sh PEEL SOURCE_DIR
set -u
peel=$1
. "$(dirname "$0")/checks.sh"

# refused WHAT PATTERN ARGUMENT...: exit 4 and one line that has PATTERN.
refused() {
    name=$1
    pattern=$2
    shift 2
    exits 4 "$name" "$peel" plan "$@"
    grep '^peel: ' output >said
    exits 0 "$name: one line" test "$(wc -l <said)" -eq 1
    exits 0 "$name: '$pattern'" grep -q -- "$pattern" said
}

sum='(list) => list.reduce((a, b) => a + b, 0)'
sums="((sum, pixels) => d.bytes === sum(d.buffers.map((b) => b.bytes))
    && sum(d.layers.histogram) === pixels && sum(d.layers.distinct_histogram) === pixels
    && d.layers.histogram.length === d.layers.max + 1
    && sum(d.layers.histogram.map((n, i) => i * n)) === d.layers.fragments
    && [...d.needed, ...d.left_out].every((n) => n.what && n.why))($sum, d.size[0] * d.size[1])"
left_out='d.left_out.map((n) => n.what)'

for scene in tutorial chain crossing_planes alpha_ladder teapot_hall; do
    exits 0 "$scene" "$peel" plan $scene --size 96x54 --json $scene.json
    json_holds "$scene adds up" $scene.json "$sums"
    json_holds "$scene: nothing is searched" $scene.json "d.choices.length === 0 && d.command === null"
done
json_holds 'layers of a ladder' alpha_ladder.json \
    "d.layers.max === 16 && d.passes.peel === 17 && d.passes.dual === 9
    && d.passes['peel-id'] === 49 && d.passes.painter === 1"

exits 0 'unlit' "$peel" plan chain --size 96x54 --lights 0 --json unlit.json
json_holds 'unlit: adds up' unlit.json "$sums"
json_holds 'unlit: no normals' unlit.json "$left_out.includes('normals') && d.lights === 0
    && !d.buffers.some((b) => b.name.includes('normal'))"
exits 0 'opaque' "$peel" plan tutorial --size 96x54 --opacity 1 --json opaque.json
json_holds 'opaque: adds up' opaque.json "$sums"
json_holds 'opaque: no peels' opaque.json "$left_out.includes('transparent passes')
    && d.layers.max === 0 && !d.buffers.some((b) => b.name.includes('peel'))"
exits 0 'all' "$peel" plan chain --size 96x54 --lights 0 --model all --json all.json
json_holds 'all: no byte less' all.json "d.bytes === d.bytes_of_all
    && !$left_out.includes('normals')"
json_holds 'unlit: fewer bytes' unlit.json "d.bytes < d.bytes_of_all"
for method in peel linked-list dual painter; do
    exits 0 "1x1 $method" "$peel" plan tutorial --size 1x1 --method $method --json one.json
    json_holds "1x1 $method adds up" one.json "$sums && d.method === '$method'"
done
for with in ref gl; do
    for model in needed all; do
        exits 0 "$with $model" "$peel" render tutorial --lights 0 --size 96x54 --with $with \
            --model $model -o $with-$model.exr
    done
    exits 0 "$with: the same image" idiff -q $with-needed.exr $with-all.exr
done

# ---- the search ----

search="plan crossing_planes --size 64x36"
chosen='d.choices.filter((c) => c.chosen)'
answers="$chosen.length === 1 && $chosen.every((c) => c.error <= d.max_error && c.pareto)"
# shellcheck disable=SC2086 # $search is several words
{
    exits 0 'reached' "$peel" $search --max-error 1e-3 --json found.json
    tail -1 output >line
    json_holds 'an answer' found.json "$answers"
    json_holds 'the cheapest' found.json "d.choices.every((c) =>
        c.error > d.max_error || c.cpu_ms >= ${chosen}[0].cpu_ms)"
    json_holds 'medians' found.json "$chosen.every((c) => c.runs === 3)"
    exits 0 'the answer is a command' sh -c "$(sed "s|build/peel|'$peel'|" line)"
    exits 0 'truth' "$peel" render crossing_planes --size 64x36 --with truth -o truth.exr
    exits 0 'its image is as near as it says' idiff -q -fail 1e-3 -warn 1 image.exr truth.exr
    exits 2 'too near' "$peel" $search --max-error 0 --json none.json
    exits 0 'one line says so' test "$(grep -c '^peel: .*no settings reach it' output)" -eq 1
    json_holds 'no answer' none.json "d.command === null && d.choices.length > 0 && $chosen.length === 0"
    exits 0 'anything will do' "$peel" $search --max-error 1 --json any.json
    json_holds 'anything' any.json "$answers"
    exits 0 'as asked for' "$peel" $search --max-error=1 --meth forward --passes=1 --accum rgba8 \
        --gbuffer seed --json asked.json
    json_holds 'only that' asked.json "$answers && d.choices.every((c) => c.method === 'forward'
        && c.passes === 1 && c.accum === 'rgba8' && c.gbuffer === 'seed')"
    tail -1 output >line
    exits 0 'said once' test "$(grep -o -- '--[mpag][a-z]*' line | sort | uniq -d | wc -l)" -eq 0
    for metric in rmse p99; do
        exits 0 $metric "$peel" $search --max-error 1 --metric $metric --method peel --json m.json
        json_holds $metric m.json "$answers && d.metric === '$metric'"
    done
}
json_holds 'fewer passes were tried' found.json "d.choices.some((c) =>
    0 < c.passes && c.passes < d.passes.peel - 1)"
exits 0 'opaque' "$peel" plan tutorial --size 32x18 --opacity 1 --max-error 1e-3 --json o.json
json_holds 'opaque: passes do not matter' o.json "$answers
    && d.choices.every((c) => c.passes === 0)"
exits 0 '1x1' "$peel" plan tutorial --size 1x1 --max-error 1 --json one.json
json_holds '1x1' one.json "$answers"

refused 'no scene' 'no scene'
refused 'no such scene' 'nosuch' nosuch
refused 'no number' 'expected a number from 0' tutorial --max-error few
refused 'negative' 'expected a number from 0' tutorial --max-error -1
refused 'NaN' 'expected a number from 0' tutorial --max-error nan
refused 'metric' 'expected max, rmse or p99' tutorial --metric psnr
refused 'metric alone' 'expected --max-error' tutorial --metric rmse
refused 'model' 'expected needed or all' tutorial --model some
refused 'JSON nowhere' 'nowhere' tutorial --size 8x8 --json nowhere/p.json
refused 'edges' 'plain images' tutorial --size 8x8 --method linked-list --post edges --max-error 1
refused 'memory' 'max-memory' tutorial --size 8x8 --max-memory 1K

echo "$passed passed, $failed failed"
[ $failed = 0 ]
