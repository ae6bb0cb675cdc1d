"""Sweeps: tables that do not depend on threads, equal to single runs, told what is wrong."""

import json
import os
import re
import signal
import subprocess
import threading
import warnings

import numpy as np
import pytest

import saltus


def run_tool(tool, folder, *arguments, code=0):
    done = subprocess.run([tool, "sweep", *arguments], cwd=folder, capture_output=True, text=True)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout + done.stderr


def page_data(page):
    return json.loads(re.search(r'id="sweep">(.*)</script>', page).group(1))


@pytest.fixture(scope="module")
def slip():
    return saltus.catalogue("stick-slip")


def test_every_run_is_the_run_alone(slip):
    s = slip.sweep({"v": [-0.1, 0.0]}, belt=[0.1, 0.2, 0.3], until=5, keep="trajectory", jobs=2)
    assert s.names == ["v", "belt"]
    assert s["v(0)"][0] == -0.1
    i = 0
    for v in (-0.1, 0.0):
        for belt in (0.1, 0.2, 0.3):
            alone = saltus.catalogue("stick-slip").simulate(until=5, set={"v": v, "belt": belt})
            assert s.results[i].x.tobytes() == alone.x.tobytes()
            assert [e.t for e in s.results[i].events] == [e.t for e in alone.events]
            assert s.results[i].to_dict()["statistics"]["rhs_evaluations"] == alone.to_dict()["statistics"]["rhs_evaluations"]
            i += 1


@pytest.mark.parametrize("name", ["bouncing-ball", "relay-feedback", "two-belts", "quarter-car", "super-twisting", "thermostat"])
def test_kernels_that_are_used_again_give_the_same_bits(name):
    """Parameters change in a kernel that has run before; a fresh model compiles its own."""
    used = saltus.catalogue(name)
    parameters = used.simulate(max_steps=5).parameters
    values = [{}, *({parameter: value * 1.0625} for parameter, value in parameters.items()), {}]
    for setting in values:
        try:
            fresh = saltus.catalogue(name).simulate(set=setting, max_steps=400)
        except saltus.ModelError:
            continue
        again = used.simulate(set=setting, max_steps=400)
        assert again.x.tobytes() == fresh.x.tobytes(), setting
        assert str(again.status) == str(fresh.status)
        assert again.to_dict()["statistics"]["rhs_evaluations"] == fresh.to_dict()["statistics"]["rhs_evaluations"]


def test_the_table_does_not_depend_on_threads(tool, tmp_path):
    arguments = ["stick-slip", "--until", "4", "--over", "belt=0.05:0.3:20", "--sample", "v=normal(0,0.1)",
                 "--sample", "q=uniform(-1,1)", "--runs", "10", "--seed", "7"]
    for keep in ("final", "events", "trajectory"):
        for jobs in ("1", "3"):
            run_tool(tool, tmp_path, *arguments, "--keep", keep, "--jobs", jobs, "--out", f"{jobs}.csv", "--quiet")
        assert (tmp_path / "1.csv").read_bytes() == (tmp_path / "3.csv").read_bytes()
    run_tool(tool, tmp_path, *arguments, "--out", "a.csv")
    header, *rows = (tmp_path / "a.csv").read_text().splitlines()
    assert header == "run,belt,v(0),q(0),status,unique,t,q,v,events"
    cells = [row.split(",") for row in rows]
    belts = list(dict.fromkeys(float(row[1]) for row in cells))
    assert belts == pytest.approx(np.linspace(0.05, 0.3, 20), rel=1e-15)
    table = saltus.catalogue("stick-slip").sweep(
        {"belt": belts}, until=4, sample={"v": "normal(0,0.1)", "q": "uniform(-1,1)"}, runs=10, seed=7
    )
    assert len(rows) == len(table) == 200
    assert [float(row[7]) for row in cells] == table["q"].tolist()
    samples = np.array([float(row[3]) for row in cells])
    assert samples.min() >= -1 and samples.max() <= 1 and len(set(samples)) == 200
    other = run_tool(tool, tmp_path, *arguments[:-1], "8", "--out", "b.csv")
    assert "200 completed" in other
    assert (tmp_path / "b.csv").read_bytes() != (tmp_path / "a.csv").read_bytes()


