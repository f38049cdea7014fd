#!/usr/bin/env bash
# A robot with wrong nominal values is simulated, recorded, calibrated, and judged on the error that is left. Needs no
# hardware; builds what it needs. Results stay in build/demo.
set -euo pipefail
cd "$(dirname "$0")"

cmake --preset release >/dev/null
cmake --build build/release -j "$(nproc)" --target odomcalibctl odomcalib-sim-record
bin=$PWD/build/release/bin
out=build/demo
rm -rf "$out"
mkdir -p "$out"

echo "== a simulated drive: guided motions in a furnished room"
"$bin/odomcalib-sim-record" --seed 7 --out "$out/recording.jsonl.gz" --truth "$out/truth.json"
echo "== calibration from the recording"
"$bin/odomcalibctl" solve "$out/recording.jsonl.gz" --out "$out/calibration.json"
echo "== the true values, which the program did not see"
cat "$out/truth.json"
