#!/usr/bin/env bash
# compare_results.sh BINARY_A BINARY_B [SAMPLE_FILTER]: do two builds give the same results?
#
# Both match and reduce every generated sample in every variant, by several methods, and measure the
# tables of the benchmark. The numbers must agree to the last bit; times, wordings and what says
# where it ran are left out. Ends with 1 where a number differs. SAMPLE_FILTER is a part of a name
# such as "floor-plain".
set -euo pipefail

a=$(realpath "$1")
b=$(realpath "$2")
filter=${3:-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The numbers of a JSON file as lines. Lists of starts keep what is compared under any wording.
cat >"$work/numbers.py" <<'PYTHON'
import json
import sys

SKIPPED = {
    "timings", "machine", "build", "command_line", "files", "schema", "convention", "direction",
    "parameters", "reasons", "reason_details", "warnings", "method", "free_motion", "units",
    "kind", "fate", "outcome", "termination", "seed", "threads", "reference",
}


def lines(value, path):
    if isinstance(value, dict):
        for key in sorted(value):
            if key not in SKIPPED and not key.endswith("_ms"):
                yield from lines(value[key], f"{path}.{key}")
    elif isinstance(value, list):
        for place, item in enumerate(value):
            yield from lines(item, f"{path}[{place}]")
    else:
        yield f"{path} = {value!r}"


for line in lines(json.load(open(sys.argv[1])), ""):
    print(line)
PYTHON

n_compared=0
n_different=0

# both NAME ARGS…: runs both builds, each with its own folder in place of OUT, and compares what
# they wrote there. That both end with the same exit code is a result too.
both() {
    local name=$1 side binary
    shift
    for side in a b; do
        binary=$a
        [ "$side" = b ] && binary=$b
        rm -rf "$work/$side"
        mkdir -p "$work/$side"
        local code=0
        "$binary" -q "${@//OUT/$work/$side}" >/dev/null 2>&1 || code=$?
        echo "$code" >"$work/$side/code"
        for json in "$work/$side"/*.json; do
            [ -e "$json" ] || continue
            python3 "$work/numbers.py" "$json" >"$json.numbers"
            rm "$json"
        done
    done
    n_compared=$((n_compared + 1))
    if ! diff -r "$work/a" "$work/b" >"$work/difference"; then
        n_different=$((n_different + 1))
        echo "DIFFERENT $name"
        head -n 6 "$work/difference"
    fi
}

list() { "$a" sample --list | sed -n "/^$1/,/^[A-Z]/p" | awk '/^  /{ print $1 }'; }

for part in $(list Parts); do
    for variant in $(list Variants); do
        sample="$part-$variant"
        [[ "$sample" == *"$filter"* ]] || continue
        folder="$work/$sample"
        "$a" -q sample --part "$part" --variant "$variant" "$folder" >/dev/null 2>&1 || continue
        pair=("$folder/crash.k" "$folder/stamped.dynain")
        both "$sample" match "${pair[@]}" --json OUT/match.json
        both "$sample, reduced" match "${pair[@]}" --triangles 1000 --json OUT/match.json
        if [ "$variant" = plain ] || [ "$variant" = addendum-and-cut ]; then
            for method in icp trimmed trimmed-search umeyama; do
                both "$sample, $method" match "${pair[@]}" --method "$method" --json OUT/match.json
            done
            both "$sample, paper" match "${pair[@]}" --method paper --triangles 500 \
                --json OUT/match.json
            both "$sample, both hands" match "${pair[@]}" --hand either --json OUT/match.json
            both "$sample, scale" match "${pair[@]}" --scale --json OUT/match.json
            both "$sample, reduction" reduce "${pair[1]}" --triangles 800 --out OUT/small.ply \
                --json OUT/reduce.json
        fi
        rm -rf "$folder"
    done
done
if [ -z "$filter" ]; then
    both bench bench --json OUT/bench.json
fi

echo "$n_compared runs compared, $n_different differ"
[ "$n_compared" -gt 0 ] && [ "$n_different" -eq 0 ]
