"""Data in memory wherever a file may stand, and runs that go on from a result."""

import json
import pickle
import warnings

import numpy as np
import pytest

import saltus

CART = """
[model]
name = "cart"
[states]
x = 0
[controls]
u = 0
[dynamics]
x = "u"
"""
TIMES, VALUES = [0.0, 1.0, 2.5], [1.0, -2.0, 0.5]
END = 1 * 1 - 2 * 1.5 + 0.5 * 0.5


@pytest.fixture
def cart():
    return saltus.Model.from_text(CART, "cart.toml")


def of_every_kind():
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"t": TIMES, "u": VALUES, "other": [9, 9, 9]})
    yield {"u": (TIMES, VALUES)}
    yield {"u": (np.array(TIMES), np.array(VALUES))}
    yield {"u": [TIMES, VALUES]}
    yield {"u": {"t": TIMES, "u": VALUES}}
    yield {"u": {"times": TIMES, "values": VALUES}}
    yield {"u": np.column_stack([TIMES, VALUES])}
    yield {"u": frame}
    yield {"u": frame.set_index("t")}
    yield {"u": pandas.Series(VALUES, index=TIMES)}
    yield frame[["t", "u"]]


@pytest.mark.parametrize("number", range(10))
def test_inputs_are_arrays_dicts_or_frames(cart, number):
    inputs = list(of_every_kind())[number]
    r = cart.simulate(until=3, inputs=inputs)
    assert r.final["x"] == pytest.approx(END, abs=1e-9)
    assert r.at(0.5)["u"][0] == 1 and r.at(2)["u"][0] == -2


def test_a_file_and_an_array_give_the_same_bits(cart, tmp_path):
    file = tmp_path / "u.csv"
    file.write_text("t,u\n" + "".join(f"{t},{u}\n" for t, u in zip(TIMES, VALUES)))
    a = cart.simulate(until=3, inputs={"u": {"file": str(file)}})
    b = cart.simulate(until=3, inputs={"u": (TIMES, VALUES)})
    assert a.x.tobytes() == b.x.tobytes()
    b.save(tmp_path / "r.json")
    again = saltus.Model(tmp_path / "r.json").simulate()  # the stored result knows the samples
    assert again.x.tobytes() == b.x.tobytes()
    assert pickle.loads(pickle.dumps(b))(1.5).tolist() == b(1.5).tolist()


def test_controls_of_a_result_are_an_input(cart):
    before = cart.simulate(until=3, inputs={"u": (TIMES, VALUES)})
    for inputs in ({"u": before}, {"u": {"result": before}}):
        assert cart.simulate(until=3, inputs=inputs).final["x"] == pytest.approx(END, abs=1e-9)


def test_a_sweep_takes_them(cart):
    s = cart.sweep(x=[0, 1], until=3, inputs={"u": (TIMES, VALUES)})
    assert s["x"].tolist() == pytest.approx([END, 1 + END], abs=1e-9)
    assert s.results[1].whole.final["x"] == pytest.approx(1 + END, abs=1e-9)


@pytest.mark.parametrize("inputs, said", [
    ({"u": (TIMES, VALUES[:2])}, "3 times and 2 values"),
    ({"u": (TIMES, [1, np.nan, 2])}, "nan in row 1 of the values"),
    ({"u": ([0, 2, 1], VALUES)}, "the times must ascend, found 1 in row 2 after 2"),
    ({"u": ([0, 1, 1], VALUES)}, "the times must ascend, found 1 in row 2 after 1"),
    ({"u": (TIMES, np.ones((3, 2)))}, r"shape \(3, 2\)"),
    ({"u": (TIMES, ["a", "b", "c"])}, "the values are no numbers"),
    ({"u": ([], [])}, "there are no times"),
    ({"u": np.array([0, 1])}, "an input is no list of values"),
    ({"u": [0, 1, 2]}, "an input is no list of values"),
    ({"u": {"t": TIMES}}, 'expected the keys "t" and "u"'),
    ({"w": (TIMES, VALUES)}, "w"),
    ({"u": {"times": TIMES, "values": VALUES, "kind": "linear"}}, r'a table of the model: \[tables\].*"load\(t\)"'),
    ([1, 2], "expected a dict"),
])
def test_what_is_wrong_with_inputs_is_said(cart, inputs, said):
    with pytest.raises(saltus.ModelError, match=said):
        cart.simulate(until=3, inputs=inputs)


