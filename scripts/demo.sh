#!/usr/bin/env bash
# `make demo`: installs what is missing, builds the tool, simulates shipped models and optimises one, ends with tables and reports.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OPENBLAS_NUM_THREADS=1

scripts/install.sh
cmake --preset release --log-level=NOTICE
cmake --build --preset demo --parallel "$(nproc)"
built=$SECONDS

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
# The swing-up of a pole on a cart with dry friction: a quarter of a minute.
printf '\n$ %s\n' "$tool optimize cart-pole --out demo/cart-pole.json --report demo/cart-pole.html"
"$tool" optimize cart-pole --out demo/cart-pole.json --report demo/cart-pole.html
printf '\nReports: %s\n         %s\n' "$PWD/demo/stick-slip.html" "$PWD/demo/cart-pole.html"
printf '%d s: installed and built %d s, ran %d s\n' "$SECONDS" "$built" $((SECONDS - built))
