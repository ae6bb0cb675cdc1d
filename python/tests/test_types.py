"""The annotations of the package and its stubs, by mypy."""

import os
import subprocess
import sys

import pytest


def test_mypy_finds_nothing(source, tmp_path):
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path)]
    written = tmp_path / "written.py"
    written.write_text('import numpy as np\nimport saltus\n\nx = saltus.Builder("m").state("x", 1)\nprint(np.sin(x))\n')
    run = subprocess.run([*command, written], cwd=source, capture_output=True, text=True, check=False,
                         env={**os.environ, "MYPYPATH": str(source / "python")})
    assert run.returncode == 0, run.stdout + run.stderr
    run = subprocess.run(command, cwd=source, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
