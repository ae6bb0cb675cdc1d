#!/usr/bin/env bash
# `make package`: build/package has a tarball that can be unpacked anywhere, a .deb, and the source as an archive of which
# pip makes a wheel (pip install 'saltus-….tar.gz#subdirectory=python').
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/install.sh
cmake --preset release --log-level=NOTICE
cmake --build build/release --target saltus_tool saltus_libraries
rm -rf build/package && mkdir -p build/package
(cd build/release && cpack --config CPackConfig.cmake >/dev/null)
rm -rf build/package/_CPack_Packages
version=$(sed -n 's/.*version = "\([^"]*\)".*/\1/p' src/saltus/base/version.hpp)
git archive --format=tar.gz --prefix="saltus-$version/" --output="build/package/saltus-$version-source.tar.gz" HEAD
ls -l build/package