def test_pairs_and_archives(tool, tmp_path):
    out = run_tool(tool, tmp_path, "stick-slip", "--until", "3", "--over", "belt=0.1,0.2,0.3", "--over", "v=0:0.2:3",
                   "--zip", "--out", "s.npz")
    assert "3 completed" in out
    table = np.load(tmp_path / "s.npz")
    assert table["belt"].tolist() == [0.1, 0.2, 0.3]
    assert table["v(0)"].tolist() == [0.0, 0.1, 0.2]
    assert table["status"].tolist() == ["completed"] * 3
    run_tool(tool, tmp_path, "stick-slip", "--over", "simulate.event.integrator=dopri5,dop853", "--until", "3", "--out", "i.csv")
    assert (tmp_path / "i.csv").read_text().splitlines()[1].startswith("1,dopri5,completed,1,3,")


def test_a_run_that_stops_early_is_a_row(tool, tmp_path):
    out = run_tool(tool, tmp_path, "stick-slip", "--over", "simulate.max_steps=5,100000", "--until", "3", "--out", "s.csv", code=3)
    assert "1 of 2 runs stopped early; run 1: iteration_limit" in out
    rows = [row.split(",") for row in (tmp_path / "s.csv").read_text().splitlines()]
    assert [row[2] for row in rows] == ["status", "iteration_limit", "completed"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--over", "bellt=1,2"], "--over bellt=1: error: expected the name"),
        (["--over", "bellt=1,2"], "  in --over bellt\n  in run 1\n  did you mean 'belt'"),
        (["--over", "simulate.rtoll=1,2"], "--over simulate.rtoll"),
        (["--sample", "w=normal(0,0.1)", "--runs", "5"], "in --sample w\n"),
        (["--over", "belt=1,2", "--set", "bellt=1"], "in --set bellt\n"),
        (["--over", "belt=1:2:0"], "empty range"),
        (["--over", "belt=1:2:1"], "empty range"),
        (["--over", "belt=1:2"], "FROM:TO:NUMBER"),
        (["--over", "belt=1,,2"], "empty value"),
        (["--over", "v=normal(0,1)"], 'expected values, found a distribution\n  --sample "v=normal(0,1)" --runs 100'),
        (["--over", "v(0)=1,2"], "did you mean 'v'"),
        (["--over", "belt"], "NAME="),
        ([], "nothing is changed"),
        (["--sample", "v=normal(0,0.1)"], "--runs"),
        (["--over", "belt=1,2", "--runs", "5"], "nothing is sampled"),
        (["--sample", "v=normal(0,0.1)", "--runs", "0"], "at least 1 run"),
        (["--sample", "v=normal(0,-1)", "--runs", "5"], "standard deviation"),
        (["--sample", "v=uniform(1,0)", "--runs", "5"], "lower end"),
        (["--sample", "v=norml(0,1)", "--runs", "5"], "did you mean 'normal'"),
        (["--sample", "v=normal(0)", "--runs", "5"], "two numbers"),
        (["--over", "belt=0:1:10000", "--over", "v=0:1:10000"], "--yes"),
        (["--over", "belt=1,2", "--over", "belt=1,2"], "changed twice"),
        (["--over", "belt=1,2", "--over", "v=1,2,3", "--zip"], "--zip"),
        (["--over", "belt=1,2", "--keep", "everything"], "final, events or trajectory"),
        (["--over", "belt=1,2", "--jobs", "-1"], "--jobs -1: expected a number of threads, 1 to 4096"),
        (["--over", "belt=1,2", "--set", "belt=3"], "--set belt=3: 'belt' is changed twice\n"),
        (["--sample", "v=normal(0,0.1)", "--runs", "5", "--seed", "-1"], "--seed -1: expected a number from 0 on"),
        (["--over", "belt=0:1:100000", "--over", "v=0:1:100000", "--yes"], "GB of memory at once"),
        (["--over", "belt=1,2", "--jobs", "0"], "--jobs 0: expected a number of threads, 1 to 4096"),
        (["--over", "belt=1,x"], "in run 2\n"),
    ],
)
def test_what_is_wrong(tool, tmp_path, arguments, words):
    out = run_tool(tool, tmp_path, "stick-slip", "--until", "3", *arguments, "--out", "s.csv", code=2)
    assert words in out
    assert not (tmp_path / "s.csv").exists()