def test_data_that_begin_late_are_told(cart):
    with pytest.warns(saltus.ModelWarning, match=r"input 'u' begin at t = 0.5, the run at t = 0: until then it is 3"):
        r = cart.simulate(until=3, inputs={"u": ([0.5, 1], [3, 4])})
    assert r["u"][0] == 3


def test_a_column_that_is_not_there_is_said(cart):
    pandas = pytest.importorskip("pandas")
    with pytest.raises(saltus.ModelError, match="no column 'u'") as refused:
        cart.simulate(until=3, inputs={"u": pandas.DataFrame({"t": TIMES, "v": VALUES})})
    assert refused.value.remedy == "expected t and u, found t, v"
    with pytest.raises(saltus.ModelError, match="the times are dates"):
        cart.simulate(until=3, inputs={"u": (pandas.date_range("2026-01-01", periods=3), VALUES)})
    with pytest.raises(saltus.ModelError, match=r"times\[1\]=nan"):
        cart.simulate(until=3, times=[1, np.nan, 2])
    with pytest.raises(saltus.ModelError, match="no column 't'"):
        cart.simulate(until=3, inputs={"u": pandas.DataFrame({"when": TIMES, "u": VALUES})})


def test_a_builder_writes_samples_into_its_text():
    b = saltus.Builder("cart")
    x, u = b.state("x", 0), b.control("u")
    b.rate(x, u)
    b.input(u, (TIMES, VALUES))
    assert b.simulate(until=3).final["x"] == pytest.approx(END, abs=1e-9)
    assert saltus.Model.from_text(b.to_toml()).simulate(until=3).final["x"] == pytest.approx(END, abs=1e-9)


def test_files_that_a_text_names_are_in_memory():
    text = CART + '[simulate]\nuntil = 3\ninputs = { u = { file = "u.csv" } }\n'
    for value in (np.column_stack([TIMES, VALUES]), (TIMES, VALUES), {"t": TIMES, "u": VALUES}, "0,1\n1,-2\n2.5,0.5\n"):
        m = saltus.Model.from_text(text, files={"u.csv": value})
        assert m.simulate().final["x"] == pytest.approx(END, abs=1e-9)
        assert pickle.loads(pickle.dumps(m)).simulate().final["x"] == pytest.approx(END, abs=1e-9)
    with pytest.raises(saltus.ModelError, match="nan in row 1, column 1"):
        saltus.Model.from_text(text, files={"u.csv": np.array([[0, 1], [1, np.nan]])})


def test_points_of_a_table_are_an_array_or_a_frame():
    pandas = pytest.importorskip("pandas")
    points = np.array([[0.0, 0.0], [1.0, 2.0], [2.0, 1.0]])
    for given in ((points,), (pandas.DataFrame(points, columns=["s", "height"]),), (points[:, 0], points[:, 1])):
        b = saltus.Builder("m")
        road = b.table("road", *given)
        b.rate(b.state("x", 0), road(saltus.t))
        assert b.simulate(until=1).final["x"] == pytest.approx(1, abs=1e-9)
    with pytest.raises(saltus.ModelError, match="3 columns"):
        saltus.Builder("m").table("road", pandas.DataFrame(np.eye(3)))


def decay(reference, **more):
    b = saltus.Builder("decay")
    k = b.parameter("k", 1.0, lower=0.1, upper=5, free=True)
    x = b.state("x", 2)
    b.rate(x, -k*x)
    b.optimal_control(horizon=2, control_intervals=2, least_squares=[{"of": [x], "reference": reference, **more}])
    return b


