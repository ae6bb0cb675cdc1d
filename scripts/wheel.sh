#!/usr/bin/env bash
# Makes the wheel of a build folder, for every Python from 3.10 on. It brings the libraries of the system that it links;
# those of CasADi are in the package casadi.
#   scripts/wheel.sh BUILD_FOLDER WHEEL_FOLDER
set -euo pipefail
build_folder=$(realpath "$1")
wheels=$(realpath "$2")
cd "$(dirname "${BASH_SOURCE[0]}")/.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
.venv/bin/python3 -m pip wheel --disable-pip-version-check --quiet --no-build-isolation --no-deps . --wheel-dir "$folder" \
  --config-settings=build-dir="$build_folder"
rm -rf "$wheels"
PATH="$PWD/.venv/bin:$PATH" auditwheel repair --exclude 'libcasadi.so.*' --exclude 'libipopt.so.*' --exclude 'libhighs.so.*' \
  --wheel-dir "$wheels" "$folder"/saltus-*.whl >"$folder/log" 2>&1 || { cat "$folder/log" >&2; exit 1; }
ls "$wheels"/saltus-*.whl
