"""Results: what was computed, and what becomes of it."""

import json
import pickle
import re
import subprocess

import numpy as np
import pytest

import saltus


@pytest.fixture(scope="module")
def slip():
    return saltus.catalogue("stick-slip").simulate(until=20)


def without_clock(text):
    """A stored result without the time it took, and the call that only the tool has."""
    stored = json.loads(text)
    stored["statistics"].pop("wall_seconds")
    stored.pop("command_line", None)
    stored.pop("date")
    return stored


def test_arrays_are_views_that_cannot_be_written(slip):
    assert slip.x.shape == (len(slip.t), len(slip.states))
    assert np.shares_memory(slip.x, slip.x)
    assert np.shares_memory(slip["v"], slip.x)
    assert np.shares_memory(slip.t, slip.t)
    for array in (slip.t, slip.x, slip.alpha, slip.mode, slip["v"]):
        assert not array.flags.writeable
        with pytest.raises(ValueError):
            array[0] = 1
    t = slip.t
    v = slip["v"]
    first = t[0], v[0], t[-1], v[-1]
    other = saltus.catalogue("stick-slip").simulate(until=1)
    column = other["v"]
    end = other.final["v"]
    del other
    assert column[-1] == end  # the array keeps its result
    assert (t[0], v[0], t[-1], v[-1]) == first


def test_names(slip):
    assert slip["t"].tolist() == slip.t.tolist()
    assert slip["alpha(slip)"].tolist() == slip.alpha[:, 0].tolist()
    assert set(slip["mode(slip)"].tolist()) == {-1, 0}
    with pytest.raises(KeyError, match="alpha"):
        slip["alpha"]


def test_it_is_what_the_tool_writes(source, tool, tmp_path):
    for name in ("stick-slip", "relay-feedback", "bouncing-ball", "two-belts", "quadrants", "quarter-car"):
        subprocess.run([tool, "simulate", name, "--quiet", "--out", "r.json", "--out", "r.csv"], cwd=tmp_path, check=False)
        r = saltus.catalogue(name).simulate()
        r.save(tmp_path / "p.json")
        r.save(tmp_path / "p.csv")
        r.save(tmp_path / "p.npz")
        assert without_clock((tmp_path / "p.json").read_text()) == without_clock((tmp_path / "r.json").read_text())
        assert (tmp_path / "p.csv").read_bytes() == (tmp_path / "r.csv").read_bytes()
        with np.load(tmp_path / "p.npz") as columns:
            assert columns["t"].tolist() == r.t.tolist()
        header, *rows = (tmp_path / "r.csv").read_text().splitlines()
        assert len(rows) == len(r.t)
        assert [float(row.split(",")[0]) for row in rows] == r.t.tolist()


def test_it_prints_what_the_tool_prints(source, tool, tmp_path):
    """Units, labels, events and all; but for the seconds."""
    file = tmp_path / "fall.toml"
    file.write_text(
        '[model]\nname = "fall"\n[states]\nh = { initial = 9, unit = "m", label = "height" }\n[dynamics]\nh = "-1"\n'
        '[[events]]\nname = "low"\nwhen = "h - 8"\n[outputs]\np = { value = "2*h", unit = "W" }\n[simulate]\nuntil = 2\n'
    )
    told = subprocess.run([tool, "simulate", file], cwd=tmp_path, check=True, capture_output=True, text=True).stdout
    r = saltus.Model(file).simulate()
    assert "h = 7 m" in told and "p = 14 W" in told and "\nwhere       h: height\n" in told
    r.save(tmp_path / "r.json")
    for printed in (str(r), str(saltus.load(tmp_path / "r.json"))):
        assert re.sub(r"[\d.e-]+ s\n", "", printed) == re.sub(r"[\d.e-]+ s\n", "", told)


def test_alternatives_say_what_they_are():
    others = saltus.catalogue("part-ways").simulate().events[0].alternatives
    assert [repr(other) for other in others] == [
        f"<alternative: mode {other.mode}, alpha [{', '.join(f'{alpha:.6g}' for alpha in other.alpha)}]>" for other in others
    ]


