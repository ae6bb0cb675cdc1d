"""``python -m saltus`` and the script ``saltus`` are the command-line tool."""

from __future__ import annotations

import sys

from . import _core


def main() -> int:
    """Runs the tool with the arguments of the command line and returns its exit code."""
    return _core.run_tool(["saltus", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