def test_outputs_that_cannot_be(tool, tmp_path):
    for out in ("s.txt", "no-folder/s.csv"):
        run_tool(tool, tmp_path, "stick-slip", "--over", "belt=1,2", "--out", out, code=2)
    assert "--out" in run_tool(tool, tmp_path, "stick-slip", "--over", "belt=1,2", code=2)


def test_in_python(slip):
    with pytest.raises(saltus.ModelError, match="did you mean 'belt'"):
        slip.sweep(bellt=[1, 2])
    with pytest.raises(saltus.ModelError, match="empty list"):
        slip.sweep(belt=[])
    s = slip.sweep(belt=np.linspace(0.1, 0.3, 3), rtol=[1e-6, 1e-8], until=3)
    data = s.dataset()
    assert data["v"].dims == ("belt", "simulate.rtol")
    assert data["v"].shape == (3, 2)
    assert data["v"].sel(belt=0.2, **{"simulate.rtol": 1e-8}).item() == slip.simulate(until=3).final["v"]
    assert len(s.frame()) == 6
    events = slip.sweep(belt=[0.1, 0.2], until=5, keep="events")
    assert len(events["t"]) == sum(len(r.events) for r in events.results)
    with pytest.raises(ValueError, match="final"):
        events.dataset()


class Inline:
    """An executor without processes: what it gets and gives went through pickle."""

    _max_workers = 2

    def submit(self, function, *arguments):
        import concurrent.futures
        import pickle

        future = concurrent.futures.Future()
        function, arguments = pickle.loads(pickle.dumps((function, arguments)))
        try:
            future.set_result(pickle.loads(pickle.dumps(function(*arguments))))
        except Exception as error:
            future.set_exception(pickle.loads(pickle.dumps(error)))
        return future


def test_an_executor_warns_as_threads_do(slip):
    for executor in (None, Inline()):
        with pytest.warns(saltus.ModelWarning, match="epsilon") as told:
            slip.sweep(belt=[0.1, 0.2], until=1, epsilon=0.1, executor=executor)
        assert len(told) == 1 and told[0].filename == __file__


def test_swept_options_are_those_of_the_method_that_is_given(slip):
    s = slip.sweep(stages=[1, 3], method="timestepping", steps=10, until=1)
    assert s.names == ["simulate.timestepping.stages"] and s["q"][0] != s["q"][1]


@pytest.mark.parametrize(
    "how", [{"over": {"belt": [0.1]}}, {"belt": [0.1]}, {"sample": {"belt": "uniform(0, 1)"}, "runs": 2}]
)
def test_what_is_swept_cannot_be_set(slip, how):
    with pytest.raises(saltus.ModelError, match="'belt' is changed twice"):
        slip.sweep(**how, until=1, set={"belt": 0.3})


