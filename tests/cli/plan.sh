#!/bin/sh
# peel plan: its figures add up, its answer is what it says, its exit codes.
# Usage: plan.sh PEEL SOURCE_DIR
set -u
peel=$1
. "$(dirname "$0")/checks.sh"

# holds WHAT FILE CONDITION: a Python expression about the JSON document d.
holds() {
    exits 0 "$1" python3 -c "import json, sys
d = json.load(open('$2'))
sys.exit(0 if ($3) else 1)"
}

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

sums="d['bytes'] == sum(b['bytes'] for b in d['buffers'])
    and sum(d['layers']['histogram']) == d['size'][0] * d['size'][1]
    and sum(d['layers']['distinct_histogram']) == d['size'][0] * d['size'][1]
    and len(d['layers']['histogram']) == d['layers']['max'] + 1
    and sum(i * n for i, n in enumerate(d['layers']['histogram'])) == d['layers']['fragments']
    and all(n['what'] and n['why'] for n in d['needed'] + d['left_out'])"
left_out="[n['what'] for n in d['left_out']]"

for scene in tutorial chain crossing_planes alpha_ladder teapot_hall; do
    exits 0 "$scene" "$peel" plan $scene --size 96x54 --json $scene.json
    holds "$scene adds up" $scene.json "$sums"
    holds "$scene: nothing is searched" $scene.json "d['choices'] == [] and d['command'] is None"
done
holds 'layers of a ladder' alpha_ladder.json \
    "d['layers']['max'] == 16 and d['passes']['peel'] == 17 and d['passes']['dual'] == 9
    and d['passes']['peel-id'] == 49 and d['passes']['painter'] == 1"

exits 0 'unlit' "$peel" plan chain --size 96x54 --lights 0 --json unlit.json
holds 'unlit: adds up' unlit.json "$sums"
holds 'unlit: no normals' unlit.json "'normals' in $left_out and d['lights'] == 0
    and not [b for b in d['buffers'] if 'normal' in b['name']]"
exits 0 'opaque' "$peel" plan tutorial --size 96x54 --opacity 1 --json opaque.json
holds 'opaque: adds up' opaque.json "$sums"
holds 'opaque: no peels' opaque.json "'transparent passes' in $left_out
    and d['layers']['max'] == 0 and not [b for b in d['buffers'] if 'peel' in b['name']]"
exits 0 'all' "$peel" plan chain --size 96x54 --lights 0 --model all --json all.json
holds 'all: no byte less' all.json "d['bytes'] == d['bytes_of_all'] and 'normals' not in $left_out"
holds 'unlit: fewer bytes' unlit.json "d['bytes'] < d['bytes_of_all']"
for method in peel linked-list dual painter; do
    exits 0 "1x1 $method" "$peel" plan tutorial --size 1x1 --method $method --json one.json
    holds "1x1 $method adds up" one.json "$sums and d['method'] == '$method'"
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
answers="sum(c['chosen'] for c in d['choices']) == 1
    and all(c['error'] <= d['max_error'] for c in d['choices'] if c['chosen'])
    and all(c['pareto'] for c in d['choices'] if c['chosen'])
    and [c for c in d['choices'] if c['pareto']]"
# shellcheck disable=SC2086 # $search is several words
{
    exits 0 'reached' "$peel" $search --max-error 1e-3 --json found.json
    tail -1 output >command
    holds 'an answer' found.json "$answers"
    holds 'the cheapest' found.json "min((c['cpu_ms'], c['chosen']) for c in d['choices']
        if c['error'] <= d['max_error'])[1]"
    holds 'medians' found.json "all(c['runs'] == 3 for c in d['choices'] if c['chosen'])"
    exits 0 'the answer is a command' sh -c "$(sed "s|build/peel|'$peel'|" command)"
    exits 0 'truth' "$peel" render crossing_planes --size 64x36 --with truth -o truth.exr
    exits 0 'its image is as near as it says' idiff -q -fail 1e-3 -warn 1 image.exr truth.exr
    exits 2 'too near' "$peel" $search --max-error 0 --json none.json
    exits 0 'one line says so' test "$(grep -c '^peel: .*no settings reach it' output)" -eq 1
    holds 'no answer' none.json "d['command'] is None and d['choices']
        and not [c for c in d['choices'] if c['chosen']]"
    exits 0 'anything will do' "$peel" $search --max-error 1 --json any.json
    holds 'anything' any.json "$answers"
    exits 0 'as asked for' "$peel" $search --max-error=1 --meth forward --passes=1 --accum rgba8 \
        --gbuffer seed --json asked.json
    holds 'only that' asked.json "$answers and all((c['method'], c['passes'], c['accum'],
        c['gbuffer']) == ('forward', 1, 'rgba8', 'seed') for c in d['choices'])"
    tail -1 output >command
    exits 0 'said once' test "$(grep -o -- '--[mpag][a-z]*' command | sort | uniq -d | wc -l)" -eq 0
    for metric in rmse p99; do
        exits 0 $metric "$peel" $search --max-error 1 --metric $metric --method peel --json m.json
        holds $metric m.json "$answers and d['metric'] == '$metric'"
    done
}
holds 'fewer passes were tried' found.json "any(0 < c['passes'] < d['passes']['peel'] - 1
    for c in d['choices'])"
exits 0 'opaque' "$peel" plan tutorial --size 32x18 --opacity 1 --max-error 1e-3 --json o.json
holds 'opaque: passes do not matter' o.json "$answers and all(c['passes'] == 0
    for c in d['choices'])"
exits 0 '1x1' "$peel" plan tutorial --size 1x1 --max-error 1 --json one.json
holds '1x1' one.json "$answers"

refused 'no scene' 'no scene'
refused 'no such scene' 'nosuch' nosuch
refused 'no number' 'expected a number from 0' tutorial --max-error few
refused 'negative' 'expected a number from 0' tutorial --max-error -1
refused 'NaN' 'expected a number from 0' tutorial --max-error nan
refused 'metric' 'expected max, rmse or p99' tutorial --metric psnr
refused 'model' 'expected needed or all' tutorial --model some
refused 'JSON nowhere' 'nowhere' tutorial --size 8x8 --json nowhere/p.json
refused 'edges' 'plain images' tutorial --size 8x8 --method linked-list --post edges --max-error 1
refused 'memory' 'max-memory' tutorial --size 8x8 --max-memory 1K

echo "$passed passed, $failed failed"
[ $failed = 0 ]