def test_measurements_are_in_memory(tmp_path):
    pandas = pytest.importorskip("pandas")
    times = np.array([0.3, 0.9, 1.4, 2.0])
    values = 2*np.exp(-1.7*times)
    file = tmp_path / "data.csv"
    file.write_text("".join(f"{float(t)!r},{float(v)!r}\n" for t, v in zip(times, values)))
    wanted = decay({"file": str(file)}, at="times").optimize()
    assert wanted.optimization["parameters"]["k"] == pytest.approx(1.7, abs=5e-3)
    for reference, more in [((times, values), {}), (values, {"times": times}), (values.reshape(-1, 1), {"times": times}),
                            (pandas.DataFrame({"t": times, "x": values}), {})]:
        found = decay(reference, **more).optimize()
        assert found.optimization["parameters"] == wanted.optimization["parameters"]
    for reference, said in [((times, values[:3]), "4 times and 3 rows"), ((times[::-1], values), "must ascend"),
                            ((times, np.where(times > 1, np.nan, values)), "nan in row 2"),
                            (np.ones((2, 3)), r"shape \(rows, 1\), found \(2, 3\)"),
                            (pandas.DataFrame({"t": times, "y": values}), "no column 'x'")]:
        with pytest.raises(saltus.ModelError, match=said):
            decay(reference)


def test_an_optimum_in_memory_is_a_start_as_its_file_is(tmp_path, block):
    first = block.optimize()
    first.save(tmp_path / "first.json")
    by_file = block.optimize(start=tmp_path / "first.json", control_intervals=8)
    for call in ({"start": first}, {"initial_guess": first}, {"initial_guess": {"result": first}}):
        in_memory = block.optimize(control_intervals=8, **call)
        assert in_memory.x.tobytes() == by_file.x.tobytes()
        assert in_memory.statistics["iterations"] == by_file.statistics["iterations"]
    with pytest.raises(saltus.ModelError, match="expected a result"):
        block.optimize(start=3)


def test_a_run_goes_on_from_a_result(brake, tmp_path):
    whole = brake.simulate(until=6)
    first = brake.simulate(until=1)
    first.save(tmp_path / "first.json")
    for start in (first, tmp_path / "first.json"):
        then = brake.simulate(until=6, start=start)
        assert then.t[0] == 1
        assert then.final.x == pytest.approx(whole.final.x, abs=1e-7)
        assert then.events.t == pytest.approx(whole.events["enter_sliding"].t, abs=1e-7)
    at_rest = brake.simulate(until=3)
    assert at_rest.final.mode == [0]
    then = brake.simulate(until=6, start=at_rest)
    assert then["mode(" + then.switching_functions[0] + ")"].tolist() == [0]*len(then.t)
    assert then.final["x"] == at_rest.final["x"]
    assert brake.simulate(until=6, start=at_rest, set={"mu": 0.01}).final["x"] != at_rest.final["x"]
    with pytest.warns(saltus.ModelWarning, match='computed with mu = 3.*set={"mu": 3.0} keeps them'):
        brake.simulate(until=6, start=brake.simulate(until=1, set={"mu": 3}))
    assert brake.simulate(until=6, start=at_rest, from_=5).t[0] == 5
    with pytest.raises(saltus.ModelError, match="has no state 'x'"):
        brake.simulate(until=6, start=saltus.catalogue("stick-slip").simulate(until=1))
    with pytest.raises(saltus.ModelError, match="expected a result"):
        brake.simulate(until=6, start=[1, 2])


def test_the_end_of_a_run_is_a_setting(brake):
    end = brake.simulate(until=1).final
    assert brake.simulate(until=2, set=end).x[0].tolist() == end.x.tolist()
    s = brake.sweep(mu=[1, 2], set=end, until=2, keep="trajectory")
    assert s.results[0].x[0].tolist() == end.x.tolist()


