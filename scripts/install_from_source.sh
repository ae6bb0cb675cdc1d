#!/usr/bin/env bash
# Builds what Saltus links from its sources into PREFIX, where no package of the system has it: the wheels of manylinux and of macOS.
# Needs git, cmake and a compiler; versions are pinned. CasADi comes from PyPI, zlib from the system.
#   scripts/install_from_source.sh PREFIX
set -euo pipefail
prefix=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# NAME URL TAG options of its build, without its tests
install() {
  local name=$1 url=$2 tag=$3
  git clone --quiet --depth 1 --branch "$tag" "$url" "$folder/$name"
  cmake -S "$folder/$name" -B "$folder/build/$name" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" \
    -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF "${@:4}" >/dev/null
  cmake --build "$folder/build/$name" --parallel >/dev/null
  cmake --install "$folder/build/$name" >/dev/null
  echo "$name $tag"
}

install eigen https://gitlab.com/libeigen/eigen.git 3.4.0 -DEIGEN_BUILD_DOC=OFF
install fmt https://github.com/fmtlib/fmt.git 9.1.0 -DFMT_TEST=OFF -DFMT_DOC=OFF
install expected https://github.com/TartanLlama/expected.git v1.1.0 -DEXPECTED_BUILD_TESTS=OFF
install tomlplusplus https://github.com/marzer/tomlplusplus.git v3.4.0
install json https://github.com/nlohmann/json.git v3.11.3 -DJSON_BuildTests=OFF
install CLI11 https://github.com/CLIUtils/CLI11.git v2.4.2 -DCLI11_BUILD_TESTS=OFF -DCLI11_BUILD_EXAMPLES=OFF -DCLI11_BUILD_DOCS=OFF
