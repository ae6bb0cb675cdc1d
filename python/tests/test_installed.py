"""What a wheel holds: run by scripts/test_wheel.sh, in an environment that knows no source tree."""

import importlib.metadata
import os
import pathlib
import subprocess
import sys

import pytest

import saltus

pytestmark = pytest.mark.skipif("SALTUS_TEST_WHEEL" not in os.environ, reason="the package is not installed: scripts/test_wheel.sh")

PACKAGE = pathlib.Path(saltus.__file__).parent


def test_it_is_what_is_installed():
    assert PACKAGE.is_relative_to(sys.prefix)
    assert {"py.typed", "_core.pyi", "share"} <= {path.name for path in PACKAGE.iterdir()}
    assert all((PACKAGE / "share" / name).exists() for name in ("LICENSE", "CITATION.cff"))
    assert importlib.metadata.version("saltus") == saltus.__version__


def test_it_brings_its_catalogue_and_its_pictures(tmp_path):
    assert len(saltus.models()) >= 70
    assert all(pathlib.Path(saltus.catalogue(name).path).is_relative_to(PACKAGE) for name in saltus.models())
    r = saltus.catalogue("stick-slip").simulate(until=5)
    r.report(tmp_path / "r.html")
    assert r.status == "completed"
    assert (tmp_path / "r.html").stat().st_size > 100_000


def test_it_brings_the_tool():
    tool = pathlib.Path(sys.prefix) / "bin" / "saltus"
    version = subprocess.run([tool, "--version"], check=True, capture_output=True, text=True).stdout
    assert saltus.__version__ in version
