"""Pictures in axes of one's own: several columns, several calls, the words for them."""

import copy
import pickle

import matplotlib
import numpy as np
import pytest

import saltus

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402


pytestmark = pytest.mark.usefixtures("close_figures")


def test_several_columns_share_axes(slip):
    (axis,) = slip.plot([["q", "v"]])
    lines = [line for line in axis.lines if line.get_gid() == "saltus"]
    assert [line.get_ydata().tolist() for line in lines] == [slip["q"].tolist(), slip["v"].tolist()]
    assert [text.get_text() for text in axis.get_legend().get_texts()] == ["q", "v"] and axis.get_ylabel() == "q, v"
    assert len({line.get_color() for line in lines}) == 2
    own = pyplot.subplots()[1]
    for axes in (own, [pyplot.subplots()[1]] * 2):
        (axis, *rest) = slip.plot(["q", "v"], ax=axes, label="run")
        assert [text.get_text() for text in axis.get_legend().get_texts()] == ["q, run", "v, run"]
    m = saltus.Builder("chain")
    x = m.states("x", [1, 0], unit="mol")
    m.rate(x, np.roll(x, 1) - x)
    r = m.simulate(until=1)
    for names in (["x"], "x", ["x*"]):
        (axis,) = r.plot(names)
        assert axis.get_ylabel() == f"{names[0]} [mol]" and len(axis.lines) == 2
    assert [axis.get_ylabel() for axis in m.sweep(x1=[1, 2], until=1).plot("x")] == ["x1 [mol]", "x2 [mol]"]


def test_axes_of_ones_own_keep_what_they_have(slip):
    figure, (left, right) = pyplot.subplots(1, 2)
    figure.suptitle("mine")
    left.set_title("left")
    left.set_ylabel("speed")
    slip.plot("v", ax=left)
    slip.phase("q", "v", ax=right)
    assert (left.get_title(), left.get_ylabel(), left.get_xlabel(), right.get_title()) == ("left", "speed", "t", "")
    assert figure.get_suptitle() == "mine" and slip.plot("v")[0].get_title() == slip.model


def test_results_over_each_other_are_told_apart(slip):
    m = saltus.catalogue("stick-slip")
    other = m.simulate(until=10, set={"belt": 0.1})

    def words(axis):
        return [text.get_text() for text in axis.get_legend().get_texts()]

    def looks(axis):
        return {(line.get_color(), line.get_linestyle()) for line in axis.lines if line.get_gid() == "saltus"}

    (axis,) = slip.plot("v")
    assert axis.get_legend() is None
    other.plot("v", ax=axis)
    assert words(axis) == ["result 1", "result 2"] and len(looks(axis)) == 2
    (axis,) = slip.plot([["q", "v"]])
    other.plot([["q", "v"]], ax=axis, label="slow")
    assert words(axis) == ["q, result 1", "v, result 1", "q, slow", "v, slow"]
    for _ in range(3):
        other.plot([["q", "v"]], ax=axis)
    assert len(looks(axis)) == 10
    both = other.phase("q", "v", ax=slip.phase("q", "v"))
    assert words(both) == ["result 1", "result 2"]
    (axis,) = slip.plot("q")
    slip.plot("v", ax=axis)
    assert words(axis) == ["q", "v"]


def test_figures_of_results_are_stored_and_copied(slip):
    (axis,) = slip.plot("v")
    other = saltus.catalogue("stick-slip").simulate(until=1)
    for again in (pickle.loads(pickle.dumps(axis.figure)), copy.deepcopy(axis.figure)):
        other.plot("v", ax=again.axes[0])
        assert [text.get_text() for text in again.axes[0].get_legend().get_texts()] == ["result 1", "result 2"]


def test_labels_and_legends_of_ones_own_stay(slip):
    other = saltus.catalogue("stick-slip").simulate(until=1)
    (axis,) = slip.plot("v")
    axis.lines[0].set_label("mine")
    other.plot("v", ax=axis)
    assert [text.get_text() for text in axis.get_legend().get_texts()] == ["mine", "result 2"]
    own = axis.legend(["only this"])
    other.plot("v", ax=axis, label="again")
    assert axis.get_legend() is own
    (axis,) = slip.plot("v", label="")
    assert axis.get_legend() is None
    other.plot("v", ax=axis, label="named")
    assert [text.get_text() for text in axis.get_legend().get_texts()] == ["named"]


def test_phase_lines_are_told_apart_by_both_columns(slip):
    axis = slip.phase("v", "q", ax=slip.phase("t", "q"))
    assert [text.get_text() for text in axis.get_legend().get_texts()] == ["q over t", "q over v"]


def test_pictures_have_one_word_for_axes_and_say_it(slip):
    s = saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=40)
    events = saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2], until=40, keep="events")
    for draw in (lambda **how: slip.plot("v", **how)[0], lambda **how: slip.phase("q", "v", **how),
                 lambda **how: s.plot("v", **how), lambda **how: events.bifurcation("v", **how)):
        own = pyplot.subplots()[1]
        assert draw(ax=own, color="red", label="mine") is own
        assert any(line.get_color() == "red" and "mine" in line.get_label() for line in own.lines)
        with pytest.raises(TypeError, match="has no keyword 'subplot': write ax=axes of matplotlib"):
            draw(subplot=own)
        with pytest.raises(TypeError, match=r'write color="black"'):
            draw(colour="red")


def test_a_bifurcation_diagram_of_several_events():
    s = saltus.catalogue("stick-slip").sweep(belt=[0.1, 0.2, 0.3], until=40, keep="events")
    both = ["enter_sliding", "leave_sliding"]
    axis = s.bifurcation("q", event=both, after=20)
    assert len(axis.lines) == 2 and axis.get_ylabel() == "q at enter_sliding, leave_sliding"
    one = s.bifurcation("q", event=both[0], after=20)
    assert one.get_legend() is None
    s.bifurcation("q", event=both[1], after=20, ax=one)
    assert [line.get_color() for line in one.lines] == [line.get_color() for line in axis.lines]
    words = [text.get_text() for text in one.get_legend().get_texts()]
    assert words == [text.get_text() for text in axis.get_legend().get_texts()] and len(words) == 2
    assert one.get_ylabel() == "q at enter_sliding; q at leave_sliding"
    with pytest.raises(KeyError, match="has no 'maxi'"):
        s.bifurcation("q", event=["enter_sliding", "maxi"])
