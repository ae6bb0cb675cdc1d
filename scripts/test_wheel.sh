#!/usr/bin/env bash
# Installs the wheel of a build folder into an empty environment, without the source tree, and runs the tests there.
#   scripts/test_wheel.sh WHEEL_FOLDER PYTHON…     the environments are those of these interpreters
set -euo pipefail
source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
wheels=$(cd "$1" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r "$source_folder/python/tests" "$folder/tests"
unset PYTHONPATH SALTUS_MODELS SALTUS_PLOTLY
wheel=$(ls -t "$wheels"/saltus-*.whl | head -n 1)
for python in "${@:2}"; do
  tag=$("$python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
  # The versions that are pinned are for the tree's own Python; others take the newest that they can have.
  pins=()
  [[ ! -e "$source_folder/.venv/lib/${tag/cp3/python3.}" ]] || pins=(--constraint "$source_folder/scripts/requirements-python.txt")
  "$python" -m venv "$folder/$tag"
  "$folder/$tag/bin/pip" install --quiet --disable-pip-version-check "${pins[@]}" "$wheel[plot,data]" pytest mypy
  (cd "$folder/tests" && SALTUS_TEST_WHEEL=1 SALTUS_TEST_TOOL="$folder/$tag/bin/saltus" SALTUS_TEST_SOURCE="$source_folder" \
    MPLBACKEND=Agg "$folder/$tag/bin/python" -m pytest -q -p no:cacheprovider .)
done
