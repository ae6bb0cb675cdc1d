#!/usr/bin/env python3
"""Runs per second of a sweep for 1 to 8 workers, what a run costs beside its simulation, and SciPy in joblib on the same study.

    PYTHONPATH=build/release/python python3 benchmarks/sweeps/run.py            writes benchmarks/results/sweeps.md
    python3 benchmarks/sweeps/run.py --runs 40 --workers 1 2 --output /tmp/s.md     shorter

The study: `stick-slip` over so many speeds of the belt to t = 40, rtol 1e-6, atol 1e-8, the state at the end. What is not
installed (loky, joblib, SciPy, dask) is a row that says so: pip install loky joblib scipy distributed.
"""

import argparse
import concurrent.futures
import contextlib
import datetime
import importlib.util
import multiprocessing
import os
import pathlib
import pickle
import platform
import statistics
import sys
import tempfile
import time
import types

import numpy as np

import saltus
from saltus._machines import _shares

HERE = pathlib.Path(__file__).resolve().parent
UNTIL, TOLERANCES = 40.0, {"rtol": 1e-6, "atol": 1e-8}
#: SciPy takes so much longer that it gets every fifth run only: what is compared are runs per second.
EVERY = 5


@contextlib.contextmanager
def processes(workers):
    with concurrent.futures.ProcessPoolExecutor(workers, multiprocessing.get_context("forkserver")) as pool:
        yield pool


@contextlib.contextmanager
def loky_pool(workers):
    import loky

    pool = loky.ProcessPoolExecutor(workers)
    yield pool
    pool.shutdown()


@contextlib.contextmanager
def dask_pool(workers):
    from dask.distributed import Client

    with Client(n_workers=workers, threads_per_worker=1, dashboard_address=None) as client:
        yield client.get_executor()


POOLS = {"concurrent.futures, processes": (processes, None), "loky": (loky_pool, "loky"),
         "dask.distributed": (dask_pool, "distributed")}


def sweep(model, belts, **how):
    return model.sweep(belt=belts, until=UNTIL, **TOLERANCES, **how)


def timed(action, rounds):
    """The median of so many rounds, in seconds, and what the last one gave."""
    seconds = []
    for _ in range(rounds):
        begin = time.perf_counter()
        value = action()
        seconds.append(time.perf_counter() - begin)
    return statistics.median(seconds), value


def scipy_row(belts, workers, rounds):
    """Runs per second, and the table."""
    import joblib

    sys.path.insert(0, str(HERE))
    import scipy_study

    with joblib.Parallel(n_jobs=workers) as parallel:
        def action():
            return parallel(joblib.delayed(scipy_study.run)(belt, UNTIL, **TOLERANCES) for belt in belts)

        parallel(joblib.delayed(abs)(i) for i in range(2 * workers))
        return timed(action, rounds)


def pool_row(model, belts, workers, rounds, make, folder=None):
    with make(workers) as pool:
        list(model.sweep(belt=belts[: 8 * workers], until=0.1, executor=pool).results)  # workers are there
        if folder is None:
            return timed(lambda: sweep(model, belts, executor=pool), rounds)
        seconds, s = timed(lambda: sweep(model, belts, executor=pool, resume=tempfile.mkdtemp(dir=folder) + "/runs"), rounds)
        return seconds, types.SimpleNamespace(table=dict(s.table))  # the folder does not stay


def speeds(belts, counts, rounds, left_out):
    """Rows of (what, runs per second for each number of workers, None where it is not installed), and the tables."""
    model, rows, tables = saltus.catalogue("stick-slip"), [], {}

    def row(name, module, one, runs=len(belts)):
        if any(word in name for word in left_out):
            return
        missing = [m for m in (module or "").split() if importlib.util.find_spec(m) is None]
        cells = []
        for workers in counts:
            if missing:
                cells.append(None)
                continue
            print(name, workers, "workers", flush=True)
            seconds, tables[name] = one(workers)
            cells.append(runs / seconds)
        rows.append((name, cells))

    row("Saltus, threads (`jobs=`)", None, lambda w: timed(lambda: sweep(model, belts, jobs=w), rounds))
    for name, (make, module) in POOLS.items():
        row(f"Saltus, {name}", module, lambda w, make=make: pool_row(model, belts, w, rounds, make))
    with tempfile.TemporaryDirectory() as folder:
        row("Saltus, concurrent.futures into a folder (`resume=`)", None,
            lambda w: pool_row(model, belts, w, rounds, processes, folder))
    few = belts[::EVERY]
    row("SciPy, joblib", "scipy joblib", lambda w: scipy_row(few, w, rounds), len(few))
    return rows, tables


