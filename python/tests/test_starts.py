"""Starts of an optimisation by an executor: the result of one process, whoever found which of them."""

import concurrent.futures
import multiprocessing
import os
import signal

import pytest

import saltus

CAR = """
[model]
name = "car with a turbo"
[states]
q = 0
v = 0
[controls]
u = { lower = -1, upper = 1 }
[dynamics]
q = "v"
v = "if(v > 0.8, 3, 1)*u"
[optimize]
control_intervals = 4
horizon = { free = true, initial = 2.5, lower = 0.5, upper = 5 }
minimize_time = true
terminal_constraints = ["q == 1", "v == 0"]
"""


@pytest.fixture(scope="module")
def car():
    return saltus.Model.from_text(CAR, "car.toml")


def pool(workers):
    return concurrent.futures.ProcessPoolExecutor(workers, multiprocessing.get_context("fork"))


def without_times(value):
    if isinstance(value, dict):
        return {key: without_times(one) for key, one in value.items() if not key.endswith("seconds") and key not in ("date", "record_sha256")}
    return [without_times(one) for one in value] if isinstance(value, list) else value


def test_workers_give_what_one_process_gives(car):
    alone = car.optimize(starts=4)
    with pool(2) as workers:
        shared = car.optimize(starts=4, executor=workers)
    assert [row["seed"] for row in shared.optimization["starts"]] == [0, 1, 2, 3]
    assert sum(row["is_taken"] for row in shared.optimization["starts"]) == 1
    assert without_times(shared.to_dict()) == without_times(alone.to_dict())


def test_a_start_of_one_seed_is_that_of_all(car):
    rows = {row["seed"]: row for row in car.optimize(starts=3).optimization["starts"]}
    for seed in (0, 2):
        (row,) = car.optimize(set={"optimize.mpcc.seed": seed}).optimization["starts"]
        assert row["is_taken"] and row["objective"] == rows[seed]["objective"] and row["iterations"] == rows[seed]["iterations"]


def test_a_start_that_ends_its_worker_leaves_the_others(car, monkeypatch):
    optimum = saltus.Model._optimum

    def ending(model, settings, options, *more):
        if ("optimize.mpcc.seed", "1", "seed=1") in options:
            os.kill(os.getpid(), signal.SIGKILL)
        return optimum(model, settings, options, *more)

    monkeypatch.setattr(saltus.Model, "_optimum", ending)  # processes by fork have it, too
    with pool(2) as workers, pytest.raises(saltus.Stopped, match="^the start of seed 1: the worker ended 3 times") as stopped:
        car.optimize(starts=3, executor=workers)
    kept = stopped.value.result
    assert "the best of 2 other starts is in the attribute result" in str(stopped.value)
    assert [row["seed"] for row in kept.optimization["starts"]] == [0, 2] and str(kept.status) == "completed"


def test_what_is_wrong(car):
    with pool(1) as workers:
        with pytest.raises(saltus.ModelError, match="there is one start.*\n.*starts=8"):
            car.optimize(executor=workers)
        with pytest.raises(saltus.ModelError, match="horizonn|did you mean"):
            car.optimize(starts=2, horizonn=3, executor=workers)
    with pytest.raises(TypeError, match="submit"):
        car.optimize(starts=2, executor=4)


def test_starts_go_on_from_a_result(car, tmp_path):
    before = car.optimize()
    before.save(tmp_path / "r.json")
    with pool(2) as workers:
        for start in (before, tmp_path / "r.json"):
            shared = car.optimize(starts=2, start=start, executor=workers)
            assert shared.optimization["objective"] == car.optimize(starts=2, start=start).optimization["objective"]
