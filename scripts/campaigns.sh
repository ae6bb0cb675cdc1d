#!/usr/bin/env bash
# Campaigns over random systems that no test has drawn: COUNT of each family (default 2000), a tenth of that of contacts. Seeds begin
# at a number of the day, which is printed, or at FIRST. Needs the release build (cmake --workflow --preset release builds it).
#   scripts/campaigns.sh [COUNT [FIRST]]
# What complains is added to tests/robustness: its seed becomes a test when it is mended, or a row of the list of what is open.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export OPENBLAS_NUM_THREADS=1

count=${1:-2000}
first=${2:-$(($(date +%s) / 86400 * 100000))}
campaign=build/release/tests/robustness/saltus_random_campaign
python=.venv/bin/python3
[[ -x $python ]] || python=python3
[[ -x $campaign ]] || { echo "$campaign is not built: cmake --preset release && cmake --build --preset release" >&2; exit 2; }

printf '%s systems of each family from seed %s on\n' "$count" "$first"
outcome=0
printf '%s\n' affine constant smooth nested friction jumps relays regions |
  xargs -P "$(nproc)" -I FAMILY "$campaign" FAMILY "$first" "$count" || outcome=1
PYTHONPATH=build/release/python "$python" tests/robustness/random_contacts.py --first "$first" --runs "$((count / 10))" || outcome=1
exit $outcome
