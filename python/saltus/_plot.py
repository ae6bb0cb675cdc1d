"""Pictures by matplotlib."""

from __future__ import annotations

import typing

import numpy as np

from ._events import Event
from ._expression import Expression
from ._errors import needed
from ._recorded import Recorded
from ._shape import as_drawn, broken_at_jumps, edges, is_alone, is_stepwise, slides, sliding_spans

SLIDING = "#d95f02"
#: Of the first result in a picture, and of those that are drawn over it.
LINES = ("#1f5fa8", "#1b9e77", "#e7298a", "#66a61e", "#a6761d", "#7570b3")
#: Marks a line as a result's.
_OURS = "saltus"
#: Of more events than this the marks hide the curves.
MOST_MARKS = 100
MARKS = {
    "crossing": ("|", "#555555"),
    "enter_sliding": (">", SLIDING),
    "leave_sliding": ("<", SLIDING),
    "change_sliding": ("D", SLIDING),
    "jump": ("o", "#7570b3"),
    "impact": ("v", "#7570b3"),
    "accumulation": ("*", "#e7298a"),
    "contact": ("_", "#666666"),
    "lift_off": ("x", "#666666"),
    "stick": ("s", SLIDING),
    "slip": ("P", SLIDING),
    "user": ("^", "#1b9e77"),
}


def _matplotlib() -> typing.Any:
    needed("matplotlib", "plot")
    return needed("matplotlib.pyplot", "plot")


def plot(
    r: Recorded,
    names: typing.Sequence[str | Expression] | None,
    axes: typing.Any,
    label: str | None = None,
    events: bool | None = None,
) -> typing.Any:
    """A row of axes for every name; sliding is shaded, events are marked at their values."""
    r = as_drawn(r)
    pyplot, is_own = _matplotlib(), axes is None
    if isinstance(axes, (str, Expression)):
        raise TypeError(f'r.plot({names!r}, {axes!r}): names are one list, r.plot(["{names}", "{axes}"]); axes are those of matplotlib')
    names = [names] if isinstance(names, (str, Expression)) else names
    all_names = [*r._run.states_in_rows, *r.controls, *r.output_names]
    wanted = [str(name) for name in names] if names is not None else all_names
    columns = {name: r[name] for name in wanted}
    if axes is None:
        _, axes = pyplot.subplots(
            len(wanted), 1, sharex=True, squeeze=False, figsize=(8, 1.2 + 1.4 * len(wanted)), layout="constrained"
        )
        axes = axes[:, 0]
    axes = list(getattr(axes, "flat", axes if isinstance(axes, (list, tuple)) else [axes]))
    if len(axes) != len(wanted):
        raise ValueError(f"axes: expected {len(wanted)} of matplotlib, one for each of {', '.join(wanted)}")
    for axis, (name, column) in zip(axes, columns.items(), strict=True):
        for begin, end in sliding_spans(r):
            axis.axvspan(begin, end, color=SLIDING, alpha=0.13, linewidth=0)
        line = _line(axis, broken_at_jumps(r, r.t, column), label)
        if is_stepwise(r.t, column):
            axis.plot(*edges(r.t, column), color=line.get_color(), linewidth=0.6)
        _mark_events(axis, r, "t", name, events)
        axis.set_ylabel(caption_of(r, name))
        axis.margins(x=0)
    axes[0].set_title(r.model)
    axes[-1].set_xlabel("t")
    _legend(axes[0])
    if is_own:
        # The room for labels is that of the ticks, which change with the height that the first layout gives.
        axes[0].figure.get_layout_engine().execute(axes[0].figure)
    return axes


def _line(axis: typing.Any, curve: list[typing.Any], label: str | None) -> typing.Any:
    """Another result over one that is there has another colour; a value between two gaps is a dot."""
    before = sum(line.get_gid() == _OURS for line in axis.lines)
    named = {"label": label} if label is not None else {}
    dots = np.flatnonzero(is_alone(curve[0] + curve[1])).tolist()
    style = {"marker": ".", "markersize": 2.4, "markevery": dots} if dots else {}
    (line,) = axis.plot(*curve, color=LINES[before % len(LINES)], linewidth=1.2, gid=_OURS, **style, **named)
    return line


def _legend(axis: typing.Any) -> None:
    """Of the results that were given a label."""
    named = [line for line in axis.lines if line.get_gid() == _OURS and not line.get_label().startswith("_")]
    if named:
        axis.legend(handles=named)


def caption_of(r: Recorded, name: str) -> str:
    """The label of a column with its unit: "height [m]"."""
    caption = r._captions.get(name, {})
    unit = caption.get("unit", "")
    return (caption.get("label") or name) + (f" [{unit}]" if unit else "")


def _mark_events(axis: typing.Any, r: Recorded, x: str, y: str, wanted: bool | None) -> None:
    """By their kinds; of a column over time that is stepwise those that its edges do not show."""
    if not (len(r.events) <= MOST_MARKS if wanted is None else wanted):
        return
    shown = set(edges(r.t, r[y])[0].tolist()) if x == "t" and is_stepwise(r.t, r[y]) else set()
    for kind, (mark, colour) in MARKS.items():
        events = [event for event in r.events if event.kind == kind and event.t not in shown]
        if events:
            places = [[_at(r, name, event) for event in events] for name in (x, y)]
            axis.plot(*places, mark, color=colour, markersize=3.5, linestyle="none", label=kind)


def _at(r: Recorded, name: str, event: Event) -> float:
    """A column before an event; NaN where neither the event nor a row has it."""
    if name == "t":
        return event.t
    if name in r.states:
        return float(event.x[r.states.index(name)])
    row = int(r.t.searchsorted(event.t, side="left"))
    return float(r[name][row]) if row < len(r.t) and r.t[row] == event.t else float("nan")


def phase(
    r: Recorded,
    x: str | Expression,
    y: str | Expression,
    axis: typing.Any,
    label: str | None = None,
    events: bool | None = None,
) -> typing.Any:
    """One column over another; where the solution slides the line is thick."""
    r = as_drawn(r)
    pyplot = _matplotlib()
    x, y = str(x), str(y)
    if axis is None:
        _, axis = pyplot.subplots(figsize=(5, 4.5), layout="constrained")
    _line(axis, broken_at_jumps(r, r[x], r[y]), label)
    held = slides(r)
    here, there = r[x].astype(float), r[y].astype(float)
    here[~held] = float("nan")
    axis.plot(*broken_at_jumps(r, here, there), color=SLIDING, linewidth=2.6, solid_capstyle="butt")
    _mark_events(axis, r, x, y, events)
    axis.plot(r[x][0], r[y][0], "o", color="black", markersize=4)
    axis.set_xlabel(caption_of(r, x))
    axis.set_ylabel(caption_of(r, y))
    axis.set_title(r.model)
    _legend(axis)
    return axis
