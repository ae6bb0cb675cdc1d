"""Pictures by matplotlib."""

from __future__ import annotations

import functools
import inspect
import typing
import uuid
import weakref

import numpy as np

from ._events import Event
from ._expression import Expression
from ._errors import needed
from ._names import several
from ._recorded import Recorded
from ._shape import as_drawn, broken_at_jumps, edges, is_alone, is_stepwise, slides, sliding_spans

SLIDING = "#d95f02"
#: Of the first result in a picture, and of those that are drawn over it.
LINES = ("#1f5fa8", "#1b9e77", "#e7298a", "#66a61e", "#a6761d", "#7570b3")
DASHES = ("-", "--", "-.", ":")
#: Marks a line as a result's, and a legend as ours.
_OURS = "saltus"
#: What tells results apart, also in figures that were stored.
_TOKENS: weakref.WeakKeyDictionary[Recorded, str] = weakref.WeakKeyDictionary()
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


Arguments = typing.ParamSpec("Arguments")
Returned = typing.TypeVar("Returned")
#: What keywords of pictures are called elsewhere.
_ELSEWHERE = {
    **dict.fromkeys(("axis", "axes", "axs", "subplot"), "ax=axes of matplotlib"),
    **dict.fromkeys(("colour", "c", "linecolor"), 'color="black"'),
    **dict.fromkeys(("legend", "name"), 'label="its name in the legend"'),
    **dict.fromkeys(("title", "xlabel", "ylabel", "xlim", "ylim", "figsize", "linewidth", "lw", "linestyle", "ls", "marker"),
                    "that is for the axes which are returned, ax.set_title(…), or for their lines, ax.lines[0].set_linewidth(2)"),
}


def with_words(method: typing.Callable[Arguments, Returned]) -> typing.Callable[Arguments, Returned]:
    """A picture that says, of a keyword that it does not have, which one is meant."""
    known = list(inspect.signature(method).parameters)[1:]

    @functools.wraps(method)
    def checked(*arguments: Arguments.args, **keywords: Arguments.kwargs) -> Returned:
        for word in keywords:
            if word not in known:
                instead = _ELSEWHERE.get(word)
                hint = f"write {instead}" if instead and "=" in instead.split(",")[0] else instead or f"known: {', '.join(known)}"
                raise TypeError(f"{method.__name__}() has no keyword {word!r}: {hint}")
        return method(*arguments, **keywords)

    return checked


def axes_of(places: typing.Any, ax: typing.Any) -> typing.Any:
    """Axes by either of their words."""
    if places is not None and ax is not None:
        raise TypeError("the axes are given twice: leave one of them out")
    return places if ax is None else ax


class Group(typing.NamedTuple):
    """Columns in one picture, and what names all of them."""

    title: str
    names: list[str]


def _groups(r: Recorded, names: typing.Any) -> list[Group]:
    """What is drawn: an entry that is a list, an array or a pattern has its columns in one picture."""
    if names is None:
        return [Group(name, [name]) for name in [*r._run.states_in_rows, *r.controls, *r.output_names]]
    if isinstance(names, (str, Expression, np.ndarray)):
        names = [names]
    return [_group(r, entry) for entry in names]


def _group(r: Recorded, entry: typing.Any) -> Group:
    if isinstance(entry, (list, tuple)):
        return Group("", [name for one in entry for name in _group(r, one).names])
    whole = several(entry, r.names)
    if whole is not None:
        return Group("" if isinstance(entry, np.ndarray) else str(entry), whole.ravel().tolist())
    return Group(str(entry), [str(entry)])


def plot(
    r: Recorded,
    names: typing.Any,
    axes: typing.Any,
    label: str | None = None,
    events: bool | None = None,
    color: typing.Any = None,
) -> typing.Any:
    """A row of axes for every name; sliding is shaded, events are marked at their values."""
    r, of = as_drawn(r), _token(r)
    pyplot, is_own = _matplotlib(), axes is None
    if isinstance(axes, (str, Expression)):
        raise TypeError(f'r.plot({names!r}, {axes!r}): names are one list, r.plot(["{names}", "{axes}"]); axes are those of matplotlib')
    groups = _groups(r, names)
    columns = {name: r[name] for group in groups for name in group.names}
    if axes is None:
        _, axes = pyplot.subplots(
            len(groups), 1, sharex=True, squeeze=False, figsize=(8, 1.2 + 1.4 * len(groups)), layout="constrained"
        )
        axes = axes[:, 0]
    axes = list(getattr(axes, "flat", axes if isinstance(axes, (list, tuple)) else [axes]))
    if len(axes) not in (1, len(groups)):
        wanted = [group.title or ", ".join(group.names) for group in groups]
        raise ValueError(f"axes: expected {len(groups)} of matplotlib, one for each of {', '.join(wanted)}, or one for all")
    for axis, group in _by_axes(axes, groups):
        for begin, end in sliding_spans(r):
            axis.axvspan(begin, end, color=SLIDING, alpha=0.13, linewidth=0)
        for name in group.names:
            line = _line(axis, broken_at_jumps(r, r.t, columns[name]), _Drawn(of, name, label), color)
            if is_stepwise(r.t, columns[name]):
                axis.plot(*edges(r.t, columns[name]), color=line.get_color(), linewidth=0.6)
            _mark_events(axis, r, "t", name, events)
        _caption_once(axis, "y", _title(r, group))
        axis.margins(x=0)
        _legend(axis, axis is axes[0])
    _caption_once(axes[-1], "x", "t")
    if is_own:
        axes[0].set_title(r.model)
        # The room for labels is that of the ticks, which change with the height that the first layout gives.
        axes[0].figure.get_layout_engine().execute(axes[0].figure)
    return axes


