"""Values between the rows of a result: r(t), r.at, r.frame(grid=…)."""

import pickle

import numpy as np
import pytest

import saltus

JUMPS = """
[model]
name = "jumps"
[states]
x = 0
[dynamics]
x = "1"
[[jumps]]
when = "x - 1"
direction = "up"
set = { x = "0.25" }
[simulate]
until = 1.5
"""


@pytest.fixture(scope="module")
def jumps():
    return saltus.Model.from_text(JUMPS).simulate()


def test_values_are_those_of_rows_at_these_times(jumps):
    assert jumps(0.3) == pytest.approx([0.3], abs=1e-14)
    slip = saltus.catalogue("stick-slip")
    times = [0.1, 3.3, 7.7]
    r, rows = slip.simulate(until=10), slip.simulate(until=10, times=times)
    at = r(times)
    for t, x in zip(times, at):
        assert x.tobytes() == rows.x[int(rows.t.searchsorted(t))].tobytes()
    assert r([7.7, 0.1]).tobytes() == at[[2, 0]].tobytes()


def test_sides_of_an_event(jumps):
    t = jumps.events[0].t
    assert jumps(t, side="left") == pytest.approx([1], abs=1e-12)
    assert jumps(t) == pytest.approx([0.25], abs=1e-12)
    with pytest.raises(ValueError, match="left"):
        jumps(t, side="before")


@pytest.mark.parametrize("t", [-0.1, 1.6, float("nan")])
def test_times_outside_are_told_the_span(jumps, t):
    with pytest.raises(ValueError, match="from 0 to 1.5"):
        jumps([1.0, t])


def test_a_run_that_stops_early_ends_there():
    r = saltus.catalogue("stick-slip").simulate(until=10, max_steps=20)
    assert r(r.status.time_reached).tobytes() == r.final.x.tobytes()
    with pytest.raises(ValueError, match="outside"):
        r(9.9)


def test_frames_on_a_grid(jumps):
    pytest.importorskip("pandas")
    frame = jumps.frame(grid=4)
    assert list(frame.index) == [0, 0.5, 1.0, 1.5]
    assert list(jumps.frame(grid=[0.2, 0.4])["x"]) == pytest.approx([0.2, 0.4])


def test_data_sets_on_a_grid(jumps):
    pytest.importorskip("xarray")
    data = jumps.dataset(grid=4)
    assert data["x"].dims == ("t",) and data["t"].values.tolist() == [0, 0.5, 1.0, 1.5]
    assert data["x"].sel(t=0.5).item() == jumps(0.5)[0]
    with pytest.raises(ValueError, match="grid=1"):
        jumps.dataset(grid=1)


def test_values_say_that_they_are_no_run(jumps):
    values = jumps.at([0.5, 1.0])
    for text in (repr(values), str(values), repr(pickle.loads(pickle.dumps(values)))):
        assert "values at 2 times" in text and "events" not in text


def test_results_from_elsewhere(jumps, tmp_path):
    assert pickle.loads(pickle.dumps(jumps))(0.3) == jumps(0.3)
    jumps.save(tmp_path / "r.json")
    assert saltus.load(tmp_path / "r.json")(0.3) == jumps(0.3)
    with pytest.raises(ValueError, match="rows only"):
        saltus.catalogue("stick-slip").compare(until=1)(0.3)
