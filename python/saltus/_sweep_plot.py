"""Pictures of sweeps by matplotlib."""

from __future__ import annotations

import typing

import numpy as np

from ._outcome import unknown
from ._plot import caption_of
from ._result import needed

if typing.TYPE_CHECKING:
    from ._sweep import Sweep


def plot(s: Sweep, name: str, over: str | None, axis: typing.Any) -> typing.Any:
    """Lines of a column over what was swept, one for each value of everything else."""
    name = str(name)
    first_rows = np.unique(s["run"], return_index=True)[1]

    def of_runs(name: str) -> typing.Any:
        return s[name][first_rows]

    if name != "events" and (len(s["run"]) != len(s) or "kind" in s.table):
        raise ValueError('a line has a value for every run: sweep(…, keep="final"), or s.bifurcation(…) for events')
    column, (x, others) = of_runs(name), _axes(s, over)
    along = of_runs(x)
    axis = _axis(axis)
    rows = np.column_stack([of_runs(other) for other in others]) if others else np.zeros((len(along), 1))
    _, line_of_run = np.unique(rows, axis=0, return_inverse=True)
    lines = list(dict.fromkeys(np.ravel(line_of_run).tolist()))
    for line in lines:
        runs = np.flatnonzero(np.ravel(line_of_run) == line)
        runs = runs[np.argsort(along[runs], kind="stable")]
        label = ", ".join(f"{other} = {_shown(of_runs(other)[runs[0]])}" for other in others)
        marker = "." if len(runs) < 60 or s._sampled else None
        axis.plot(along[runs], column[runs], marker=marker, linewidth=0 if s._sampled else 1.2, label=label or None)
    if 1 < len(lines) <= 12:
        axis.legend()
    axis.set_xlabel(_caption(s, x))
    axis.set_ylabel(_caption(s, name))
    return axis


def plot_all(s: Sweep, over: str | None, axes: typing.Any) -> typing.Any:
    """The same for all states and outputs, below each other."""
    first = s.results[0]
    names = [*first.states, *first.output_names]
    if axes is None:
        needed("matplotlib", "plot")
        _, axes = needed("matplotlib.pyplot", "plot").subplots(
            len(names), 1, sharex=True, squeeze=False, figsize=(6, 1.2 + 1.8 * len(names)), layout="constrained"
        )
        axes = list(axes[:, 0])
    for name, axis in zip(names, axes, strict=True):
        plot(s, name, over, axis)
    return axes


def bifurcation(s: Sweep, name: str, event: str | None, after: float, over: str | None, axis: typing.Any) -> typing.Any:
    """Points: a column at events over what was swept."""
    if "kind" not in s.table:
        raise ValueError('a bifurcation diagram is made of events: sweep(…, keep="events")')
    chosen = s["t"] > after
    if event is not None:
        chosen &= (s["name"] == event) | (s["kind"] == event)
        if not np.any((s["name"] == event) | (s["kind"] == event)):
            raise unknown(event, sorted({*s["name"].tolist(), *s["kind"].tolist()} - {""}), "the list of events")
    x, _ = _axes(s, over)
    axis = _axis(axis)
    axis.plot(s[x][chosen], s[name][chosen], ".", markersize=2.5, color="#1f5fa8")
    axis.set_xlabel(_caption(s, x))
    axis.set_ylabel(_caption(s, name) + (f" at {event}" if event is not None else ""))
    return axis


def _axes(s: Sweep, over: str | None) -> tuple[str, list[str]]:
    """What is drawn along the axis, and the rest of what was swept."""
    swept = list(s.table)[1 : 1 + len(s.names)]
    numbers = [name for name in swept if s[name].dtype.kind in "if"]
    if over is not None and over not in numbers:
        over = dict(zip(s.names, swept)).get(over, over)
        if over not in numbers:
            raise unknown(over, numbers, "what was swept")
    if not numbers:
        raise ValueError("nothing with numbers was swept")
    stated = swept[: len(swept) - s._sampled]
    across = [name for name in numbers if name in stated] or numbers
    x = over if over is not None else max(across, key=lambda name: len(np.unique(s[name])))
    return x, [name for name in stated if name != x]


def _caption(s: Sweep, name: str) -> str:
    """With the unit that its runs know; a swept start `v(0)` has that of `v`."""
    of_state = name.removesuffix("(0)")
    caption = caption_of(s.results[0], of_state)
    return caption if caption != of_state else name


def _shown(value: typing.Any) -> str:
    return str(value) if isinstance(value, str) else f"{value:.4g}"


def _axis(axis: typing.Any) -> typing.Any:
    needed("matplotlib", "plot")
    if axis is None:
        _, axis = needed("matplotlib.pyplot", "plot").subplots(figsize=(6, 4), layout="constrained")
    return axis
