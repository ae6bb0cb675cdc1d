"""What goes to another process and comes back, and what is copied."""

import copy
import pickle

import numpy as np
import pytest

import saltus

PARTS = (
    "t kind name turned surfaces mode_before mode_after alpha_before alpha_after regions_before regions_after contact_modes_before "
    "contact_modes_after impulse x x_after unique reason"
).split()


def there_and_back(value):
    return pickle.loads(pickle.dumps(value))


def parts(event):
    values = [getattr(event, name) for name in PARTS]
    values += [(other.mode, other.alpha.tolist(), other.regions) for other in event.alternatives]
    met = event.intersection
    values.append(met and (met.surfaces, met.velocities, met.alpha_before, met.alpha_after))
    # Of arrays the numbers, of which nan is equal to itself in a text.
    return repr([value.tolist() if isinstance(value, np.ndarray) else value for value in values])


#: Sliding, jumps, impulses of contacts, regions, alternatives, names, accumulations.
NAMES = ["stick-slip", "bouncing-ball", "sliding-ball", "stay-or-leave", "thermostat", "two-belts", "quadrants", "frozen-hysteresis", "temperature-control", "three-windings",
         "slide-and-hide"]


@pytest.mark.parametrize("name", NAMES)
def test_events(name):
    events = saltus.catalogue(name).simulate().events
    assert len(events) > 0
    for how in (there_and_back, copy.copy, copy.deepcopy):
        again = how(events)
        assert type(again) is saltus.Events
        assert list(map(parts, again)) == list(map(parts, events))
        one = how(events[0])
        assert type(one) is saltus.Event
        assert parts(one) == parts(events[0]) and repr(one) == repr(events[0])
    assert there_and_back(list(events))[0].t == events[0].t
    assert events[:2].table().equals(there_and_back(events[:2].table()))
    for event in events:
        for other in event.alternatives:
            assert (there_and_back(other).mode, there_and_back(other).regions) == (other.mode, other.regions)


def test_all_kinds_of_events_are_tried():
    seen = {e.kind for name in NAMES for e in saltus.catalogue(name).simulate().events}
    assert seen >= {"enter_sliding", "leave_sliding", "crossing", "jump", "impact", "accumulation"}


def test_results(brake):
    r = brake.simulate(method="fesd", steps=10, sensitivities=True)
    again = there_and_back(r)
    assert again.x.tobytes() == r.x.tobytes()
    assert again.sensitivities.p.tolist() == r.sensitivities.p.tolist()
    assert (again.status, again.status.message, again.status.done) == (r.status, r.status.message, r.status.done)
    assert again.parameters == r.parameters and again.names == r.names
    assert repr(again) == repr(r)
    assert copy.copy(r).final.x.tolist() == copy.deepcopy(r).final.x.tolist() == r.final.x.tolist()
    status = there_and_back(r.status)
    assert (status, status.message, status.time_reached, status.done) == ("completed", "", 6.0, True)
    assert there_and_back(r.final)["x"] == r.final["x"]
    branched = saltus.catalogue("stay-or-leave").simulate(branches="all")
    assert [b.x.tobytes() for b in there_and_back(branched).branches] == [b.x.tobytes() for b in branched.branches]


def test_sweeps(brake):
    for keep in ("final", "events", "trajectory"):
        s = brake.sweep(mu=[1, 2], keep=keep)
        again = there_and_back(s)
        assert repr(again) == repr(s) and len(again) == 2
        assert list(again.table) == list(s.table)
        for name in s.table:
            assert again[name].tolist() == s[name].tolist()
        assert again.results[1].final.x.tolist() == s.results[1].final.x.tolist()
        assert [repr(r) for r in again.results] == [repr(r) for r in s.results]
        assert [str(r) for r in again.results] == [str(r) for r in s.results]
    assert there_and_back(brake.sweep(mu=[1, 2])).dataset()["x"].shape == (2,)


def test_models(brake, tmp_path):
    assert there_and_back(brake).simulate().x.tobytes() == brake.simulate().x.tobytes()
    m = saltus.Builder("decay")
    x = m.state("x", 1)
    m.rate(x, -x)
    assert there_and_back(m.model()).name == "decay"
    again = there_and_back(m)
    assert again.to_toml() == m.to_toml()
    again.output("y", again.state("z", 0))
    with pytest.raises(saltus.ModelError, match="another builder"):
        again.output("w", x)
    assert str(there_and_back(x > 0)) == "x>0"


def test_exceptions(brake):
    with pytest.raises(saltus.Stopped) as stopped:
        brake.simulate(max_steps=3).require()
    again = there_and_back(stopped.value)
    assert str(again) == str(stopped.value)
    assert again.result.x.tobytes() == stopped.value.result.x.tobytes()
    with pytest.raises(saltus.ModelError) as refused:
        saltus.Model.from_text('[model]\nname = "m"\n[states]\nx = "1 +"\n', "m.toml")
    again = there_and_back(refused.value)
    for name in ("message", "remedy", "file", "line", "column", "code"):
        assert getattr(again, name) == getattr(refused.value, name)
    assert str(copy.copy(refused.value)) == str(refused.value)
