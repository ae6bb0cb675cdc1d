"""Pictures, tables and the card of a notebook."""

import re
import xml.etree.ElementTree

import matplotlib
import numpy as np
import pytest

import saltus

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


@pytest.fixture(autouse=True)
def close_figures():
    yield
    pyplot.close("all")


@pytest.fixture(scope="module")
def slip():
    return saltus.catalogue("stick-slip").simulate(until=20)


@pytest.fixture(scope="module")
def ball():
    return saltus.catalogue("bouncing-ball").simulate()


def test_curves_over_time(slip, tmp_path):
    axes = slip.plot()
    assert [axis.get_ylabel() for axis in axes] == slip.states
    curve = axes[1].lines[0]
    assert curve.get_xdata().tolist() == slip.t.tolist()
    assert curve.get_ydata().tolist() == slip["v"].tolist()
    shaded = [patch.get_extents() for patch in axes[0].patches]
    sticks = [e.t for e in slip.events if e.kind == "enter_sliding"]
    assert len(shaded) == len(sticks)
    axes[0].figure.savefig(tmp_path / "plot.png")
    figure, own = pyplot.subplots()
    assert slip.plot(["v"], axes=own) == [own]
    with pytest.raises(KeyError, match="known|did you mean"):
        slip.plot(["w"])


def test_results_over_each_other_can_be_told_apart(slip):
    other = saltus.catalogue("stick-slip").simulate(until=20, set={"belt": 0.3})
    axes = other.plot(axes=slip.plot(label="belt 0.2"), label="belt 0.3")
    for axis in (*axes, other.phase("q", "v", slip.phase("q", "v", label="a"), label="b")):
        lines = [line for line in axis.lines if line.get_gid() == "saltus"]
        assert len({line.get_color() for line in lines}) == len(lines) == 2
    assert [text.get_text() for text in axes[0].get_legend().get_texts()] == ["belt 0.2", "belt 0.3"]
    assert slip.plot()[0].get_legend() is None


def test_the_sides_of_a_jump_are_not_joined(ball):
    (axis, *_) = ball.plot([ball.states[1]])
    x, y = (np.asarray(data) for data in axis.lines[0].get_data())
    for event in ball.events:
        if event.kind != "jump":
            continue
        (between,) = np.flatnonzero(np.isnan(y) & (np.abs(np.interp(np.arange(len(x)), np.flatnonzero(~np.isnan(x)), x[~np.isnan(x)]) - event.t) < 1e-12))[:1]
        assert y[between - 1] == pytest.approx(event.x[1])
        assert y[between + 1] == pytest.approx(event.x_after[1])
        break
    assert np.isnan(y).sum() == sum(abs(e.x_after[1] - e.x[1]) > 1e-6 * np.ptp(ball["v"]) for e in ball.events)


def test_a_jump_between_two_rows_is_not_joined():
    """Of a result without rows at events curves have the sides of the event, and so have the marks of events."""
    m = saltus.catalogue("bouncing-ball")
    r = m.simulate(until=3, output={"every": 0.1, "events": False})
    (axis,) = r.plot(["v"])
    x, y = (np.asarray(data, dtype=float) for data in axis.lines[0].get_data())
    (gap,) = np.flatnonzero(np.isnan(y))
    (jump,) = r.events
    assert (x[gap - 1], y[gap - 1]) == (jump.t, jump.x[1]) and (x[gap + 1], y[gap + 1]) == (jump.t, jump.x_after[1])
    assert f"{y.min():.3g}</text>" in r._repr_html_() and y.min() == jump.x[1]
    (mark,) = [line for line in axis.lines if line.get_label() == "jump"]
    assert [data.tolist() for data in map(np.asarray, mark.get_data())] == [[r.events[0].t], [r.events[0].x[1]]]
    assert len(m.simulate(until=3, output={"times": [0, 0.1], "events": False}).plot()) == 2


def test_some_states_only():
    """Of a run that has rows of some states only these are drawn."""
    r = saltus.catalogue("bouncing-ball").simulate(until=3, output={"states": ["v"]})
    assert [axis.get_ylabel() for axis in r.plot()] == ["v"]
    assert "<svg" in r._repr_html_() and ">v</text>" in r._repr_html_()


