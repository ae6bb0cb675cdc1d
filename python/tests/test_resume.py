"""Sweeps that fill a folder: they go on where they were ended, and refuse folders of others."""

import concurrent.futures
import contextlib
import functools
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import saltus
from saltus._machines import _sweep_folder

BELTS = np.linspace(0.05, 0.3, 40)


@pytest.fixture(scope="module")
def slip():
    return saltus.catalogue("stick-slip")


@pytest.fixture(params=["npz", "parquet"])
def kind(request, monkeypatch):
    if request.param == "parquet":
        pytest.importorskip("pyarrow")
    else:
        monkeypatch.setattr(_sweep_folder, "_has_parquet", lambda: False)
    return request.param


def same_tables(a, b):
    assert list(a.table) == list(b.table)
    for name, column in a.table.items():
        assert column.dtype.kind == b[name].dtype.kind and column.tolist() == b[name].tolist() or (
            np.asarray(column).tobytes() == np.asarray(b[name]).tobytes()), name


def content(folder):
    return {file.name: file.read_bytes() for file in folder.iterdir() if file.name != "_lock"}


def remove_parts(folder, lines):
    """As if the process had been killed before it noted these lines of the journal."""
    journal = folder / "_parts.csv"
    kept = journal.read_text().splitlines(keepends=True)
    gone = [line for i, line in enumerate(kept) if i in lines]
    journal.write_text("".join(line for i, line in enumerate(kept) if i not in lines))
    for line in gone:
        (folder / line.split(",")[3]).unlink()


@pytest.mark.parametrize("keep", ["final", "events", "trajectory"])
def test_a_folder_is_the_table(slip, tmp_path, kind, keep):
    how = {"belt": BELTS[::3], "until": 4, "keep": keep, "points": 5}
    alone = slip.sweep(**how)
    s = slip.sweep(**how, resume=tmp_path / "runs")
    same_tables(alone, s)
    assert s.done and len(s) == 14 and s.names == ["belt"]
    assert {file.suffix for file in (tmp_path / "runs").glob("runs-*")} == {f".{kind}"}
    assert sum(len(part["run"]) for part in s.parts()) == len(alone["run"])
    with np.load(next((tmp_path / "runs").glob("*.npz"))) if kind == "npz" else contextlib.nullcontext({}) as part:
        assert all(part[name].dtype == np.int64 for name in ("run", "unique", "events") if kind == "npz")
    assert s.results[7].x.tobytes() == alone.results[7].whole.x.tobytes()
    assert f"of 14 runs over belt, in {tmp_path / 'runs'}: 14 completed" in repr(s)
    s.save(tmp_path / "a.csv")
    alone.save(tmp_path / "b.csv")
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()
    s.report(tmp_path / "s.html")
    alone.report(tmp_path / "b.html")
    assert (tmp_path / "s.html").read_text() == (tmp_path / "b.html").read_text()
    if keep == "final":
        assert s.dataset()["q"].dims == ("belt",) and s.frame()["q"].tolist() == alone["q"].tolist()
        assert s.plot("v").get_xlabel() == "belt"


def test_only_what_is_missing_is_run(slip, tmp_path, kind):
    folder = tmp_path / "runs"
    how = {"sample": {"v": "normal(0, 0.1)"}, "runs": 200, "until": 1, "resume": folder}
    before = slip.sweep(**how)
    whole = content(folder)
    stamps = {file: file.stat().st_mtime_ns for file in folder.glob("runs-*")}
    assert len(stamps) == 64
    remove_parts(folder, {3, 4, 60})
    again = slip.sweep(**how)
    same_tables(before, again)
    assert {name: data for name, data in content(folder).items() if name != "_parts.csv"} == {
        name: data for name, data in whole.items() if name != "_parts.csv"}
    assert sum(file.stat().st_mtime_ns == stamp for file, stamp in stamps.items()) == 61
    assert sorted(whole["_parts.csv"].splitlines()) == sorted((folder / "_parts.csv").read_bytes().splitlines())


