"""Single runs of a sweep: what they say of what was not kept, and that they can be asked like any other run."""

import concurrent.futures
import json
import pickle
import re
import subprocess

import numpy as np
import pytest

import saltus


@pytest.fixture(scope="module")
def slip():
    return saltus.catalogue("stick-slip")


@pytest.fixture(scope="module")
def alone(slip):
    return slip.simulate(until=5, set={"belt": 0.2})


def sweep(slip, keep="final", **more):
    return slip.sweep(belt=[0.1, 0.2, 5.0], until=5, keep=keep, **more)


def test_events_that_were_not_kept_are_told(slip, alone):
    run = sweep(slip).results[1]
    count = len(alone.events)
    assert count == sweep(slip)["events"][1] == 2
    for text in (repr(run), str(run), run._repr_html_()):
        assert f"not kept; {count} happened" in text
        assert "none" not in text
    with pytest.raises(ValueError, match=f'not kept; {count} happened.*keep="events"'):
        run.events
    assert "not kept; 2 happened" in repr(pickle.loads(pickle.dumps(run)))
    # Where nothing happened, nothing is missing.
    still = sweep(slip).results[2]
    assert list(still.events) == [] and "0 events, rows not kept" in repr(still)


def test_events_that_were_kept(slip, alone):
    run = sweep(slip, "events").results[1]
    assert [e.t for e in run.events] == [e.t for e in alone.events]
    assert "2 events, rows not kept" in repr(run)
    assert repr(sweep(slip, "trajectory").results[1]) == repr(alone)


@pytest.mark.parametrize("keep", ["final", "events", "trajectory"])
def test_spans_and_values_between(slip, alone, keep):
    for s in (sweep(slip, keep), pickle.loads(pickle.dumps(sweep(slip, keep)))):
        assert s.results[1].span == alone.span == (0.0, 5.0)
        assert s.results[1](2.5).tobytes() == alone(2.5).tobytes()
        assert s.results[1].frame(grid=3).equals(alone.frame(grid=3))
    assert sweep(slip, keep, from_=1).results[1].span == (1.0, 5.0)


@pytest.mark.parametrize("again", [lambda s: s, lambda s: pickle.loads(pickle.dumps(s))], ids=["made", "pickled"])
def test_runs_without_an_event_know_their_values(slip, again):
    run = again(sweep(slip, "events")).results[2]
    fast = slip.simulate(until=5, set={"belt": 5.0})
    assert run.span == fast.span and run(2.5).tobytes() == fast(2.5).tobytes()
    assert run.whole.parameters == {"belt": 5.0} and len(run.plot()) == 2
    # Random ones, too.
    ends = slip.sweep(sample={"v": "normal(5, 0.1)"}, runs=4, until=1)
    sampled = again(slip.sweep(sample={"v": "normal(5, 0.1)"}, runs=4, until=1, keep="events", set={"belt": 9}))
    assert [len(r.events) for r in sampled] == [0] * 4
    assert [r(0.0)[1] for r in sampled] == ends["v(0)"].tolist()


def test_shares_of_an_executor_know_the_values_of_runs_without_an_event(slip):
    belts = np.linspace(5, 6, 11)
    with concurrent.futures.ThreadPoolExecutor(2) as executor:
        s = slip.sweep(belt=belts, until=1, keep="events", executor=executor)
    assert [run.whole.parameters["belt"] for run in s.results] == belts.tolist()


def test_results_of_many_runs_are_made_when_they_are_asked_for(slip):
    s = slip.sweep(belt=np.linspace(0.05, 0.3, 2000), until=0.01)
    assert "2000 completed" in repr(s) and s.done and len(s.results) == 2000
    assert not s.results._made
    assert "table" not in vars(s) and len(s["status"]) == 2000 and s.table is s.table
    assert s.results[-1] is s.results[1999] and [r is s.results[i] for i, r in enumerate(s.results[3:5], 3)] == [True] * 2
    with pytest.raises(IndexError):
        s.results[2000]


def test_every_kind_of_setting_is_run_again(slip):
    s = slip.sweep(
        {"v": [-0.1, 0.05]}, sample={"q": "uniform(0, 0.5)"}, runs=2, integrator=["dop853", "radau5"], max_steps=[5, 1000], until=3
    )
    for i, run in enumerate(s.results):
        until = min(0.01, run.status.time_reached)
        values = {"v": s["v(0)"][i], "q": s["q(0)"][i]}
        options = {"integrator": str(s["simulate.event.integrator"][i]), "max_steps": int(s["simulate.max_steps"][i])}
        assert run(until).tobytes() == slip.simulate(until=3, set=values, **options)(until).tobytes()


