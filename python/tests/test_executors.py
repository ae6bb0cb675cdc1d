"""Sweeps and starts by executors: workers that end, cannot begin, or are others than they should be."""

import concurrent.futures
import functools
import multiprocessing
import os
import pathlib
import signal
import sys
import threading
import time

import numpy as np
import pytest

import saltus
from saltus._machines import _shares, _tasks

BELTS = np.linspace(0.05, 0.3, 40)


@pytest.fixture(scope="module")
def slip():
    return saltus.catalogue("stick-slip")


def pool(workers, initializer=None, *arguments):
    context = multiprocessing.get_context("fork")
    return concurrent.futures.ProcessPoolExecutor(workers, context, initializer, arguments)


def end_once(marker, after):
    """One worker of all that ever begin ends itself a little later."""
    try:
        os.close(os.open(marker, os.O_CREAT | os.O_EXCL))
    except FileExistsError:
        return
    threading.Timer(after, os.kill, (os.getpid(), signal.SIGKILL)).start()


def forget_the_package():
    for name in [name for name in sys.modules if name.partition(".")[0] == "saltus"]:
        sys.modules[name] = None


def pretend_to_be_old():
    saltus.__version__ = "0.0.1"


def ends_its_worker_at(bad, number):
    if number == bad:
        os.kill(os.getpid(), signal.SIGKILL)
    return number * number


def ends_its_worker_twice(folder, number):
    if number == 2:
        tries = pathlib.Path(folder, "tries")
        with open(tries, "a") as file:
            file.write("x")
        if len(tries.read_text()) < 3:
            os.kill(os.getpid(), signal.SIGKILL)
    return number


def same_tables(a, b):
    assert list(a.table) == list(b.table)
    for name, column in a.table.items():
        assert np.asarray(column).tobytes() == np.asarray(b[name]).tobytes(), name


def test_a_worker_that_is_killed_costs_its_share_only(slip, tmp_path):
    seen = []
    with pool(2, end_once, str(tmp_path / "ended"), 0.05) as workers:
        s = slip.sweep(belt=BELTS, until=200, executor=workers)
        with pytest.raises(concurrent.futures.BrokenExecutor):
            workers.submit(int).result()  # it is the pool that was given that broke
        assert slip.sweep(belt=BELTS[:3], until=1, executor=workers).done  # and another one takes its place again
    same_tables(slip.sweep(belt=BELTS, until=200), s)
    assert (tmp_path / "ended").exists() and not seen


def test_a_task_that_ends_every_worker_is_named_and_the_others_are_done():
    with pool(2) as workers:
        tasks = [_tasks.Task((3, i), f"runs {i} to {i}") for i in range(8)]
        found = {}
        with pytest.raises(saltus.Stopped, match=r"^runs 3 to 3: the worker ended 3 times \(.*\)$") as stopped:
            for i, value in _tasks.Tasks(_tasks.Workers(workers), ends_its_worker_at, tasks):
                found[i] = value
    assert found == {i: i * i for i in range(8) if i != 3}
    assert "\n" not in str(stopped.value) and stopped.value.__cause__ is None


def test_a_task_is_begun_three_times(tmp_path):
    with pool(2) as workers:
        tasks = [_tasks.Task((str(tmp_path), i), f"{i}") for i in range(5)]
        assert sorted(_tasks.Tasks(_tasks.Workers(workers), ends_its_worker_twice, tasks)) == [(i, i) for i in range(5)]
    assert (tmp_path / "tries").read_text() == "xxx"


def end_soon():
    threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGKILL)).start()


def test_workers_that_end_whatever_they_do_are_given_up(slip):
    begin = time.perf_counter()
    with pool(1, end_soon) as workers:
        with pytest.raises(saltus.Stopped, match=r"^the workers of ProcessPoolExecutor end, whatever they have to do \(.*; 0 of 400 runs"):
            slip.sweep(belt=np.linspace(0.05, 0.3, 400), until=20000, executor=workers)
    assert time.perf_counter() - begin < 60


def test_runs_that_cannot_be_done_leave_the_others(slip, monkeypatch):
    """The sentence names the runs, and the error has all others."""
    monkeypatch.setattr(_shares, "run_share", functools.partial(_ends_in, _shares.run_share, 3))
    with pool(2) as workers, pytest.raises(saltus.Stopped, match=r"runs 6 to 7: the worker ended 3 times") as stopped:
        slip.sweep(belt=BELTS, until=2, executor=workers)
    kept = stopped.value.result
    assert "; 38 of 40 runs are in the attribute result of this error" in str(stopped.value)
    assert kept["run"].tolist() == [*range(1, 6), *range(8, 41)] and kept.done
    assert kept["q"].tolist() == [r.final["q"] for r in kept.results]


