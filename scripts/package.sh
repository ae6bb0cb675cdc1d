#!/usr/bin/env bash
# `make package`: build/package has a tarball that can be unpacked anywhere, a .deb, a wheel for every Python from 3.10 on, and
# the source, of which pip makes a wheel (pip install saltus-….tar.gz).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/install.sh python
cmake --preset release --log-level=NOTICE
cmake --build build/release --target saltus_tool saltus_libraries saltus_python
rm -rf build/package && mkdir -p build/package
(cd build/release && cpack --config CPackConfig.cmake >/dev/null)
rm -rf build/package/_CPack_Packages
scripts/wheel.sh build/release build/wheel
cp build/wheel/saltus-*.whl build/package/
.venv/bin/python3 -c 'from scikit_build_core.build import build_sdist; build_sdist("build/package")' >/dev/null
ls -l build/package