def test_a_sweep_is_gone_through_run_by_run(slip):
    s = sweep(slip)
    assert [run is kept for run, kept in zip(s, s.results)] == [True] * 3


def test_pictures_tables_and_files_of_a_single_run_have_all_of_it(slip, alone, tmp_path):
    for keep in ("final", "events", "trajectory"):
        run = sweep(slip, keep).results[1]
        assert run.whole.x.tobytes() == alone.x.tobytes() and len(run.whole.events) == 2
        assert run.frame().equals(alone.frame())
        assert run.dataset().equals(alone.dataset())
        assert len(run.plot()[0].lines) == len(alone.plot()[0].lines)
        run.save(tmp_path / "r.json")
        stored = saltus.load(tmp_path / "r.json")
        assert [e.t for e in stored.events] == [e.t for e in alone.events]
        assert stored(2.5).tobytes() == alone(2.5).tobytes()
        assert saltus.Model(tmp_path / "r.json").simulate().x.tobytes() == alone.x.tobytes()
    assert alone.whole is alone


def test_all_states_over_what_was_swept(slip):
    axes = sweep(slip).plot()
    assert [axis.get_ylabel() for axis in axes] == ["q", "v"]
    assert axes[1].lines[0].get_ydata().tolist() == sweep(slip)["v"].tolist()


def test_samples_are_points_over_what_was_stated(slip):
    s = slip.sweep(belt=[0.1, 0.2], sample={"v": "normal(0, 0.1)"}, runs=5, until=2)
    axis = s.plot("q")
    assert axis.get_xlabel() == "belt" and len(axis.lines) == 1
    assert axis.lines[0].get_linewidth() == 0 and len(axis.lines[0].get_xdata()) == 10
    assert s.plot("q", over="v").get_xlabel() == "v(0)"
    assert len(slip.sweep(sample={"v": "normal(0, 0.1)"}, runs=5, until=2).plot("q").lines) == 1


@pytest.mark.parametrize("keep", ["final", "events", "trajectory"])
def test_the_number_of_events_of_every_run_is_a_column(slip, keep):
    s = sweep(slip, keep)
    events_of = dict(zip(s["run"].tolist(), s["events"].tolist()))
    assert events_of == {1: 1, 2: 2, 3: 0}
    assert list(s.frame().groupby("run")["events"].first()) == [1, 2, 0]
    line = s.plot("events").lines[0]
    assert (line.get_xdata().tolist(), line.get_ydata().tolist()) == ([0.1, 0.2, 5.0], [1, 2, 0])


def test_a_run_without_an_event_has_a_row_that_names_none(slip):
    s = sweep(slip, "events")
    assert s["event"].tolist() == [1, 1, 2, 0] and s["belt"].tolist() == [0.1, 0.2, 0.2, 5.0]
    assert s["kind"][-1] == s["name"][-1] == s["surfaces"][-1] == "" and s["status"][-1] == "completed"
    assert np.isnan(s["t"][-1]) and np.isnan(s["v"][-1]) and np.isnan(s["v(after)"][-1])
    assert [len(run.events) for run in s] == [1, 2, 0] and s.results[2].whole.parameters == {"belt": 5.0}
    axis = s.bifurcation("v")
    end = next(line for line in axis.lines if line.get_label() == "at the end, without events")
    assert sum(len(line.get_xdata()) for line in axis.lines if line is not end) == 3
    # Where nothing happens any more the state at the end is drawn.
    assert (end.get_xdata().tolist(), end.get_ydata().tolist()) == ([5.0], [s.results[2].final["v"]])
    assert s["v(end)"][-1] == s.results[2].final["v"] and s["t(end)"].tolist() == [5.0] * 4


def test_counts_are_whole_numbers(slip):
    pytest.importorskip("pandas")
    for keep, names in (("final", ["run", "events"]), ("events", ["run", "events", "event"]), ("trajectory", ["run", "events", "mode(slip)"])):
        s = sweep(slip, keep)
        for name in names:
            assert s[name].dtype == np.int64
            assert s.frame()[name].dtype == np.int64
        assert s["belt"].dtype == np.float64
    assert sweep(slip).dataset()["events"].dtype == np.int64