def test_executors_fill_folders(slip, tmp_path):
    how = {"belt": BELTS, "until": 2, "resume": tmp_path / "runs"}
    with concurrent.futures.ThreadPoolExecutor(2) as workers:
        s = slip.sweep(**how, executor=workers)
        same_tables(slip.sweep(belt=BELTS, until=2), s)
        remove_parts(tmp_path / "runs", {0, 30})
        workers.shutdown()
        with pytest.raises(saltus.Stopped, match=r"takes no more work.*; 38 of 40 runs are in .*runs, the same call goes on") as stopped:
            slip.sweep(**how, executor=workers)
    kept = stopped.value.result
    assert len(kept) == len(kept["run"]) == 38 and not kept.done and "38 of 40 runs" in repr(kept)
    same_tables(s, slip.sweep(**how))


PROGRAM = """
import concurrent.futures
import multiprocessing
import sys
import numpy as np
import saltus

if __name__ == "__main__":
    m = saltus.catalogue("stick-slip")
    pool = concurrent.futures.ProcessPoolExecutor(2, multiprocessing.get_context("fork")) if sys.argv[2] == "pool" else None
    m.sweep(belt=np.linspace(0.05, 0.3, 64), until=100, rtol=1e-11, resume=sys.argv[1], executor=pool, jobs=1)
"""


