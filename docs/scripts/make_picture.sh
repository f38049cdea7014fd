#!/usr/bin/env bash
# Makes docs/pictures/drive.svg: a simulated robot is calibrated from one recording; on another, random drive of the same robot
# dead reckoning with nominal and with calibrated values is compared with where the robot really was.
#
# usage: docs/scripts/make_picture.sh [SEED]
set -euo pipefail
cd "$(dirname "$0")/../.."
seed=${1:-5}
cmake --preset release > /dev/null
cmake --build build/release -j "$(nproc)" --target odomcalibctl odomcalib-sim-record
bin=build/release/bin
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

"$bin/odomcalib-sim-record" --seed "$seed" --out "$dir/guided.jsonl.gz"
"$bin/odomcalib-sim-record" --seed "$seed" --drive random --duration 120 --out "$dir/random.jsonl.gz" --path "$dir/true.tum"
"$bin/odomcalibctl" solve "$dir/guided.jsonl.gz" --out "$dir/calibration.json"
"$bin/odomcalibctl" predict "$dir/random.jsonl.gz" --calibration nominal --trajectory "$dir/nominal.tum"
"$bin/odomcalibctl" predict "$dir/random.jsonl.gz" --calibration "$dir/calibration.json" --trajectory "$dir/calibrated.tum"
python3 docs/scripts/draw_paths.py "$dir/true.tum" "$dir/nominal.tum" "$dir/calibrated.tum" > docs/pictures/drive.svg
