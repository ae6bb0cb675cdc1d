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
  printf '\n$ %s\n' "$tool simulate $1 --out demo/$1.json --report demo/$1.html"
  "$tool" simulate "$1" --out "demo/$1.json" --report "demo/$1.html"
}
for model in rotating-oscillator relay-feedback stick-slip; do
  simulate "$model"
done
printf '\nReport: %s\n' "$PWD/demo/stick-slip.html"
