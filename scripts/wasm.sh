#!/usr/bin/env bash
# Builds build/wasm/try.html: the event engine, the reader and the page as WebAssembly, in one file that works offline.
# Needs Debian's emscripten (installed where this runs as root), node, and at the first time PyPI and Debian's sources.
#   scripts/wasm.sh            all of it, and its tests
#   scripts/wasm.sh --no-test
# Jobs at a time: JOBS, or one for each processor.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
jobs=${JOBS:-$(nproc)}
root=$PWD
work=$root/build/wasm

scripts/install.sh
# Its own compiler, clang 14, lacks a part of C++20 (structured bindings in lambdas): clang 16 takes its place.
if ! command -v emcmake >/dev/null || ! command -v clang++-16 >/dev/null; then
  [[ $(id -u) -eq 0 ]] || { echo "sudo apt-get install emscripten clang-16" >&2; exit 1; }
  apt-get update -qq && apt-get install -y -qq --no-install-recommends emscripten clang-16 >&2
fi
export EM_CLANG_ADD_VERSION=16 EMCC_CFLAGS=-Wno-version-check
casadi=$(sed -n 's/^casadi==//p' scripts/requirements.txt)
sources=$work/sources
mkdir -p "$sources"

# CasADi's core, from the source distribution of the wheel that the native build has.
if [[ ! -d $sources/casadi-$casadi ]]; then
  .venv/bin/python3 -m pip download --quiet --disable-pip-version-check --no-deps --no-binary :all: --dest "$sources" "casadi==$casadi"
  tar xf "$sources/casadi-$casadi.tar.gz" -C "$sources"
fi
# zlib, from Debian's sources: lists of its own, those of the system have programs only.
if [[ ! -d $sources/zlib ]]; then
  lists=$work/apt
  mkdir -p "$lists/partial" "$sources/zlib"
  suite=$(. /etc/os-release && echo "$VERSION_CODENAME")
  echo "deb-src http://deb.debian.org/debian $suite main" > "$lists/sources.list"
  apt=(apt-get -qq -o "Dir::Etc::sourcelist=$lists/sources.list" -o Dir::Etc::sourceparts=/dev/null -o "Dir::State::lists=$lists")
  "${apt[@]}" update
  (cd "$lists" && "${apt[@]}" source --download-only zlib)
  tar xf "$lists"/zlib_*.orig.tar.* -C "$sources/zlib" --strip-components=1
fi
# Headers of Debian's packages beside each other, without those of its C library.
mkdir -p "$work/headers"
for headers in eigen3/Eigen fmt tl toml++ nlohmann; do
  ln -sfn "/usr/include/$headers" "$work/headers/$(basename "$headers")"
done

# Its CMake asks for position-independent code, which nothing here needs. Joined sources: headers are most of the work.
options="-O2 -fno-PIC -fwasm-exceptions"
off=()
for part in DL SUNDIALS BUILD_SUNDIALS CSPARSE BUILD_CSPARSE TINYXML BUILD_TINYXML FMI2 FMI3 THREAD THREADSAFE_SYMBOLICS EXAMPLES \
  QPOASES BLOCKSQP SUPERSCS DEEPBIND; do
  off+=("-DWITH_$part=OFF")
done
emcmake cmake -S "$sources/casadi-$casadi" -B "$work/casadi" -G Ninja -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS_RELEASE=$options" \
  "-DCMAKE_C_FLAGS_RELEASE=$options" -DENABLE_STATIC=ON -DENABLE_SHARED=OFF -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=10 \
  "-DCMAKE_PROJECT_INCLUDE=$root/wasm/casadi_project.cmake" "${off[@]}" > "$work/casadi.log" 2>&1
ninja -C "$work/casadi" -j "$jobs" casadi

emcmake cmake -S wasm -B "$work" -G Ninja -DCMAKE_BUILD_TYPE=Release --log-level=NOTICE "-DSALTUS_WASM_CASADI=$sources/casadi-$casadi" >/dev/null
ninja -C "$work" -j "$jobs" saltus_wasm
plotly=.venv/plotly/plotly.min.js
[[ -f $plotly ]] || plotly=$(echo .venv/lib/python3*/site-packages/plotly/package_data/plotly.min.js)
python3 wasm/assemble.py "$work/saltus.js" "$plotly" "$work/try.html"
[[ "${1:-}" == --no-test ]] && exit 0
# The release build knows of these tests from the time on when there is a page, and has the tool that they compare with.
cmake --preset release --log-level=ERROR >/dev/null
cmake --build build/release --parallel "$jobs" --target saltus_tool
ctest --test-dir build/release --output-on-failure -R '^wasm\.'
