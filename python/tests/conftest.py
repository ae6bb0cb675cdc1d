import os
import pathlib
import sys
import types

import pytest

import saltus

BRAKE = """
[model]
name = "brake"
[parameters]
mu = 2
[states]
x = 0
v = 3
[dynamics]
x = "v"
v = "-0.4*x - mu*sign(v)"
[simulate]
until = 6
"""

BLOCK = """
[model]
name = "block"
[states]
q = 0
v = 0
[controls]
u = { lower = -2, upper = 2 }
[dynamics]
q = "v"
v = "u - 0.5*sign(v)"
[optimize]
horizon = 2
control_intervals = 4
running_cost = "u^2"
terminal_constraints = ["q == 0.5", "v == 0"]
"""


@pytest.fixture
def brake():
    return saltus.Model.from_text(BRAKE, "brake.toml")


@pytest.fixture
def block():
    """A block with dry friction, and what is best for it."""
    return saltus.Model.from_text(BLOCK, "block.toml")


@pytest.fixture(scope="session")
def source():
    """The source tree."""
    return pathlib.Path(os.environ["SALTUS_TEST_SOURCE"])


@pytest.fixture(scope="session")
def tool():
    """The tool as a program of its own."""
    return os.environ["SALTUS_TEST_TOOL"]


@pytest.fixture
def close_figures():
    """For tests of pictures: what they draw is closed behind them."""
    from matplotlib import pyplot

    yield
    pyplot.close("all")


@pytest.fixture(scope="module")
def slip():
    return saltus.catalogue("stick-slip").simulate(until=20)


class Bar:
    made: list = []

    def __init__(self, **how):
        self.how, self.n, self.total, self.words = how, 0, None, []
        Bar.made.append(self)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        pass

    def update(self, more):
        self.n += more

    def set_postfix_str(self, text, refresh=True):
        self.words.append(text)


@pytest.fixture
def bars(monkeypatch):
    """Bars of progress, in the place of tqdm."""
    Bar.made = []
    monkeypatch.setitem(sys.modules, "tqdm", types.ModuleType("tqdm"))
    monkeypatch.setitem(sys.modules, "tqdm.auto", types.SimpleNamespace(tqdm=Bar))
    return Bar.made
