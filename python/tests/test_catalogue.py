"""All models of the catalogue, stated a second time by the Builder, are the same bit by bit."""

import pathlib
import warnings

import numpy as np
import pytest

import saltus

tomllib = pytest.importorskip("tomllib")
from catalogue_in_python import restated  # noqa: E402

OF_EVENTS = (
    "t kind name surfaces mode_before mode_after alpha_before alpha_after regions_before regions_after contact_modes_before "
    "contact_modes_after impulse x x_after unique reason"
).split()


def bits(value):
    return value.tobytes() if isinstance(value, np.ndarray) else value


@pytest.mark.parametrize("name", saltus.models())
def test_a_model_and_its_restatement(name):
    shipped = saltus.catalogue(name)
    built = restated(pathlib.Path(shipped.path))
    stated = built.model()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", saltus.ModelWarning)
        a, b = shipped.simulate(), stated.simulate()
    for part in ("t", "x", "u", "alpha", "mode", "outputs"):
        assert getattr(a, part).tobytes() == getattr(b, part).tobytes(), part
    assert [[bits(getattr(e, part)) for part in OF_EVENTS] for e in a.events] == [
        [bits(getattr(e, part)) for part in OF_EVENTS] for e in b.events
    ]
    assert (a.status, a.status.time_reached) == (b.status, b.status.time_reached)
    assert a.names == b.names and a.parameters == b.parameters
    assert a.final.x.tobytes() == b.final.x.tobytes()
    # All that `check` says is said of both, but for parentheses that are not needed.
    assert shipped.states == stated.states
    assert without_parentheses(shipped.check().replace(shipped.path, stated.path)) == without_parentheses(stated.check())


def without_parentheses(text):
    return text.translate({ord("("): None, ord(")"): None})