def test_saved_and_loaded(slip, tmp_path):
    slip.save(tmp_path / "r.json")
    again = saltus.load(tmp_path / "r.json")
    for one in (again, pickle.loads(pickle.dumps(slip))):
        assert one.x.tolist() == slip.x.tolist()
        assert [e.t for e in one.events] == [e.t for e in slip.events]
        assert one.status == slip.status
    with pytest.raises(saltus.ModelError, match="json"):
        slip.save(tmp_path / "r.txt")
    with pytest.raises(saltus.ModelError):
        saltus.load(tmp_path / "none.json")


def test_the_page(slip, tmp_path):
    slip.report(tmp_path / "r.html")
    page = (tmp_path / "r.html").read_text()
    assert page.startswith("<!DOCTYPE html>")
    assert "stick-slip" in page
    assert "<iframe" in slip.report()._repr_html_()
    with pytest.raises(saltus.ModelError):
        slip.report(tmp_path / "no-such-folder" / "r.html")


def test_events(slip):
    assert {e.kind for e in slip.events} >= {"enter_sliding", "leave_sliding"}
    for event in slip.events:
        row = int(np.searchsorted(slip.t, event.t))
        assert slip.x[row] == pytest.approx(event.x, abs=1e-14)
    assert slip.events[0].surfaces == ["slip"]


def test_jumps_have_two_sides():
    r = saltus.catalogue("bouncing-ball").simulate()
    bounce = next(e for e in r.events if e.kind == "jump")
    assert bounce.x.tolist() != bounce.x_after.tolist()
    at = np.flatnonzero(r.t == bounce.t)
    assert r.x[at[0]].tolist() == bounce.x.tolist()
    assert r.x[at[-1]].tolist() == bounce.x_after.tolist()


def test_branches():
    r = saltus.catalogue("stay-or-leave").simulate(branches="all")
    assert r.branches
    assert {branch.final["x"] for branch in r.branches if "x" in branch.states} or r.branches[0].x.shape[0] > 1


def test_a_run_that_stops_early(brake):
    r = brake.simulate(max_steps=3)
    assert r.status == "iteration_limit"
    assert not r.status.done
    assert r.status.time_reached < 6
    with pytest.raises(saltus.Stopped, match="iteration_limit") as stopped:
        r.require()
    assert stopped.value.result is r
    assert brake.simulate().require().status == "completed"


def test_optimal_control(source):
    r = saltus.Model(source / "examples" / "optimize" / "block.toml").optimize(control_intervals=6)
    assert r.status == "completed"
    assert r.final["q"] == pytest.approx(1.0, abs=1e-6)
    assert r.objective == r.optimization["objective"] == pytest.approx(r.t[-1], rel=1e-6)
    assert r.certificate == r.optimization["certificate"] and r.certificate["b_stationary"]
    assert r.verification == r.optimization["verification"] and r.verification["interval_defect"] < 1e-3
    assert r.u.shape == (len(r.t), 1) and r.intervals.u.shape == (6, 1) and r.intervals.ends[-1] == r.t[-1]
    assert r.intervals["u"].tolist() == [row[0] for row in r.optimization["u"]] and list(r.intervals.keys()) == ["u"]
    with pytest.raises(KeyError, match="the optimum has no 'q'; known: u"):
        r.intervals["q"]
    again = saltus.Model(source / "examples" / "optimize" / "block.toml").optimize(start=r, control_intervals=6)
    assert again.optimization["objective"] == pytest.approx(r.optimization["objective"], rel=1e-5)
    simulated = saltus.Model(source / "examples" / "optimize" / "block.toml").optimize(start="simulated", control_intervals=6)
    assert simulated.options["optimize.start"] == "simulated"
    unsolved = saltus.Model(source / "examples" / "optimize" / "block.toml").optimize(control_intervals=6, time_limit=1e-9)
    assert "time_limit, " in repr(unsolved) and " at t = " not in unsolved._repr_html_().partition("<svg")[0]
    with pytest.raises(saltus.Stopped, match="^stopped early: time_limit: stopped before it was solved"):
        unsolved.require()
    with pytest.raises(saltus.ModelError, match="control_interval"):
        saltus.Model(source / "examples" / "optimize" / "block.toml").optimize(control_interval=6)
    with pytest.raises(saltus.ModelError, match="optimize"):
        saltus.catalogue("stick-slip").optimize(control_intervals=3)