@pytest.mark.parametrize("workers", ["none", "pool"])
def test_a_kill_costs_the_parts_in_work(slip, tmp_path, workers):
    """Also where workers outlive the process that is killed, as those of a pool by fork do."""
    program, folder = tmp_path / "study.py", tmp_path / "runs"
    program.write_text(PROGRAM)
    running = subprocess.Popen([sys.executable, program, folder, workers], start_new_session=True)
    try:
        while not (folder / "_parts.csv").exists() or (folder / "_parts.csv").read_bytes().count(b"\n") < 5:
            assert running.poll() is None
            time.sleep(0.01)
        running.send_signal(signal.SIGKILL)
        running.wait()
        noted = (folder / "_parts.csv").read_text().splitlines()
        stamps = {file: (folder / file).stat().st_mtime_ns for file in (line.split(",")[3] for line in noted)}
        assert 5 <= len(noted) < 64
        how = {"belt": np.linspace(0.05, 0.3, 64), "until": 100, "rtol": 1e-11}
        s = slip.sweep(**how, resume=folder, jobs=1)
    finally:
        try:
            os.killpg(running.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    same_tables(slip.sweep(**how), s)
    assert stamps == {file: (folder / file).stat().st_mtime_ns for file in stamps}


def refused(call, words, folder):
    before = content(folder)
    with pytest.raises(saltus.ModelError, match=words) as error:
        call()
    assert content(folder) == before and str(error.value).count("\n") <= 1


def test_folders_that_do_not_fit(slip, tmp_path):
    folder = tmp_path / "runs"
    how = {"belt": BELTS, "until": 1, "resume": folder}
    s = slip.sweep(**how)
    refused(lambda: slip.sweep(**{**how, "until": 2}), "a folder of another sweep, of 40 runs.*\n  name another folder", folder)
    refused(lambda: slip.sweep(**{**how, "belt": BELTS[:5]}), "a folder of another sweep", folder)
    refused(lambda: slip.sweep(**how, set={"q": 1}), "a folder of another sweep", folder)
    refused(lambda: saltus.catalogue("thermostat").sweep(until=[1, 2], resume=folder), "a folder of another sweep", folder)
    statement = folder / "_sweep.txt"
    text = statement.read_text()
    statement.write_text(text.replace(f"version {saltus.__version__}", "version 0.0.1"))
    refused(lambda: slip.sweep(**how), f"begun with version 0.0.1 of saltus, this is {re.escape(saltus.__version__)}", folder)
    statement.write_text("what\n")
    refused(lambda: slip.sweep(**how), "_sweep.txt is no statement of a sweep", folder)
    statement.write_text(text)
    part = next(folder.glob("runs-*"))
    data = part.read_bytes()
    part.write_bytes(data[:100])
    refused(lambda: slip.sweep(**how), rf"{part.name} has 100 bytes, expected {len(data)}: rows of the runs \d+ to \d+ are lost", folder)
    part.write_bytes(data)
    same_tables(s, slip.sweep(**how))
    other = tmp_path / "other"
    other.mkdir()
    (other / "thesis.txt").write_text("mine")
    refused(lambda: slip.sweep(**{**how, "resume": other}), "there are other files, and no sweep", other)


def test_half_written_lines_and_files_are_made_again(slip, tmp_path):
    folder = tmp_path / "runs"
    how = {"belt": BELTS, "until": 1, "resume": folder}
    s = slip.sweep(**how)
    journal = folder / "_parts.csv"
    lines = journal.read_bytes()
    journal.write_bytes(lines[:-7])
    left = folder / ".part-1-runs-01-01.npz"
    left.write_bytes(b"half")
    same_tables(s, slip.sweep(**how))
    assert journal.read_bytes() == lines and not left.exists()


def test_names_that_are_no_folders(slip, tmp_path):
    with pytest.raises(TypeError, match="resume=5: expected the name of a folder"):
        slip.sweep(belt=BELTS, until=1, resume=5)
    (tmp_path / "file").write_text("mine")
    for name, words in (("file", "there are other files"), ("file/runs", "the folder cannot be made: Not a directory")):
        with pytest.raises(saltus.ModelError, match=words):
            slip.sweep(belt=BELTS, until=1, resume=tmp_path / name)
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.parametrize("executor", [None, functools.partial(concurrent.futures.ThreadPoolExecutor, 1)])
def test_who_stops_a_sweep_goes_on_with_it(slip, tmp_path, executor):
    folder, how = tmp_path / "runs", {"belt": BELTS, "until": 150, "rtol": 1e-11, "jobs": 1}
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    stopping = threading.Thread(target=stop_after, args=(folder / "_parts.csv", 3))
    stopping.start()
    with pytest.raises(KeyboardInterrupt) as stopped:
        slip.sweep(**how, resume=folder, executor=executor)
    stopping.join()
    signal.signal(signal.SIGINT, before)
    kept = stopped.value.result
    runs = kept["run"].tolist()  # the run that the stop met is not among them, while a worker may have ended the next
    assert 3 <= len(kept) < 40 and not kept.done and runs == sorted(set(runs)) and set(runs) <= set(range(1, 41))
    assert set(kept["status"]) == {"completed"}
    same_tables(slip.sweep(**how), slip.sweep(**how, resume=folder))


def stop_after(journal, lines):
    while not journal.exists() or journal.read_bytes().count(b"\n") < lines:
        time.sleep(0.005)
    os.kill(os.getpid(), signal.SIGINT)


def test_one_process_fills_a_folder(slip, tmp_path):
    pytest.importorskip("fcntl")
    folder = tmp_path / "runs"
    how = {"belt": BELTS, "until": 1}
    slip.sweep(**how, resume=folder)
    command = "import fcntl, sys, time\nf = open(sys.argv[1], 'a')\nfcntl.lockf(f, fcntl.LOCK_EX)\nprint(1, flush=True)\ntime.sleep(60)"
    other = subprocess.Popen([sys.executable, "-c", command, folder / "_lock"], stdout=subprocess.PIPE)
    other.stdout.readline()
    refused(lambda: slip.sweep(**how, resume=folder), "another sweep fills this folder", folder)
    other.kill()
    other.wait()
    other.stdout.close()
    assert slip.sweep(**how, resume=folder).done


def test_progress_begins_with_what_is_there(slip, tmp_path, capfd, monkeypatch):
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    how = {"belt": BELTS, "until": 1, "resume": tmp_path / "runs", "progress": True}
    slip.sweep(**how)
    assert re.findall(r"(\d+) of 40 runs", capfd.readouterr().err)[-1] == "40"
    remove_parts(tmp_path / "runs", set(range(10)))
    slip.sweep(**how)
    told = [int(number) for number in re.findall(r"(\d+) of 40 runs", capfd.readouterr().err)]
    assert told[0] == 30 and told[-1] == 40 and told == sorted(told)


def run_tool(tool, folder, *arguments, code=0):
    done = subprocess.run([tool, "sweep", *arguments], cwd=folder, capture_output=True, text=True)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


TOOL = ["stick-slip", "--until", "1", "--over", "belt=0.05:0.3:128"]


def test_the_tool_fills_a_folder(tool, tmp_path):
    run_tool(tool, tmp_path, *TOOL, "--out", "whole.csv", "--report", "whole.html")
    assert "128 runs: 128 completed\nruns\n" in run_tool(tool, tmp_path, *TOOL, "--resume", "runs")
    assert sorted(file.name for file in (tmp_path / "runs").glob("share*")) == [f"share-{i:05}.csv" for i in range(1, 65)]
    (tmp_path / "runs" / "share-00002.csv").unlink()
    stamp = (tmp_path / "runs" / "share-00001.csv").stat().st_mtime_ns
    out = run_tool(tool, tmp_path, *TOOL, "--resume", "runs", "--out", "all.csv", "--report", "all.html")
    assert out == "126 of 128 runs are there\n128 runs: 128 completed\nall.csv\n"
    assert (tmp_path / "runs" / "share-00001.csv").stat().st_mtime_ns == stamp
    for suffix in ("csv", "html"):
        assert (tmp_path / f"all.{suffix}").read_bytes() == (tmp_path / f"whole.{suffix}").read_bytes()
    run_tool(tool, tmp_path, "--join", *[str(file) for file in (tmp_path / "runs").glob("share*")], "--out", "joined.csv")
    assert (tmp_path / "joined.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()


def test_tasks_of_the_tool_fill_one_folder(tool, tmp_path):
    for i in (2, 1, 3):
        run_tool(tool, tmp_path, *TOOL, "--resume", "runs", "--task", f"{i}/3", "--quiet")
    run_tool(tool, tmp_path, *TOOL, "--resume", "runs", "--out", "all.csv", "--quiet")
    run_tool(tool, tmp_path, *TOOL, "--out", "whole.csv", "--quiet")
    assert (tmp_path / "all.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
    assert "64 shares, and --task of 65" in run_tool(tool, tmp_path, *TOOL, "--resume", "runs", "--task", "1/65", code=2)
    out = run_tool(tool, tmp_path, *TOOL, "--resume", "runs", "--task", "1/3", "--out", "x.csv", code=2)
    assert "by the same command without --task" in out


def test_folders_that_do_not_fit_the_tool(slip, tool, tmp_path):
    folder = tmp_path / "runs"
    run_tool(tool, tmp_path, *TOOL, "--resume", "runs")
    share = folder / "share-00003.csv"
    text = share.read_text()

    def told(words, *arguments):
        before = content(folder)
        assert words in run_tool(tool, tmp_path, *(arguments or TOOL), "--resume", "runs", code=2)
        assert content(folder) == before

    told("a folder of another sweep, of 128 runs", *TOOL, "--set", "q=1")
    told("a folder of another sweep", *TOOL[:-1], "belt=0.05:0.3:129")
    share.write_text(text[:-40])
    told("share-00003.csv")
    told("remove this file, and these runs are run again")
    share.write_text(text[: text.rfind("\n", 0, -40) + 1])
    told("the table ends with run 5, expected run 6")
    share.write_text(text)
    statement = folder / "_sweep.txt"
    statement.write_text(statement.read_text().replace(f"version {saltus.__version__}", "version 0.0.1"))
    told("begun with version 0.0.1 of Saltus")
    statement.write_text("what\n")
    told("no statement of a sweep")
    with pytest.raises(saltus.ModelError, match="no statement"):
        slip.sweep(belt=BELTS, resume=folder)
    shutil.rmtree(folder)
    slip.sweep(belt=BELTS, until=1, resume=folder)
    told("a sweep of the Python package")
    shutil.rmtree(folder)
    folder.mkdir()
    (folder / "thesis.txt").write_text("mine")
    told("there are other files, and no sweep")


def test_a_kill_of_the_tool_costs_the_share_in_work(tool, tmp_path):
    sweep = ["stick-slip", "--until", "40", "--over", "belt=0.05:0.3:300", "--set", "simulate.rtol=1e-11"]
    running = subprocess.Popen([tool, "sweep", *sweep, "--resume", "runs", "--quiet"], cwd=tmp_path)
    while not (tmp_path / "runs" / "share-00001.csv").exists():
        assert running.poll() is None
        time.sleep(0.005)
    running.send_signal(signal.SIGKILL)
    running.wait()
    assert "of 300 runs are there" in run_tool(tool, tmp_path, *sweep, "--resume", "runs", "--out", "all.csv")
    run_tool(tool, tmp_path, *sweep, "--out", "whole.csv")
    assert (tmp_path / "all.csv").read_bytes() == (tmp_path / "whole.csv").read_bytes()
    assert os.listdir(tmp_path / "runs").count("share-00064.csv") == 1


def test_a_part_that_is_removed_while_it_is_read(slip, tmp_path):
    s = slip.sweep(belt=BELTS[:3], until=1, resume=tmp_path / "runs")
    next((tmp_path / "runs").glob("runs-*")).unlink()
    with pytest.raises(saltus.ModelError, match="is not there any more\n"):
        s["q"]