def test_an_executor_gives_the_same_table(slip):
    how = {"belt": np.linspace(0.1, 0.3, 13), "until": 5, "keep": "events"}
    alone, shared = slip.sweep(**how), slip.sweep(**how, executor=Inline())
    assert list(shared.table) == list(alone.table)
    for name, column in alone.table.items():
        assert shared[name].tolist() == column.tolist()
    assert [e.t for r in shared.results for e in r.events] == [e.t for r in alone.results for e in r.events]
    assert slip.sweep(belt=[0.1, 0.2], until=5, executor=Inline()).dataset()["q"].shape == (2,)


def test_processes_and_their_mistakes(slip):
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    with ProcessPoolExecutor(1, mp_context=get_context("forkserver")) as pool:
        assert slip.sweep(belt=[0.1, 0.2], until=2, executor=pool)["q"].tolist() == slip.sweep(belt=[0.1, 0.2], until=2)["q"].tolist()
    with pytest.raises(saltus.ModelError, match="in run 1"):
        slip.sweep(belt=["what"], nope=[1, 2], until=2, executor=Inline())
    with pytest.raises(TypeError, match="submit"):
        slip.sweep(belt=[0.1], until=2, executor=4)


def shares(tool, folder, number, *arguments):
    for i in range(1, number + 1):
        run_tool(tool, folder, *arguments, "--task", f"{i}/{number}", "--out", f"s{i}.csv", "--quiet")
    return [f"s{i}.csv" for i in range(number, 0, -1)]


@pytest.mark.parametrize("keep", ["final", "events"])
def test_shares_are_the_whole(tool, tmp_path, keep):
    sweep = ["stick-slip", "--until", "4", "--over", "belt=0.05:0.3:7", "--keep", keep]
    files = shares(tool, tmp_path, 3, *sweep)
    for suffix in ("csv", "npz"):
        run_tool(tool, tmp_path, *sweep, "--out", f"whole.{suffix}")
        run_tool(tool, tmp_path, "--join", *files, "--out", f"joined.{suffix}", "--report", "joined.html")
        assert (tmp_path / f"whole.{suffix}").read_bytes() == (tmp_path / f"joined.{suffix}").read_bytes()
    run_tool(tool, tmp_path, *sweep, "--report", "whole.html")
    assert (tmp_path / "whole.html").read_text() == (tmp_path / "joined.html").read_text()


def test_axes_of_the_page_say_labels_and_units(tool, tmp_path):
    (tmp_path / "m.toml").write_text(
        '[model]\nname = "m"\n[parameters]\nF = { initial = 1, unit = "N", label = "force" }\n'
        '[states]\nx = { initial = 1, unit = "m" }\n[dynamics]\nx = "F - x"\n'
        '[outputs]\ny = { value = "2*x", label = "twice, \\"x\\"" }\n')
    sweep = ["m.toml", "--until", "1", "--over", "F=1,2", "--over", "x=1,2"]
    run_tool(tool, tmp_path, *sweep, "--report", "m.html")
    data = page_data((tmp_path / "m.html").read_text())
    assert dict(zip(data["columns"], data["axes"], strict=True)) == {
        "run": "run", "F": "force [N]", "x(0)": "x(0) [m]", "status": "status", "unique": "unique", "t": "t", "x": "x [m]",
        "y": 'twice, "x"', "events": "events"}
    run_tool(tool, tmp_path, "--join", *shares(tool, tmp_path, 2, *sweep), "--report", "joined.html")
    assert (tmp_path / "joined.html").read_text() == (tmp_path / "m.html").read_text()


