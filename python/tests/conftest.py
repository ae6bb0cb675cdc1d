import os
import pathlib

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


@pytest.fixture
def brake():
    return saltus.Model.from_text(BRAKE, "brake.toml")


@pytest.fixture(scope="session")
def source():
    """The source tree."""
    return pathlib.Path(os.environ["SALTUS_TEST_SOURCE"])


@pytest.fixture(scope="session")
def tool():
    """The tool as a program of its own."""
    return os.environ["SALTUS_TEST_TOOL"]
