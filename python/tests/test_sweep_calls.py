"""How a sweep is asked for in Python: names, options, and what is wrong."""

import numpy as np
import pytest

import saltus


@pytest.fixture(scope="module")
def slip():
    return saltus.catalogue("stick-slip")


def called_like_options():
    m = saltus.Builder("m")
    x, rho, stages, until = m.state("x", 1), m.parameter("rho", 1), m.parameter("stages", 1), m.parameter("until", 1)
    m.rate(x, -rho * stages * until * x)
    return m


def test_names_of_the_model_come_before_options():
    m = called_like_options()
    (rho,) = (saltus.Expression("rho", owner=m),)
    for s in (m.sweep({"rho": [0.5, 1]}, until=1), m.sweep(rho=[0.5, 1], until=1), m.sweep({rho: [0.5, 1]}, until=1)):
        assert s.names == ["rho"] and s["x"] == pytest.approx(np.exp([-0.5, -1]), rel=1e-6)
    assert m.sweep({"stages": [1, 2], "until": [1, 2]}, until=1).names == ["stages", "until"]
    whole = m.sweep({"simulate.fesd.rho": [0.5, 1], "fesd.stages": [2]}, until=1, method="fesd", steps=4)
    assert whole.names == ["simulate.fesd.rho", "simulate.fesd.stages"]
    for run in (lambda: m.simulate(until=1, rho=3), lambda: m.sweep(stages=[1, 2], until=1, rho=3)):
        with pytest.raises(saltus.ModelError, match=r'rho=3 may be two things.*\n.*set={"rho": …}.*set={"simulate.fesd.rho": …}'):
            run()
    r = m.simulate(until=1, method="fesd", steps=4, set={"rho": 2, "simulate.fesd.stages": 3})
    assert r.final["x"] == pytest.approx(np.exp(-2), rel=1e-4) and r.options["simulate.fesd.stages"] == 3


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"over": {"v(0)": [1, 2]}}, r"'v\(0\)', which is not in the model\n  in over={\"v\(0\)\": …}\n.*\n  did you mean 'v'"),
        ({"rtoll": [1e-5]}, "'rtoll' is no name of the model and no option\n  did you mean 'rtol'"),
        ({"bellt": [1e-5]}, "did you mean 'belt'"),
        ({"belt": "normal(0, 1)"}, r'write sample={"belt": "normal\(0, 1\)"}, runs=100'),
        ({"over": {"belt": "normal(0, 1)"}}, r'write sample={"belt": "normal\(0, 1\)"}, runs=100'),
        ({"belt": [1], "seed": 2**64}, "seed=18446744073709551616: expected a whole number <= 18446744073709551615"),
        ({"belt": [1], "jobs": 10**6}, "jobs=1000000: expected a whole number <= 4096"),
        ({"belt": [1], "runs": 2**64}, "expected a whole number <= "),
    ],
)
def test_what_is_wrong_in_python(slip, arguments, words):
    with pytest.raises(saltus.ModelError, match=words):
        slip.sweep(**arguments, until=1)


def test_what_is_no_dict_or_no_model(slip):
    with pytest.raises(TypeError, match=r"set=\[1\]: expected a dict"):
        slip.sweep(belt=[1, 2], set=[1], until=1)
    with pytest.raises(TypeError, match=r'saltus.catalogue\("stick-slip"\)'):
        saltus.compare("stick-slip")
    with pytest.raises(TypeError, match=r'saltus.catalogue\("stick-slip"\)'):
        saltus.order("stick-slip")


def test_inputs_are_swept():
    m = saltus.Builder("cart")
    x, u = m.state("x", 0), m.control("u")
    m.rate(x, u)
    assert m.sweep({"inputs.u": ["t", "2*t"]}, until=1)["x"] == pytest.approx([0.5, 1])
    assert m.sweep(u=[1, 2], until=1)["x"] == pytest.approx([1, 2])