def test_shares_say_what_the_page_needs(tool, tmp_path):
    """Names with commas and quotes, pairs instead of a grid; older shares say nothing of it."""
    text = '[model]\nname = "a, \\"b\\""\n[parameters]\na = 1\nb = 1\n[states]\nx = "a"\n[dynamics]\nx = "-b*x"\n'
    (tmp_path / "m.toml").write_text(text)
    files = shares(tool, tmp_path, 2, "m.toml", "--until", "1", "--set", "b=2 + 1", "--over", "a=1,2", "--over", "x=1,2", "--zip")
    run_tool(tool, tmp_path, "--join", *files, "--report", "new.html")
    page = (tmp_path / "new.html").read_text()
    data = page_data(page)
    assert "<title>a, &quot;b&quot; - Saltus</title>" in page and data["title"] == 'a, "b"' and data["names"] == ["a", "x"] and not data["grid"]
    assert data["command"] == "saltus simulate m.toml --until 1 --set 'b=2 + 1'"
    for file in files:
        share = (tmp_path / file).read_text()
        heading, rest = re.match(r'"(run \[[^]]*), runs [^]]*\](?:[^"]|"")*"(.*)', share, re.DOTALL).groups()
        (tmp_path / file).write_text(f'"{heading}]"{rest}')
    run_tool(tool, tmp_path, "--join", *files, "--report", "old.html")
    page = (tmp_path / "old.html").read_text()
    assert "<title>Sweep - Saltus</title>" in page and page_data(page)["command"] == "" and "do not say their model" in page


@pytest.mark.parametrize("keep", ["final", "events"])
def test_shares_without_all_their_runs(tool, tmp_path, keep):
    files = shares(tool, tmp_path, 2, "stick-slip", "--until", "4", "--over", "belt=0.05:0.3:6", "--keep", keep)
    lines = (tmp_path / "s1.csv").read_text().splitlines(keepends=True)
    ends = [i for i in range(1, len(lines)) if lines[i].startswith("3,")]
    without_last, without_second = lines[:ends[0]], [line for line in lines if not line.startswith("2,")]
    twice = lines[:2] + lines[1:]
    cases = [(without_last, "ends with run 2, expected run 3"), (without_second, "run 3, expected run 2")]
    for changed, words in cases + ([(twice, "run 1, expected run 2")] if keep == "final" else []):
        (tmp_path / "s1.csv").write_text("".join(changed))
        assert words in run_tool(tool, tmp_path, "--join", *files, "--out", "x.csv", code=2)
    assert not (tmp_path / "x.csv").exists()


def test_shares_that_do_not_fit(tool, tmp_path):
    sweep = ["stick-slip", "--until", "1", "--over", "belt=0.1,0.2"]
    files = shares(tool, tmp_path, 2, *sweep)
    said = run_tool(tool, tmp_path, "--join", files[0], "--out", "x.csv", code=2)
    assert "there is no 1" in said and "--task 1/2" in said
    assert "there already" in run_tool(tool, tmp_path, "--join", *files, files[0], "--out", "x.csv", code=2)
    run_tool(tool, tmp_path, *sweep, "--set", "q=0.3", "--task", "1/2", "--out", "other.csv")
    assert "another sweep" in run_tool(tool, tmp_path, "--join", files[0], "other.csv", "--out", "x.csv", code=2)
    run_tool(tool, tmp_path, *sweep, "--out", "all.csv")
    assert "no share" in run_tool(tool, tmp_path, "--join", "all.csv", "--out", "x.csv", code=2)
    for task in ("3/2", "0/2", "1", "1/2x", "-1/2"):
        assert "expected I/N" in run_tool(tool, tmp_path, *sweep, "--task", task, "--out", "x.csv", code=2)
    assert "2 runs only" in run_tool(tool, tmp_path, *sweep, "--task", "1/3", "--out", "x.csv", code=2)
    assert not (tmp_path / "x.csv").exists()


def test_the_page_of_a_sweep(tool, tmp_path):
    run_tool(tool, tmp_path, "stick-slip", "--until", "2", "--over", "belt=0.1,0.2", "--over", "v=0,0.1", "--report", "p.html")
    page = (tmp_path / "p.html").read_text()
    data = page_data(page)
    assert data["swept"] == ["belt", "v(0)"] and data["names"] == ["belt", "v"] and data["grid"]
    assert data["columns"]["belt"] == [0.1, 0.1, 0.2, 0.2]
    assert data["command"] == "saltus simulate stick-slip --until 2"
    assert not re.search(r"(src|href)=", page)
    assert ".html" in run_tool(tool, tmp_path, "stick-slip", "--over", "belt=1,2", "--report", "p.txt", code=2)