def test_methods_compared():
    r = saltus.compare(saltus.catalogue("stick-slip"), until=3)
    assert {run["method"] for run in r.comparison["runs"]} >= {"event", "fesd", "smoothed"}
    study = saltus.order(saltus.catalogue("stick-slip"), until=2, schemes=iter([("radau_iia", 2)]), steps=[20, 40, 80])
    assert study.order["series"]
    with pytest.raises(saltus.ModelError, match="ascending"):
        saltus.order(saltus.catalogue("stick-slip"), until=2, steps=[40, 20])


def test_rows_with_some_of_the_columns():
    model = saltus.catalogue("stick-slip")
    whole = model.simulate(until=20)
    some = model.simulate(until=20, output={"states": ["v*"], "surfaces": []})
    assert some.x.shape == (len(some.t), 1)
    assert some["v"].tolist() == whole["v"].tolist()
    assert some.alpha.shape == some.mode.shape == (len(some.t), 0)
    with pytest.raises(KeyError):
        some["q"]
    assert some.states == whole.states
    assert some.final.x.tolist() == whole.final.x.tolist()
    assert some.events[0].x.tolist() == whole.events[0].x.tolist()
    assert model.simulate(until=20, states="q")["q"].tolist() == whole["q"].tolist()
    with pytest.raises(saltus.ModelError, match="unknown state 'w'"):
        model.simulate(until=1, output={"states": ["w"]})


def test_what_is_no_attribute_is_told_where_it_is():
    ball = saltus.Model.from_text('[model]\nname = "m"\n[states]\nh = 1\n[dynamics]\nh = "-1"')
    r = ball.simulate(until=1)
    with pytest.raises(AttributeError, match=r'h is a column of the result: r\["h"\]'):
        r.h
    with pytest.raises(AttributeError, match="a result has no attribute 'u0'"):
        r.u0


def test_files_of_numbers_are_no_results(slip, tmp_path):
    for name, reader in ("r.csv", "pandas.read_csv"), ("r.npz", "numpy.load"):
        slip.save(tmp_path / name)
        with pytest.raises(saltus.ModelError, match="numbers only") as said:
            saltus.load(tmp_path / name)
        assert reader in said.value.remedy and "r.json" in said.value.remedy


def test_a_stored_result_is_a_model_that_runs_again(slip, tmp_path):
    slip.save(tmp_path / "r.json")
    again = saltus.Model(tmp_path / "r.json")
    assert again.name == "stick-slip" and again.simulate().x.tobytes() == slip.x.tobytes()
    assert again.simulate(set={"belt": 0.3}).parameters == {"belt": 0.3}


#: Of these it is to_dict() that has them: of the file, of pictures, of finite elements.
IN_THE_FILE = set(
    "format saltus record_sha256 model command command_line status trajectory surfaces vector_field drawing elements kept_columns region_groups".split()
)
RENAMED = {"outputs": "output_names"}


