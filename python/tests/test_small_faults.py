"""Small things that a newcomer meets: each says where it belongs, at the place where it was written."""

import sys

import numpy as np
import pytest

import saltus


def said_by(call):
    with pytest.raises(saltus.ModelError) as refused:
        call()
    return str(refused.value)


@pytest.mark.parametrize("options, said", [
    ({"event": {"sensitivities": True}}, 'write method="fesd", sensitivities=True'),
    ({"event": {"native": "off"}}, "it is of every method: native='off'"),
    ({"fesd": {"rtol": 1e-6}}, "it is of every method: rtol=1e-06"),
    ({"fesd": {"integrator": "taylor"}}, "write method=\"event\", integrator='taylor'"),
    ({"event": {"points": 3}}, 'write output={"points": …}'),
    ({"event": {"integrato": "taylor"}}, "did you mean 'integrator'"),
])
def test_an_option_is_told_where_it_belongs(brake, options, said):
    text = said_by(lambda: brake.simulate(**options))
    assert said in text
    assert "'sensitivities' or 'sensitivities'" not in text


def test_no_word_is_meant_twice(brake):
    """Of two options that Python calls by one word."""
    text = said_by(lambda: brake.simulate(set={"simulate.event.sensitivities": True}))
    assert text.count("'sensitivities'") <= 1


def test_a_model_without_states_is_told_before_its_end():
    b = saltus.Builder("empty")
    assert "has no states" in said_by(b.simulate)
    assert "has no states" in said_by(lambda: saltus.Model.from_text('[model]\nname = "empty"\n').simulate())
    b.rate(b.state("x", 0), 1)
    assert "no end time" in said_by(b.simulate)


def test_what_no_expression_has_may_be_called_like_a_function():
    b = saltus.Builder("m")
    x, v = b.state("x", 1), b.state("v", 0)
    b.mechanics([x], [v], force={v: -9.81})
    b.contact("floor", gap=x, restitution=0.5)
    b.event(v, name="max", direction="down")
    r = b.simulate(until=0.8)
    met = [(e.kind, e.name or e.surfaces[0]) for e in r.events if e.kind in ("impact", "user")]
    assert met == [("impact", "floor"), ("user", "max")]
    assert r["gap(floor)"].min() >= -1e-12
    with pytest.raises(saltus.ModelError, match="'floor' is a word of the language"):
        b.parameter("floor", 1)


@pytest.mark.parametrize("name", ["left wall", "1st", "wall-left", "otherwise", "bounce é"])
def test_names_that_may_not_be_used_are_told_where_they_are_declared(name):
    b = saltus.Builder("m")
    x, v = b.state("x", 1), b.state("v", 0)
    for declare in (lambda: b.jump(x, {v: -v}, direction="down", name=name), lambda: b.event(x, name=name),
                    lambda: b.contact(name, gap=x), lambda: b.parameter(name, 1), lambda: b.hysteresis(name, x, on=1, off=0)):
        assert f"'{name}' is" in said_by(declare)
    b.event(x, name="wall")


def test_the_card_of_an_optimum_tells_objective_certificate_and_verification(block):
    r = block.optimize()
    card = r._repr_html_()
    assert f"objective <b>{r.optimization['objective']:.10g}</b>, horizon 2" in card
    assert "Feasible to" in card and "B-stationary" in card
    assert "Simulated event by event" in card
    assert card.count("✓") >= 3
    assert "objective" not in saltus.catalogue("stick-slip").simulate(until=1)._repr_html_()


def test_tables_stand_in_monospace(brake):
    for shown in (brake.compare(until=1), brake.order(until=1, schemes=[("radau_iia", 2)], steps=[10, 20]), brake.check()):
        assert "font-family:monospace" in shown._repr_html_()


def test_a_bar_tells_how_far_a_run_is_and_what_is_prepared(bars):
    from saltus._progress import progress_line

    saltus.catalogue("stick-slip").simulate(until=5, progress=True)
    (bar,) = bars
    assert bar.n == pytest.approx(100)
    with progress_line("slow", True) as tell:
        tell.prepare("compiling", 2, 5)
        tell(1.0, 0.0, 2.0, 3, 4)
    words = bars[1].words
    assert words[0] == "compiling: 2 of 5"
    assert words[-2:] == ["t = 1, 3 steps, 4 events", "done"]
    assert bars[1].n == pytest.approx(100)


def test_a_bar_counts_the_problems_of_an_optimisation(bars, block):
    r = block.optimize(progress=True)
    (bar,) = bars
    assert bar.n == len(r.optimization["homotopy"])
    assert "scholtes" in " ".join(bar.words) or len(bar.words) >= bar.n


