"""Models stated in Python: the same text, the same bits, and what is wrong with them."""

import functools
import math

import numpy as np
import pytest

import saltus


def stick_slip():
    m = saltus.Builder("stick-slip")
    belt = m.parameter("belt", 0.2)
    q, v = m.state("q", 0.04), m.state("v", -0.01)
    slip = m.switching("slip", v - belt)
    m.rate(q, v)
    m.rate(v, -q + saltus.if_(slip > 0, -1 / (1 - belt + v), 1 / (1 + belt - v)))
    return m


def dry_friction_oscillator():
    m = saltus.Builder("dry-friction-oscillator")
    mu = m.parameter("mu", 0.4)
    x, v = m.state("x", 3), m.state("v", 0)
    m.rate(x, v)
    m.rate(v, -x - mu * saltus.sign(v))
    return m


def bouncing_ball():
    m = saltus.Builder("bouncing-ball")
    g, e = m.parameter("g", 9.8), m.parameter("e", 0.9)
    y, v = m.state("y", 10), m.state("v", 0)
    m.rate(y, v)
    m.rate(v, -g)
    m.jump(y, {v: -e * v}, direction="down", name="bounce")
    return m


def quadrants():
    m = saltus.Builder("quadrants")
    x1, x2 = m.state("x1", 0.1), m.state("x2", 0.1)
    right, upper = m.switching("right", x1), m.switching("upper", x2)
    m.mode(((right < 0) & (upper > 0)) | ((right > 0) & (upper < 0)), {x1: -0.1 * x1 + x2, x2: -4 * x1 - 0.1 * x2})
    m.otherwise({x1: -0.1 * x1 + 4 * x2, x2: -x1 - 0.1 * x2})
    return m


def thermostat():
    m = saltus.Builder("thermostat")
    outside, power = m.parameter("outside", 18), m.parameter("power", 2)
    low, high = m.parameter("low", 22), m.parameter("high", 23.5)
    T, heating = m.state("T", 15), m.state("heating", 1)
    m.rate(T, -0.1 * (T - outside) + power * heating)
    m.rate(heating, 0)
    m.jump(T > high, {heating: 0}, name="too_warm")
    m.jump(T < low, {heating: 1}, name="too_cold")
    return m


def welander():
    m = saltus.Builder("welander")
    mixing_rate, salt_weight = m.parameter("mixing_rate", 5), m.parameter("salt_weight", 1.2)
    T, S = m.state("T", 0.5), m.state("S", 0.3)
    dense = m.switching("dense", salt_weight * S - T + 0.01)
    mixing = m.define("mixing", saltus.if_(dense > 0, mixing_rate, 0))
    m.rate(T, 1 - T - mixing * T)
    m.rate(S, (1 - S) / 2 - mixing * S)
    m.output("density", salt_weight * S - T)
    return m


@pytest.mark.parametrize(
    "builder", [stick_slip, dry_friction_oscillator, bouncing_ball, quadrants, thermostat, welander], ids=lambda f: f.__name__
)
def test_catalogue_models_restated_are_equal_bit_by_bit(builder):
    shipped = saltus.catalogue(builder.__name__.replace("_", "-"))
    until = shipped.simulate().t[-1]
    a, b = shipped.simulate(until, output="steps"), builder().simulate(until, output="steps")
    assert a.x.tobytes() == b.x.tobytes()
    assert a.alpha.tobytes() == b.alpha.tobytes()
    assert a.switching_functions == b.switching_functions
    assert [(e.t, e.kind, e.name, e.surfaces, e.reason) for e in a.events] == [
        (e.t, e.kind, e.name, e.surfaces, e.reason) for e in b.events
    ]
    # What it wrote is read as the same model again.
    c = saltus.Model.from_text(builder().to_toml()).simulate(until, output="steps")
    assert c.x.tobytes() == b.x.tobytes()


@pytest.fixture
def m():
    m = saltus.Builder("m")
    m.state("x", 1)
    m.state("y", 2)
    return m


