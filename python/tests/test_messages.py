"""Messages speak Python: no flags of the tool, no commands, options by their keywords, and what to write instead."""

import math
import warnings

import numpy as np
import pytest

import saltus

OF_THE_TOOL = ["--", "saltus sweep", "saltus simulate", "saltus optimize", "command line", "simulate.r", "simulate.f"]


@pytest.fixture(scope="module")
def slip():
    return saltus.catalogue("stick-slip")


@pytest.fixture(scope="module")
def block(source):
    return saltus.Model(source / "examples" / "optimize" / "block.toml")


def said_by(call, kind=ValueError):
    with pytest.raises(kind) as refused, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        call()
    text = str(refused.value)
    for word in OF_THE_TOOL:
        assert word not in text
    assert "error: " not in text or text.partition(": error: ")[0].rstrip("0123456789:").endswith((".toml", ".json", ">"))
    return text


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"rtoll": 1e-8}, "rtoll=1e-08: unknown option rtoll\n  did you mean 'rtol'?"),
        ({"rtol": -1}, "rtol=-1: expected a finite number > 0"),
        ({"rtol": "small"}, "rtol='small': expected a finite number"),
        ({"until": -5}, "until=-5: until (-5) is not after from (0)"),
        ({"until": [1, 2]}, "until=[1, 2]: expected a finite number"),
        ({"method": "euler"}, 'method=\'euler\': expected "event"'),
        ({"method": "BDF"}, "did you mean the integrator radau5?"),
        ({"engine": "fesd"}, "'engine' is no option\n  write integrator=\"dopri5\", or method=\"fesd\""),
        ({"blet": 0.2}, "'blet' is no option, and no name of the model\n  did you mean set={\"belt\": …}?"),
        ({"method": "fesd", "fesd": {"stage": 2}}, "did you mean 'stages'"),
        ({"method": "fesd", "stages": 20}, "1 to 9 stages, not 20"),
        ({"times": [3, 2]}, "times=[3, 2]"),
        ({"times": [3, 20]}, "output time 20 lies outside the simulation from 0 to 5"),
        ({"points": 5, "every": 1}, "every and points say twice"),
        ({"output": {"points": 5, "every": 1}}, "every and points say twice"),
        ({"output": {"points": 5}, "times": [1, 2]}, "points and times say twice"),
        ({"states": ["w"]}, "unknown state 'w'\n  in states"),
        ({"initial_mode": {"slipp": 0}}, "in initial_mode.slipp\n  did you mean 'slip'?"),
        ({"inputs": 3}, "inputs=3: expected a dict"),
        ({"inputs": {"u": "sin(t)"}}, 'inputs={"u": …}: expected the name of a control'),
        ({"inputs": {"u": [0, 1]}}, 'inputs={"u": …}: an input is no list'),
        ({"inputs": {"u": ([0, 1], [[2], [3, 4]])}}, 'the values are no numbers'),
        ({"t_eval": [0, 1]}, "'t_eval' is no option\n  write times=[…]"),
        ({"x0": [0, 1]}, 'set={"name": value}'),
        ({"belt": 0.1}, 'write set={"belt": 0.1}'),
        ({"set": {"bel": 1}}, 'set={"bel": 1}: expected the name'),
        ({"set": {"integrator": "radau5"}}, "'integrator' is an option, no name of the model"),
        ({"set": {"belt": "1+"}}, 'set={"belt": "1+"}: expected a number, a name'),
        ({"set": {"belt": "foo"}}, 'set={"belt": "foo"}: unknown name \'foo\''),
        ({"set": {"belt": None}}, "belt=None: that is no value"),
        ({"set": {"belt": [1, 2]}}, "m.sweep(belt=[…])"),
        ({"set": {"belt": math.nan}}, "belt=nan"),
        ({"set": {"dynamics.v": "-w"}}, 'set={"dynamics.v": …}: unknown name \'w\''),
        ({"set": {"simulate.rtol": -1}}, "rtol=…: expected a finite number > 0"),
        ({"set": {"": 1}}, "'' is no name"),
        ({"set": {3: 1}}, "3 is no name"),
        ({"set": {"events": [{"when": "q"}]}}, "write [[events]] into the text, saltus.Model.from_text(text), or use saltus.Builder: b.event("),
        ({"jumps": [{"when": "q > 0"}]}, "jumps=[{…}]: a setting changes numbers of a model, it adds no tables"),
    ],
)
def test_options_and_settings(slip, options, told):
    assert told in said_by(lambda: slip.simulate(**{"until": 5, **options}))


