#!/usr/bin/env bash
# Formats every C++ source of the tree, or with --check only says which ones are not formatted (exit code 1).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mode=(-i)
[[ "${1:-}" == --check ]] && mode=(--dry-run --Werror)
git ls-files -z '*.cpp' '*.hpp' | xargs -0 -r clang-format "${mode[@]}"
