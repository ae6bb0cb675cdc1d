"""Pictures of sweeps by matplotlib."""

from __future__ import annotations

import typing

import numpy as np

from ._errors import needed, warn
from ._outcome import unknown
from ._plot import LINES, caption_of
from ._shape import Array


class Sweep(typing.Protocol):
    """What pictures show of a sweep."""

    names: list[str]
    results: typing.Sequence[typing.Any]
    _sampled: int

    @property
    def table(self) -> dict[str, typing.Any]: ...
    def __getitem__(self, name: str) -> Array: ...
    def __len__(self) -> int: ...


#: How runs end that did what was asked; where others stopped is no end of theirs.
_DONE = ("completed", "stopped_by_event")

#: Kind, name and surfaces of an event, as in the table.
Sort = tuple[str, str, str]


def plot(
    s: Sweep, name: str, over: str | None, axis: typing.Any, label: str | None = None, color: typing.Any = None
) -> typing.Any:
    """Lines of a column over what was swept, one for each value of everything else."""
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
        words = [f"{other} = {_shown(of_runs(other)[runs[0]])}" for other in others]
        words = [*([label] if label is not None else []), *words]
        style = {"marker": "." if len(runs) < 60 or s._sampled else None, "linewidth": 0 if s._sampled else 1.2}
        axis.plot(along[runs], column[runs], **style, label=", ".join(words) or None, color=color)
    _mark_lost_runs(s, x, axis)
    if not done.all() or label is not None or 1 < len(lines) <= 12:
        axis.legend()
    axis.set_xlabel(_caption(s, x))
    axis.set_ylabel(_caption(s, name))
    return axis


def plot_all(
    s: Sweep, names: list[str], over: str | None, axes: typing.Any, label: str | None = None, color: typing.Any = None
) -> typing.Any:
    """The same for several columns, below each other."""
    if axes is None:
        needed("matplotlib", "plot")
        _, axes = needed("matplotlib.pyplot", "plot").subplots(
            len(names), 1, sharex=True, squeeze=False, figsize=(6, 1.2 + 1.8 * len(names)), layout="constrained"
        )
        axes = list(axes[:, 0])
    for name, axis in zip(names, axes, strict=True):
        plot(s, name, over, axis, label, color)
    return axes


def bifurcation(
    s: Sweep,
    name: str,
    event: str | typing.Sequence[str] | None,
    after: float,
    over: str | None,
    axis: typing.Any,
    label: str | None = None,
    color: typing.Any = None,
) -> typing.Any:
    """Points: a column at events over what was swept; other parameters and sorts of events have looks of their own.

    A run that goes on after `after` without such an event is drawn by its end, one that stopped early by a cross at the foot.
    """
    if "kind" not in s.table:
        raise ValueError('a bifurcation diagram is made of events: sweep(…, keep="events")')
    sorts, sort_of_row = _sorts_of_events(s)
    events = [event] if isinstance(event, str) else list(event or [])
    known = {name for sort in sorts for name in _names_of(sort)}
    for one in events:
        if one not in known:
            raise unknown(one, sorted(known), "the list of events")
    wanted = [i for i, sort in enumerate(sorts) if not events or set(events) & set(_names_of(sort))]
    x, others = _axes(s, over)
    axis, is_own = _axis(axis), axis is None
    values, label_of_row = _other_values(s, others)
    ends = _quiet_ends(s, name, after, np.isin(sort_of_row, wanted))
    looks = _looks(s, [sorts[i] for i in wanted], [sort_of_row == i for i in wanted], label_of_row, values, after)
    if not looks:
        _warn_of_nothing(s["t"][np.isin(sort_of_row, wanted)], ", ".join(events), after, len(ends[0]))
    before = _drawn_before(axis)
    for rows, style in looks:
        _draw_points(axis, s[x][rows], s[name][rows], style, before, label, color)
    without = f"at the end, without {', '.join(events) or 'events'}"
    _draw_ends(s, x, ends, label_of_row, (len(values), without), axis)
    _mark_lost_runs(s, x, axis)
    # One sort of points alone needs no words; some runs that are drawn otherwise do.
    handles = axis.get_legend_handles_labels()[1]
    if 0 < len(handles) <= 13:
        axis.legend(markerscale=2, **({"loc": "upper left", "bbox_to_anchor": (1, 1)} if is_own else {}))
    # All that was swept is along the axis, also where no event is left.
    axis.dataLim.update_from_data_x(s[x], ignore=False)
    axis.autoscale_view()
    axis.set_xlabel(_caption(s, x))
    heading = _caption(s, name) + (f" at {', '.join(events)}" if events else "")
    drawn = axis.get_ylabel() if before else ""
    axis.set_ylabel(f"{drawn}; {heading}" if drawn not in ("", heading) else heading)
    return axis


#: Marks points as those of a sweep: one for each sort of events.
_OURS = "saltus sort"


def _drawn_before(axis: typing.Any) -> int:
    """How many sorts of events other calls have drawn. One that was alone had no need of words; now it has."""
    ours = [line for line in axis.lines if str(line.get_gid()).startswith(_OURS)]
    for line in ours:
        line.set_label(line.get_label().removeprefix("_"))
    return len({line.get_gid() for line in ours})


