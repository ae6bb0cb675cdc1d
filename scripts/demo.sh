#!/usr/bin/env bash
# `make demo`: installs what is missing, builds the tool, simulates shipped models, ends with a table and a report.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OPENBLAS_NUM_THREADS=1

scripts/install.sh
cmake --preset release --log-level=NOTICE
cmake --build --preset demo --parallel "$(nproc)"

# The tool lies at the same place of the build tree whatever its folder of sources is called.
tool=$(find build/release -type f -name saltus -perm -u+x | head -n 1)
[[ -n "$tool" ]] || { echo "scripts/demo.sh: the build made no tool named saltus" >&2; exit 1; }

mkdir -p demo
simulate() {
  printf '\n$ %s\n' "$tool simulate $1 --out demo/$1.json --report demo/$1.html"
  "$tool" simulate "$1" --out "demo/$1.json" --report "demo/$1.html"
}
for model in rotating-oscillator relay-feedback stick-slip; do
  simulate "$model"
done
printf '\nReport: %s\n' "$PWD/demo/stick-slip.html"
