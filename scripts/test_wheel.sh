#!/usr/bin/env bash
# Installs the wheel of a build folder into an empty environment, without the source tree, and runs the tests there.
#   scripts/test_wheel.sh WHEEL_FOLDER PYTHON…     the environments are those of these interpreters
#   scripts/test_wheel.sh WHEEL_FOLDER others      of the oldest and the newest other Python >= 3.10 here, with a part of the tests
set -euo pipefail
source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
wheels=$(cd "$1" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r "$source_folder/python/tests" "$folder/tests"
unset PYTHONPATH SALTUS_MODELS SALTUS_PLOTLY
wheel=$(ls -t "$wheels"/saltus-*.whl | head -n 1)

# The versions that are pinned are for the tree's own Python; others take the newest that they can have.
is_of_the_tree() { [[ -e "$source_folder/.venv/lib/python$1" ]]; }

pythons=("${@:2}")
extras="[plot,data]"
tests=(.)
if [[ "${pythons[*]}" == others ]]; then
  pythons=()
  extras=""
  tests=(test_installed.py test_process.py test_builder.py test_between_rows.py)
  for minor in 3.10 3.11 3.12 3.13 3.14; do
    ! is_of_the_tree $minor || continue
    for python in "$(command -v python$minor || true)" "$HOME"/.pyenv/versions/$minor.*/bin/python; do
      "$python" -c '' 2>/dev/null && pythons+=("$python") && break
    done
  done
  ((${#pythons[@]} < 3)) || pythons=("${pythons[0]}" "${pythons[-1]}")
fi
for python in "${pythons[@]}"; do
  version=$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
  pins=()
  ! is_of_the_tree "$version" || pins=(--constraint "$source_folder/scripts/requirements-python.txt")
  "$python" -m venv "$folder/$version"
  "$folder/$version/bin/pip" install --quiet --disable-pip-version-check --no-compile "${pins[@]}" "$wheel$extras" pytest ${extras:+mypy}
  echo "Python $version"
  (cd "$folder/tests" && SALTUS_TEST_WHEEL=1 SALTUS_TEST_TOOL="$folder/$version/bin/saltus" SALTUS_TEST_SOURCE="$source_folder" \
    MPLBACKEND=Agg "$folder/$version/bin/python" -m pytest -q -p no:cacheprovider "${tests[@]}")
done