def test_settings_by_expressions():
    m = saltus.Builder("decay")
    x, k = m.state("x", 1), m.parameter("k", 1)
    m.rate(x, -k * x)
    assert m.simulate(1, set={k: 0}).final["x"] == 1
    assert m.sweep({k: [0, 1]}, until=1)["k"].tolist() == [0, 1]


@pytest.mark.parametrize(
    ("sweep", "told"),
    [
        ({"bel": [1, 2]}, 'over={"bel": 1}: expected the name'),
        ({"sample": {"w": "normal(0,1)"}, "runs": 2}, 'in sample={"w": …}'),
        ({"belt": [1, 2], "set": {"w": 1}}, 'in set={"w": …}'),
        ({"bel": [1, 2]}, "in over={\"bel\": …}\n  in run 1\n  did you mean 'belt'?"),
        ({"belt": []}, "belt: an empty list"),
        ({}, "m.sweep(mu=np.linspace(0.1, 0.5, 50), until=10)"),
        ({"over": {"belt": "1:2:0"}}, 'over={"belt": "1:2:0"}: an empty range'),
        ({"over": {"belt": "1:2"}}, 'over={"belt": "1:2"}: expected FROM:TO:NUMBER\n  for example mu=np.linspace(0.05, 0.3, 100)'),
        ({"over": {"belt": "2,,3"}}, 'over={"belt": "2,,3"}: an empty value'),
        ({"over": [1, 2]}, "over=[1, 2]: expected a dict"),
        ({"sample": {"v": "normal(0,1)"}}, "runs=1000"),
        ({"sample": {"v": "normal(0,1)"}, "runs": 0}, "runs=0: expected a whole number >= 1"),
        ({"sample": {"v": "normal(0,-1)"}, "runs": 3}, 'sample={"v": "normal(0,-1)"}: the standard deviation'),
        ({"sample": {"v": "norml(0,1)"}, "runs": 3}, "did you mean 'normal'"),
        ({"sample": {"v": "normal(0)"}, "runs": 3}, "two numbers"),
        ({"sample": {"v": 3}, "runs": 3}, 'sample={"v": "3"}: expected a distribution'),
        ({"sample": "v", "runs": 3}, "expected a dict"),
        ({"belt": [1, 2], "runs": 3}, "nothing is sampled"),
        ({"belt": np.linspace(0, 1, 10**4), "v": np.linspace(0, 1, 10**4)}, "yes=True"),
        ({"belt": [1, 2], "v": [1, 2, 3], "zip": True}, "without zip=True they make a grid"),
        ({"belt": [1, 2], "keep": "all"}, "keep='all': expected final, events or trajectory"),
        ({"belt": [1, 2], "jobs": 0}, "jobs=0: expected a whole number >= 1"),
        ({"belt": [1, "x"]}, 'over={"belt": "x"}: unknown name'),
        ({"belt": np.ones((2, 2))}, "an array of shape (2, 2)"),
        ({"belt": 3}, 'write set={"belt": 3}'),
        ({"rtol": [1e-6, -1]}, "rtol=…: expected a finite number > 0, found -1\n  in run 2"),
        ({"belt": [1, 2], "rtoll": 3}, "did you mean 'rtol'"),
    ],
)
def test_sweeps(slip, sweep, told):
    assert told in said_by(lambda: slip.sweep(**{"until": 1, **sweep}))


def test_the_end_is_swept_like_any_option(slip):
    assert slip.sweep(until=[1, 2])["t"].tolist() == [1, 2]