def _draw_points(
    axis: typing.Any, x: Array, y: Array, look: Look, before: int, label: str | None, color: typing.Any
) -> None:
    number = before + look.sort
    words = ", ".join([*([label] if label is not None else []), *look.words])
    # Words that begin with "_" are in no legend.
    axis.plot(
        x,
        y,
        linestyle="none",
        markersize=2.5,
        gid=f"{_OURS} {number}",
        color=color if color is not None else LINES[(number if look.value is None else look.value) % len(LINES)],
        marker="." if look.value is None else _MARKERS[number % len(_MARKERS)],
        label=words if look.is_named or before or label is not None else f"_{words}",
    )


#: Markers of sorts of events where colours stand for values of another parameter.
_MARKERS = (".", "x", "+", "^", "s", "v")

#: Other parameters of at most so many pairs of values are told apart by colours.
_MOST_VALUES = 12


def _other_values(s: Sweep, others: list[str]) -> tuple[list[str], Array]:
    """What the other parameters are, as words, and of every row which of them."""
    rows = np.column_stack([np.unique(s[other], return_inverse=True)[1] for other in others]) if others else None
    if rows is None:
        return [""], np.zeros(len(s["run"]), dtype=int)
    _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    if len(first) > _MOST_VALUES:
        return [""], np.zeros(len(s["run"]), dtype=int)
    words = [", ".join(f"{other} = {_shown(s[other][row])}" for other in others) for row in first]
    return words, np.ravel(number)


class Look(typing.NamedTuple):
    """How points look: colours by value of other parameters, where these have one value by sort of event."""

    sort: int
    value: int | None  # which of the values of other parameters; None where there is one
    words: list[str]
    is_named: bool  # one sort of points alone needs no words


def _looks(
    s: Sweep, sorts: list[Sort], rows_of_sorts: list[Array], label_of_row: Array, values: list[str], after: float
) -> list[tuple[Array, Look]]:
    """Rows with their look."""
    late = s["t"] > after
    present = [(sort, rows & late) for sort, rows in zip(sorts, rows_of_sorts) if (rows & late).any()]
    looks = []
    for n, (sort, rows) in enumerate(present):
        for k, words in enumerate(values):
            chosen = rows & (label_of_row == k)
            if not chosen.any():
                continue
            many, several_sorts = len(values) > 1, len(present) > 1
            named = [words] if many else []
            named += [_names_of(sort)[0]] if several_sorts or not many else []
            looks.append((chosen, Look(n, k if many else None, named, many or several_sorts)))
    return looks


def _quiet_ends(s: Sweep, name: str, after: float, chosen: Array) -> tuple[Array, Array]:
    """Rows and values at the end of runs that were done and have no chosen event after a time; none of older tables.

    `chosen` says of every row whether it is one."""
    column = name.removesuffix("(after)") + "(end)"
    if column not in s.table or name == "t":
        return np.array([], dtype=int), np.array([])
    moves = chosen & (s["event"] > 0) & (s["kind"] != "start") & (s["t"] > after)
    first = np.unique(s["run"], return_index=True)[1]
    quiet = ~np.isin(s["run"][first], s["run"][moves]) & np.isin(s["status"][first], _DONE) & (s["t(end)"][first] > after)
    return first[quiet], s[column][first[quiet]]


def _draw_ends(
    s: Sweep, x: str, ends: tuple[Array, Array], label_of_row: Array, shown: tuple[int, str], axis: typing.Any
) -> None:
    """Open diamonds in the colours of the points; one of them has the words."""
    rows, heights = ends
    count, words = shown
    label: dict[str, typing.Any] = {"label": words} if words not in axis.get_legend_handles_labels()[1] else {}
    for k in np.unique(label_of_row[rows]).tolist():
        chosen = label_of_row[rows] == k
        style = {"color": LINES[k % len(LINES)] if count > 1 else "#555555", "markerfacecolor": "none"}
        axis.plot(s[x][rows[chosen]], heights[chosen], linestyle="none", marker="D", markersize=3, **style, **label)
        label = {}


def _mark_lost_runs(s: Sweep, x: str, axis: typing.Any) -> None:
    """At the foot: they have no end, and what they have of events may be a part."""
    first = np.unique(s["run"], return_index=True)[1]
    lost = first[~np.isin(s["status"][first], _DONE)]
    if len(lost):
        foot = axis.get_xaxis_transform()
        heights = np.full(len(lost), 0.03)
        axis.plot(s[x][lost], heights, "x", color="black", transform=foot, label="stopped early")


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


def _warn_of_nothing(times: Array, event: str, after: float, ends: int) -> None:
    what = f'events "{event}"' if event else "events"
    instead = f"; {ends} run{' is' if ends == 1 else 's are'} drawn by the end" if ends else ""
    if len(times) == 0:
        warn([f"no point is drawn: no run has {what}{instead}"])
    else:
        last = f"the last of the {what} is at t = {times.max():.6g}, and after={after:g} leaves none"
        warn([f"no point is drawn: {last}{instead}"])


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
