#!/usr/bin/env bash
# `make test`: installs what is missing, builds and runs every test, in release and under the sanitizers.
# Ends with the line "N passed, M failed"; exit code 0 only if nothing failed.
#   scripts/test.sh [PRESET…]     default: release sanitize
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OPENBLAS_NUM_THREADS=1

presets=("$@")
[[ ${#presets[@]} -gt 0 ]] || presets=(release sanitize)

scripts/install.sh python
reports=()
seconds=""  # of each stage: what to make shorter when the run becomes long
stage() {
  local begin=$SECONDS outcome=0
  "${@:2}" || outcome=$?
  seconds+="  $1: $((SECONDS - begin)) s"
  return $outcome
}
for preset in "${presets[@]}"; do
  report="$PWD/build/$preset/ctest.xml"
  reports+=("$preset=$report")
  rm -f "$report"
  # A preset that does not build is one failure in the summary; the others still run. All errors of a build are shown.
  cmake --preset "$preset" --log-level=NOTICE &&
    stage "build $preset" cmake --build --preset "$preset" --parallel "$(nproc)" -- -k 0 || continue
  stage "tests $preset" ctest --preset "$preset" --parallel "$(nproc)" --output-junit "$report" || true
done
printf '\nSeconds:%s\n' "$seconds"
python3 scripts/summarise_tests.py "${reports[@]}"