def _by_axes(axes: list[typing.Any], groups: list[Group]) -> list[tuple[typing.Any, Group]]:
    """Every one of the axes once, with all that it has; one alone has everything."""
    places = axes * len(groups) if len(axes) == 1 else axes
    found: dict[int, tuple[typing.Any, Group]] = {}
    for axis, group in zip(places, groups, strict=True):
        if id(axis) in found:
            group = Group("", [*found[id(axis)][1].names, *group.names])
        found[id(axis)] = axis, group
    return list(found.values())


def _title(r: Recorded, group: Group) -> str:
    """The caption that all have; else what names them, or their names if they are few; with the unit that all have."""
    captions = dict.fromkeys(caption_of(r, name) for name in group.names)
    if len(captions) == 1:
        return next(iter(captions))
    units = {r._captions.get(name, {}).get("unit", "") for name in group.names}
    unit = f"[{units.pop()}]" if len(units) == 1 and "" not in units else ""
    return " ".join(filter(None, [group.title or (", ".join(group.names) if len(group.names) < 4 else ""), unit]))


class _Drawn(typing.NamedTuple):
    """What a line shows: a column of a result, the label that was given, and the one that the line has got."""

    of: str
    name: str
    label: str | None
    shown: str = ""


def _token(r: Recorded) -> str:
    return _TOKENS.setdefault(r, uuid.uuid4().hex)


def _line(axis: typing.Any, curve: list[typing.Any], drawn: _Drawn, color: typing.Any = None) -> typing.Any:
    """Every further line has another colour, then another dash; a value between two gaps is a dot."""
    round, place = divmod(len(_ours(axis)), len(LINES))
    dots = np.flatnonzero(is_alone(curve[0] + curve[1])).tolist()
    style = {"marker": ".", "markersize": 2.4, "markevery": dots} if dots else {}
    color, dash = (LINES[place], DASHES[round % len(DASHES)]) if color is None else (color, "-")
    (line,) = axis.plot(*curve, color=color, linestyle=dash, linewidth=1.2, gid=_OURS, **style)
    line._saltus = drawn._replace(shown=line.get_label())
    return line


def _ours(axis: typing.Any) -> list[typing.Any]:
    return [line for line in axis.lines if line.get_gid() == _OURS and hasattr(line, "_saltus")]


def _legend(axis: typing.Any, with_labels: bool = True) -> None:
    """Names what tells the lines apart: their columns, their results, and labels that were given.

    A label that somebody else has set stays, and so does a legend.
    """
    lines = _ours(axis)
    names = {line._saltus.name for line in lines}
    results = list(dict.fromkeys(line._saltus.of for line in lines))
    for line in lines:
        of, name, label, shown = line._saltus
        if label is None and len(results) > 1:
            label = f"result {results.index(of) + 1}"
        words = ", ".join(filter(None, [name if len(names) > 1 else "", label]))
        if words and line.get_label() == shown:
            line.set_label(words)
            line._saltus = line._saltus._replace(shown=words)
    named = [line for line in lines if line.get_label() and not line.get_label().startswith("_")]
    legend = axis.get_legend()
    if named and (with_labels or len(names) > 1) and (legend is None or legend.get_gid() == _OURS):
        axis.legend(handles=named).set_gid(_OURS)


def _caption_once(axis: typing.Any, side: str, caption: str) -> None:
    """Axes of one's own keep the captions that they have."""
    if not getattr(axis, f"get_{side}label")():
        getattr(axis, f"set_{side}label")(caption)


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
    color: typing.Any = None,
) -> typing.Any:
    """One column over another; where the solution slides the line is thick."""
    r, of = as_drawn(r), _token(r)
    pyplot, is_own = _matplotlib(), axis is None
    x, y = str(x), str(y)
    if is_own:
        _, axis = pyplot.subplots(figsize=(5, 4.5), layout="constrained")
    _line(axis, broken_at_jumps(r, r[x], r[y]), _Drawn(of, f"{y} over {x}", label), color)
    held = slides(r)
    here, there = r[x].astype(float), r[y].astype(float)
    here[~held] = float("nan")
    axis.plot(*broken_at_jumps(r, here, there), color=SLIDING, linewidth=2.6, solid_capstyle="butt")
    _mark_events(axis, r, x, y, events)
    axis.plot(r[x][0], r[y][0], "o", color="black", markersize=4)
    _caption_once(axis, "x", caption_of(r, x))
    _caption_once(axis, "y", caption_of(r, y))
    if is_own:
        axis.set_title(r.model)
    _legend(axis)
    return axis
