"""Runs one check of checks.py, or all of them, on a source tree.

usage: check_architecture.py SOURCE_FOLDER [CHECK...]
       check_architecture.py SOURCE_FOLDER --list RATCHET     all that a ratchet (ratchets.py) counts

Prints the complaints one per line; exit code 1 if there are any, 2 for an unknown check.
"""

import sys
import tomllib
from pathlib import Path

import ratchets
from checks import ALL_CHECKS


def read_table():
    """The table of dependencies, with the ceilings of the ratchets."""
    table = tomllib.loads((Path(__file__).parent / "dependencies.toml").read_text(encoding="utf-8"))
    ceilings = tomllib.loads((Path(__file__).parent / "ceilings.toml").read_text(encoding="utf-8"))
    return {**table, "ceilings": ceilings}


def main(arguments):
    root, names = Path(arguments[0]).resolve(), arguments[1:]
    listed = names[:1] == ["--list"]
    known = list(ratchets.RATCHETS if listed else ALL_CHECKS)
    names = (names[1:] if listed else names) or known
    unknown = [name for name in names if name not in known]
    if unknown:
        print(f"unknown check {unknown[0]}; known: {', '.join(known)}")
        return 2
    table = read_table()
    if listed:
        for name in names:
            for key, items in ratchets.items_of(name, root, table).items():
                print("\n".join(f"{name}: {key}: {item}" for item in items))
        return 0
    complaints = [complaint for name in names for complaint in ALL_CHECKS[name](root, table)]
    print("\n".join(complaints) if complaints else f"{', '.join(names)}: nothing to complain about")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
