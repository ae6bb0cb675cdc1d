#!/usr/bin/env bash
# Installs what benchmarks/ measures Saltus against, and nothing that building or testing Saltus needs: SUNDIALS and Siconos
# from Debian (as root), the others from PyPI into virtual environments in build/benchmarks. Each of
# them is optional: what cannot be installed becomes a row "not installed" of the comparison, never a failure. Safe to repeat.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

venv=build/benchmarks/venv
scipy_version=1.16.3
nosnoc_version=0.2.0
mpecss_version=1.0.3
mujoco_version=4.0.0
drake_version=1.51.1
diffrax_version=0.7.2
jaxonomy_version=3.4.0
osqp_version=1.1.3
highspy_version=1.16.0
casadi_version=3.8.2

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

# A search of pip for versions that fit each other may take hours: it gets a quarter of one.
install_from_pypi() {
  local package=$1 version=$2 folder=$3 module=${4:-$1}
  "$folder/bin/python3" -c "import $module" 2>/dev/null && return 0
  say "Installing $package $version into $folder …"
  mkdir -p "$(dirname "$folder")"
  { python3 -m venv "$folder" &&
    timeout 900 "$folder/bin/python3" -m pip install --quiet --disable-pip-version-check "$package==$version"; } >&2 ||
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
install_from_pypi osqp "$osqp_version" "$venv"
install_from_pypi highspy "$highspy_version" "$venv"
install_from_pypi casadi "$casadi_version" "$venv"
install_from_pypi mujoco "$mujoco_version" build/benchmarks/mujoco-venv
install_from_pypi drake "$drake_version" build/benchmarks/drake-venv pydrake
install_from_pypi diffrax "$diffrax_version" build/benchmarks/diffrax-venv
install_from_pypi jaxonomy "$jaxonomy_version" build/benchmarks/jaxonomy-venv
