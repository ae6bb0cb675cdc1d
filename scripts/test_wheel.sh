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
for python in "${@:2}"; do
  tag=$("$python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
  wheel=$(ls -t "$wheels"/saltus-*-"$tag"-*.whl | head -n 1)
  "$python" -m venv "$folder/$tag"
  "$folder/$tag/bin/pip" install --quiet --disable-pip-version-check --constraint "$source_folder/scripts/requirements-python.txt" \
    "$wheel[plot,data]" pytest mypy
  (cd "$folder/tests" && SALTUS_TEST_WHEEL=1 SALTUS_TEST_TOOL="$folder/$tag/bin/saltus" SALTUS_TEST_SOURCE="$source_folder" \
    MPLBACKEND=Agg "$folder/$tag/bin/python" -m pytest -q -p no:cacheprovider .)
done