def costs(belts, rounds):
    """Bytes and seconds of sending."""
    model = saltus.catalogue("stick-slip")
    with processes(1) as pool:
        model.sweep(belt=belts[:4], until=0.1, executor=pool)
        one, _ = timed(lambda: model.sweep(belt=[0.2], until=0.1, executor=pool), 5 * rounds)
        alone, _ = timed(lambda: model.sweep(belt=[0.2], until=0.1, jobs=1), 5 * rounds)
        near, kept = timed(lambda: sweep(model, belts, jobs=1), rounds)
        far, _ = timed(lambda: sweep(model, belts, executor=pool), rounds)
    arguments = ([], [], ["belt=" + ",".join(map(repr, belts.tolist()))], False, [], None, 1, "final", False)
    cut, place = _shares.Cutter(arguments, len(belts), 4).cut(1)
    share = pickle.dumps((_shares.share_of, model, cut, 1, place, "stop"))
    rows = sum(np.asarray(column).nbytes for column in kept.table.values()) / len(belts)
    results = len(pickle.dumps(list(kept.results))) / len(belts)
    return {"a share, there": f"{len(share) / 1e3:.1f} kB", "a run, back: its row": f"{rows:.0f} bytes",
            "a run, back: its result (without `resume=`)": f"{results:.0f} bytes",
            "a share, beside its runs": f"{1e3 * max(0.0, one - alone):.1f} ms",
            "a run, beside its simulation": f"{1e6 * max(0.0, far - near) / len(belts):.0f} µs",
            "a run, alone in one thread": f"{1e6 * near / len(belts):.0f} µs"}


def agreement(tables):
    """Whether the tables of Saltus are the same bits, and how far SciPy's is from them."""
    ours = [table for name, table in tables.items() if name.startswith("Saltus")]
    for other in ours[1:]:
        for name in ours[0].table:  # every row of Saltus is of the same runs
            assert ours[0].table[name].tolist() == other.table[name].tolist(), name
    if "SciPy, joblib" not in tables:
        return "SciPy was not there to be compared with."
    q, v, events = map(np.array, zip(*tables["SciPy, joblib"]))
    few = {name: ours[0].table[name][::EVERY] for name in ("q", "v", "events")}
    away = max(np.abs(q - few["q"]).max(), np.abs(v - few["v"]).max())
    other = int(np.count_nonzero(events != few["events"]))
    return f"SciPy's ends are at most {away:.1e} away, and {other} of its {len(events)} runs have another number of events."


def processor():
    """Its name, as /proc/cpuinfo or the system says it."""
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(line.partition(": ")[2] for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def page(arguments, rows, sent, agreed, load):
    counts = arguments.workers
    is_busy = max(load[0], os.getloadavg()[0]) > os.cpu_count()
    busy = " It was busier than it has processors: how rows grow with the workers is not to be seen." if is_busy else ""
    lines = [
        "# Sweeps by several workers", "",
        f"Made by `benchmarks/sweeps/run.py` on {datetime.date.today()}: {processor()}, {os.cpu_count()} processors, "
        f"Python {platform.python_version()}, load {load[0]:.1f} before and {os.getloadavg()[0]:.1f} after it; median of "
        f"{arguments.rounds} rounds. Other work on the machine makes all of it slower: compare the rows, and no absolute figures." + busy, "",
        f"The study: `stick-slip` over {arguments.runs} speeds of the belt to t = {UNTIL:g}, rtol 1e-6, atol 1e-8, the state at "
        "the end. SciPy has its modes, sliding field and restarts hard-coded (`scipy_study.py`), and "
        f"every {EVERY}th of these runs. Workers are started before.", "",
        "Runs per second:", "",
        "| workers | " + " | ".join(map(str, counts)) + " |", "|---|" + "---:|" * len(counts),
        *(f"| {name} | " + " | ".join("not installed" if cell is None else f"{cell:.0f}" for cell in cells) + " |" for name, cells in rows),
        "", f"The tables of all rows of Saltus are bit by bit the same. {agreed}", "",
        "What is sent, and what it costs (one worker, pool of processes):", "", "| | |", "|---|---:|",
        *(f"| {name} | {value} |" for name, value in sent.items()), "",
    ]
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=1000)
    parser.add_argument("--workers", type=int, nargs="+", default=[1, 2, 4, 8])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--leave-out", nargs="+", default=[], help="rows with such a word in their names")
    parser.add_argument("--output", type=pathlib.Path, default=HERE.parent / "results/sweeps.md")
    arguments = parser.parse_args()
    load, belts = os.getloadavg(), np.linspace(0.05, 0.3, arguments.runs)
    rows, tables = speeds(belts, arguments.workers, arguments.rounds, arguments.leave_out)
    arguments.output.write_text(page(arguments, rows, costs(belts, arguments.rounds), agreement(tables), load), encoding="utf-8")
    print(arguments.output)


if __name__ == "__main__":
    main()
