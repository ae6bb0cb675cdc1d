#!/usr/bin/env bash
# `make test`: installs what is missing, builds and runs every test, in release and under the sanitizers.
# Ends with the seconds of each stage and of all (the budget is in CONTRIBUTING.md), and the line "N passed, M failed"; exit
# code 0 only if nothing failed.
#   scripts/test.sh [PRESET…]     default: release sanitize; "nightly" runs the campaigns on the build of release
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OPENBLAS_NUM_THREADS=1

presets=("$@")
[[ ${#presets[@]} -gt 0 ]] || presets=(release sanitize)

reports=()
seconds=""  # of each stage: what to make shorter when the run becomes long
stage() {
  local begin=$SECONDS outcome=0
  "${@:2}" || outcome=$?
  seconds+=$(printf '%6d s  %s' $((SECONDS - begin)) "$1")$'\n'
  return $outcome
}
stage "install" scripts/install.sh python
for preset in "${presets[@]}"; do
  report="$PWD/build/$preset/ctest.xml"
  reports+=("$preset=$report")
  rm -f "$report"
  build=$preset
  [[ $preset != nightly ]] || build=release
  mkdir -p "${report%/*}"
  # A preset that does not build is one failure in the summary; the others still run. All errors of a build are shown.
  stage "configure $build" cmake --preset "$build" --log-level=NOTICE &&
    stage "build $build" cmake --build --preset "$build" --parallel "$(nproc)" -- -k 0 || continue
  stage "tests $preset" ctest --preset "$preset" --parallel "$(nproc)" --output-junit "$report" || true
done
printf '\n%s%6d s  all\n' "$seconds" "$SECONDS"
python3 scripts/summarise_tests.py "${reports[@]}"