@pytest.mark.parametrize(
    ("expression", "text", "value"),
    [
        (lambda x, y: x - (y - 3), "x-(y-3)", 2),
        (lambda x, y: x - y - 3, "x-y-3", -4),
        (lambda x, y: x + (y + 3), "x+(y+3)", 6),
        (lambda x, y: x / (y * 3), "x/(y*3)", 1 / 6),
        (lambda x, y: x / y * 3, "x/y*3", 1.5),
        (lambda x, y: (x + y) * 3, "(x+y)*3", 9),
        (lambda x, y: -(x + y), "-(x+y)", -3),
        (lambda x, y: -(x * y), "-(x*y)", -2),
        (lambda x, y: -x * y, "-x*y", -2),
        (lambda x, y: -(x**y), "-x^y", -1),
        (lambda x, y: (-y) ** 2, "(-y)^2", 4),
        (lambda x, y: y ** -x, "y^-x", 0.5),
        (lambda x, y: y**x**y, "y^x^y", 2),
        (lambda x, y: (y**3) ** y, "(y^3)^y", 64),
        (lambda x, y: 2**y, "2^y", 4),
        (lambda x, y: (-2) ** y, "(-2)^y", 4),
        (lambda x, y: x - (-2), "x--2", 3),
        (lambda x, y: 1e-9 * x, "1e-9*x", 1e-9),
        (lambda x, y: np.float64(0.1) * x, "0.1*x", 0.1),
        (lambda x, y: +y, "+y", 2),
        (lambda x, y: abs(x - y), "abs(x-y)", 1),
        (lambda x, y: y % 3, "mod(y,3)", None),
        (lambda x, y: np.sqrt(y + 2), "sqrt(y+2)", 2),
        (lambda x, y: saltus.max(x, 3), "max(x,3)", 3),
        (lambda x, y: saltus.if_((x < 0) | ~(y > 1), 5, saltus.hypot(3, 4)), "if(x<0 or not y>1,5,hypot(3,4))", 5),
        (lambda x, y: saltus.if_(~((x < 0) & (y > 1)), 5, 6), "if(not (x<0 and y>1),5,6)", 5),
        (lambda x, y: saltus.pi * x, "pi*x", math.pi),
        (lambda x, y: np.array([[2.0, 1.0]]) @ np.array([x, y]), "2.0*x+1.0*y", 4),
    ],
)
def test_operators_mean_what_they_mean_in_python(m, expression, text, value):
    x, y = saltus.Expression("x", owner=m), saltus.Expression("y", owner=m)
    made = expression(x, y)
    made = made.item() if isinstance(made, np.ndarray) else made
    assert made.text == text
    if value is None:
        return
    m.rate("x", 0)
    m.rate("y", 0)
    m.output("z", made)
    assert m.simulate(1e-3)["z"][0] == pytest.approx(value, rel=1e-15)


def refused(action, *words):
    with pytest.raises(saltus.ModelError) as said:
        action()
    for word in words:
        assert word in str(said.value), str(said.value)
    assert said.value.remedy


def test_what_python_must_not_decide(m):
    x, y = saltus.Expression("x", owner=m), saltus.Expression("y", owner=m)
    refused(lambda: 1 if x > 0 else 2, "saltus.if_")
    refused(lambda: (x > 0) and (y > 0), "& |")
    refused(lambda: 0 < x < 1, "(a < x) & (x < b)")
    refused(lambda: max(x, y), "saltus.max")
    refused(lambda: not x, "x > 0")
    refused(lambda: math.sin(x), "saltus.sin")
    refused(lambda: float(x), "saltus.sin")
    refused(lambda: x > 0 & y > 0, "(x > 0) & (y > 0)")
    refused(lambda: list(x), "arrays")
    refused(lambda: np.array([x, y]) > 0, "saltus.array([x, v]) > 0")
    refused(lambda: x + "1", "'1'")
    refused(lambda: x + float("nan"), "finite")
    refused(lambda: saltus.max(x), "2 arguments")
    refused(lambda: saltus.if_(x, 1, 2), "if_")
    refused(lambda: x ^ 2, "x**2")
    refused(lambda: (x > 0) ^ (y > 0), "(a & ~b)")