@pytest.mark.parametrize("name", ["stick-slip", "slide-and-hide", "falling-rod", "bouncing-ball", "quadrants", "stay-or-leave", "three-windings"])
def test_what_the_file_has_is_an_attribute(name):
    r = saltus.catalogue(name).simulate(branches="all")
    stored = r.to_dict()
    assert [key for key in stored if key not in IN_THE_FILE and not hasattr(r, RENAMED.get(key, key))] == []
    assert [key for key in stored["final"] if not hasattr(r.final, key)] == []
    assert [key for key in stored["trajectory"] if key not in ("regions", "theta") and not hasattr(r, key)] == []
    for event, told in zip(r.events, stored["events"]):
        assert [key for key in told if not hasattr(event, key)] == []
        for other, written in zip(event.alternatives, told["alternatives"]):
            assert [key for key in written if not hasattr(other, key)] == []
        assert (event.intersection is not None) == ("intersection" in told)
        for key, value in told.get("intersection", {}).items():
            assert list(getattr(event.intersection, key) or []) == (value or [])
    for key in ("options", "statistics", "contacts", "penetration", "families"):
        assert getattr(r, key) == stored.get(key, [] if key in ("contacts", "families") else None)
    assert r.contact_modes.tolist() == stored["trajectory"].get("contact_modes", [])
    assert [branch.left_at for branch in r.branches] == [branch["left_at"] for branch in stored.get("branches", [])]


def test_two_results_are_compared_as_the_tool_does(slip, tool, tmp_path):
    m = saltus.catalogue("stick-slip")
    other = m.simulate(until=20, set={"belt": 0.1})
    for name, result in (("a.json", slip), ("b.json", other)):
        result.save(tmp_path / name)
    d = saltus.diff(slip, other)
    assert d and not d.same and d.parameters == [("belt", 0.2, 0.1)] and d.events == (len(slip.events), len(other.events))
    assert [number.what for number in d.end] == ["q", "v"] and d.end[0].a == slip.final["q"] and d.end[0].b == other.final["q"]
    assert d.rows[0].what.startswith("q at t = ") and d.first_event.startswith("event 1: enter_sliding slip: t = ")
    assert repr(d).startswith("<saltus.Difference: different to rtol 1e-06") and "lines more" in repr(d)
    told = subprocess.run([tool, "diff", "a.json", "b.json"], cwd=tmp_path, capture_output=True, text=True)
    assert told.returncode == 1 and told.stdout.rstrip() == str(d)
    assert str(saltus.diff(tmp_path / "a.json", str(tmp_path / "b.json"))) == str(d)
    same = saltus.diff(slip, tmp_path / "a.json", rtol=0, atol=0)
    assert same.same and not same and same.end == same.rows == [] and same.ends == ""
    assert repr(same).startswith("<saltus.Difference: the same to rtol 0, atol 0 (")
    # Runs of sweeps are whole for it.
    assert saltus.diff(m.sweep(belt=[0.1, 0.2], until=20).results[1], slip, rtol=0, atol=0).same


def test_results_that_cannot_be_compared(slip):
    ball = saltus.catalogue("bouncing-ball").simulate(until=1)
    for wrong, told in [
        (lambda: saltus.diff(slip, ball), "different models"),
        (lambda: saltus.diff(slip, 3), "int: expected a result"),
        (lambda: saltus.diff(slip, slip, rtol=-1), "rtol=-1: expected a number that is not negative"),
        (lambda: saltus.diff(slip, slip, atol=float("nan")), "atol=nan"),
        (lambda: slip.report(over=ball), "result 2 is a result of the model 'bouncing-ball'"),
        (lambda: slip.report(over=[3]), "int: expected a result"),
    ]:
        with pytest.raises(saltus.ModelError, match=told):
            wrong()


def test_a_page_with_others_laid_over_it_is_that_of_the_tool(slip, tool, tmp_path):
    other = saltus.catalogue("stick-slip").simulate(until=20, set={"belt": 0.1})
    for name, result in (("a.json", slip), ("b.json", other)):
        result.save(tmp_path / name)
    subprocess.run([tool, "report", "a.json", "b.json", "--out", "tool.html"], cwd=tmp_path, check=True, capture_output=True)
    of_tool = (tmp_path / "tool.html").read_text()
    stored = saltus.load(tmp_path / "a.json")
    for over in ({"b.json": other}, tmp_path / "b.json", [tmp_path / "b.json"]):
        stored.report(tmp_path / "python.html", over=over)
        assert (tmp_path / "python.html").read_text() == of_tool
    assert slip.report(over=[other, other]).html != slip.report(over=other).html != slip.report().html
