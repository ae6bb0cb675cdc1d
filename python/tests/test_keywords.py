"""Options as keywords: in signatures, in help, for whoever checks types and whoever presses TAB."""

import inspect
import os
import pydoc
import subprocess
import sys

import pytest

import saltus

CALLS = [saltus.Model.simulate, saltus.Model.compare, saltus.Model.order, saltus.Model.sweep, saltus.compare, saltus.order,
         saltus.Builder.simulate, saltus.Builder.compare, saltus.Builder.order, saltus.Builder.sweep]


def last_words(table):
    found = [option["key"].removesuffix(".*").rpartition(".")[2] for option in saltus._core.option_tables()[table]]
    return {"from_" if word == "from" else word for word in found}


@pytest.mark.parametrize("call", CALLS, ids=lambda call: call.__qualname__)
def test_every_option_of_a_simulation_is_a_keyword(call):
    names = set(inspect.signature(call).parameters)
    assert last_words("simulate") | {"inputs", "fesd", "event", "smoothed", "timestepping", "set"} <= names
    assert len(last_words("simulate")) > 35


@pytest.mark.parametrize("call", [saltus.Model.optimize, saltus.Builder.optimize], ids=lambda call: call.__qualname__)
def test_every_option_of_an_optimisation_is_a_keyword(call):
    names = set(inspect.signature(call).parameters)
    assert last_words("optimize") | last_words("problem") | {"start", "set", "progress"} <= names


def test_every_option_of_a_foreign_problem_is_a_keyword():
    assert last_words("mpcc") | {"time_limit", "start"} <= set(inspect.signature(saltus.mpcc).parameters)


def test_only_a_sweep_takes_other_keywords():
    """They are names of the model."""
    kinds = {call: [one.kind for one in inspect.signature(call).parameters.values()] for call in CALLS}
    for call, found in kinds.items():
        assert (inspect.Parameter.VAR_KEYWORD in found) == call.__qualname__.endswith("sweep"), call


def test_help_tells_types_units_and_defaults():
    text = pydoc.plain(pydoc.render_doc(saltus.Model.simulate))
    assert "rtol: a finite number > 0; default 1e-08. Relative error tolerance of a step, per component" in text
    assert "atol: a finite number >= 0; default 1e-10. Absolute error tolerance of a step, in the units of the states" in text
    assert "'auto' | 'dopri5' | 'dop853'" in text
    assert "max_steps: 'int | None' = None" in text


def test_the_module_of_types_is_that_of_the_table(source):
    script = source / "scripts" / "python_keywords.py"
    made = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False,
                          env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)})
    assert made.returncode == 0, made.stderr
    assert made.stdout == (source / "python" / "saltus" / "_keywords.py").read_text(), f"run {script}"


RIGHT = """
import numpy as np
import saltus

m = saltus.catalogue("stick-slip")
r = m.simulate(until=5, rtol=1e-10, integrator="dop853", points=10, set={"belt": 0.3}, output={"every": 0.1, "events": False})
t: float = r.events[0].t
kinds: list[str] = r.events.kind
first: saltus.Event = r.events[0]
some: saltus.Events = r.events[:2]
m.simulate(until=10, start=r, method="fesd", fesd={"stages": 3})
m.sweep(belt=np.linspace(0.1, 0.3, 5), until=5, keep="events")
m.sweep(rtol=[1e-6, 1e-8], until=5)
m.order(until=1, schemes=[("radau_iia", 2)], steps=[10, 20], max_step=0.1)
b = saltus.Builder("b")
b.simulate(until=3, integrator="taylor")
b.optimize(control_intervals=4, tolerance=1e-8, terminal_constraints=[b.state("x", 0) == 1])
m.optimize(start=r, elements=[1, 2], solver="ipopt")
"""
WRONG = """
import saltus

m = saltus.catalogue("stick-slip")
m.simulate(until=5, rtoll=1e-10)
m.simulate(until=5, integrator="dop999")
m.simulate(until=5, max_steps="many")
m.optimize(control_interval=4)
m.compare(until=5, fesd={"stage": 3})
saltus.Builder("b").simulate(until=1, pointz=3)
"""


def test_mypy_knows_every_option(source, tmp_path):
    pytest.importorskip("mypy")
    (tmp_path / "right.py").write_text(RIGHT)
    (tmp_path / "wrong.py").write_text(WRONG)
    run = subprocess.run([sys.executable, "-m", "mypy", "--strict", "--follow-imports", "silent", "--cache-dir", str(tmp_path / "cache"), "right.py", "wrong.py"],
                         cwd=tmp_path, capture_output=True, text=True, check=False,
                         env={**os.environ, "MYPYPATH": str(source / "python")})
    lines = [line for line in run.stdout.splitlines() if ": error: " in line]
    assert [line for line in lines if not line.startswith("wrong.py")] == [], run.stdout
    assert {int(line.split(":")[1]) for line in lines} == {5, 6, 7, 8, 9, 10}, run.stdout