def test_what_a_model_cannot_be(m):
    x = saltus.Expression("x", owner=m)
    refused(m.model, "'x' has no rate", "m.rate(x")
    m.rate(x, 1)
    refused(lambda: m.rate(x, 2), "two rates")
    refused(lambda: m.rate("z", 2), "'z'", "x, y")
    refused(lambda: m.parameter("x", 2), "taken")
    other = saltus.Builder("other")
    a = other.state("a", 0)
    refused(lambda: m.rate("y", a), "another builder")
    refused(lambda: x + a, "another builder")
    refused(lambda: m.rate(a, 1), "another builder")
    m.rate("y", x)
    refused(lambda: m.state("bad name", 0), "is no name")
    refused(lambda: m.jump(x > 1, x), "set=x: expected a dict", "{x: 0}")


def test_tables_inputs_events_and_regions():
    m = saltus.Builder("all", "what there is")
    s, w = m.state("s", 0.0), m.state("w", 0.5)
    u = m.control("u", 1, lower=-1, upper=1)
    road = m.table("road", [0, 1, 2], [0, 1, 0])
    m.rate(s, u)
    m.rate(w, road(s) - w)
    m.input(u, saltus.cos(saltus.t))
    m.event(w - 0.4, name="low", direction="down")
    m.event(s > 0.5, name="far", stop=True)
    m.region((s - 1) ** 2, {s: 0.0}, name="near")
    m.region((s + 1) ** 2, {s: 0.1}, name="far_off")
    r = m.simulate(2)
    assert r.status == "stopped_by_event"
    assert r.events[-1].name == "far"
    assert r["u"].tolist() == np.cos(r.t).tolist()
    m = saltus.Builder("clock")
    n = m.state("n", 0)
    m.rate(n, 0)
    m.jump(set={n: n + 1}, every=0.5)
    m.jump(set={n: n * 10}, at=[1.25])
    assert m.simulate(2.1).final["n"] == 22


def test_contacts_and_mechanics():
    """A ball that slides under friction stops where v = mu g t; dropped first, it lands with an impulse."""
    m = saltus.Builder("ball")
    x, y, u, v = m.state("x", 0), m.state("y", 0.1), m.state("u", 2), m.state("v", 0)
    mu = m.parameter("mu", 0.5)
    m.mechanics([x, y], [u, v], mass=[[2, 0], [0, 2]], force={v: -2 * 10})
    m.contact("ground", gap=y, tangent={x: 1}, friction=mu)
    r = m.simulate(until=2, rtol=1e-10)
    lands = np.sqrt(2 * 0.1 / 10)
    # The impact takes mu v_n of the tangential velocity.
    slides = 2 - 0.5 * 10 * lands
    assert [e.kind for e in r.events] == ["impact", "stick"]
    assert r.events[0].t == pytest.approx(lands, abs=1e-9)
    assert r.events[1].t == pytest.approx(lands + slides / 5, abs=1e-9)
    with pytest.raises(saltus.ModelError, match="stated twice"):
        m.mechanics([x], [u])
    with pytest.raises(saltus.ModelError, match="is taken"):
        m.contact("ground", gap=x)


def test_friction_in_a_plane():
    """A puck stops where |v| = mu g t, in the direction of its velocity."""
    m = saltus.Builder("puck")
    x, y, z = m.state("x", 0), m.state("y", 0), m.state("z", 0)
    u, v, w = m.state("u", 3), m.state("v", 4), m.state("w", 0)
    m.mechanics([x, y, z], [u, v, w], force={w: -10})
    m.contact("table", gap=z, tangents=[{x: 1}, {y: 1}], friction=0.5)
    r = m.simulate(until=2, rtol=1e-10)
    assert [e.kind for e in r.events] == ["stick"]
    assert r.events[0].t == pytest.approx(1, abs=1e-9)
    assert (r.final["x"], r.final["y"]) == pytest.approx((1.5, 2), abs=1e-9)
    assert (r.final["u"], r.final["v"]) == (0, 0)


def test_numbers_are_numbers_of_toml():
    m = saltus.Builder("m")
    numbers = [6, -2.5, 1e-7, 1e22, 0.1, np.float64(3), 2**70]
    for place, value in enumerate(numbers):
        m.parameter(f"p{place}", value, unit="V")
    x = m.state("x", -1)
    m.rate(x, -m.parameter("k", 2) * x)
    text = m.to_toml()
    for line in ("p0 = { initial = 6, unit", "p1 = { initial = -2.5,", "p2 = { initial = 1e-7,", "\nx = -1\n", "\nk = 2\n", '\nx = "-k*x"\n'):
        assert line in text
    # A whole number that TOML does not have.
    assert f'p6 = {{ initial = "{2**70}",' in text
    assert [m.model().parameters[f"p{place}"] for place in range(7)] == numbers