def relay():
    m = saltus.Builder("relay")
    x, v = m.state("x", 1, unit="m", label="way"), m.state("v", 0, unit="m/s")
    m.rate(x, v)
    m.rate(v, -saltus.sign(x) - 0.1 * v)
    m.output("u", -saltus.sign(x))
    return m


def test_an_output_that_switches_is_not_joined():
    r = relay().simulate(until=5)
    way, _, u = r.plot()
    assert np.isnan(u.lines[0].get_ydata()).sum() == len(r.events) > 1
    assert not np.isnan(way.lines[0].get_ydata()).any()


def test_an_output_that_no_row_has_at_an_event_is_not_joined():
    r = relay().simulate(until=5, output={"every": 0.5, "events": False})
    (u,) = r.plot(["u"])
    x, y = (np.asarray(data, dtype=float) for data in u.lines[0].get_data())
    for event in r.events:
        assert np.isnan(y[x == event.t]).all() and (x == event.t).sum() == 2


def test_a_value_alone_between_events_is_seen():
    r = relay().simulate(until=5, output={"times": [0, 2, 4.9], "events": False})
    (line,) = (line for line in r.plot(["u"])[0].lines if line.get_gid() == "saltus")
    dots = line.get_markevery()
    assert line.get_marker() == "." and np.asarray(line.get_xdata())[dots].tolist() == [0, 2, 4.9]


def test_axes_have_labels_and_units():
    r = relay().simulate(until=5)
    assert [axis.get_ylabel() for axis in r.plot()] == ["way [m]", "v [m/s]", "u"]
    axis = r.phase("x", "v")
    assert (axis.get_xlabel(), axis.get_ylabel()) == ("way [m]", "v [m/s]")


def test_pictures_of_sweeps(slip):
    m = saltus.catalogue("stick-slip")
    s = m.sweep(belt=np.linspace(0.3, 0.1, 5), q=[0, 0.1], until=5)
    axis = s.plot("v")
    assert (axis.get_xlabel(), axis.get_ylabel()) == ("belt", "v")
    first = axis.lines[0]
    assert first.get_xdata().tolist() == sorted(np.linspace(0.3, 0.1, 5).tolist())
    assert first.get_ydata().tolist() == s["v"][s["q(0)"] == 0][::-1].tolist()
    assert [line.get_label() for line in axis.lines] == ["q(0) = 0", "q(0) = 0.1"]
    assert len(s.plot("events", over="q").lines) == 5
    with pytest.raises(KeyError, match="belt"):
        s.plot("v", over="mu")
    with pytest.raises(KeyError, match="has no 'w'"):
        s.plot("w")
    with pytest.raises(ValueError, match='keep="events"'):
        s.bifurcation("v")


def test_bifurcation_diagrams():
    m = saltus.catalogue("stick-slip")
    s = m.sweep(belt=[0.1, 0.2, 0.3], until=40, keep="events")
    points = s.bifurcation("q", event="leave_sliding", after=20).lines[0]
    kept = (s["kind"] == "leave_sliding") & (s["t"] > 20)
    assert 0 < kept.sum() < len(s["t"])
    assert points.get_xdata().tolist() == s["belt"][kept].tolist()
    assert points.get_ydata().tolist() == s["q"][kept].tolist()
    assert len(s.bifurcation("v").lines[0].get_xdata()) == len(s["t"])
    with pytest.raises(KeyError, match="leave_sliding"):
        s.bifurcation("q", event="leaves_sliding")
    with pytest.raises(ValueError, match='keep="final"'):
        s.plot("q")


def test_a_builder_in_a_notebook_before_it_is_complete():
    m = saltus.Builder("m")
    x = m.state("x", 1)
    assert "not yet a model: the state &#x27;x&#x27; has no rate" in m._repr_html_()
    m.rate(x, -x)
    assert "dot{x}" in m._repr_html_()


def test_phase_plane(slip):
    axis = slip.phase("q", "v")
    across, up = axis.lines[0].get_data()
    assert across.tolist() == slip["q"].tolist()
    assert up.tolist() == slip["v"].tolist()
    held = np.asarray(axis.lines[1].get_xdata())
    assert np.isnan(held).any() and not np.isnan(held).all()


