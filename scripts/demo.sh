#!/usr/bin/env bash
# `make demo`: installs what is missing, builds the tool, simulates shipped models, ends with a table and a report.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OPENBLAS_NUM_THREADS=1

scripts/install.sh
cmake --preset release --log-level=NOTICE
cmake --build --preset demo --parallel "$(nproc)"

tool=build/release/bin/saltus
mkdir -p demo
simulate() {
  local model=$1 name=$1
  shift
  [ $# -eq 0 ] || name=$model-$2
  printf '\n$ %s\n' "$tool simulate $model${*:+ $*} --out demo/$name.json --report demo/$name.html"
  "$tool" simulate "$model" "$@" --out "demo/$name.json" --report "demo/$name.html"
}
for model in rotating-oscillator relay-feedback stick-slip; do
  simulate "$model"
done
# Multipliers and lengths of finite elements: its report has a card for them.
simulate sliding --method fesd --set simulate.fesd.steps=10
printf '\nReport: %s\n' "$PWD/demo/stick-slip.html"
