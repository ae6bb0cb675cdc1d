"""Runs one check of checks.py, or all of them, on a source tree.

usage: check_architecture.py SOURCE_FOLDER [CHECK...]

Prints the complaints one per line; exit code 1 if there are any, 2 for an unknown check.
"""

import sys
import tomllib
from pathlib import Path

from checks import ALL_CHECKS


def main(arguments):
    root = Path(arguments[0]).resolve()
    names = arguments[1:] or list(ALL_CHECKS)
    unknown = [name for name in names if name not in ALL_CHECKS]
    if unknown:
        print(f"unknown check {unknown[0]}; known: {', '.join(ALL_CHECKS)}")
        return 2
    table = tomllib.loads((Path(__file__).parent / "dependencies.toml").read_text(encoding="utf-8"))
    complaints = [complaint for name in names for complaint in ALL_CHECKS[name](root, table)]
    print("\n".join(complaints) if complaints else f"{', '.join(names)}: nothing to complain about")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
