"""What a wheel holds, without the source tree: the installed component runs from anywhere."""

import os
import subprocess
import sys


def test_the_installed_package(tmp_path):
    build, cmake = os.environ["SALTUS_TEST_BUILD"], os.environ["SALTUS_TEST_CMAKE"]
    subprocess.run([cmake, "--install", build, "--component", "python", "--prefix", tmp_path / "site"], check=True, capture_output=True)
    moved = tmp_path / "moved"
    (tmp_path / "site").rename(moved)
    code = """
import pathlib, sys
import saltus
assert pathlib.Path(saltus.__file__).is_relative_to(sys.argv[1]), saltus.__file__
assert len(saltus.models()) >= 70
assert all(pathlib.Path(saltus.catalogue(name).path).is_relative_to(sys.argv[1]) for name in saltus.models())
r = saltus.catalogue("stick-slip").simulate(until=5)
r.report("r.html")
print(r.status)
"""
    environment = {**os.environ, "PYTHONPATH": str(moved)}
    for name in ("SALTUS_MODELS", "SALTUS_PLOTLY"):
        environment.pop(name, None)
    done = subprocess.run([sys.executable, "-c", code, moved], cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "completed"
    assert (tmp_path / "r.html").stat().st_size > 100_000
    files = {path.name for path in (moved / "saltus").iterdir()}
    assert {"py.typed", "_core.pyi", "share"} <= files
    assert (moved / "saltus" / "share" / "LICENSE").exists()