def test_hysteresis_switches_at_its_thresholds():
    m = saltus.Builder("room")
    T = m.state("T", 15)
    heats = m.hysteresis("heats", -T, on=-18, off=-20, initial=1)
    m.rate(T, 10 * heats - 0.1 * T)
    r = m.simulate(until=10)
    assert {round(float(e.x[0]), 9) for e in r.events} == {18.0, 20.0}
    m.rate(m.state("clock", 0), 1)
    for method in ("event", "fesd"):
        assert m.simulate(until=10, method=method).final["clock"] == pytest.approx(10, abs=1e-8)


def test_a_builder_is_a_model_in_all_it_does():
    m = saltus.Builder("decay")
    k = m.parameter("k", 1)
    x = m.state("x", 1)
    m.rate(x, -k * x)
    assert m.sweep(k=[1, 2], until=1).results[1].final["x"] == pytest.approx(np.exp(-2), rel=1e-6)
    assert "x' = -k*x" in m.check()
    assert "dot{x}" in m._repr_html_()


def test_a_problem_of_optimal_control():
    m = saltus.Builder("car")
    q, v = m.state("q", 0, unit="m", label="way"), m.state("v", 0)
    u = m.control("u", lower=-1, upper=1)
    m.rate(q, v)
    m.rate(v, u)
    refused(m.optimize, "no problem", "m.optimal_control")
    refused(m.optimal_control, "no keys")
    horizon = {"free": True, "initial": 2.5, "lower": 1, "upper": 5}
    m.optimal_control(horizon=horizon, minimize_time=True, control_intervals=4, terminal_constraints=[q == 1, v == 0])
    refused(lambda: m.optimal_control(horizon=1), "twice")
    refused(lambda: saltus.Builder("other").optimal_control(objective=q), "another builder")
    found = m.optimize().require()
    assert abs(found.optimization["horizon"] - 2) < 1e-6
    assert 'unit = "m"' in m.to_toml()


def test_powers_are_the_language_s(m):
    x = saltus.Expression("x", owner=m)
    assert saltus.pow(x, 3).text == "pow(x,3)"
    assert saltus.max(x, 1, 2).text == "max(max(x,1),2)"


def test_arrays_and_numbers_of_casadi():
    casadi = pytest.importorskip("casadi")
    m = saltus.Builder("m")
    x, v, k = m.state("x", 0), m.state("v", 1), m.parameter("k", 2.0)
    both = np.array([x, v])
    for made, expected in [
        (both * k, ["x*k", "v*k"]),
        (k * both, ["k*x", "k*v"]),
        (both - k, ["x-k", "v-k"]),
        (both**k, ["x^k", "v^k"]),
        (np.array([1, 2]) * x, ["1*x", "2*x"]),
        (saltus.max(both, 0), ["max(x,0)", "max(v,0)"]),
    ]:
        assert [str(entry) for entry in made] == expected
    assert str(both @ both) == "x*x+v*v"
    assert str(np.arctan2(x, v)) == "atan2(x,v)"
    a = casadi.SX.sym("x")
    m.rate(x, v)
    m.rate(v, casadi.sin(a) ** 2 - k)
    assert m.simulate(until=0.1).status.done
    for wrong in ("x y", 3, ""):
        with pytest.raises(saltus.ModelError, match="is no name"):
            m.state(wrong, 1)
    with pytest.raises(saltus.ModelError, match="compare"):
        saltus.if_(x, 1, 2)


def test_vectors_and_long_sums_of_casadi():
    """Rates by a vertcat; a sum of hundreds of terms is one of the language, without parentheses."""
    casadi = pytest.importorskip("casadi")
    m = saltus.Builder("m")
    both = [m.state("x", 0), m.state("v", 1)]
    x, v = casadi.SX.sym("x"), casadi.SX.sym("v")
    m.rate(both, casadi.vertcat(v, -x + sum(k * 1e-9 * v for k in range(1, 900))))
    assert m.to_toml().count("(") == 0
    assert m.simulate(until=0.1).status.done
    for _ in range(60):
        v = casadi.sin(v) * v
    # What occurs in itself twice, sixty times, has names.
    m.output("y", v)
    assert len(m.to_toml()) < 1_000_000 and m.simulate(until=0.1).final["y"] == 0


