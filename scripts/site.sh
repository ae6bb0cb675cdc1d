#!/usr/bin/env bash
# Builds the documentation into build/site: every block and command of it runs, every picture is made, warnings are errors.
#   scripts/site.sh            all of it
#   scripts/site.sh --quick    without the gallery, the C++ reference and the run of the blocks of plain pages
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
scripts/install.sh python
.venv/bin/python3 -c 'import sphinx, furo, myst_nb, ipykernel, breathe, scipy' 2>/dev/null ||
  .venv/bin/python3 -m pip install --quiet --disable-pip-version-check --requirement scripts/requirements-site.txt
if ! command -v doxygen >/dev/null && command -v apt-get >/dev/null && [[ $(id -u) -eq 0 ]]; then
  apt-get install -y -qq --no-install-recommends doxygen >&2 || echo "going on without doxygen: no C++ reference" >&2
fi
cmake --preset release --log-level=ERROR >/dev/null 2>&1
cmake --build build/release --target saltus_tool saltus_python
exec .venv/bin/python3 scripts/site/build.py "$@"
