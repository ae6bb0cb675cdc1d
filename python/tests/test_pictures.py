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
    assert np.isnan(y).sum() == len({e.t for e in ball.events if e.kind in ("jump", "accumulation")})


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


def test_a_result_without_rows_is_told(slip):
    run = saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=5, keep="events").results[0]
    for draw in (run.plot, lambda: run.phase("q", "v")):
        with pytest.raises(ValueError, match='keep="trajectory"'):
            draw()
    with pytest.raises(ValueError, match="one for each of"):
        slip.plot(axes=[1])
    with pytest.raises(TypeError, match="by its name"):
        slip[0]