def test_lists_of_any_kind_are_swept(slip):
    assert slip.sweep(belt=range(1, 4), until=1).table["belt"].tolist() == [1, 2, 3]
    with pytest.raises(TypeError, match="expected a dict"):
        slip.simulate(set=[("belt", 1)])


def test_what_is_swept_is_said_once(slip):
    assert slip.sweep(over={"belt": "0.1:0.3:3"}, until=1)["belt"].tolist() == [0.1, 0.2, 0.3]
    assert slip.sweep(over={"rtol": [1e-4, 1e-8]}, until=1).done
    for wrong, told in [
        (dict(over={"belt": [0.1]}, belt=[0.2]), "changed twice"),
        (dict(set={"belt": 0.1}, belt=[0.2]), "changed twice"),
        (dict(over={"belt": 0.3}), "expected a list"),
        (dict(belt=0.3), "not an option"),
        (dict(belt=[0.1], jobs=-1), "whole number"),
        (dict(sample={"v": "normal(3, 0.1)"}, runs=2.5), "whole number"),
        (dict(sample={"v": "normal(3, 0.1)"}), r"runs="),
        (dict(sample={"v": "normal(3, 0.1)"}, runs=20_000_000), r"yes=True"),
    ]:
        with pytest.raises(saltus.ModelError, match=told):
            slip.sweep(until=1, **wrong)


def test_messages_speak_python(slip):
    for call, told, untold in [
        (lambda: slip.simulate(belt=3), r'set={"belt": 3}', "simulate.belt"),
        (lambda: slip.simulate(set={"beltt": 1}), r'set={"beltt"', "--set"),
        (lambda: slip.simulate(set={"belt": float("nan")}), "belt=nan", "--set"),
        (lambda: slip.sweep(beltt=[1, 2], until=1), "'beltt'", "--"),
        (lambda: slip.order(steps=["a"]), "steps=", "--steps"),
    ]:
        with pytest.raises(saltus.ModelError, match=told) as error:
            call()
        assert untold not in str(error.value)


TOGGLE = """
[model]
name = "toggle"
[parameters]
threshold = 1
[states]
x = 0.5
y = 0.5
[switching]
x_high = "x - threshold"
y_high = "y - threshold"
y_low = "1 - y"
[dynamics]
x = "2*step(-y_high) - x"
y = "2*step(-x_high) - y + 0*step(y_low)"
[simulate]
until = 6
"""


@pytest.fixture
def toggle(tmp_path):
    """Two genes that repress each other: from equal values either may win."""
    (tmp_path / "toggle.toml").write_text(TOGGLE)
    return "toggle.toml", "--over", "x=0.4,0.5,0.6"


@pytest.mark.parametrize("keep", ["final", "events", "trajectory"])
def test_runs_whose_solution_is_not_unique_are_told(tool, tmp_path, toggle, keep):
    assert "3 runs: 3 completed; 1 not unique\n" in run_tool(tool, tmp_path, *toggle, "--keep", keep, "--out", "t.npz")
    table = np.load(tmp_path / "t.npz")
    doubted = {1: 1, 2: 0, 3: 1}
    assert dict(zip(table["run"], table["unique"], strict=True)) == doubted
    files = shares(tool, tmp_path, 2, *toggle, "--keep", keep)
    assert "; 1 not unique\n" in run_tool(tool, tmp_path, "--join", *files, "--out", "joined.csv", "--report", "joined.html")
    run_tool(tool, tmp_path, *toggle, "--keep", keep, "--out", "t.csv")
    assert (tmp_path / "t.csv").read_bytes() == (tmp_path / "joined.csv").read_bytes()
    with pytest.warns(saltus.ModelWarning):
        s = saltus.Model(str(tmp_path / "toggle.toml")).sweep(x=[0.4, 0.5, 0.6], keep=keep)
    assert s["unique"].dtype == np.int64 and dict(zip(s["run"], s["unique"], strict=True)) == doubted
    assert "3 completed; 1 not unique>" in repr(s)
    assert s.frame().query("unique == 0")["run"].unique().tolist() == [2]
    if keep == "final":
        assert s.dataset()["unique"].values.tolist() == [1, 0, 1]


