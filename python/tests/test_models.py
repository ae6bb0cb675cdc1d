"""Models: where they come from, what is wrong with them, what they are run with."""

import importlib
import pathlib
import pickle
import re
import subprocess
import sys
import warnings

import numpy as np
import pytest

import saltus
from saltus._spelling import in_python


def test_a_file_and_its_text_are_the_same_model(brake, tmp_path):
    from conftest import BRAKE

    file = tmp_path / "brake.toml"
    file.write_text(BRAKE)
    assert saltus.Model(file).name == brake.name == "brake"
    assert saltus.Model(str(file)).simulate().x.tolist() == brake.simulate().x.tolist()


def test_the_exact_solution(brake):
    """x'' = -0.4 x - 2 from (0, 3): with w^2 = 0.4 and c = 2/w^2 it is x = -c + c cos wt + 3/w sin wt until v = 0."""
    w = np.sqrt(0.4)
    c = 2 / 0.4
    stop = np.arctan2(3 / w, c) / w
    r = brake.simulate(rtol=1e-12, atol=1e-12)
    (event,) = [e for e in r.events if e.kind == "enter_sliding"]
    assert event.t == pytest.approx(stop, abs=1e-10)
    assert r.final["x"] == pytest.approx(-c + np.hypot(c, 3 / w), abs=1e-10)
    assert r.final["v"] == 0.0
    assert r.mode[-1].tolist() == [0]


def test_the_catalogue(source):
    assert saltus.models() == sorted(file.stem for file in (source / "models").rglob("*.toml"))
    with pytest.raises(saltus.ModelError, match="did you mean 'stick-slip'"):
        saltus.catalogue("stick-slipp")


def test_settings_change_parameters_initial_values_and_keys(brake):
    r = brake.simulate(set={"mu": 1, "v": 2.5, "dynamics.x": "2*v"})
    assert r.parameters == {"mu": 1.0}
    assert r["v"][0] == 2.5
    direct = saltus.Model.from_text(
        '[model]\nname = "b"\n[states]\nx = 0\nv = 2.5\n[dynamics]\nx = "2*v"\nv = "-0.4*x - 1*sign(v)"\n'
    ).simulate(until=6)
    assert direct.final["x"] == pytest.approx(r.final["x"], rel=1e-9)
    # The model itself is as it was.
    assert brake.simulate()["v"][0] == 3.0
    assert brake.simulate(set={"mu": 1, "v": 2.5, "dynamics.x": "2*v"}).x.tolist() == r.x.tolist()


def test_options_by_keyword(brake):
    r = brake.simulate(until=2, rtol=1e-11, integrator="dop853", points=5, event={"max_step": 0.1})
    stored = r.to_dict()["options"]
    assert stored["simulate.rtol"] == 1e-11
    assert stored["simulate.event.integrator"] == "dop853"
    assert stored["simulate.event.max_step"] == 0.1
    assert sorted(set(np.round(r.t, 12)) & {0.0, 0.5, 1.0, 1.5, 2.0}) == [0.0, 0.5, 1.0, 1.5, 2.0]
    fesd = brake.simulate(method="fesd", stages=3, steps=20, sensitivities=True)
    assert fesd.method == "fesd"
    assert fesd.sensitivities.x0.shape == (2, 2)
    assert fesd.sensitivities.parameters == ["mu"]
    stepping = brake.simulate(method="timestepping", stages=1, steps=10)
    assert stepping.to_dict()["options"]["simulate.timestepping.stages"] == 1


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"rtoll": 1e-8}, ["rtoll", "did you mean 'rtol'"]),
        ({"rtol": -1}, ["rtol=-1", "> 0"]),
        ({"integrator": "dopri"}, ["integrator='dopri'", "dopri5"]),
        ({"until": float("nan")}, ["until"]),
        ({"set": {"muu": 1}}, ["muu", "did you mean 'mu'"]),
        ({"set": {"dynamics.w": "1"}}, ["dynamics.w"]),
        ({"event": {"integrato": "dop853"}}, ["event.integrato"]),
        ({"start": 3}, ["start"]),
    ],
)
def test_misspelt_options_are_told_as_by_the_tool(brake, options, words):
    with pytest.raises(saltus.ModelError) as refused:
        brake.simulate(**options)
    for word in words:
        assert word in str(refused.value)


