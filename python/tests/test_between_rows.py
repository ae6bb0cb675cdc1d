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


def test_later_calls_simulate_nothing():
    r = saltus.Model.from_text(JUMPS).simulate()
    first = r(0.3)
    r.__dict__["_again"] = None  # with this it cannot be run
    assert r(0.3).tobytes() == first.tobytes() and r(0.7) == pytest.approx([0.7])


def test_a_run_may_keep_its_polynomials():
    model = saltus.Model.from_text(JUMPS)
    kept = model.simulate(continuous=True)
    kept.__dict__["_again"] = None
    assert kept(0.3).tobytes() == model.simulate()(0.3).tobytes()
    assert kept(kept.events[0].t, side="left") == pytest.approx([1], abs=1e-12)


def test_branches_follow_their_own_choices():
    model = saltus.catalogue("stay-or-leave")
    r, rows = model.simulate(branches="all"), model.simulate(branches="all", points=61)
    assert len(r.branches) == len(rows.branches) > 1
    for branch, asked in zip(r.branches, rows.branches):
        inside = asked.t > asked.t[0]
        assert branch(asked.t[inside]).tobytes() == asked.x[inside].tobytes()
        with pytest.raises(ValueError, match="outside"):
            branch(0.0)


BLOCK = """
[model]
name = "block"
[states]
q = 0
v = 0
[controls]
u = { lower = -5, upper = 5 }
[dynamics]
q = "v"
v = "u"
[optimize]
horizon = 4
control_intervals = 8
running_cost = "u^2"
terminal_constraints = ["q == 10", "v == 0"]
"""


def test_the_end_may_be_rounded():
    r = saltus.Model.from_text('[model]\nname = "a"\n[states]\nx = 1\n[dynamics]\nx = "-x"\n').simulate(until=5.83)
    end = max(5.83 * n / n for n in range(2, 60))
    assert end > 5.83
    assert r(end).tolist() == [r.final["x"]]
    with pytest.raises(ValueError, match="lies outside"):
        r(5.83 + 1e-9)


def test_optima_are_their_collocation_polynomials(tmp_path):
    r = saltus.Model.from_text(BLOCK).optimize().require()
    grid, u = r.optimization["grid"], np.ravel(r.optimization["u"])
    times = np.linspace(*r.span, 41)
    x = np.zeros((41, 2))
    for begin, end, force in zip(grid, grid[1:], u):
        part = np.clip(times, begin, end) - begin
        x[:, 0] += np.where(times > begin, x[:, 1] * part + force * part**2 / 2, 0)
        x[:, 1] += force * part
    assert np.abs(r(times) - x).max() < 1e-8
    left, right = (r.at(grid[3], side).u[0, 0] for side in ("left", "right"))
    assert (left, right) == pytest.approx((u[2], u[3]))
    assert pickle.loads(pickle.dumps(r.at([1.0]))).x.tobytes() == r([1.0]).tobytes()
    r.save(tmp_path / "r.json")
    with pytest.raises(ValueError, match="rows only"):
        saltus.load(tmp_path / "r.json")(1.0)