def test_optimisations(block, slip):
    assert "did you mean 'control_intervals'" in said_by(lambda: block.optimize(control_interval=3))
    assert 'set={"q": 0.3}' in said_by(lambda: block.optimize(q=0.3))
    assert "write control_intervals=20" in said_by(lambda: block.optimize(N=20))
    assert "write horizon=2" in said_by(lambda: block.optimize(until=3))
    solved = block.optimize(control_intervals=2)
    with pytest.raises(AttributeError, match=r'r.optimization\["horizon"\]'):
        solved.horizon
    with pytest.raises(AttributeError, match="no attribute 'figure'"):
        solved.figure
    assert block.simulate(until=1, inputs={"u": solved})["u"][0] == solved.u[0, 0]
    assert "set=r.final" in said_by(lambda: block.simulate(until=1, set={"u": solved}))
    assert "u=[… " in said_by(lambda: block.simulate(until=1, set={"u": solved.u}))
    assert "or run m.simulate()" in said_by(lambda: slip.optimize())
    assert "options change what is stated" in said_by(lambda: slip.optimize(control_intervals=5))
    assert "start=3: expected a result" in said_by(lambda: block.optimize(start=3))
    m = saltus.Builder("m")
    m.rate(m.state("x", 0), 1)
    m.optimal_control(horizon=1)
    assert "or give control_intervals=20" in said_by(m.optimize)


def test_studies(slip):
    assert "steps=[25,50,100,200]" in said_by(lambda: slip.order(until=1, steps=[2, 1]))
    assert 'schemes=[("radau_iia", 2)]' in said_by(lambda: slip.order(until=1, schemes="radau_iia:2"))
    assert "steps=[50, 100, 200]" in said_by(lambda: slip.order(until=1, steps=10))


def test_results(slip, tmp_path):
    r = slip.simulate(until=5)
    for t in (7, math.nan):
        assert "known from 0 to 5" in said_by(lambda t=t: r(t))
    assert "expected a time" in said_by(lambda: r("x"))
    for grid in (0, -3, 2.5):
        assert "whole number of rows" in said_by(lambda grid=grid: r.frame(grid=grid))
    for wrong in (lambda: r["belt"], lambda: r.final["belt"]):
        assert "r.parameters['belt']" in said_by(wrong, KeyError)
    assert "s.results[0]" in said_by(lambda: slip.sweep(belt=[1, 2], until=1)[0], TypeError)
    assert "end in .html" in said_by(lambda: r.report(tmp_path / "r.pdf"))
    assert "did you mean 'belt'" in said_by(lambda: slip.sweep(belt=[1, 2], until=1)["bel"], KeyError)
    assert r.plot("v")[0].get_ylabel() == "v"
    assert "m.simulate() or m.optimize()" in said_by(lambda: saltus.load(slip.path))


def test_statuses():
    """Reasons, too, name options by their keywords."""
    m = saltus.Builder("ball")
    y, v = m.state("y", 1), m.state("v", 0)
    m.mechanics([y], [v], force={v: -9.81})
    m.contact("ground", gap=y)
    for steps in (10, 20, 40):
        r = m.simulate(until=1, method="fesd", steps=steps)
        assert "simulate." not in r.status.message


def test_files_and_texts(slip):
    assert f'saltus.Model("{slip.path}")' in said_by(lambda: saltus.Model.from_text(slip.path))
    assert "a Builder is a model already" in said_by(lambda: saltus.Model(saltus.Builder("m")), TypeError)
    assert "saltus.Model.from_text" in said_by(lambda: saltus.Model("[model]\nname = 1"))


@pytest.fixture
def m():
    m = saltus.Builder("m")
    m.state("q", 1)
    return m


def test_what_a_builder_is_given(m):
    q = saltus.Expression("q", owner=m)
    for call, told in [
        (lambda: m.state("sin", 0), "'sin' is a word of the language"),
        (lambda: m.rate(q, "-q"), "without quotes"),
        (lambda: m.rate(q, q > 0), "saltus.if_(q>0, 1, 0)"),
        (lambda: (q > 0) * 2, "q>0 is a condition, not a number"),
        (lambda: saltus.sin(q > 0), "q>0 is a condition"),
        (lambda: q + True, "write 1 or 0"),
        (lambda: q + [1, 2], "scalar"),
        (lambda: round(q), "saltus.floor"),
        (lambda: m.jump(q > 1), "changes nothing"),
        (lambda: m.jump(set={q: 0}), "not clear"),
        (lambda: m.jump(q > 1, {q: 0}, every=2), "not clear"),
        (lambda: m.mode(q > 1, [1]), "expected a dict by states"),
        (lambda: m.states("z", 3), "no list of initial values"),
        (lambda: m.output("a b", q), "is no name"),
        (lambda: m.output(q), "none of the definitions"),
        (lambda: m.table("f", [0, 1], [0, 1])(q > 0), "q>0 is a condition"),
        (lambda: math.floor(q), "saltus.floor"),
        (lambda: saltus.max([q, q]), "saltus.max(*values)"),
    ]:
        assert told in said_by(call)
    m.rate(q, 1)
    assert "m.simulate(until=10)" in said_by(m.simulate)


