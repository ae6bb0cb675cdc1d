"""Prints the line coverage of every module after `cmake --workflow --preset coverage`, and the lines nobody ran.

usage: coverage.py [MODULE]       with a module: its files with the line numbers that were not run

Uses gcov of the compiler (JSON output) and the standard library only.
"""

import collections
import json
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build" / "coverage"


def run_counts():
    """File -> line -> number of runs, over all objects of the build."""
    counts = collections.defaultdict(collections.Counter)
    for data in sorted(BUILD.rglob("*.gcda")):
        command = ["gcov", "--json-format", "--stdout", str(data)]
        output = subprocess.run(command, cwd=BUILD, capture_output=True, text=True, check=True).stdout
        for document in output.splitlines():
            for file in json.loads(document)["files"]:
                path = (BUILD / file["file"]).resolve()
                if ROOT / "src" not in path.parents:
                    continue
                for line in file["lines"]:
                    counts[path][line["line_number"]] += line["count"]
    return counts


def percentage(lines):
    return 100.0 * sum(1 for count in lines if count) / max(1, len(lines))


def main(arguments):
    counts = run_counts()
    if not counts:
        print("no coverage data: run `cmake --workflow --preset coverage` first", file=sys.stderr)
        return 2
    modules = collections.defaultdict(list)
    for path in sorted(counts):
        module = path.relative_to(ROOT / "src" / "saltus").parts[0]
        modules[module].extend(counts[path].values())
        if module in arguments:
            missed = sorted(line for line, count in counts[path].items() if not count)
            print(f"{path.name:40} {percentage(list(counts[path].values())):6.1f} %  not run: {missed}")
    for module, lines in sorted(modules.items()):
        print(f"{module:20} {percentage(lines):6.1f} % of {len(lines)} lines")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
