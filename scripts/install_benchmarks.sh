#!/usr/bin/env bash
# Installs what benchmarks/compare measures Saltus against, and nothing that building or testing Saltus needs: SUNDIALS
# and Siconos from Debian (as root), SciPy from PyPI into build/benchmarks/venv. Each of them is optional: what cannot
# be installed becomes a row "not installed" of the comparison, never a failure. Safe to repeat.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=build/benchmarks/venv
scipy_version=1.16.3

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

install_scipy() {
  "$venv/bin/python3" -c 'import scipy' 2>/dev/null && return 0
  say "Installing SciPy $scipy_version into $venv …"
  mkdir -p "$(dirname "$venv")"
  { python3 -m venv "$venv" &&
    "$venv/bin/python3" -m pip install --quiet --disable-pip-version-check "scipy==$scipy_version"; } >&2 ||
    say "pip could not install SciPy: going on without it"
}

if command -v apt-get >/dev/null && [[ $(id -u) -eq 0 ]] &&
  ! { is_installed libsundials-dev && is_installed python3-siconos; }; then
  apt-get update -qq || say "apt-get update failed: is the network there?"
fi
install_debian_package libsundials-dev
install_debian_package python3-siconos
install_scipy
