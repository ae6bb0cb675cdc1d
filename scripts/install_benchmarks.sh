#!/usr/bin/env bash
# Installs what benchmarks/compare measures Saltus against, and nothing that building or testing Saltus needs: SUNDIALS
# and Siconos from Debian (as root), SciPy, nosnoc and mpecss from PyPI into virtual environments in build/benchmarks. Each of
# them is optional: what cannot be installed becomes a row "not installed" of the comparison, never a failure. Safe to repeat.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=build/benchmarks/venv
scipy_version=1.16.3
nosnoc_version=0.2.0
mpecss_version=1.0.3

say() { printf '%s\n' "$*" >&2; }
is_installed() { [[ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]; }

install_debian_package() {
  local package=$1
  is_installed "$package" && return 0
  if ! command -v apt-get >/dev/null || [[ $(id -u) -ne 0 ]]; then
    say "$package is missing and can be installed only as root on Debian: going on without it"
    return 0
  fi
  say "Installing $package …"
  DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$package" >/dev/null ||
    say "apt-get could not install $package: going on without it"
}

install_from_pypi() {
  local package=$1 version=$2 folder=$3
  "$folder/bin/python3" -c "import $package" 2>/dev/null && return 0
  say "Installing $package $version into $folder …"
  mkdir -p "$(dirname "$folder")"
  { python3 -m venv "$folder" &&
    "$folder/bin/python3" -m pip install --quiet --disable-pip-version-check "$package==$version"; } >&2 ||
    say "pip could not install $package: going on without it"
}

if command -v apt-get >/dev/null && [[ $(id -u) -eq 0 ]] &&
  ! { is_installed libsundials-dev && is_installed python3-siconos; }; then
  apt-get update -qq || say "apt-get update failed: is the network there?"
fi
install_debian_package libsundials-dev
install_debian_package python3-siconos
install_from_pypi scipy "$scipy_version" "$venv"
install_from_pypi nosnoc "$nosnoc_version" build/benchmarks/nosnoc-venv
install_from_pypi mpecss "$mpecss_version" build/benchmarks/mpecss-venv