def test_a_line_tells_what_is_prepared(capsys, monkeypatch):
    from saltus._progress import progress_line

    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    with progress_line("slow", True) as tell:
        tell.prepare("reading", 0, 0)
        tell(1.0, 0.0, 2.0, 3, 4)
    written = capsys.readouterr().err.split("\r")
    assert written[1].startswith("slow: reading")
    assert written[-3].startswith("slow: t = 1   50 %   3 steps   4 events")


@pytest.mark.parametrize("text, said", [
    ('[states]\nm = [1, 0, 0]\n[dynamics]\nm = "-m"', ["in quotes, found a list", "name the entries m1, m2", "b.states and b.parameters"]),
    ('[states]\ny = 1\n[dynamics]\ny = "-delay(y, 0.5)"', ["unknown function 'delay'", "states in a row come close"]),
    ('[states]\ny = 1\n[dynamics]\ny = "randn()"', ["unknown function 'randn'", "nothing in a run is random"]),
    ('[states]\ny = 1\n[dynamics]\ny = "-y"\n[[events]]\nwhen = "y - 0.5"\nset = { y = 1 }', ["an event records", "write it under [[jumps]]"]),
    ('[inputs]\nu = 1\n[states]\ny = 1\n[dynamics]\ny = "-y"', ["unknown table [inputs]", "declared under [controls]", "under [simulate]"]),
])
def test_a_file_is_told_what_is_meant(text, said):
    told = said_by(lambda: saltus.Model.from_text(f'[model]\nname = "m"\n{text}\n').simulate(until=1))
    assert all(words in told for words in said), told


@pytest.mark.parametrize("name, text, what", [
    ("m.ant", "S1 -> S2; k*S1\nk = 0.1\n", "Antimony"),
    ("m.txt", "// a loop\nmodel M\n  S1 -> S2; k*S1\nend\n", "Antimony"),
    ("m.cps", '<?xml version="1.0"?>\n<COPASI xmlns="http://www.copasi.org/static/schema"/>\n', "a model of COPASI"),
    ("m.mo", "Model ball\n Real x;\nequation\n der(x) = -x;\nend ball;\n", "Modelica"),
])
def test_files_of_others_are_named(tmp_path, name, text, what):
    (tmp_path / name).write_text(text)
    assert f"this is {what}, no model of Saltus" in said_by(lambda: saltus.Model(tmp_path / name))


def test_the_end_is_the_last_of_the_times_where_nothing_else_says_it(brake):
    b = saltus.Builder("decay")
    x = b.state("x", 1)
    b.rate(x, -x)
    assert b.simulate(times=[0.5, 2]).t.tolist() == b.model().simulate(output={"times": [0.5, 2]}).t.tolist() == [0.5, 2]
    assert b.model().sweep(x=[1, 2], times=[0.5, 2])["t"].tolist() == [2, 2]
    assert brake.simulate(times=[1, 2]).final.t == 6


def test_a_function_as_an_input_is_told(brake):
    b = saltus.Builder("m")
    x, u = b.state("x", 1), b.control("u")
    b.rate(x, u)
    text = said_by(lambda: b.simulate(until=1, inputs={"u": lambda t: t}))
    assert "a function of Python is called at no time" in text and "0.5*sin(t)" in text


def test_a_converter_rounds_at_its_samples():
    """floor of a state in `set` is the value at an instant."""
    m = saltus.Model.from_text(
        '[model]\nname = "adc"\n[states]\ny = 0\nus = 0\n[dynamics]\ny = "us - y"\nus = 0\n'
        '[[jumps]]\nevery = 0.1\nset = { us = "2*(1 - 0.25*floor(y/0.25))" }\n[simulate]\nuntil = 3\n')
    r = m.simulate()
    assert len(r.events) == 30
    y, us = 0.0, 0.0
    for event in r.events:
        y = us + (y - us) * np.exp(-0.1)
        assert event["y"] == pytest.approx(y, abs=1e-8)
        us = 2 * (1 - 0.25 * np.floor(y / 0.25))
        assert event["us(after)"] == pytest.approx(us, abs=1e-8)
    assert {round(us, 9) for us in r["us"].tolist()} >= {2, 1.5, 1}
    assert "for `set` of jumps" in said_by(lambda: saltus.Model.from_text(
        '[model]\nname = "m"\n[states]\ny = 0\n[dynamics]\ny = "1 - floor(y)"\n').simulate(until=1))