def test_tables(slip):
    table = slip.frame()
    assert table.index.name == "t"
    assert list(table.columns[:2]) == slip.states
    assert table["v"].to_numpy().tolist() == slip["v"].tolist()
    events = slip.events.table()
    assert events["t"].tolist() == [e.t for e in slip.events]
    data = slip.dataset()
    assert data["v"].dims == ("row",)
    assert data.attrs["parameter.belt"] == 0.2


@pytest.mark.parametrize("name", ["stick-slip", "bouncing-ball", "relay-feedback", "two-belts", "turbo-car"])
def test_the_card_is_small_and_well_formed(name):
    try:
        r = saltus.catalogue(name).simulate()
    except saltus.ModelError:
        r = saltus.catalogue(name).simulate(until=1)
    html = r._repr_html_()
    assert len(html) < 100_000
    assert "<script" not in html
    tree = xml.etree.ElementTree.fromstring(html.replace("&nbsp;", " "))
    picture = tree.find(".//{http://www.w3.org/2000/svg}svg")
    assert picture is not None
    assert len(picture.findall("{http://www.w3.org/2000/svg}path")) == min(6, len(r.states) + len(r.controls))
    for number in re.findall(r"[ML](-?[\d.]+) (-?[\d.]+)", html):
        assert 0 <= float(number[0]) <= 520


def test_what_is_not_installed_is_told(slip, monkeypatch):
    import builtins

    real = builtins.__import__
    import importlib

    def without(name, package=None):
        if name.startswith("pandas"):
            raise ImportError(name)
        return real(name)

    monkeypatch.setattr(importlib, "import_module", without)
    with pytest.raises(ImportError, match=r"pip install 'saltus\[data\]'"):
        slip.frame()


def test_contacts_are_seen():
    r = saltus.catalogue("sliding-ball").simulate()
    impact = next(event for event in r.events if event.kind == "impact")
    assert impact.contact_modes_before != impact.contact_modes_after
    assert len(impact.impulse) == len(impact.contact_modes_after) and impact.impulse[0][0] > 0
    curve = r.plot(["vz"])[0].lines[0]
    assert np.isnan(curve.get_ydata()).any()


def test_what_cannot_be_drawn_is_told(slip):
    with pytest.raises(ValueError, match="one for each of"):
        slip.plot(axes=[1])
    with pytest.raises(TypeError, match="by its name"):
        slip[0]


def test_what_a_builder_gave_is_a_name():
    m = saltus.Builder("relay")
    x = m.state("x", 1)
    v = m.state("v", 0)
    m.rate(x, v)
    m.rate(v, -v - 2 * saltus.sign(x + v))
    r = m.simulate(until=3)
    assert r[x].tolist() == r["x"].tolist()
    assert [axis.get_ylabel() for axis in r.plot([x, v])] == ["x", "v"]
    assert r.phase(x, v).get_xlabel() == "x"
    with pytest.raises(TypeError, match=r'r.plot\(\["x", "v"\]\)'):
        r.plot("x", "v")
    s = m.sweep({v: [0, 1]}, until=3)
    assert s.plot(x).get_ylabel() == "x" and s[x].tolist() == s["x"].tolist()


def test_units_of_a_run_of_a_sweep():
    m = saltus.Model.from_text(
        '[model]\nname = "m"\n[parameters]\nk = 1\n[states]\nx = { initial = 1, unit = "m", label = "position" }\n'
        '[dynamics]\nx = "-k*x"\n[simulate]\nuntil = 1\n'
    )
    alone = [axis.get_ylabel() for axis in m.simulate().plot()]
    assert alone == ["position [m]"]
    of_sweep = m.sweep(k=[1, 2], keep="trajectory").results[1]
    assert [axis.get_ylabel() for axis in of_sweep.plot()] == alone
    assert m.sweep(k=[1, 2]).plot("x").get_ylabel() == "position [m]"
    assert m.sweep(x=[1, 2]).plot("x").get_xlabel() == "position [m]"