def test_keys_and_truths_are_those_of_toml():
    """Texts of switching functions are keys in quotes, truths of numpy are truths."""
    m = saltus.Builder("m")
    x = m.state("x", 1)
    m.rate(x, -1 - 0.1 * saltus.sign(x - 0.5))
    speed = m.define("speed", -1 - 0 * x)
    m.output(speed)
    m.event(x - 0.5, stop=np.bool_(True))
    m.jump(x + 5, {x: 0}, direction="down")
    m.jump(at=0.25, set={x: x - 0.1})
    m.simulation(event={"scaling": {"x-0.5": 2.0}}, output={"events": np.False_, "points": 3})
    assert '"x-0.5" = 2.0' in m.to_toml()
    with pytest.warns(saltus.ModelWarning, match="scaling.x-0.5 has no effect"):
        r = m.simulate(until=5)
    assert r.final.t == pytest.approx(0.4 / 1.1)


def test_files_options_and_words(tmp_path):
    (tmp_path / "u.csv").write_text("t,u\n0,1\n1,3\n")
    (tmp_path / "f.csv").write_text("0,0\n1,2\n")
    m = saltus.Builder("m")
    x, u = m.state("x", 0, unit="m"), m.control("u", unit="N", label="force")
    double = m.table("double", file=str(tmp_path / "f.csv"))
    speed = m.define("speed", double(x / 4))
    m.rate(x, u)
    m.input(u, {"file": str(tmp_path / "u.csv")})
    m.output("speed", unit="m/s")
    m.simulation(until=2, output={"points": 3})
    r = m.simulate()
    assert r["u"].tolist()[0] == 1 and r["u"].tolist()[-1] == 3
    assert r["speed"] == pytest.approx(np.minimum(r["x"] / 2, 2))
    assert m.simulate(until=1).t[-1] == 1
    captions = r.to_dict()["model"]["captions"]
    assert captions["speed"]["unit"] == "m/s" and captions["u"] == {"unit": "N", "label": "force"}
    for wrong in ({}, {"x": [0, 1]}, {"x": [0, 1], "y": [0, 1], "file": "f.csv"}):
        refused(lambda wrong=wrong: m.table("other", **wrong), "not clear", "file=")
    refused(lambda: m.table("other", [0, "a"], [0, 1]), "no lists of numbers")
    assert [str(entry) for entry in double(saltus.array([x, u]))] == ["double(x)", "double(u)"]


def test_free_parameters_are_chosen():
    """The constant acceleration that brings a body 1 m far in 1 s, and the initial speed that needs none."""
    for free, other, found in (("a", {"v": 0}, 2), ("v", {"a": 0}, 1)):
        m = saltus.Builder("throw")
        bounds = {"lower": -5, "upper": 5, "free": True}
        a = m.parameter("a", 1, **(bounds if free == "a" else {}))
        q, v = m.state("q", 0), m.state("v", 0.5 if free == "v" else 0, **(bounds if free == "v" else {}))
        m.rate(q, v)
        m.rate(v, a)
        m.optimal_control(horizon=1, control_intervals=1, running_cost=a**2, terminal_constraints=[q == 1])
        best = m.optimize(set={"a": 0} if free == "v" else {}).require()
        value = best.optimization["parameters"]["a"] if free == "a" else best["v"][0]
        assert value == pytest.approx(found, abs=1e-5)


def test_what_is_optimised_may_be_said_where_it_is():
    b = saltus.Builder("block")
    q, v, u = b.state("q", 0), b.state("v", 0), b.control("u", lower=-1, upper=1)
    b.rate(q, v)
    b.rate(v, u)
    ends = [q == 1, v == 0]
    free = {"free": True, "initial": 2.5, "lower": 1, "upper": 5}
    whole = b.optimize(horizon=free, minimize_time=True, control_intervals=4, terminal_constraints=ends)
    assert abs(whole.optimization["horizon"] - 2) < 1e-6
    assert "[optimize]" not in b.to_toml()
    b.optimal_control(horizon=free, minimize_time=True, control_intervals=4)
    assert b.optimize(terminal_constraints=ends).optimization["u"] == whole.optimization["u"]
    with pytest.raises(saltus.ModelError, match="did you mean '.*terminal_constraints'"):
        b.optimize(terminal_constraint=ends)
    with pytest.raises(saltus.ModelError, match="b.optimize.terminal_constraints="):
        b.model().optimize(terminal_constraints=["q == 1"])


