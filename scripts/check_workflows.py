"""Checks .github/workflows: by actionlint where it is installed, and that what a workflow calls of this tree is there.

usage: check_workflows.py

actionlint is installed by `go install github.com/rhysd/actionlint/cmd/actionlint@v1.7.12`; without it a line says that it was left out.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
CALLED = re.compile(r"(?<![\w/.])((?:scripts|tests|benchmarks|packaging)/[\w/-]+\.(?:sh|py))")


def missing_files(root):
    """Complaints about files of this tree that a workflow, a hook or the settings of the wheels name."""
    places = [*sorted((root / ".github/workflows").glob("*.yml")), root / ".pre-commit-config.yaml", root / "pyproject.toml"]
    for place in places:
        for name in CALLED.findall(place.read_text(encoding="utf-8")):
            if not (root / name).exists():
                yield f"{place.relative_to(root)}: there is no {name}"


def main():
    complaints = list(missing_files(ROOT))
    print("\n".join(complaints) if complaints else "workflows call what is there")
    program = shutil.which("actionlint")
    if not program:
        print("actionlint is not installed: the syntax of the workflows is not checked")
        return 1 if complaints else 0
    files = sorted((ROOT / ".github/workflows").glob("*.yml"))
    return 1 if subprocess.run([program, *files], cwd=ROOT, check=False).returncode or complaints else 0


if __name__ == "__main__":
    sys.exit(main())