def test_values_that_no_option_can_have(brake):
    with pytest.raises(TypeError, match="found object"):
        brake.simulate(rtol=object())
    with pytest.raises(saltus.ModelError, match="from_text"):
        saltus.Model("[model]\nname = 'x'\n")


def test_an_option_without_effect_is_a_warning(brake):
    with pytest.warns(saltus.ModelWarning, match="has no effect"):
        brake.simulate(epsilon=1e-3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        brake.simulate(rtol=1e-6)


def test_every_message_of_the_golden_tests(source, tool, tmp_path, monkeypatch):
    """The same text, line and column as the tool says of every malformed file."""
    monkeypatch.syspath_prepend(str(source / "tests" / "golden"))
    topics = [importlib.import_module(f"malformed.{name}") for name in ("texts", "names", "values", "expressions", "tables")]
    monkeypatch.chdir(tmp_path)
    cases = [case for topic in topics for case in topic.FILES.values()]
    assert len(cases) >= 150
    file = pathlib.Path("m.toml")
    for content, *_ in cases:
        if len(content) > 100_000:
            continue  # the same messages, slowly
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
        said = subprocess.run([tool, "simulate", file], capture_output=True, text=True).stderr
        with warnings.catch_warnings(), pytest.raises(saltus.ModelError) as refused:
            warnings.simplefilter("ignore")
            saltus.Model(file).simulate()
        error = refused.value
        # Beside the text the tool shows the line.
        text = "\n".join(line for line in said.splitlines() if not re.match(r" +\d* *\| ?", line))
        assert in_python(text).endswith(str(error).rstrip("\n"))
        place = f"{error.file}:{error.line}:{error.column}:" if error.line else f"{error.file}: "
        assert str(error).startswith(place)
        assert error.message in str(error) or len(error.message) > 1000 or "\\x" in str(error)
        again = pickle.loads(pickle.dumps(error))
        assert (str(again), again.line, again.remedy) == (str(error), error.line, error.remedy)


def test_models_pickle(brake):
    again = pickle.loads(pickle.dumps(brake))
    assert again.simulate().x.tolist() == brake.simulate().x.tolist()
    assert pickle.loads(pickle.dumps(saltus.catalogue("stick-slip"))).name == "stick-slip"


def test_check_is_that_of_the_tool(tool):
    said = subprocess.run([tool, "check", "two-belts"], capture_output=True, text=True, check=True).stdout
    assert saltus.catalogue("two-belts").check() == said


def test_the_tool_itself():
    run = [sys.executable, "-m", "saltus"]
    done = subprocess.run([*run, "simulate", "stick-slip", "--until", "2"], capture_output=True, text=True)
    assert done.returncode == 0
    assert "completed" in done.stdout
    done = subprocess.run([*run, "simulat"], capture_output=True, text=True)
    assert done.returncode == 2
    assert "did you mean 'simulate'" in done.stderr


def test_equations_and_card_of_every_model():
    for name in saltus.models():
        m = saltus.catalogue(name)
        plain, latex = m.equations(), m.equations(latex=True)
        assert len(plain) == len(latex) > 0
        assert [where for *_, where in plain] == [where for *_, where in latex]
        for _, right, _ in latex:
            assert right.count("{") == right.count("}"), (name, right)
            assert right.count("\\left") == right.count("\\right"), (name, right)
        card = m._repr_html_()
        assert len(card) < 100_000 and "<script" not in card


def test_events_say_what_they_are(brake):
    assert repr(brake.simulate().events[0]).startswith("<enter_sliding of ")