def test_runs_that_did_not_begin_have_no_rows():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    endless = saltus.Model.from_text(
        '[model]\nname = "endless"\n[parameters]\na = 1\n[states]\nx = 0\nv = 2\n'
        '[dynamics]\nx = "v"\nv = "-a*x - 0.01*sign(v - cos(3*t))"\n')
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt) as stopped:
        endless.sweep(a=[1, 2], until=1e7, max_steps=10**9, max_events=10**9, jobs=1)
    signal.signal(signal.SIGINT, before)
    assert stopped.value.result["run"].tolist() == [1] and stopped.value.result["status"].tolist() == ["stopped_by_user"]


def test_a_sweep_follows_one_motion(tool, tmp_path, toggle):
    for how in (["--branch", "all"], ["--set", "simulate.event.branches=2"], ["--over", "simulate.event.branches=1,2"]):
        out = run_tool(tool, tmp_path, *toggle, *how, "--out", "t.csv", code=2)
        assert "a sweep takes no --branch" in out and "'unique'" in out
    run_tool(tool, tmp_path, *toggle, "--branch", "report", "--out", "t.csv")
    m = saltus.Model(str(tmp_path / "toggle.toml"))
    with pytest.raises(saltus.ModelError, match="a sweep takes no branches="):
        m.sweep(x=[0.4, 0.5], branches="all")
    with pytest.warns(saltus.ModelWarning):
        whole = m.sweep(x=[0.4, 0.5], branches="all", keep="trajectory")
    assert [len(run.branches) for run in whole.results] == [0, 2]


def test_warnings_of_the_model_are_told_once_with_their_runs(tool, tmp_path, toggle):
    over = ("toggle.toml", "--over", "threshold=0.9,1,1.1,1", "--jobs", "2")
    told = "'y_low' is a negative multiple of 'y_high' under another name (in runs 2, 4)"
    out = run_tool(tool, tmp_path, *over, "--out", "t.csv")
    assert told in out and out.count("warning: ") == 1
    assert "(in run 4)" in run_tool(tool, tmp_path, *over, "--task", "2/2", "--out", "s.csv")
    m = saltus.Model(str(tmp_path / "toggle.toml"))
    for how in ({}, {"executor": Inline()}):
        with pytest.warns(saltus.ModelWarning) as warned:
            m.sweep(threshold=[0.9, 1, 1.1, 1], **how)
        assert len(warned) == 1 and told in str(warned[0].message)


@pytest.mark.parametrize("order", [[1, 2, 3], [3, 2, 1], [2, 1, 3], [2, 3, 1], [1, 1, 2, 2, 1, 3]])
def test_switching_functions_that_coincide_in_some_runs(order):
    """Of a run in which they do both are one; its kernel is not used for a run in which they do not."""
    m = saltus.Model.from_text(
        '[model]\nname = "two"\n[parameters]\na = 1\nb = 1\n[states]\nx = 0\n'
        '[dynamics]\nx = "1 + step(x - a) + step(x - b)"\n[simulate]\nuntil = 3\n')
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", saltus.ModelWarning)
        for jobs in (1, 2):
            s = m.sweep(b=order, jobs=jobs)
            assert s["x"] == pytest.approx([{1: 7, 2: 6.5, 3: 6}[b] for b in order], rel=1e-9)
            assert s["x"].tolist() == [m.simulate(set={"b": b}).final["x"] for b in order]