def test_times_are_exactly_the_rows(brake):
    r = brake.simulate(until=5, output={"times": [1, 2, 3], "events": False})
    assert r.t.tolist() == [1, 2, 3]
    r = brake.simulate(until=5, output={"times": [0, 0.5, 4]})
    assert r.t.tolist() == [0, 0.5, 4]
    assert len(r.events) == 1 and r.final.t == 5 and r.status.time_reached == 5
    assert r.options["simulate.output.events"] is False
    with_events = brake.simulate(until=5, output={"times": [0, 0.5, 4], "events": True})
    assert len(with_events.t) == 6 and with_events.t[-1] == 5  # two of the event, and the end
    for method in ("fesd", "smoothed"):
        assert brake.simulate(until=5, times=[1, 2, 3], method=method).t.tolist() == [1, 2, 3]
    stopped = brake.simulate(until=5, times=[4, 5], max_steps=3)
    assert len(stopped.t) == 1 and not stopped.status.done  # where it stopped
    assert json.loads(json.dumps(r.to_dict()))["trajectory"]["t"] == [0, 0.5, 4]
    assert brake.simulate(until=5, times=[1, 2]).frame().index.tolist() == [1, 2]


DOSES = """
[model]
name = "doses"
[states]
c = 0
doses = 0
[dynamics]
c = "-0.5*c"
doses = 0
[[jumps]]
name = "dose"
when
set = { c = "c + 1", doses = "doses + 1" }
"""


@pytest.mark.parametrize("when", ["every = 0.2", "at = [0.5, 1.0, 1.5]"])
@pytest.mark.parametrize("parts", [(0.5,), (1.0,), (1.2,), (0.7, 1.0), (0.3, 0.5, 1.5)])
def test_a_run_in_parts_has_the_jumps_of_the_whole(when, parts, tmp_path):
    m = saltus.Model.from_text(DOSES.replace("when", when))
    whole = m.simulate(until=2.05)
    r = m.simulate(until=parts[0])
    for until in (*parts[1:], 2.05):
        r.save(tmp_path / "part.json")
        r = m.simulate(until=until, start=tmp_path / "part.json")
    assert r.final["doses"] == whole.final["doses"]
    assert r.final["c"] == pytest.approx(whole.final["c"], rel=1e-9)
    # At another time it is another run.
    assert m.simulate(until=2.05, start=r, from_=0).final["doses"] == 2 * whole.final["doses"]


def test_conditions_at_the_start_of_a_run_that_goes_on():
    counter = saltus.Model.from_text("""
[model]
name = "counter"
[states]
x = 0
n = 0
[dynamics]
x = 0.1
n = 0
[[jumps]]
when = "x > 1"
at_start = true
set = { n = "n + 1" }
""")
    for part in 5, 10, 15:  # as in one run
        assert counter.simulate(until=20, start=counter.simulate(until=part)).final["n"] == 1
    moved = {"start": counter.simulate(until=15), "set": {"x": 4}, "until": 20}
    assert counter.simulate(**moved).final["n"] == 1
    assert counter.simulate(**moved, begun=None).final["n"] == 2


def test_a_hysteresis_that_is_moved_beyond_its_threshold_switches():
    m = saltus.Builder("heating")
    x = m.state("x", 0)
    w = m.hysteresis("w", x, on=2 + 0.01 * saltus.t, off=1 + 0.01 * saltus.t)
    m.rate(x, 0.1 - 0.3 * w)
    heating = m.model()
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of jumps that nobody wrote nothing is said
        r = heating.simulate(until=5)
        assert r.final["w"] == 0
        assert heating.simulate(until=6, start=r, set={"x": 4}).events[0].t == 5
        assert heating.simulate(until=6, start=r, set={"x": 4}).final["x"] == pytest.approx(3.8)
