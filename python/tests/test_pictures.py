"""Pictures, tables and the card of a notebook."""

import re
import xml.etree.ElementTree

import matplotlib
import numpy as np
import pytest

import saltus

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


pytestmark = pytest.mark.usefixtures("close_figures")


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
    assert f"{np.nanmin(y):.3g}</text>" in r._repr_html_() and np.nanmin(y) == jump.x[1]
    (mark,) = [line for line in axis.lines if line.get_label() == "jump"]
    assert [data.tolist() for data in map(np.asarray, mark.get_data())] == [[r.events[0].t], [r.events[0].x[1]]]
    assert len(m.simulate(until=3, output={"times": [0, 0.1], "events": False}).plot()) == 2


def test_some_states_only():
    """Of a run that has rows of some states only these are drawn."""
    r = saltus.catalogue("bouncing-ball").simulate(until=3, output={"states": ["v"]})
    assert [axis.get_ylabel() for axis in r.plot()] == ["v"]
    assert "<svg" in r._repr_html_() and ">v</tspan>" in r._repr_html_()


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


SERVO = """
[model]
name = "servo"
[states]
angle = { initial = 0, unit = "rad", label = "position" }
speed = 0
[[hysteresis]]
name = "forward"
input = "1 - angle"
on = 0.10
off = 0.06
initial = 1
[[hysteresis]]
name = "backward"
input = "angle - 1"
on = 0.10
off = 0.06
[dynamics]
angle = "speed"
speed = "60*(forward - backward) - 5*speed"
[outputs]
u = { value = "6*(forward - backward)", unit = "V", label = "voltage" }
[simulate]
until = 3
"""


@pytest.fixture(scope="module")
def servo():
    return saltus.Model.from_text(SERVO)


def marked(axis):
    return [line for line in axis.lines if line.get_label() in ("jump", "user", "crossing")]


def test_what_changes_at_events_only_has_steps(servo):
    r = servo.simulate()
    angle, _, forward, backward, u = r.plot()
    turns = {name: [e.t for e in r.events if e.name == name] for name in ("forward", "backward")}
    assert len(turns["forward"]) > 3 and len(turns["backward"]) > 3
    for axis, times in ((forward, turns["forward"]), (backward, turns["backward"]), (u, sorted(sum(turns.values(), [])))):
        curve, edges = axis.lines[:2]
        assert np.isnan(curve.get_ydata()).sum() == len(times)
        across, up = (np.asarray(data).reshape(-1, 3) for data in edges.get_data())
        assert across[:, 0].tolist() == across[:, 1].tolist() == times and np.isnan(up[:, 2]).all()
        assert (np.abs(up[:, 1] - up[:, 0]) == (6 if axis is u else 1)).all()
        assert edges.get_color() == curve.get_color() and edges.get_linewidth() < curve.get_linewidth()
    # What the edges show has no marks beside.
    assert [len(line.get_xdata()) for line in marked(angle)] == [len(r.events)]
    assert [list(line.get_xdata()) for line in marked(forward)] == [turns["backward"]] and marked(u) == []


def test_labels_lie_within_the_figure(servo):
    axes = servo.simulate().plot()
    axes[0].figure.draw_without_rendering()
    assert min(axis.yaxis.label.get_window_extent().x0 for axis in axes) >= 0


def test_many_events_are_marked_if_asked_for(servo):
    few, many = servo.simulate(), servo.simulate(until=20)
    assert len(few.events) <= 100 < len(many.events)
    assert marked(few.plot(["angle"])[0]) and marked(few.phase("angle", "speed"))
    assert not marked(few.plot(["angle"], events=False)[0]) and not marked(few.phase("angle", "speed", events=False))
    assert not marked(many.plot(["angle"])[0]) and not marked(many.phase("angle", "speed"))
    (all_of_them,) = marked(many.plot(["angle"], events=True)[0])
    assert len(all_of_them.get_xdata()) == len(many.events)


SVG = "{http://www.w3.org/2000/svg}"


def card(r):
    return xml.etree.ElementTree.fromstring(r._repr_html_().replace("&nbsp;", " "))


def test_the_card_has_ticks_for_all_of_a_run(servo):
    r = servo.simulate(until=40)
    picture = card(r).find(f".//{SVG}svg")
    ticks = [re.findall(r"M([\d.]+) ", path.get("d")) for path in picture.findall(f"{SVG}path[@class='events']")]
    assert len(ticks) == 5 and all(one == ticks[0] for one in ticks)
    places = np.array(ticks[0], dtype=float)
    assert 50 < len(places) < len(r.events) and places.max() > 500
    assert np.diff(places).max() < 520 / 40
    words = ["".join(text.itertext()) for text in picture.iter(f"{SVG}text")]
    assert f"ticks: {len(places)} of {len(r.events)} events" in words
    assert "ticks: " not in servo.simulate(until=0.3)._repr_html_()


