"""What one finds by TAB, and what cannot be assigned."""

import copy
import pickle

import numpy as np
import pytest

import saltus


def test_names_of_columns_events_and_parameters_are_completed(brake):
    r = brake.simulate()
    assert r._ipython_key_completions_() == r.names
    assert r.final._ipython_key_completions_() == ["x", "v"]
    assert r.parameters._ipython_key_completions_() == ["mu"]
    assert brake.parameters._ipython_key_completions_() == ["mu"]
    assert brake.states._ipython_key_completions_() == ["x", "v"]
    assert r.events._ipython_key_completions_() == ["enter_sliding", *r.events[0].surfaces]
    s = brake.sweep(mu=[1, 2])
    assert set(s._ipython_key_completions_()) == set(s.table)


def test_events_have_their_times_and_sorts():
    r = saltus.catalogue("bouncing-ball").simulate(until=5)
    assert r.events.t.tolist() == [event.t for event in r.events]
    assert r.events.t.dtype == float
    assert r.events.x.shape == (len(r.events), 2)
    assert np.array_equal(r.events.x_after[0], r.events[0].x_after)
    bounces = r.events["bounce"]
    assert isinstance(bounces, saltus.Events)
    assert bounces.kind == ["jump"] * len(bounces)
    assert len(r.events["impact"]) == 0  # a kind that did not happen
    with pytest.raises(KeyError, match="bounce"):
        r.events["bonuce"]
    assert saltus.Events().t.shape == (0,)


def test_one_event_is_one(brake):
    r = brake.simulate()
    assert len(r.events) == 1
    assert "1 event, " in repr(r)


def test_parameters_are_not_assigned(brake):
    with pytest.raises(saltus.ModelError) as refused:
        brake.parameters["mu"] = 0.3
    assert refused.value.remedy == 'change it in the call: m.simulate(set={"mu": 0.3})'
    for change in (lambda p: p.update(mu=1), lambda p: p.pop("mu"), lambda p: p.clear(), lambda p: p.__delitem__("mu")):
        with pytest.raises(saltus.ModelError):
            change(brake.parameters)
    with pytest.raises(saltus.ModelError, match="cannot be assigned"):
        brake.states["x"] = 1
    with pytest.raises(saltus.ModelError, match="what was computed"):
        brake.simulate().parameters["mu"] = 1
    assert brake.parameters == {"mu": 2.0}
    mine = dict(brake.parameters)
    mine["mu"] = 3
    assert {**brake.parameters, "mu": 3} == mine
    assert pickle.loads(pickle.dumps(brake.parameters)) == {"mu": 2.0}
    assert copy.copy(brake.parameters) == {"mu": 2.0}
