"""Pictures of sweeps by matplotlib."""

from __future__ import annotations

import typing

import numpy as np

from ._errors import warn
from ._outcome import unknown
from ._plot import LINES, caption_of
from ._result import needed

if typing.TYPE_CHECKING:
    from ._shape import Array
    from ._sweep import Sweep

#: How runs end that did what was asked; where others stopped is no end of theirs.
_DONE = ("completed", "stopped_by_event")


def plot(s: Sweep, name: str, over: str | None, axis: typing.Any) -> typing.Any:
    """Lines of a column over what was swept, one for each value of everything else."""
    name = str(name)
    first_rows = np.unique(s["run"], return_index=True)[1]

    def of_runs(name: str) -> typing.Any:
        return s[name][first_rows]

    if name != "events" and (len(s["run"]) != len(s) or "kind" in s.table):
        raise ValueError('a line has a value for every run: sweep(…, keep="final"), or s.bifurcation(…) for events')
    done = np.isin(of_runs("status"), _DONE)
    column, (x, others) = np.where(done, of_runs(name), np.nan), _axes(s, over)
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
    if not done.all():
        # At the foot: they have no value, and their last one may lie far off.
        foot = axis.get_xaxis_transform()
        axis.plot(along[~done], np.full((~done).sum(), 0.03), "x", color="black", transform=foot, label="stopped early")
    if not done.all() or 1 < len(lines) <= 12:
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
    """Points: a column at events over what was swept; events of each sort in a colour of their own."""
    if "kind" not in s.table:
        raise ValueError('a bifurcation diagram is made of events: sweep(…, keep="events")')
    sorts, sort_of_row = _sorts_of_events(s)
    wanted = [i for i, sort in enumerate(sorts) if event is None or event in _names_of(sort)]
    if event is not None and not wanted:
        raise unknown(event, sorted({name for sort in sorts for name in _names_of(sort)}), "the list of events")
    x, _ = _axes(s, over)
    axis, is_own = _axis(axis), axis is None
    late = s["t"] > after
    drawn = [(sorts[i], late & (sort_of_row == i)) for i in wanted]
    drawn = [(sort, rows) for sort, rows in drawn if rows.any()]
    if not drawn:
        _warn_of_nothing(s["t"][np.isin(sort_of_row, wanted)], event, after)
    for sort, rows in drawn:
        style = {"color": LINES[0]} if len(drawn) == 1 else {"label": _names_of(sort)[0]}
        axis.plot(s[x][rows], s[name][rows], ".", markersize=2.5, **style)
    if 1 < len(drawn) <= 12:
        axis.legend(markerscale=3, **({"loc": "upper left", "bbox_to_anchor": (1, 1)} if is_own else {}))
    # All that was swept is along the axis, also where no event is left.
    axis.dataLim.update_from_data_x(s[x], ignore=False)
    axis.autoscale_view()
    axis.set_xlabel(_caption(s, x))
    axis.set_ylabel(_caption(s, name) + (f" at {event}" if event is not None else ""))
    return axis


#: Kind, name and surfaces of an event, as in the table.
Sort = tuple[str, str, str]


def _sorts_of_events(s: Sweep) -> tuple[list[Sort], Array]:
    """All that there are, and of every row which it is; -1 of a run without events."""
    words, numbers = zip(*(np.unique(s[column], return_inverse=True) for column in ("kind", "name", "surfaces")))
    shape = tuple(len(part) for part in words)
    found, sort_of_row = np.unique(np.ravel_multi_index(numbers, shape), return_inverse=True)
    places = np.unravel_index(found, shape)
    kinds, names, surfaces = (part[place].tolist() for part, place in zip(words, places))
    return list(zip(kinds, names, surfaces)), np.where(s["event"] > 0, sort_of_row, -1)


def _names_of(sort: Sort) -> list[str]:
    """What an event may be called, first as the page of a sweep does: its name, or the kind with its surfaces."""
    kind, name, surfaces = sort
    with_surfaces = [f"{kind} {surface}" for surface in (surfaces, *surfaces.split())]
    return list(dict.fromkeys(filter(None, [name, *(with_surfaces if surfaces else []), kind, *surfaces.split()])))


def _warn_of_nothing(times: Array, event: str | None, after: float) -> None:
    what = f'events "{event}"' if event is not None else "events"
    if len(times) == 0:
        warn([f"nothing is drawn: no run has {what}"])
    else:
        warn([f"nothing is drawn: the last of the {what} is at t = {times.max():.6g}, and after={after:g} leaves none"])


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