def test_the_card_shades_all_of_a_run():
    r = saltus.catalogue("stick-slip").simulate(until=3000)
    assert len(r.events) > 500
    shaded = card(r).find(f".//{SVG}path[@class='sliding']").get("d")
    assert max(float(x) for x in re.findall(r"H([\d.]+)", shaded)) > 500
    assert len(r._repr_html_()) < 100_000


def test_the_card_has_steps_units_and_outputs(servo):
    r = servo.simulate(until=40)
    picture = card(r).find(f".//{SVG}svg")
    words = ["".join(text.itertext()) for text in picture.iter(f"{SVG}text")]
    assert {"angle [rad] position", "speed", "forward", "u [V] voltage"} <= set(words)
    *_, forward, backward, u = (path.get("d") for path in picture.findall(f"{SVG}path[@class='curve']"))
    for path, name in ((forward, "forward"), (backward, "backward"), (u, None)):
        assert set(re.findall("[A-Za-z]", path)) == {"M", "h", "H", "V"}
        assert path.count("V") == sum(name in (None, e.name) for e in r.events)
    assert len(r._repr_html_()) < 60_000


def test_the_card_says_what_it_leaves_out():
    m = saltus.Builder("many")
    for number in range(9):
        m.rate(m.state(f"x{number}", 1), -1)
    m.output("y", m.define("z", 2))
    html = m.simulate(until=1)._repr_html_()
    assert "and 4 more columns" in html and ">y</tspan>" in html and ">x4</tspan>" in html and ">x5</tspan>" not in html


def test_a_hysteresis_says_what_it_turned_to(servo):
    r = servo.simulate()
    first = r.events[0]
    assert (first.name, first.turned) == ("forward", "off") and repr(first).startswith("<jump of forward off at t = 0.")
    turned = [e.turned for e in r.events if e.name == "backward"]
    assert turned[:4] == ["on", "off", "on", "off"]
    assert r.events.table()["turned"].tolist() == [e.turned for e in r.events]
    assert ">forward off<" in r._repr_html_() and ">backward on<" in r._repr_html_()
    assert "jump  forward off" in str(r) and "jump  backward on" in str(r)
    assert saltus.catalogue("bouncing-ball").simulate(until=2).events[0].turned is None


def test_an_output_that_no_row_has_at_an_event_is_not_joined():
    r = relay().simulate(until=5, output={"every": 0.5, "events": False})
    (u,) = r.plot(["u"])
    x, y = (np.asarray(data, dtype=float) for data in u.lines[0].get_data())
    for event in r.events:
        assert np.isnan(y[x == event.t]).all() and (x == event.t).sum() == 2


def test_a_value_alone_between_events_is_seen():
    r = relay().simulate(until=5, output={"times": [0, 2, 4.9, 5], "events": False})
    (line,) = (line for line in r.plot(["u"])[0].lines if line.get_gid() == "saltus")
    dots = line.get_markevery()
    assert line.get_marker() == "." and np.asarray(line.get_xdata())[dots].tolist() == [0, 2]


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
    kept = (s["kind"] == "leave_sliding") & (s["t"] > 20)
    assert 0 < kept.sum() < len(s["t"])
    for event in ("leave_sliding", "leave_sliding slip"):
        (points,) = s.bifurcation("q", event=event, after=20).lines
        assert points.get_xdata().tolist() == s["belt"][kept].tolist()
        assert points.get_ydata().tolist() == s["q"][kept].tolist()
    with pytest.raises(KeyError, match="leave_sliding"):
        s.bifurcation("q", event="leaves_sliding")
    with pytest.raises(ValueError, match='keep="final"'):
        s.plot("q")


def test_events_of_several_sorts_can_be_told_apart():
    s = saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2, 0.3], until=40, keep="events")
    axis = s.bifurcation("v")
    assert sum(len(line.get_xdata()) for line in axis.lines) == len(s["t"])
    assert len({line.get_color() for line in axis.lines}) == len(axis.lines) == 2
    assert [text.get_text() for text in axis.get_legend().get_texts()] == ["enter_sliding slip", "leave_sliding slip"]
    assert s.bifurcation("v", event="enter_sliding").get_legend() is None


def test_a_bifurcation_diagram_over_one_of_two_parameters_has_a_colour_for_each_value_of_the_other():
    m = saltus.catalogue("stick-slip")
    s = m.sweep(belt=[0.1, 0.2, 0.3], q=[0, 0.1], until=40, keep="events")
    axis = s.bifurcation("q", event="leave_sliding", after=20)
    assert [line.get_label() for line in axis.lines] == ["q(0) = 0", "q(0) = 0.1"]
    assert len({line.get_color() for line in axis.lines}) == 2
    kept = (s["kind"] == "leave_sliding") & (s["t"] > 20) & (s["q(0)"] == 0.1)
    assert axis.lines[1].get_ydata().tolist() == s["q"][kept].tolist()
    several = s.bifurcation("v").lines
    assert len({(line.get_color(), line.get_marker()) for line in several}) == len(several) == 4


