"""The annotations of the package and its stubs, by mypy."""

import subprocess
import sys

import pytest


def test_mypy_finds_nothing(source, tmp_path):
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "--cache-dir", str(tmp_path)]
    run = subprocess.run(command, cwd=source, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout + run.stderr