def _ends_in(run_share, number, model, arguments, jobs, share, stop):
    if share[0] == number:
        os.kill(os.getpid(), signal.SIGKILL)
    return run_share(model, arguments, jobs, share, stop)


def test_workers_without_the_package_or_with_another_one(slip):
    with pool(1, forget_the_package) as workers, pytest.raises(saltus.Stopped) as stopped:
        slip.sweep(belt=BELTS, until=2, executor=workers)
    assert str(stopped.value).startswith("the workers of ProcessPoolExecutor have no saltus (") and "\n" not in str(stopped.value)
    assert f"install version {saltus.__version__} where they run; 0 of 40 runs" in str(stopped.value)
    with pool(1, pretend_to_be_old) as workers, pytest.raises(saltus.Stopped, match=r"have version 0\.0\.1 of saltus, this process"):
        slip.sweep(belt=BELTS, until=2, executor=workers)


class Closing(concurrent.futures.ThreadPoolExecutor):
    """Closes itself after so many tasks."""

    left = 4

    def submit(self, *arguments):
        if self.left == 0:
            self.shutdown()
        self.left -= 1
        return super().submit(*arguments)


def test_an_executor_that_is_shut_down(slip):
    workers = concurrent.futures.ThreadPoolExecutor(1)
    workers.shutdown()
    with pytest.raises(saltus.Stopped, match="^ThreadPoolExecutor takes no more work: cannot schedule new futures after shutdown; 0 of"):
        slip.sweep(belt=BELTS, until=2, executor=workers)
    with pytest.raises(saltus.Stopped, match="Closing takes no more work") as stopped:
        slip.sweep(belt=BELTS, until=2, executor=Closing(1))
    kept = stopped.value.result
    assert 0 < len(kept) < 40 and kept["run"].tolist() == list(range(1, len(kept) + 1))


def test_a_function_makes_the_executor(slip, tmp_path):
    made = []

    def make():
        made.append(pool(1, end_once, str(tmp_path / "ended"), 0.02))
        return made[-1]

    same_tables(slip.sweep(belt=BELTS, until=200), slip.sweep(belt=BELTS, until=200, executor=make))
    assert len(made) == 2
    with pytest.raises(RuntimeError, match="shutdown"):
        made[-1].submit(int)
    assert slip.sweep(belt=BELTS, until=1, executor=concurrent.futures.ThreadPoolExecutor).done


def test_shares_are_sent_their_own_values_of_long_lists(slip, monkeypatch):
    monkeypatch.setattr(_shares, "_LONG", 100)
    how = {"belt": BELTS, "q": 0.1 * BELTS, "until": 5, "zip": True, "keep": "events"}
    alone = slip.sweep(**how)
    with concurrent.futures.ThreadPoolExecutor(2) as workers:
        s = slip.sweep(**how, executor=workers)
    same_tables(alone, s)
    assert [e.t for e in s.results[33].whole.events] == [e.t for e in alone.results[33].events]
    whole = ([], [], ["belt=" + ",".join(map(str, BELTS))], False, [], None, 1, "final", False)
    cut, place = _shares.Cutter(whole, 40, 8).cut(2)
    assert cut[2] == ["belt=" + ",".join(map(str, BELTS[5:10]))] and place == (1, 1, 5)
    m = saltus.Model.from_text('[model]\nname = "m"\n[parameters]\nm = 1\n[states]\nx = "1/m"\n[dynamics]\nx = "-x"\n')
    with pytest.raises(saltus.ModelError, match="in run 12"), concurrent.futures.ThreadPoolExecutor(2) as workers:
        m.sweep(m=[1.0] * 11 + [0.0] + [1.0] * 40, until=1, executor=workers)


def test_progress_counts_runs(slip):
    told = []
    with concurrent.futures.ThreadPoolExecutor(2) as workers:
        arguments = ([], [("simulate.until", "1", "until=1")], ["belt=0.1:0.2:50"], False, [], None, 1, "final", False)
        _shares.sweep_by(workers, slip, arguments, 1, lambda done, total: told.append((done, total)))
    assert told[-1] == (50, 50) and len(told) == 16 and told == sorted(told)


def test_threads_and_processes_give_one_table(slip):
    alone = slip.sweep(belt=BELTS, until=5)
    for executor in (concurrent.futures.ThreadPoolExecutor(2), pool(2)):
        begin = time.perf_counter()
        with executor:
            same_tables(alone, slip.sweep(belt=BELTS, until=5, executor=executor))
        assert time.perf_counter() - begin < 60