def test_what_is_said_twice(m):
    """What is said once more does not silently take the place of the first."""
    q, u = saltus.Expression("q", owner=m), m.control("u")
    m.output("y", q)
    assert "'y' is taken" in said_by(lambda: m.output("y", -q))
    m.input(u, 1)
    assert "two inputs" in said_by(lambda: m.input(u, 2))


def test_conditions_of_casadi(m):
    casadi = pytest.importorskip("casadi")
    q = casadi.SX.sym("q")
    m.rate("q", casadi.if_else(casadi.logic_and(q > 0.5, q < 2), -1, 2) + 0 * casadi.ceil(casadi.SX.sym("t")))
    r = m.simulate(until=1)
    assert r.status.done and r.events[0].t == pytest.approx(0.5, abs=1e-12)
    assert "2 entries" in said_by(lambda: m.output("z", casadi.SX.sym("z", 2)))
    assert "functions of saltus" in said_by(lambda: m.output("z", casadi.erf(q)))
    own = saltus.Expression("q", owner=m)
    assert repr(saltus.if_(q > 0, own, 1)) == "if(0<q,q,1)"
    assert repr((own < 2) & (q > 0)) == "q<2 and 0<q"


@pytest.mark.parametrize("call, said", [
    (lambda m: m.simulate(until=2, times=np.ones((2, 2))), "times: expected a list of values, found an array of shape (2, 2)"),
    (lambda m: m.simulate(until=2, set={"mu": True}), "mu=True: expected a number"),
    (lambda m: m.simulate(until=2, set={"mu": 1j}), "mu: a number, a text or a list of numbers is expected, found complex"),
    (lambda m: m.sweep(mu=(value for value in (1, 2)), until=1), "mu"),
    (lambda m: m.simulate(until=2)(np.ones((2, 2))), "found an array of shape (2, 2)"),
])
def test_values_of_another_shape_or_type_are_told_with_their_names(brake, call, said):
    with pytest.raises((saltus.ModelError, TypeError, ValueError)) as refused:
        call(brake)
    assert said in str(refused.value)


def test_times_of_a_calendar_are_refused(brake):
    pandas = pytest.importorskip("pandas")
    times = pandas.date_range("2026-01-01", periods=3)
    without_end = saltus.Model.from_text('[model]\nname = "m"\n[states]\nx = 1\n[dynamics]\nx = "-x"\n')
    for model in brake, without_end:
        with pytest.raises((saltus.ModelError, TypeError), match="times: .*numbers.* found Timestamp"):
            model.simulate(times=times)


def test_files_with_another_name_are_not_meant(tmp_path):
    (tmp_path / "B3e.toml").write_text("")
    (tmp_path / "brakes.toml").write_text("")
    for name, meant in ("nope", ""), ("brake", "brakes.toml"):
        with pytest.raises(saltus.ModelError) as refused:
            saltus.Model(tmp_path / f"{name}.toml")
        assert ("did you mean" in str(refused.value)) == bool(meant) and meant in str(refused.value)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        ({"until": [10, 20]}, "until=[10, 20]: expected the end time, a number\n  numbers of steps are steps=[10, 20]"),
        ({"steps": 10}, "steps=10: expected a list of numbers of steps"),
        ({"schemes": ["radau_iia"]}, "schemes=['radau_iia']: expected pairs of a name and a number of stages"),
        ({"schemes": "radau_iia"}, "expected pairs of a name and a number of stages"),
        ({"schemes": ("radau_iia", 2)}, 'e.g. schemes=[("radau_iia", 2)]'),
    ],
)
def test_order_says_which_list_it_expects(call, told):
    with pytest.raises(saltus.ModelError) as refused:
        saltus.catalogue("stick-slip").order(**call)
    assert told in str(refused.value)


def test_warnings_of_one_kind_are_one():
    m = saltus.Builder("unused")
    x = m.state("x", 1)
    for i in range(20):
        m.parameter(f"p{i}", i)
    m.rate(x, -x)
    with pytest.warns(saltus.ModelWarning) as warned:
        m.simulate(until=1)
    assert len(warned) == 1 and "(and 19 more like it: 'p1', 'p2', 'p3', …)" in str(warned[0].message)
