#!/usr/bin/env bash
# Installs what is missing to build and test Saltus, and only that: Debian packages with apt-get (as root), CasADi and
# plotly into ./.venv. Safe to repeat; done in a fraction of a second when there is nothing to do.
#   scripts/install.sh              what `make demo` and `make test` need
#   scripts/install.sh developer    also clang-format and clang-tidy
#   scripts/install.sh python       also what the Python package needs, as far as it can be had
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

packages=(g++ cmake make ninja-build libeigen3-dev libfmt-dev libtomlplusplus-dev libcli11-dev nlohmann-json3-dev
  libexpected-dev zlib1g-dev libgtest-dev libbenchmark-dev)
optional_packages=(ccache)
if [[ "${1:-}" == developer ]]; then
  packages+=(clang-format clang-tidy)
fi

say() { printf '%s\n' "$*" >&2; }
fail() { say "scripts/install.sh: $*"; exit 1; }

is_installed() { [[ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" == installed ]]; }

# A tool that came from elsewhere than Debian's package is as good as the package.
is_present() {
  case "$1" in
    cmake | make | g++ | ccache | clang-format | clang-tidy) command -v "$1" >/dev/null || is_installed "$1" ;;
    ninja-build) command -v ninja >/dev/null || is_installed "$1" ;;
    *) is_installed "$1" ;;
  esac
}

missing_of() {
  local package
  for package in "$@"; do
    is_present "$package" || printf '%s\n' "$package"
  done
}

python_can_make_venv() { python3 -c 'import ensurepip, venv' 2>/dev/null; }

# Mirrors hiccup: three attempts, a few seconds apart.
retry() {
  local attempt
  for attempt in 1 2 3; do
    "$@" && return 0
    say "attempt $attempt of 3 failed: $*"
    sleep $((attempt * 5))
  done
  return 1
}

install_debian_packages() {
  local missing=() optional=()
  mapfile -t missing < <(missing_of "${packages[@]}")
  mapfile -t optional < <(missing_of "${optional_packages[@]}")
  command -v python3 >/dev/null || missing+=(python3)
  python_can_make_venv || missing+=(python3-venv)
  [[ ${#missing[@]} -eq 0 ]] && return 0

  if [[ $(id -u) -ne 0 ]]; then
    say "These Debian packages are missing. Install them and repeat:"
    say "  sudo apt-get update && sudo apt-get install -y --no-install-recommends ${missing[*]}"
    exit 1
  fi
  say "Installing ${missing[*]} ${optional[*]:-} …"
  export DEBIAN_FRONTEND=noninteractive
  retry apt-get update -qq || fail "apt-get update failed: is the network there?"
  retry apt-get install -y -qq --no-install-recommends "${missing[@]}" >&2 || fail "apt-get could not install ${missing[*]}"
  if [[ ${#optional[@]} -gt 0 ]]; then
    apt-get install -y -qq --no-install-recommends "${optional[@]}" >&2 || say "going on without ${optional[*]}"
  fi
}

# What the build uses of each wheel; RECORD is the last file that pip writes.
wheel_is_complete() {
  local name=${1%%==*} version=${1##*==} site
  for site in .venv/lib/python3*/site-packages; do
    [[ -f "$site/$name-$version.dist-info/RECORD" ]] || continue
    case "$name" in
      casadi) [[ -f "$site/casadi/cmake/casadi-config.cmake" ]] && return 0 ;;
      plotly) [[ -f "$site/plotly/package_data/plotly.min.js" ]] && return 0 ;;
      *) return 0 ;;
    esac
  done
  return 1
}

# Of one file of requirements.
install_wheels() {
  local requirement complete=yes
  while read -r requirement; do
    wheel_is_complete "$requirement" || complete=no
  done < <(grep -v '^#' "$1")
  [[ $complete == yes ]] && return 0

  say "Installing $1 into .venv …"
  # A virtual environment whose Python has gone (a moved tree, an upgraded system) cannot be repaired, only made anew.
  .venv/bin/python3 -m pip --version >/dev/null 2>&1 || { rm -rf .venv && python3 -m venv .venv; }
  retry .venv/bin/python3 -m pip install --quiet --disable-pip-version-check --retries 5 --timeout 60 \
    --no-deps --requirement "$1" >&2
}

if command -v dpkg-query >/dev/null && command -v apt-get >/dev/null; then
  install_debian_packages
elif ! python_can_make_venv; then
  fail "this is not Debian: install python3 with venv, and what cmake/dependencies.cmake lists, by hand"
fi
install_wheels scripts/requirements.txt || fail "pip could not install scripts/requirements.txt"
if [[ "${1:-}" == python ]]; then
  if [[ ! -e $(python3 -c 'import sysconfig; print(sysconfig.get_path("include"))')/Python.h && $(id -u) -eq 0 ]]; then
    apt-get install -y -qq --no-install-recommends python3-dev >&2 || say "going on without python3-dev"
  fi
  install_wheels scripts/requirements-python.txt || say "going on without the Python package"
fi

# A plotly with what reports need, a third of the wheel's, where npm can make it.
if [[ ! -f .venv/plotly/plotly.min.js ]] && command -v npm >/dev/null && command -v node >/dev/null; then
  say "Making a small plotly …"
  timeout 180 scripts/make_plotly.sh >/dev/null 2>&1 || say "npm's registry does not answer: reports carry the whole plotly of PyPI"
fi

# What tests/report checks the accessibility of pages with.
if [[ "${1:-}" == developer && ! -f .venv/axe/axe.min.js ]] && command -v npm >/dev/null; then
  folder=$(mktemp -d)
  if timeout 60 npm install --silent --ignore-scripts --no-audit --no-fund --prefix "$folder" axe-core@4.10.3 >/dev/null 2>&1; then
    mkdir -p .venv/axe && cp "$folder/node_modules/axe-core/axe.min.js" .venv/axe/
  else
    say "going on without axe-core"
  fi
  rm -rf "$folder"
fi