def test_a_call_that_fails_leaves_the_builder_as_it_was():
    m = saltus.Builder("m")
    m.state("x2", 0)
    before = m.to_toml()
    x, v = "x2", None
    for call, told in [
        (lambda: m.states("x", [1, 2, 3]), "'x2' is taken"),
        (lambda: m.rate(["x2", "x3"], [1, 2]), "'x3' is none of the states"),
        (lambda: m.hysteresis("h", "what", on=1, off=2), "what"),
        (lambda: m.contact("c", gap=1, tangent=3), "expected a dict"),
        (lambda: m.event(m._own(1), direction="sideways"), "direction='sideways': expected up, down or both"),
        (lambda: m.jump(m._own(1), {x: 1}, direction="no"), "direction='no': expected up, down or both"),
        (lambda: m.table("f", [1, 0], [0, 1]), "must ascend, found 0.0 after 1.0"),
        (lambda: m.table("f", [0, 1], [0]), "2 x and 1 y"),
        (lambda: m.table("f", [0], [0]), "at least 2"),
        (lambda: m.table("f", [0, 1, 2], [0, 1, 2], "cubic"), "at least 4"),
        (lambda: m.table("f", [0, 1], [0, float("nan")]), "have a nan"),
        (lambda: m.table("f", [0, 1], [0, 1], "spline"), "kind='spline': expected linear or cubic"),
    ]:
        with pytest.raises((saltus.ModelError, TypeError), match=told):
            call()
        assert m.to_toml() == before
    x = m.states("y", [1, 2])
    with pytest.raises((saltus.ModelError, TypeError)):
        m.rate(x, [x[0], v])
    m.rate(x, -x)
    for name in "h", "c", "f", "x1":
        m.parameter(name, 1)


def grown(n, grow):
    m = saltus.Builder("m")
    x = m.state("x", 0.5)
    made = grow(x, n)
    m.output("y", made)
    m.parameter("part1", 1)
    m.rate(x, 0 * made)
    return m


@pytest.mark.filterwarnings("ignore::saltus.ModelWarning")
@pytest.mark.parametrize(
    ("n", "grow", "value"),
    [
        (2500, lambda x, n: sum(saltus.sin(i * x) for i in range(n)), sum(np.sin(i * 0.5) for i in range(2500))),
        (2500, lambda x, n: (saltus.array([x] * n) * np.arange(n)).mean(), 0.5 * 2499 / 2),
        (1500, lambda x, n: functools.reduce(lambda e, i: saltus.sin(i * x) + e, range(n), 0), sum(np.sin(i * 0.5) for i in range(1500))),
        (1200, lambda x, n: functools.reduce(lambda e, i: saltus.cos(e), range(n), x), 0.7390851332151607),
        (1500, lambda x, n: functools.reduce(lambda e, i: e * (1 + 0.001 * x), range(n), 1), 1.0005**1500),
        (400, lambda x, n: functools.reduce(lambda e, i: -(1 - e / 2), range(n), x), -2.0),
    ],
    ids=["sum", "mean", "from the right", "nest", "product", "signs"],
)
def test_large_expressions_get_names_of_parts(n, grow, value):
    m = grown(n, grow)
    text = m.to_toml()
    assert "[definitions]\npart2 = " in text and "§" not in text and text == grown(n, grow).to_toml()
    r = m.simulate(until=0.1)
    assert r["y"][0] == pytest.approx(value, rel=1e-9)
    assert saltus.Model.from_text(text).simulate(until=0.1)["y"].tolist() == r["y"].tolist()


def test_small_expressions_get_no_names():
    assert "[definitions]" not in grown(900, lambda x, n: sum(i * x for i in range(n))).to_toml()


def test_what_is_too_large_is_refused_where_it_is_made():
    refused(lambda: grown(6000, lambda x, n: sum(i * x for i in range(n))), "more than 5000 operations", "groups")
    grown(6000, lambda x, n: sum(sum(i * x for i in range(k, k + 100)) for k in range(0, n, 100))).model()