def test_states_called_like_columns_of_the_table():
    model = saltus.Builder("m")
    run, status = model.state("run", 1.0), model.state("status", 2.0)
    model.rate(run, -run)
    model.rate(status, 0)
    swept = model.model().sweep(over={"run": [1.0, 2.0]}, until=1.0)
    frame = swept.frame()
    assert list(frame["run"]) == [0, 1] or list(frame["run"]) == [1, 2]
    assert list(frame["status"]) == ["completed", "completed"]
    assert frame["status (model)"].tolist() == [2.0, 2.0]


def test_trajectories_beyond_the_memory_are_refused():
    m = saltus.catalogue("stick-slip")
    # Before the first run, where the number of rows is asked for: that run would take minutes.
    with pytest.raises(ValueError, match="all 2000 runs need 48 GB or more; 4 GB are possible\n  keep events") as told:
        m.sweep(belt=range(2000), keep="trajectory", points=1_000_000, until=1e9, max_steps=10**9, max_events=10**9, jobs=1)
    assert "in run" not in str(told.value)
    # Else behind it.
    with pytest.raises(ValueError, match="all 2000000 runs need .* GB or more") as told:
        m.sweep(belt=range(2_000_000), keep="trajectory", output="steps", until=200, jobs=1)
    assert "in run" not in str(told.value)


@pytest.fixture(scope="module")
def failing():
    return saltus.Model.from_text(
        '[model]\nname = "z"\n[parameters]\na = 1\n[states]\nx = 1\n[dynamics]\nx = "sqrt(a - x)*x"\n'
    )


def test_runs_that_stopped_early_are_gaps_with_crosses(failing):
    s = failing.sweep(a=[0, 2, 0.5, 3], until=0.1)
    done = s["status"] == "completed"
    assert done.tolist() == [False, True, False, True]
    axis = s.plot("x")
    line, crosses = axis.lines
    assert line.get_xdata().tolist() == [0, 0.5, 2, 3] and np.isnan(line.get_ydata()).tolist() == [True, True, False, False]
    assert crosses.get_xdata().tolist() == [0, 0.5] and crosses.get_marker() == "x"
    assert [text.get_text() for text in axis.get_legend().get_texts()] == ["stopped early"]
    # What lies at the foot has no value that the axis must reach.
    assert axis.get_ylim()[0] > 1
    assert len(failing.sweep(a=[2, 3], until=0.1).plot("x").lines) == 1


@pytest.mark.parametrize("keep", ["final", "events", "trajectory"])
def test_tables_are_written_as_the_tool_writes_them(slip, tool, tmp_path, keep):
    belts = [0.1, 0.2, 1e-7, 5]
    s = slip.sweep(belt=belts, integrator=["dopri5"], until=5, keep=keep)
    over = ["--over", "belt=" + ",".join(map(str, belts)), "--over", "simulate.event.integrator=dopri5"]
    subprocess.run([tool, "sweep", "stick-slip", *over, "--until", "5", "--keep", keep, "--out", "t.csv"],
                   cwd=tmp_path, check=True, capture_output=True)
    s.save(tmp_path / "s.csv")
    assert (tmp_path / "s.csv").read_bytes() == (tmp_path / "t.csv").read_bytes()
    s.save(tmp_path / "s.npz")
    with np.load(tmp_path / "s.npz") as stored:
        assert list(stored) == list(s.table)
        for name, column in s.table.items():
            assert stored[name].tolist() == column.tolist() or np.isnan(column.astype(float)).any()
    with pytest.raises(saltus.ModelError, match=r"must end in \.csv or \.npz"):
        s.save(tmp_path / "s.json")


def test_the_page_of_a_sweep_is_that_of_the_tool(slip, tool, tmp_path):
    over = ["--over", "belt=0.1,0.2", "--over", "simulate.event.integrator=dopri5,dop853"]
    subprocess.run([tool, "sweep", "stick-slip", *over, "--until", "5", "--report", "t.html"],
                   cwd=tmp_path, check=True, capture_output=True)
    slip.sweep(belt=[0.1, 0.2], integrator=["dopri5", "dop853"], until=5).report(tmp_path / "s.html")
    pages = [(tmp_path / name).read_text() for name in ("s.html", "t.html")]
    commands = [json.loads(re.search(r'id="sweep">(.*)</script>', page).group(1))["command"] for page in pages]
    assert commands[0].startswith("saltus simulate ") and commands[0].endswith("stick-slip.toml --set=simulate.until=5")
    same = [page.replace(json.dumps(command), "") for page, command in zip(pages, commands)]
    assert same[0] == same[1]