def test_runs_that_stopped_early_are_marked_in_a_bifurcation_diagram():
    m = saltus.Model.from_text(
        '[model]\nname = "m"\n[parameters]\na = 1\n[states]\nx = 1\ny = 0\n[dynamics]\nx = "sqrt(a - x)*x"\ny = "1"\n'
        '[[events]]\nname = "early"\nwhen = "y - 0.01"\n[simulate]\nuntil = 0.1\n'
    )
    s = m.sweep(a=[2, 0, 3, 0.5], keep="events")
    lost = next(line for line in s.bifurcation("x").lines if line.get_label() == "stopped early")
    assert lost.get_xdata().tolist() == [0, 0.5] and lost.get_marker() == "x"


def test_a_bifurcation_diagram_has_all_that_was_swept():
    m = saltus.Model.from_text(
        '[model]\nname = "m"\n[parameters]\na = 1\n[states]\nx = 0\n[dynamics]\nx = "a - x"\n'
        '[[events]]\nname = "high"\nwhen = "x - 1"\n[simulate]\nuntil = 10\n'
    )
    s = m.sweep(a=[0.5, 2, 3, 9.5], keep="events")
    axis = s.bifurcation("x", event="high")
    assert axis.lines[0].get_xdata().tolist() == [2, 3, 9.5]
    assert axis.get_xlim()[0] < 0.5 and axis.get_xlim()[1] > 9.5
    with pytest.warns(saltus.ModelWarning, match="the last of the events \"high\" is at t = 0.69.*after=1000 leaves none"):
        axis = s.bifurcation("x", event="high", after=1000)
    assert axis.get_xlim()[0] < 0.5 and axis.get_xlim()[1] > 9.5 and axis.lines[:] == []
    with pytest.warns(saltus.ModelWarning, match="no run has events"):
        m.sweep(a=[0.1, 0.2], keep="events").bifurcation("x")


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
    curves = picture.findall("{http://www.w3.org/2000/svg}path[@class='curve']")
    assert len(curves) == min(6, len(r.states) + len(r.controls) + len(r.output_names))
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
    with pytest.raises(ImportError, match=r"pip install pandas xarray pyarrow"):
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
        slip.plot(axes=[1, 2, 3])
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


def test_cards_of_what_is_more_than_one_run():
    m = saltus.catalogue("stick-slip")
    compared, studied = m.compare(until=2), m.order(until=1, schemes=[("radau_iia", 2)], steps=[10, 20])
    for r, word in (compared, "timestepping"), (studied, "radau_iia"):
        html = r._repr_html_()
        xml.etree.ElementTree.fromstring(html)
        assert word in html and "<pre style='white-space:pre;" in html and "<svg" not in html
    runs = len(compared.comparison["runs"])
    assert repr(compared) == f"<saltus.Result 'stick-slip': comparison of {runs} runs; print(…) shows them>"
    assert "errors of fixed steps" in repr(studied)
    text = m.check()
    assert repr(text) == str(text).rstrip() and "\n" in repr(text) and "<pre" in text._repr_html_()


def test_the_card_of_a_sweep():
    s = saltus.catalogue("stick-slip").sweep(belt=np.linspace(0.1, 0.3, 9), until=5)
    table = xml.etree.ElementTree.fromstring(s._repr_html_()).find("table")
    rows = [[cell.text for cell in row] for row in table.findall("tr")]
    assert rows[0] == list(s.table) and len(rows) == 9
    assert [float(row[5]) for row in rows[1:]] == pytest.approx(s["q"][:8], rel=1e-5)
    assert "9 runs over belt: 9 completed" in s._repr_html_() and "and 1 more row:" in s._repr_html_()


def test_runs_with_other_events_only_are_drawn_by_their_end():
    m = saltus.Model.from_text("""
        [model]
        name = "peaks of some"
        [parameters]
        a = 0
        [states]
        x = 0
        [dynamics]
        x = "1"
        [[events]]
        name = "early"
        when = "x > 1"
        [[events]]
        name = "peak"
        when = "x > 1.5 + a"
    """)
    s = m.sweep(a=[0, 1], until=2, keep="events")
    axis = s.bifurcation("x", event="peak")
    ends = next(line for line in axis.lines if line.get_label() == "at the end, without peak")
    assert (ends.get_xdata().tolist(), ends.get_ydata().tolist()) == ([1], pytest.approx([2]))
